// Time series and published curves as a chart, in PNG and SVG.
#pragma once

#include <string>
#include <vector>

#include "apps/host/declaration.h"
#include "carom/core/result.h"

namespace carom::command {

struct ChartSeries {
  std::string name;
  bool points = false;
  std::vector<math::Vec2d> data;
  std::uint32_t color = 0;  ///< 0: by its place
};
struct Chart {
  std::string title, subtitle, x_label, y_label;
  std::vector<ChartSeries> series;
};

/// Fills in what a run has sampled.
Chart chart_of(const host::Plot& plot, int index, const std::vector<host::Sample>& samples);
/// Draws to path + ".png" and path + ".svg".
core::Status write_chart(const Chart& chart, const std::string& path);

}  // namespace carom::command
