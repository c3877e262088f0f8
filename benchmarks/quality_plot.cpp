// The picture of docs/quality.md: errors over the bars of the gates.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "benchmarks/quality.h"

namespace carom::bench {
namespace {

constexpr double low = 1e-4, high = 1e4;  ///< of the bar
constexpr double left = 470, width = 500, top = 84, row_height = 25, bottom = 40;
constexpr double apart = 2.2;  ///< engines' marks, downwards, so that equal ones are seen

std::string escaped(const std::string& s) {
  std::string out;
  for (const char c : s) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return out;
}
double x_of(double ratio) { return left + width * std::log(std::clamp(ratio, low, high) / low) / std::log(high / low); }
template <class... Arguments>
void append(std::string& out, const char* format, Arguments... arguments) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, arguments...);
  out += buffer;
}
void mark(std::string& out, std::size_t engine, double x, double y) {
  static constexpr const char* colours[] = {"#2f6fd0", "#d0482f", "#e8a08f", "#2f9a5b", "#98d0ae", "#8a6d3b"};
  const char* colour = colours[engine % 6];
  switch (engine % 6) {
    case 0:
      append(out, "<circle cx='%.1f' cy='%.1f' r='6' fill='%s'/>\n", x, y, colour);
      break;
    case 1:
    case 2:
      append(out, "<rect x='%.1f' y='%.1f' width='9' height='9' fill='%s'/>\n", x - 4.5, y - 4.5, colour);
      break;
    case 3:
    case 4:
      append(out, "<path d='M%.1f %.1fl5.5 10h-11z' fill='%s'/>\n", x, y - 5.5, colour);
      break;
    default:
      append(out, "<path d='M%.1f %.1fl6 6l-6 6l-6-6z' fill='%s'/>\n", x, y - 6, colour);
  }
}

}  // namespace

std::string svg(const QualityTable& table) {
  std::vector<Figure> rows = table.rows();
  std::erase_if(rows, [](const Figure& f) { return f.bar <= 0; });
  const double height = top + row_height * double(rows.size()) + bottom, total = left + width + 30;
  std::string out;
  append(out, "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' viewBox='0 0 %.0f %.0f' ", total,
         height, total, height);
  out += "font-family='DejaVu Sans, Helvetica, Arial, sans-serif' font-size='12' fill='#20262c'>\n";
  out += "<rect width='100%' height='100%' fill='#ffffff'/>\n";
  append(out, "<text x='20' y='28' font-size='17' font-weight='bold'>Error over the bar of the gate, %s</text>\n",
         table.dimension == 2 ? "in the plane" : "in space");
  append(out, "<text x='20' y='48'>left of the line the bar is met; what lies beyond an end is set there</text>\n");
  double x = 20;
  for (std::size_t i = 0; i < table.engines.size(); ++i) {
    mark(out, i, x + 6, 66);
    append(out, "<text x='%.1f' y='70'>%s</text>\n", x + 18, escaped(table.engines[i].name).c_str());
    x += 36 + 7.6 * double(table.engines[i].name.size());
  }
  const double end = height - bottom;
  for (int k = -4; k <= 4; ++k) {
    const double at = x_of(std::pow(10.0, k));
    append(out, "<path d='M%.1f %.1fV%.1f' stroke='%s'/>\n", at, top, end, k == 0 ? "#20262c" : "#d5dae0");
    static constexpr const char* labels[] = {"≤ .0001", ".001", ".01", ".1", "1", "10", "100", "1000", "≥ 10 000"};
    append(out, "<text x='%.1f' y='%.1f' text-anchor='middle' fill='#4a545e'>%s</text>\n", at, end + 18, labels[k + 4]);
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = top + row_height * (double(r) + 0.5);
    if (r % 2 == 1)
      append(out, "<rect x='0' y='%.1f' width='%.1f' height='%.1f' fill='#000000' fill-opacity='0.035'/>\n",
             y - row_height / 2, total, row_height);
    append(out, "<text x='%.1f' y='%.1f' text-anchor='end'>%s</text>\n", left - 16, y + 4,
           escaped(rows[r].what).c_str());
    // Carom's mark last, on top of the others.
    for (std::size_t i = table.engines.size(); i-- > 0;)
      if (const Figure* f = table.find(i, rows[r])) {
        const double ratio = std::isfinite(f->value) ? f->error() / f->bar : high;
        mark(out, i, x_of(ratio), y + apart * (double(i) - 0.5 * double(table.engines.size() - 1)));
      }
  }
  return out + "</svg>\n";
}

}  // namespace carom::bench
