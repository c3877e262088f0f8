#include "carom/ballistics/drag_curve.h"

#include <utility>

#include "carom/core/string.h"
#include "carom/math/decimal.h"

namespace carom::ballistics {

std::string_view to_string(DragFunction function) { return drag_function_names[std::size_t(function)]; }

std::optional<DragFunction> drag_function_from_name(std::string_view name) {
  for (std::size_t i = 0; i < drag_function_names.size(); ++i)
    if (drag_function_names[i] == name) return DragFunction(i);
  return std::nullopt;
}

DragCurve::DragCurve(double coefficient) : points_{{0, coefficient}} { prepare(Interpolation::linear); }

DragCurve::DragCurve(DragFunction function, Interpolation interpolation) {
  const std::span<const DragPoint> table = drag_table(function);
  points_.assign(table.begin(), table.end());
  prepare(interpolation);
}

core::Result<DragCurve> DragCurve::from_points(std::span<const DragPoint> points, Interpolation interpolation) {
  constexpr std::size_t most = 60000;
  if (points.empty() || points.size() > most)
    return core::Error{core::text("a drag curve has ", points.size(), " nodes, expected 1 to ", most)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DragPoint& point = points[i];
    const std::string name = core::text("node ", i + 1, " of a drag curve: ");
    if (!math::is_finite(point.mach) || point.mach < 0)
      return core::Error{name + core::refused("Mach number", point.mach, "a finite number >= 0")};
    if (!(point.coefficient >= 0 && point.coefficient <= 1e6))
      return core::Error{name + core::refused("C_D", point.coefficient, "a finite number >= 0, at most 1e6")};
    if (i > 0 && !(point.mach > points[i - 1].mach))
      return core::Error{
          name + core::refused("Mach number", point.mach, core::text("more than the ", points[i - 1].mach, " before"))};
  }
  DragCurve curve;
  curve.points_.assign(points.begin(), points.end());
  curve.prepare(interpolation);
  return curve;
}

void DragCurve::prepare(Interpolation interpolation) {
  const double last = points_.back().mach;
  // A table that ends next to Mach 0 has one cell: its number of cells to the Mach number would be infinite.
  cells_per_mach_ = last > 1e-9 ? double(cells) / last : 0;
  std::size_t node = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    while (node + 1 < points_.size() && points_[node].mach * cells_per_mach_ < double(cell)) ++node;
    first_[cell] = std::uint16_t(node);
  }
  const std::size_t intervals = points_.size() - 1;
  pieces_.assign(intervals + 3, {});
  pieces_.front().constant = points_.front().coefficient;
  pieces_[intervals + 1] = {last, points_.back().coefficient};
  pieces_.back().start = 1e308;
  Piece* between = pieces_.data() + 1;
  const auto finish = [&] {
    constexpr double least = 1e-3;  // of C_D, over the interval beside the node
    bends_ = false;
    for (std::size_t i = 0; i <= intervals && intervals > 0; ++i) {
      const Piece &before = pieces_[i], &after = pieces_[i + 1];
      const double x = i > 0 ? after.start - before.start : 0;
      const double jump = after.slope - (before.slope + x * (2 * before.square + x * (3 * before.cube)));
      const double beside = i < intervals ? pieces_[i + 2].start - after.start : x;
      pieces_[i + 1].bends = after.start > 0 && math::abs(jump) * beside > least * after.constant;
      bends_ = bends_ || pieces_[i + 1].bends;
      pieces_[i + 1].turns = before.turns + math::abs(2 * after.square - (2 * before.square + 6 * x * before.cube));
    }
    prepare_squares();
    prepare_rows();
  };
  for (std::size_t i = 0; i < intervals; ++i)
    between[i] = {points_[i].mach, points_[i].coefficient,
                  (points_[i + 1].coefficient - points_[i].coefficient) / (points_[i + 1].mach - points_[i].mach)};
  if (interpolation == Interpolation::linear || intervals < 2) return finish();
  // Slopes at the nodes: zero at peaks, else the harmonic mean of both sides, weighted by their lengths; at the ends
  // that of the line.
  std::vector<double> slope(points_.size());
  slope.front() = between[0].slope;
  slope.back() = between[intervals - 1].slope;
  for (std::size_t i = 1; i < intervals; ++i) {
    const double before = between[i - 1].slope, after = between[i].slope;
    const double h0 = points_[i].mach - points_[i - 1].mach, h1 = points_[i + 1].mach - points_[i].mach;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    slope[i] = before * after > 0 ? (w0 + w1) / (w0 / before + w1 / after) : 0;
  }
  for (std::size_t i = 0; i < intervals; ++i) {
    const double h = points_[i + 1].mach - points_[i].mach, line = between[i].slope;
    between[i].slope = slope[i];
    between[i].square = (3 * line - 2 * slope[i] - slope[i + 1]) / h;
    between[i].cube = (slope[i] + slope[i + 1] - 2 * line) / (h * h);
  }
  finish();
}

// The usual tables have their nodes at multiples of a fortieth.
void DragCurve::prepare_rows() {
  constexpr double most = 2000;
  rows_.reset();
  const double last = points_.back().mach;
  for (const double by_mach : {20.0, 40.0, 50.0, 100.0, 200.0}) {
    bool fits = points_.size() > 1 && last * by_mach < most;
    for (const DragPoint& point : points_) {
      const double place = point.mach * by_mach;
      fits = fits && math::abs(place - math::floor(place + 0.5)) < 1e-9;
    }
    if (!fits) continue;
    rows_per_mach_ = by_mach;
    last_row_ = int(math::floor(last * by_mach + 0.5));
    const std::shared_ptr<Row[]> rows(new Row[std::size_t(last_row_) + 1]);
    for (int i = 0; i <= last_row_; ++i) {
      const Piece& p = piece((i + 0.5) / by_mach);
      const double x = double(i) / by_mach - p.start;
      rows[std::size_t(i)] = {p.constant + x * (p.slope + x * (p.square + x * p.cube)),
                              p.slope + x * (2 * p.square + x * (3 * p.cube)), p.square + 3 * x * p.cube, p.cube};
    }
    rows_ = rows;
    return;
  }
}

