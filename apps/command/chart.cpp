#include "apps/command/chart.h"

#include <cairo/cairo-svg.h>

#include <algorithm>
#include <cmath>

#include "apps/command/canvas.h"

namespace carom::command {

namespace {

constexpr double width = 960, height = 540;

Color color_of(const ChartSeries& s, std::size_t i, double alpha = 1) {
  return rgb(s.color ? s.color : palette(i), alpha);
}

struct Frame {
  double left = 84, right = width - 28, top = 84, bottom = height - 62;
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  double x(double v) const { return left + (v - x0) / (x1 - x0) * (right - left); }
  double y(double v) const { return bottom - (v - y0) / (y1 - y0) * (bottom - top); }
};

Frame fit(const Chart& chart) {
  Frame f;
  bool any = false;
  for (const ChartSeries& s : chart.series) {
    for (const math::Vec2d p : s.data) {
      if (!any) f.x0 = f.x1 = p.x, f.y0 = f.y1 = p.y;
      any = true;
      f.x0 = std::min(f.x0, p.x);
      f.x1 = std::max(f.x1, p.x);
      f.y0 = std::min(f.y0, p.y);
      f.y1 = std::max(f.y1, p.y);
    }
  }
  // A value that does not change is shown as a level line, not as its rounding noise.
  const double size = std::max(std::fabs(f.y0), std::fabs(f.y1));
  if (f.y1 - f.y0 <= 1e-9 * size || f.y1 == f.y0) {
    const double room = size > 0 ? 0.1 * size : 1;
    f.y0 -= room;
    f.y1 += room;
  }
  if (f.x1 == f.x0) f.x1 = f.x0 + 1;
  if (f.y0 > 0 && f.y0 < 0.35 * f.y1) f.y0 = 0;  // zero is worth showing where it is near
  const double room = 0.06 * (f.y1 - f.y0);
  if (f.y0 != 0) f.y0 -= room;
  f.y1 += room;
  return f;
}

void axes(cairo_t* c, const Chart& chart, const Frame& f) {
  const std::vector<double> xs = ticks(f.x0, f.x1, 9), ys = ticks(f.y0, f.y1, 6);
  const double dx = xs.size() > 1 ? xs[1] - xs[0] : 1, dy = ys.size() > 1 ? ys[1] - ys[0] : 1;
  cairo_set_line_width(c, 1);
  font(c, 14);
  for (const double v : ys) {
    const double y = std::floor(f.y(v)) + 0.5;
    set(c, v == 0 ? rgb(0x9aa5b1) : rgb(0xe3e8ee));
    cairo_move_to(c, f.left, y);
    cairo_line_to(c, f.right, y);
    cairo_stroke(c);
    set(c, rgb(0x4a5560));
    text(c, f.left - 9, y, tick_text(v, dy), 1, 0.62);
  }
  for (const double v : xs) {
    const double x = std::floor(f.x(v)) + 0.5;
    set(c, rgb(0xe3e8ee));
    cairo_move_to(c, x, f.top);
    cairo_line_to(c, x, f.bottom);
    cairo_stroke(c);
    set(c, rgb(0x4a5560));
    text(c, x, f.bottom + 6, tick_text(v, dx), 0.5, 0);
  }
  set(c, rgb(0x9aa5b1));
  cairo_rectangle(c, std::floor(f.left) + 0.5, std::floor(f.top) + 0.5, std::floor(f.right - f.left),
                  std::floor(f.bottom - f.top));
  cairo_stroke(c);
  set(c, rgb(0x2b333b));
  font(c, 15);
  text(c, 0.5 * (f.left + f.right), height - 14, chart.x_label, 0.5, 1);
  cairo_save(c);
  cairo_translate(c, 24, 0.5 * (f.top + f.bottom));
  cairo_rotate(c, -M_PI / 2);
  text(c, 0, 0, chart.y_label, 0.5, 1);
  cairo_restore(c);
  font(c, 20, true);
  text(c, f.left, 32, chart.title, 0, 1);
  font(c, 13);
  set(c, rgb(0x6b7682));
  text(c, f.right, 31, chart.subtitle, 1, 1);
}

void curves(cairo_t* c, const Chart& chart, const Frame& f) {
  cairo_save(c);
  cairo_rectangle(c, f.left, f.top - 1, f.right - f.left + 1, f.bottom - f.top + 2);
  cairo_clip(c);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  for (const bool points : {false, true}) {
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
      const ChartSeries& s = chart.series[i];
      if (s.points != points || s.data.empty()) continue;
      set(c, color_of(s, i));
      if (points || s.data.size() == 1) {
        const auto disc = [&](math::Vec2d p) {
          cairo_new_sub_path(c);
          cairo_arc(c, f.x(p.x), f.y(p.y), 4, 0, 2 * M_PI);
        };
        for (const math::Vec2d p : s.data) disc(p);
        set(c, color_of(s, i, 0.85));
        cairo_fill(c);
        // Rims tell points apart; where the next ones lie on top of each other, they would hide them.
        const auto apart = [&](std::size_t k, std::size_t other) {
          return other >= s.data.size() ||
                 std::hypot(f.x(s.data[k].x) - f.x(s.data[other].x), f.y(s.data[k].y) - f.y(s.data[other].y)) > 7;
        };
        for (std::size_t k = 0; k < s.data.size(); ++k)
          if (apart(k, k - 1) && apart(k, k + 1)) disc(s.data[k]);
        set(c, rgb(0xffffff));
        cairo_set_line_width(c, 1);
        cairo_stroke(c);
        continue;
      }
      cairo_set_line_width(c, 2);
      // No more than a few points a pixel: an SVG should stay small.
      const std::size_t stride = s.data.size() / 4000 + 1;
      for (std::size_t k = 0; k < s.data.size(); k += stride) {
        // Time that runs backwards is a demo that began again: lift the pen.
        const bool lift = k == 0 || s.data[k].x < s.data[k - stride].x - 0.5 * (f.x1 - f.x0);
        if (lift)
          cairo_move_to(c, f.x(s.data[k].x), f.y(s.data[k].y));
        else
          cairo_line_to(c, f.x(s.data[k].x), f.y(s.data[k].y));
      }
      cairo_line_to(c, f.x(s.data.back().x), f.y(s.data.back().y));
      cairo_stroke(c);
    }
  }
  cairo_restore(c);
}

void legend(cairo_t* c, const Chart& chart, const Frame& f) {
  // Smaller where there are many.
  double size = 14, whole = 0;
  do {
    font(c, size);
    whole = -18;
    for (const ChartSeries& s : chart.series) whole += 52 + text_width(c, s.name);
    size -= 0.5;
  } while (f.left + whole > f.right + 10 && size > 9);
  double x = f.left;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& s = chart.series[i];
    const double room = 34 + text_width(c, s.name);
    if (x + room > f.right + 10) break;
    set(c, color_of(s, i));
    if (s.points) {
      cairo_arc(c, x + 11, 60, 4, 0, 2 * M_PI);
      cairo_fill(c);
    } else {
      cairo_set_line_width(c, 3);
      cairo_move_to(c, x, 60);
      cairo_line_to(c, x + 22, 60);
      cairo_stroke(c);
    }
    set(c, rgb(0x2b333b));
    text(c, x + 28, 60, s.name, 0, 0.62);
    x += room + 18;
  }
}

