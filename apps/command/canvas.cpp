#include "apps/command/canvas.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace carom::command {

void font(cairo_t* c, double size, bool bold) {
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size);
}

double text_width(cairo_t* c, const std::string& s) {
  cairo_text_extents_t e;
  cairo_text_extents(c, s.c_str(), &e);
  return e.x_advance;
}

void text(cairo_t* c, double x, double y, const std::string& s, double x_align, double y_align) {
  cairo_font_extents_t f;
  cairo_font_extents(c, &f);
  cairo_move_to(c, x - x_align * text_width(c, s),
                y + (1 - y_align) * f.ascent - (y_align > 0.9 ? f.descent * 0.2 : 0));
  cairo_show_text(c, s.c_str());
}

std::uint32_t palette(std::size_t i) {
  constexpr std::uint32_t colors[] = {0x2f6fd0, 0xe07b2e, 0x2e9a5b, 0xc8415a, 0x7d57c1, 0xb8901a, 0x1f8f8f, 0x6b7682};
  return colors[i % 8];
}

std::vector<double> ticks(double low, double high, int count) {
  std::vector<double> out;
  if (!(high > low) || count < 1) return out;
  const double raw = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  const double spacing = (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
  for (double i = std::ceil(low / spacing - 1e-9); i * spacing <= high + 1e-9 * spacing && out.size() < 64; ++i)
    out.push_back(i == 0 ? 0.0 : i * spacing);
  return out;
}

std::string tick_text(double value, double spacing) {
  char buffer[48];
  const double size = std::fabs(value);
  if (value != 0 && (size >= 1e6 || size < 1e-4)) {
    std::snprintf(buffer, sizeof buffer, "%.3g", value);
    return buffer;
  }
  const int digits = spacing > 0 ? std::max(0, int(-std::floor(std::log10(spacing) + 1e-9))) : 2;
  std::snprintf(buffer, sizeof buffer, "%.*f", std::min(digits, 8), value);
  return buffer;
}

std::string short_number(double value, int digits) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
  return buffer;
}

std::string temporary_name(const std::string& path) {
  // Shards on several machines may write the same file in one folder.
  static const std::string own = [] {
    char host[64] = {};
    if (gethostname(host, sizeof host - 1) != 0) host[0] = 0;
    return "." + std::string(host) + "-" + std::to_string(getpid()) + ".part";
  }();
  return path + own;
}

core::Status put_in_place(const std::string& temporary, const std::string& path) {
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) return core::Error{path + ": cannot write: " + error.message()};
  return {};
}

core::Status write_file(const std::string& path, const std::string& bytes) {
  const std::string temporary = temporary_name(path);
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), std::streamsize(bytes.size()));
    if (!out.flush()) return core::Error{path + ": cannot write (is the folder there, and is there room?)"};
  }
  return put_in_place(temporary, path);
}

core::Status write_png(cairo_surface_t* surface, const std::string& path) {
  const std::string temporary = temporary_name(path);
  const cairo_status_t status = cairo_surface_write_to_png(surface, temporary.c_str());
  if (status != CAIRO_STATUS_SUCCESS) return core::Error{path + ": cannot write: " + cairo_status_to_string(status)};
  return put_in_place(temporary, path);
}

}  // namespace carom::command
