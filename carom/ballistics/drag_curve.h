// The drag of a projectile by Mach number: standard functions, measured curves, and one's own (chapters 6.2, 18.1).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::ballistics {

struct DragPoint {
  double mach = 0;
  double coefficient = 0;  ///< C_D on the frontal area π d²/4
};

/// Reference projectiles of the US Army's Ballistic Research Laboratory: G1 flat base, G2 long cone, G5 short boat
/// tail, G6 flat base with a pointed nose, G7 long boat tail, G8 flat base with a secant ogive, GI Ingalls' G1, GS
/// sphere of 9/16 in, RA4 a .22 rimfire bullet of 40 grains. Tables: BRL, in the public domain, as reprinted by
/// py-ballisticcalc.
enum class DragFunction { g1, g2, g5, g6, g7, g8, gi, gs, ra4 };
inline constexpr std::array<std::string_view, 9> drag_function_names = {"g1", "g2", "g5", "g6", "g7",
                                                                        "g8", "gi", "gs", "ra4"};
CAROM_API std::string_view to_string(DragFunction function);
CAROM_API std::optional<DragFunction> drag_function_from_name(std::string_view name);
/// The nodes of the table, by rising Mach number.
CAROM_API std::span<const DragPoint> drag_table(DragFunction function);

/// What lies between the nodes of a curve.
enum class Interpolation {
  smooth,  ///< cubics with a continuous slope that never leave the range of their nodes (Fritsch & Carlson 1980)
  linear,  ///< straight lines, as many printed tables were computed; integrators lose accuracy at the bends
};

/// C_D over Mach number, through its nodes and constant beyond them.
class CAROM_API DragCurve {
 public:
  /// A constant.
  explicit DragCurve(double coefficient = 0);
  explicit DragCurve(DragFunction function, Interpolation interpolation = Interpolation::smooth);
  /// At least one node; Mach numbers from 0 up, strictly rising, and finite coefficients ≥ 0. An error names the node.
  static core::Result<DragCurve> from_points(std::span<const DragPoint> points,
                                             Interpolation interpolation = Interpolation::smooth);

  /// `mach` ≥ 0.
  double operator()(double mach) const { return with_slope(mach).coefficient; }
  struct Value {
    double coefficient = 0, slope = 0;  ///< C_D and dC_D/dM
  };
  Value with_slope(double mach) const {
    const Piece& p = piece(mach);
    const double x = mach - p.start;
    return {math::max(p.constant + x * (p.slope + x * (p.square + x * p.cube)), 0.0),  // rounding, where it is zero
            p.slope + x * (2 * p.square + x * (3 * p.cube))};
  }

  /// C_D and dC_D/dM² by the square of the Mach number, within about a thousandth of the curve; constant from Mach 11
  /// on: to find a cell takes a few bits, where the curve itself takes a root and a search.
  Value roughly(double mach2) const {
    const double place = math::min(farthest_, mach2 + lowest_square);  // in this order for what is no number
    const std::uint64_t cell = cell_of(place);
    const double x = place - std::bit_cast<double>(cell << square_shift);
    const SquareCell& c = squares_[std::ptrdiff_t(cell - first_square)];
    return {(c.constant + x * c.slope) + (x * x) * (c.square + x * c.cube),
            c.slope + x * (2 * c.square + x * (3 * c.cube))};
  }

  /// Has it nodes at which its slope jumps, by more than a smooth curve's?
  bool has_bends() const { return bends_; }
  /// Calls `f` with the Mach numbers of those between `low` and `high`, in rising order.
  template <class F>
  void for_each_bend(double low, double high, F&& f) const {
    const Piece* end = pieces_.data() + pieces_.size() - 1;
    for (const Piece* p = &piece(low) + 1; p < end && p->start < high; ++p)
      if (p->bends) f(p->start);
  }

  /// By how much its second derivative jumps at the nodes up to a Mach number, in all.
  double turns(double mach) const { return piece(mach).turns; }

