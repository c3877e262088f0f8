// The cuts of ConvexCell on a graph of corners with three edges each, in arrays of a fixed size: a cut goes round the
// corners that it takes off, and no face's loop is kept. For the many cells of a pattern and for hulls of them; what
// does not fit goes the general way.
#pragma once

#include <array>
#include <bit>

#include "carom/blast/convex_cell.h"
#include "carom/math/simd_double.h"

namespace carom::blast::detail {

class CellCutter {
 public:
  static constexpr unsigned most_corners = 64, most_faces = 64, most_edges = 3 * most_corners;
  using Cut = ConvexCell::Cut;
  /// False where it does not fit. `middle`: a point inside; corners that are gone are taken for it.
  bool load(const ConvexCell& cell, const math::Vec3d& middle);
  /// Becomes another cell, about another point inside.
  void start(const CellCutter& other, const math::Vec3d& middle) {
    const std::size_t corners = other.made_;
    alive_ = other.alive_, copies_ = other.copies_, plane_count_ = other.plane_count_, tolerance_ = other.tolerance_;
    fits_ = true, middle_ = middle, made_ = 0;
    for (std::size_t i = 0; i < corners; ++i) {
      grow(i), put(i, (alive_ >> i & 1) != 0 ? other.corner(i) : middle);
      for (std::size_t h = 4 * i; h < 4 * i + 3; ++h) face_[h] = other.face_[h], twin_[h] = other.twin_[h];
      original_[i] = other.original_[i];
    }
    for (std::size_t f = 0; f < plane_count_; ++f) planes_[f] = other.planes_[f];
  }

  /// What `fits` says after it counts only where it is true.
  Cut clip(const math::Vec3d& normal, double offset, int tag) {
    const std::uint64_t outside = beyond(normal, offset);
    if (outside == 0) return Cut::none;
    if (outside == alive_) return Cut::all;
    const unsigned cap = free_plane();
    if (cap == most_faces) return fits_ = false, Cut::none;
    planes_[cap] = {normal, offset, tag};
    // Edges from a corner outside to one inside, found without a branch: which they are cannot be foretold.
    std::array<std::uint8_t, most_edges> crossings;
    std::size_t count = 0;
    for (std::uint64_t left = outside; left != 0; left &= left - 1) {
      const std::size_t v = std::size_t(std::countr_zero(left));
      for (std::size_t h = 4 * v; h < 4 * v + 3; ++h) {
        crossings[count] = std::uint8_t(h);
        count += ~outside >> (twin_[h] >> 2) & 1;
      }
    }
    // On each a new corner.
    std::uint64_t free = ~alive_, left_faces = 0, right_faces = 0;
    if (std::size_t(std::popcount(free)) < count) return fits_ = false, Cut::none;
    std::array<std::uint8_t, most_faces> corner_with_left;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t h = crossings[k], v = h >> 2, there = twin_[h], w = there >> 2;
      const std::size_t n = std::size_t(std::countr_zero(free));
      free &= free - 1;
      grow(n);
      const double a = distance_[w], t = math::clamp(a / (a - distance_[v]), 0.0, 1.0);
      put(n, corner(w) + t * (corner(v) - corner(w)));
      const std::uint8_t on_left = face_[there], on_right = face_[h];
      left_faces |= std::uint64_t{1} << on_left, right_faces |= std::uint64_t{1} << on_right;
      corner_with_left[on_left] = std::uint8_t(n);
      face_[4 * n] = on_right, face_[4 * n + 1] = std::uint8_t(cap), face_[4 * n + 2] = on_left;
      twin_[4 * n] = std::uint8_t(there), twin_[there] = std::uint8_t(4 * n);
    }
    // A face that is crossed twice: rounding left corners outside in two places.
    if (left_faces != right_faces || std::size_t(std::popcount(left_faces)) != count) return fits_ = false, Cut::none;
    // The edges of the cut: along each face from the corner that has it on its right to the one with it on its left.
    const std::uint64_t made = ~alive_ & ~free;
    for (std::uint64_t left = made; left != 0; left &= left - 1) {
      const std::size_t n = std::size_t(std::countr_zero(left)), m = corner_with_left[face_[4 * n]];
      twin_[4 * n + 1] = std::uint8_t(4 * m + 2), twin_[4 * m + 2] = std::uint8_t(4 * n + 1);
    }
    for (std::uint64_t left = outside; left != 0; left &= left - 1) put(std::size_t(std::countr_zero(left)), middle_);
    alive_ = (alive_ & ~outside) | made;
    copies_ &= alive_ & ~made;
    return Cut::part;
  }
  bool fits() const { return fits_; }

