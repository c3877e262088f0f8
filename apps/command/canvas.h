// A Cairo surface that is a PNG or an SVG, and what plots and pictures draw alike on it.
#pragma once

#include <cairo/cairo.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "carom/core/result.h"

namespace carom::command {

struct CairoCloser {
  void operator()(cairo_surface_t* s) const { cairo_surface_destroy(s); }
  void operator()(cairo_t* c) const { cairo_destroy(c); }
};
using Surface = std::unique_ptr<cairo_surface_t, CairoCloser>;
using Context = std::unique_ptr<cairo_t, CairoCloser>;

struct Color {
  double r = 0, g = 0, b = 0, a = 1;
};
constexpr Color rgb(std::uint32_t c, double alpha = 1) {
  return {((c >> 16) & 255) / 255.0, ((c >> 8) & 255) / 255.0, (c & 255) / 255.0, alpha};
}
inline void set(cairo_t* c, Color k) { cairo_set_source_rgba(c, k.r, k.g, k.b, k.a); }
void font(cairo_t* c, double size, bool bold = false);
/// x_align, y_align: 0 left or top, 0.5 centre, 1 right or bottom.
void text(cairo_t* c, double x, double y, const std::string& s, double x_align = 0, double y_align = 1);
double text_width(cairo_t* c, const std::string& s);

/// Colours of series and bodies without one: apart in shade for the colour-blind.
std::uint32_t palette(std::size_t i);

/// About `count` round numbers from low to high.
std::vector<double> ticks(double low, double high, int count);
/// The number with no more digits than the distance between ticks calls for.
std::string tick_text(double value, double spacing);
/// "12.5 kJ", "3 mm", …: up to `digits` significant digits.
std::string short_number(double value, int digits = 4);

/// Writes through a temporary file beside `path`, so that a file that is there is whole.
core::Status write_png(cairo_surface_t* surface, const std::string& path);
core::Status write_file(const std::string& path, const std::string& bytes);
std::string temporary_name(const std::string& path);
core::Status put_in_place(const std::string& temporary, const std::string& path);

}  // namespace carom::command