  std::span<const DragPoint> points() const { return points_; }
  /// The curve times a form factor.
  DragCurve scaled(double factor) const;

  static constexpr std::size_t cells = 256;  // in one of the usual tables no cell holds two nodes
  /// A cubic in the Mach number less that at its start.
  struct Piece {
    double start = 0, constant = 0, slope = 0, square = 0, cube = 0;
    bool bends = false;  // at its start
    double turns = 0;    // by how much second derivatives jump at starts up to this one, in all
  };
  /// Likewise, for one cell of a grid that all nodes lie on.
  struct Row {
    double constant = 0, slope = 0, square = 0, cube = 0;
  };
  /// For kernels in lanes: the pieces, one beyond all at the end, and for each of so many cells the first that can hold
  /// its Mach numbers; the rows where there is such a grid, the last one for all Mach numbers beyond.
  struct Table {
    const Piece* pieces;
    const std::uint16_t* first;
    double cells_per_mach;
    const Row* rows;
    double rows_per_mach, last_row;
    bool varies;  // over the Mach number
  };
  Table table() const {
    return {pieces_.data(), first_.data(),     cells_per_mach_,   rows_.get(),
            rows_per_mach_, double(last_row_), points_.size() > 1};
  }

 private:
  const Piece& piece(double mach) const {
    // One cell of a uniform grid tells the first piece that can hold it: a step or two from there.
    const int cell = int(math::min(math::max(0.0, mach) * cells_per_mach_, double(cells - 1)));
    const Piece* p = pieces_.data() + first_[std::size_t(cell)];
    while (p[1].start < mach) ++p;
    return *p;
  }
  // Cubics between nodes at a thirty-second of a binary octave of M² + ½.
  struct SquareCell {
    double constant = 0, slope = 0, square = 0, cube = 0;
  };
  static constexpr double lowest_square = 0.5;
  static constexpr int square_shift = 47, most_squares = 256;
  static constexpr std::uint64_t cell_of(double place) { return std::bit_cast<std::uint64_t>(place) >> square_shift; }
  static constexpr std::uint64_t first_square = std::bit_cast<std::uint64_t>(lowest_square) >> square_shift;
  void prepare(Interpolation interpolation);
  void prepare_squares();
  void prepare_rows();
  std::vector<DragPoint> points_;
  std::vector<Piece> pieces_;  // before the first node, from each to the next, after the last, and one beyond all
  std::array<std::uint16_t, cells> first_{};
  std::shared_ptr<const SquareCell[]> squares_;  // shared by copies
  std::shared_ptr<const Row[]> rows_;            // likewise
  double cells_per_mach_ = 0, farthest_ = 0, rows_per_mach_ = 0;
  int last_row_ = 0;
  bool bends_ = false;
};

/// A ballistic coefficient that holds from a Mach number upward.
struct BallisticCoefficientBand {
  double mach = 0;
  double coefficient = 1;  ///< lb/in²
};
/// Several coefficients for ranges of speed as one curve, for use with the coefficient `reference`: the drag of the
/// table's nodes times reference/coefficient, each band's from its Mach number up to the next one's, the first one's
/// below it too; smooth over the node on either side of a change. Bands by rising Mach number.
CAROM_API core::Result<DragCurve> banded_drag(std::span<const DragPoint> table,
                                              std::span<const BallisticCoefficientBand> bands, double reference);

/// Two columns, Mach number and C_D, separated by spaces, tabs, commas or semicolons; a heading line, empty lines and
/// comments after # are skipped. Where the heading begins with "CFM", as in the .drg files of makers' radar data, C_D
/// comes first. Errors name `name`, the line, what was found and what was expected.
CAROM_API core::Result<DragCurve> read_drag_table(std::string_view text, std::string_view name,
                                                  Interpolation interpolation = Interpolation::smooth);

}  // namespace carom::ballistics