  /// How far the corners go from the point inside: the square of the distance, and a box about them and it.
  void reach(double& squared, math::Vec3d& low, math::Vec3d& high) const {
    using Pair = math::WideDouble<2>;
    const Pair px = Pair::splat(middle_.x), py = Pair::splat(middle_.y), pz = Pair::splat(middle_.z);
    Lanes far{}, lx{}, ly{}, lz{}, hx{}, hy{}, hz{};
    const std::size_t top = std::size_t(64 - std::countl_zero(alive_));
    for (std::size_t i = 0; i < top; i += 2) {
      const auto x = (Pair::load_aligned(&x_[i]) - px).v, y = (Pair::load_aligned(&y_[i]) - py).v,
                 z = (Pair::load_aligned(&z_[i]) - pz).v;
      const auto d = x * x + y * y + z * z;
      far = greater(d, far);
      lx = smaller(x, lx), ly = smaller(y, ly), lz = smaller(z, lz);
      hx = greater(x, hx), hy = greater(y, hy), hz = greater(z, hz);
    }
    squared = math::max(far[0], far[1]);
    low = {math::min(lx[0], lx[1]), math::min(ly[0], ly[1]), math::min(lz[0], lz[1])};
    high = {math::max(hx[0], hx[1]), math::max(hy[0], hy[1]), math::max(hz[0], hz[1])};
  }

  double tolerance() const { return tolerance_; }
  /// Into a cell, corners and faces close together. False where it did not fit after all.
  bool store(std::vector<math::Vec3d>& vertices, std::vector<ConvexCell::Face>& faces,
             std::vector<std::uint16_t>& loops, std::vector<std::uint16_t>& twins) const;

 private:
  using Lanes = math::WideDouble<2>::Vector;
#if defined(__SSE2__)
  static Lanes greater(Lanes a, Lanes b) { return Lanes(_mm_max_pd(a, b)); }
  static Lanes smaller(Lanes a, Lanes b) { return Lanes(_mm_min_pd(a, b)); }
#else
  static Lanes greater(Lanes a, Lanes b) { return a > b ? a : b; }
  static Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }
#endif
  /// Which corners lie beyond a plane.
  std::uint64_t beyond(const math::Vec3d& normal, double offset) {
    const std::size_t top = std::size_t(64 - std::countl_zero(alive_));
    using Pair = math::WideDouble<2>;
    const Pair nx = Pair::splat(normal.x), ny = Pair::splat(normal.y), nz = Pair::splat(normal.z);
    const Pair far = Pair::splat(offset), most = Pair::splat(tolerance_);
    Pair::Mask bits = {1, 2}, found = {0, 0};
    for (std::size_t i = 0; i < top; i += 2, bits <<= 2) {
      const Pair d =
          nx * Pair::load_aligned(&x_[i]) + ny * Pair::load_aligned(&y_[i]) + nz * Pair::load_aligned(&z_[i]) - far;
      d.store_aligned(&distance_[i]);
      found |= (d > most) & bits;
    }
    return std::uint64_t(found[0] | found[1]) & alive_;
  }
  unsigned free_plane() {
    if (plane_count_ < most_faces) return plane_count_++;
    std::uint64_t used = 0;
    for (std::uint64_t left = alive_; left != 0; left &= left - 1)
      for (unsigned k = 0; k < 3; ++k) used |= std::uint64_t{1} << face_[4 * std::size_t(std::countr_zero(left)) + k];
    return unsigned(std::countr_one(used));
  }
  math::Vec3d corner(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  void put(std::size_t i, math::Vec3d p) { x_[i] = p.x, y_[i] = p.y, z_[i] = p.z; }
  /// Corners stand in pairs: the other one of a new pair is no corner yet.
  void grow(std::size_t i) {
    if (i < made_) return;
    made_ = i + 1 + (~i & 1);
    put(i | 1, middle_);
  }
  std::uint8_t next(std::uint8_t half_edge) const {
    const std::uint8_t there = twin_[half_edge];
    return std::uint8_t((there & 3) == 0 ? there + 2 : there - 1);
  }

  struct Plane {
    math::Vec3d normal;
    double offset;
    int tag;
  };
  // Corner i has the half-edges 4i, 4i + 1, 4i + 2, counterclockwise seen from outside; each has a face on its left and
  // the half-edge that comes back. Distances of corners that are gone are computed as well, and masked.
  alignas(16) std::array<double, most_corners> x_, y_, z_, distance_;
  std::array<std::uint8_t, 4 * most_corners> face_, twin_;
  std::array<std::uint8_t, most_corners> original_;  // of a copy
  std::array<Plane, most_faces> planes_;
  std::uint64_t alive_ = 0, copies_ = 0;
  std::size_t made_ = 0;  // corners that have been used
  unsigned plane_count_ = 0;
  double tolerance_ = 0;
  math::Vec3d middle_{};
  bool fits_ = true;
};

}  // namespace carom::blast::detail