void DragCurve::prepare_squares() {
  struct Node {
    double place, coefficient, slope;  // M² + ½, and by M²
  };
  const auto node = [&](int i) {
    // Curves are lines over M near 0, no cubics over M²: the first cell, to M = 1/8, has the cubic that is nearest to a
    // line there, whose beginning has the value of M = .15/8 and the slope of M = .3125/8.
    const double place = std::bit_cast<double>((first_square + std::uint64_t(i)) << square_shift);
    const double mach = math::max(math::sqrt(place - lowest_square), 0.3125 / 8);
    const Value value = with_slope(mach);
    return Node{place, i > 0 ? value.coefficient : (*this)(0.15 / 8), 0.5 * value.slope / mach};
  };
  const std::uint64_t end = cell_of(math::square(points_.back().mach) + lowest_square) - first_square;
  const int last = int(math::min(end, std::uint64_t(most_squares - 2)));
  std::shared_ptr<SquareCell[]> cells(new SquareCell[std::size_t(last) + 2]);
  Node here = node(0);
  for (int i = 0; i <= last; ++i) {
    const Node next = node(i + 1);
    const double h = next.place - here.place, line = (next.coefficient - here.coefficient) / h;
    cells[i] = {here.coefficient, here.slope, (3 * line - 2 * here.slope - next.slope) / h,
                (here.slope + next.slope - 2 * line) / (h * h)};
    here = next;
  }
  farthest_ = here.place;
  cells[last + 1] = {here.coefficient, 0, 0, 0};
  squares_ = std::move(cells);
}

DragCurve DragCurve::scaled(double factor) const {
  DragCurve curve = *this;
  for (DragPoint& point : curve.points_) point.coefficient *= factor;
  for (Piece& p : curve.pieces_)
    p = {p.start, factor * p.constant, factor * p.slope, factor * p.square, factor * p.cube, p.bends, factor * p.turns};
  curve.prepare_squares();
  curve.prepare_rows();
  return curve;
}

core::Result<DragCurve> banded_drag(std::span<const DragPoint> table, std::span<const BallisticCoefficientBand> bands,
                                    double reference) {
  if (!(reference > 0) || !math::is_finite(reference))
    return core::Error{core::refused("reference ballistic coefficient", reference, "a finite number > 0")};
  if (bands.empty()) return core::Error{"expected at least one band"};
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const auto in_band = [&](const std::string& what) { return core::Error{core::text("band ", i + 1, ": ", what)}; };
    if (!(bands[i].coefficient > 0) || !math::is_finite(bands[i].coefficient))
      return in_band(core::refused("ballistic coefficient", bands[i].coefficient, "a finite number > 0"));
    if (!(bands[i].mach >= 0) || !math::is_finite(bands[i].mach))
      return in_band(core::refused("Mach number", bands[i].mach, "a finite number >= 0"));
    if (i > 0 && !(bands[i].mach > bands[i - 1].mach))
      return in_band(
          core::refused("Mach number", bands[i].mach, core::text("more than the ", bands[i - 1].mach, " before")));
  }
  std::vector<DragPoint> points(table.begin(), table.end());
  std::size_t band = 0;
  for (DragPoint& point : points) {
    while (band + 1 < bands.size() && point.mach >= bands[band + 1].mach) ++band;
    point.coefficient *= reference / bands[band].coefficient;
  }
  return DragCurve::from_points(points);
}

core::Result<DragCurve> read_drag_table(std::string_view text, std::string_view name, Interpolation interpolation) {
  std::vector<DragPoint> points;
  const auto separates = [](char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; };
  int number = 0;
  bool drag_first = false;
  for (bool headed = false; !text.empty();) {
    ++number;
    const std::size_t end = math::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, math::min(text.substr(0, end).find('#'), end));
    text.remove_prefix(math::min(end + 1, text.size()));
    const auto skip = [&] {
      while (!line.empty() && separates(line.front())) line.remove_prefix(1);
    };
    double values[2];
    int read = 0;
    skip();
    if (line.empty()) continue;
    for (; read < 2; ++read) {
      const math::DecimalResult value = math::parse_decimal(line);
      if (value.length == 0) break;
      values[read] = value.value;
      line.remove_prefix(value.length);
      if (!line.empty() && !separates(line.front())) break;
      skip();
    }
    if (read == 0 && points.empty() && !headed) {
      headed = true;
      drag_first = line.starts_with("CFM");
      continue;
    }
    if (read < 2 || !line.empty())
      return core::Error{core::text(name, ":", number, ": found ",
                                    line.empty() ? "the end of the line" : core::quoted(line),
                                    ", expected a Mach number and a drag coefficient")};
    if (drag_first) std::swap(values[0], values[1]);
    points.push_back({values[0], values[1]});
    if (points.size() > 1 && !(values[0] > points[points.size() - 2].mach))
      return core::Error{
          core::text(name, ":", number, ": ",
                     core::refused("Mach number", values[0],
                                   core::text("more than the ", points[points.size() - 2].mach, " before")))};
  }
  core::Result<DragCurve> curve = DragCurve::from_points(points, interpolation);
  if (curve) return curve;
  return core::Error{core::text(name, ": ", curve.error().message)};
}

}  // namespace carom::ballistics
