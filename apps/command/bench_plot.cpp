// Carom's time beside the fastest peer's, scene by scene, from rows as `carom bench --json` prints them.
#include <cairo/cairo-svg.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/command/canvas.h"
#include "apps/command/command.h"

namespace carom::command {
namespace benchmark_plot {

struct Bars {
  std::string scene;
  double ratio[2] = {0, 0};  ///< Carom's time over the fastest peer's, by threads − 1; 0: not measured
};

core::Result<std::vector<Bars>> read_ratios(const std::string& path) {
  std::ifstream in(path);
  const nlohmann::json rows = nlohmann::json::parse(in, nullptr, false);
  if (!rows.is_array()) return core::Error{path + ": not a list of rows as `carom bench --json` prints"};
  std::vector<std::string> order;
  std::map<std::pair<std::string, int>, std::pair<double, double>> times;  // Carom's, the fastest peer's
  for (const nlohmann::json& row : rows) {
    if (!row.is_object() || !row.contains("scene") || !row["scene"].is_string() || !row.contains("threads") ||
        !row["threads"].is_number_integer() || !row.contains("ms") || !row["ms"].is_number() ||
        !row.contains("engine") || !row["engine"].is_string())
      return core::Error{path + ": a row without scene, engine, threads and ms"};
    const std::string scene = row["scene"];
    if (std::find(order.begin(), order.end(), scene) == order.end()) order.push_back(scene);
    auto& [carom, peer] = times[{scene, row["threads"].get<int>()}];
    double& mine = row["engine"] == "carom" ? carom : peer;
    const double ms = row["ms"];
    mine = mine > 0 ? std::min(mine, ms) : ms;
  }
  std::vector<Bars> bars;
  for (const std::string& scene : order) {
    Bars b{scene, {}};
    for (int threads : {1, 2})
      if (const auto [carom, peer] = times[{scene, threads}]; carom > 0 && peer > 0)
        b.ratio[threads - 1] = carom / peer;
    if (b.ratio[0] > 0 || b.ratio[1] > 0) bars.push_back(b);
  }
  if (bars.empty()) return core::Error{path + ": no scene that was measured with Carom and with a peer"};
  return bars;
}

constexpr double plot_width = 900, left = 210, right = 40, top = 70, row_height = 24, bottom = 46;

void draw(cairo_t* c, const std::vector<Bars>& bars, double height) {
  // Ratios on a logarithmic axis: half and double are equally far from one.
  constexpr double low = 0.125, high = 4;
  const auto x = [&](double ratio) {
    return left + (plot_width - left - right) * std::log(std::clamp(ratio, low, high) / low) / std::log(high / low);
  };
  set(c, rgb(0xffffff));
  cairo_paint(c);
  set(c, rgb(0x20262c));
  font(c, 17, true);
  text(c, 20, 26, "Time of a step, Carom / the fastest build of the peer");
  font(c, 12);
  text(c, 20, 46, "left of the line Carom is faster; dark: one thread, light: two threads of both");
  cairo_set_line_width(c, 1);
  for (const double tick : {0.125, 0.25, 0.5, 1.0, 2.0, 4.0}) {
    set(c, rgb(tick == 1 ? 0x20262c : 0xd5dae0));
    cairo_move_to(c, x(tick), top);
    cairo_line_to(c, x(tick), height - bottom);
    cairo_stroke(c);
    set(c, rgb(0x4a545e));
    text(c, x(tick), height - bottom + 6, short_number(tick, 3), 0.5, 0);
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = top + row_height * double(i);
    set(c, rgb(0x20262c));
    text(c, left - 10, y + 0.5 * row_height, bars[i].scene, 1, 0.6);
    for (int k = 0; k < 2; ++k) {
      if (bars[i].ratio[k] == 0) continue;
      const double from = x(1), to = x(bars[i].ratio[k]);
      set(c, rgb(bars[i].ratio[k] <= 1 ? 0x2f6fd0 : 0xe07b2e, k == 0 ? 1 : 0.45));
      cairo_rectangle(c, std::min(from, to), y + 3 + 9 * k, std::max(1.0, std::fabs(to - from)), 8);
      cairo_fill(c);
    }
  }
}

}  // namespace benchmark_plot

int plot_benchmarks(const std::string& rows, const std::string& picture) {
  using namespace benchmark_plot;
  const auto bars = read_ratios(rows);
  if (!bars) return fail(exit_input, bars.error().message);
  const double height = top + row_height * double(bars->size()) + bottom;
  const std::string temporary = temporary_name(picture);
  {
    const Surface surface(cairo_svg_surface_create(temporary.c_str(), plot_width, height));
    const Context c(cairo_create(surface.get()));
    draw(c.get(), *bars, height);
    cairo_surface_finish(surface.get());
    if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS)
      return fail(exit_system, picture + ": cannot write");
  }
  if (const core::Status placed = put_in_place(temporary, picture); !placed)
    return fail(exit_system, placed.error().message);
  return exit_ok;
}

}  // namespace carom::command