void draw(cairo_t* c, const Chart& chart) {
  set(c, rgb(0xffffff));
  cairo_paint(c);
  const Frame frame = fit(chart);
  axes(c, chart, frame);
  curves(c, chart, frame);
  legend(c, chart, frame);
}

std::string axis_text(const host::Axis& axis) {
  return axis.unit.empty() ? axis.label : axis.label + " / " + axis.unit;
}

}  // namespace

Chart chart_of(const host::Plot& plot, int index, const std::vector<host::Sample>& samples) {
  Chart chart{plot.title, "", axis_text(plot.x), axis_text(plot.y), {}};
  for (const host::Series& s : plot.series)
    chart.series.push_back({s.name, s.style == host::Series::Style::points, s.points, s.color});
  for (const host::Sample& s : samples) {
    if (s.plot != index || s.series < 0 || std::size_t(s.series) >= chart.series.size()) continue;
    auto& data = chart.series[std::size_t(s.series)].data;
    const auto old = plot.series[std::size_t(s.series)].latest
                         ? std::find_if(data.begin(), data.end(), [&](const auto& p) { return p.x == s.x; })
                         : data.end();
    if (old != data.end())
      old->y = s.y;
    else
      data.push_back({s.x, s.y});
  }
  return chart;
}

core::Status write_chart(const Chart& chart, const std::string& path) {
  const std::string svg = path + ".svg";
  {
    const Surface surface(cairo_svg_surface_create(temporary_name(svg).c_str(), width, height));
    const Context context(cairo_create(surface.get()));
    draw(context.get(), chart);
    cairo_surface_finish(surface.get());
    if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return core::Error{svg + ": cannot write"};
  }
  if (const core::Status status = put_in_place(temporary_name(svg), svg); !status.ok()) return status;
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, int(width), int(height)));
  const Context context(cairo_create(surface.get()));
  draw(context.get(), chart);
  return write_png(surface.get(), path + ".png");
}

}  // namespace carom::command
