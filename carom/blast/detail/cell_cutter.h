// The cuts of ConvexCell in arrays of a fixed size: corners and faces keep their places, and bit masks say which faces
// a cut touches. For the many cells of a pattern; what does not fit goes the general way.
#pragma once

#include <array>
#include <bit>
#include <cstring>

#include "carom/blast/convex_cell.h"
#include "carom/math/simd_double.h"

namespace carom::blast::detail {

class CellCutter {
 public:
  static constexpr int most_corners = 64, most_faces = 64, longest_loop = 24;
  using Cut = ConvexCell::Cut;

  /// False where it does not fit.
  bool load(const ConvexCell& cell, double tolerance) {
    const auto vertices = cell.vertices();
    if (vertices.size() > most_corners || cell.faces().size() > most_faces) return false;
    alive_ = vertices.size() == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << vertices.size()) - 1;
    used_ = 0;
    face_count_ = 0;
    tolerance_ = tolerance;
    fits_ = true;
    for (std::size_t i = 0; i < vertices.size(); ++i) put(i, vertices[i]);
    for (const ConvexCell::Face& face : cell.faces()) {
      if (face.count > longest_loop) return false;
      Face& f = faces_[add_face()];
      f.normal = face.normal, f.offset = face.offset, f.tag = face.tag;
      for (const std::uint16_t v : cell.loop(face)) f.push(std::uint8_t(v));
    }
    return true;
  }

  /// What `fits` says after it counts only where it is true.
  Cut clip(const math::Vec3d& normal, double offset, int tag) {
    std::uint64_t outside = 0;
    const int top = 64 - std::countl_zero(alive_);
    using Pair = math::WideDouble<2>;
    const Pair nx = Pair::splat(normal.x), ny = Pair::splat(normal.y), nz = Pair::splat(normal.z);
    const Pair far = Pair::splat(offset), most = Pair::splat(tolerance_);
    Pair::Mask bits = {1, 2}, found = {0, 0};
    for (std::size_t i = 0; i < std::size_t(top); i += 2, bits <<= 2) {
      const Pair d =
          nx * Pair::load_aligned(&x_[i]) + ny * Pair::load_aligned(&y_[i]) + nz * Pair::load_aligned(&z_[i]) - far;
      d.store_aligned(&distance_[i]);
      found |= (d > most) & bits;
    }
    outside = std::uint64_t(found[0] | found[1]);
    outside &= alive_;
    if (outside == 0) return Cut::none;
    if (outside == alive_) return Cut::all;
    crossing_count_ = 0;
    made_ = 0;
    int kept = 0;
    for (int k = 0; k < face_count_; ++k) {
      const std::uint8_t place = order_[std::size_t(k)];
      Face& face = faces_[place];
      if ((face.mask & outside) == 0) {
        order_[std::size_t(kept++)] = place;
      } else if ((face.mask & ~outside) == 0) {
        used_ &= ~(std::uint64_t{1} << place);
      } else {
        trim(face, outside);
        if (!fits_) return Cut::none;
        order_[std::size_t(kept++)] = place;
      }
    }
    face_count_ = kept;
    for (int start = 0; start < crossing_count_; ++start) {
      if (crossings_[std::size_t(start)].next < 0) continue;
      if (used_ == ~std::uint64_t{0}) return fits_ = false, Cut::none;
      Face& cap = faces_[add_face()];
      cap.normal = normal, cap.offset = offset, cap.tag = tag;
      for (int at = start; crossings_[std::size_t(at)].next >= 0;) {
        if (cap.count == longest_loop) return fits_ = false, Cut::none;
        Crossing& x = crossings_[std::size_t(at)];
        cap.push(x.corner);
        at = x.next;
        x.next = -1;
      }
    }
    alive_ = (alive_ & ~outside) | made_;
    return Cut::part;
  }
  bool fits() const { return fits_; }

  /// How far the corners go from a point: the square of the distance, and a box about them and it.
  void reach(const math::Vec3d& point, double& squared, math::Vec3d& low, math::Vec3d& high) const {
    using Pair = math::WideDouble<2>;
    const Pair px = Pair::splat(point.x), py = Pair::splat(point.y), pz = Pair::splat(point.z);
    typename Pair::Vector far{}, lx{}, ly{}, lz{}, hx{}, hy{}, hz{};
    const std::size_t top = std::size_t(64 - std::countl_zero(alive_));
    for (std::size_t i = 0; i < top; i += 2) {
      // A corner that is gone is taken for the point.
      const std::int64_t even = std::int64_t(alive_ >> i & 1), odd = std::int64_t(alive_ >> i >> 1 & 1);
      const Pair::Mask here = {-even, -odd};
      const auto of = [&](Pair d) { return typename Pair::Vector(Pair::Mask(d.v) & here); };
      const auto x = of(Pair::load_aligned(&x_[i]) - px), y = of(Pair::load_aligned(&y_[i]) - py),
                 z = of(Pair::load_aligned(&z_[i]) - pz);
      const auto d = x * x + y * y + z * z;
      far = d > far ? d : far;
      lx = x < lx ? x : lx, ly = y < ly ? y : ly, lz = z < lz ? z : lz;
      hx = x > hx ? x : hx, hy = y > hy ? y : hy, hz = z > hz ? z : hz;
    }
    squared = math::max(far[0], far[1]);
    low = {math::min(lx[0], lx[1]), math::min(ly[0], ly[1]), math::min(lz[0], lz[1])};
    high = {math::max(hx[0], hx[1]), math::max(hy[0], hy[1]), math::max(hz[0], hz[1])};
  }
  /// Into a cell, corners and faces close together.
  void store(std::vector<math::Vec3d>& vertices, std::vector<ConvexCell::Face>& faces,
             std::vector<std::uint16_t>& loops) const {
    vertices.clear(), faces.clear(), loops.clear();
    std::array<std::uint16_t, 64> place{};
    vertices.reserve(std::size_t(std::popcount(alive_)));
    for (std::uint64_t left = alive_; left != 0; left &= left - 1) {
      const std::size_t i = std::size_t(std::countr_zero(left));
      place[i] = std::uint16_t(vertices.size());
      vertices.push_back(corner(i));
    }
    faces.reserve(std::size_t(face_count_));
    std::size_t total = 0;
    for (int k = 0; k < face_count_; ++k) total += faces_[order_[std::size_t(k)]].count;
    loops.reserve(total);
    for (int k = 0; k < face_count_; ++k) {
      const Face& f = faces_[order_[std::size_t(k)]];
      faces.push_back({f.normal, f.offset, f.tag, std::uint32_t(loops.size()), f.count});
      for (std::size_t i = 0; i < f.count; ++i) loops.push_back(place[f.loop[i]]);
    }
  }

 private:
  struct Face {
    math::Vec3d normal;
    double offset;
    std::uint64_t mask;
    int tag;
    std::uint8_t count;
    std::array<std::uint8_t, 2 * longest_loop + 2> loop;  // with room for moves of a fixed length
    void push(std::uint8_t v) {
      loop[count++] = v;
      mask |= std::uint64_t{1} << v;
    }
  };
  struct Crossing {
    std::uint8_t inside, outside, corner;
    std::int16_t next;
  };

  std::uint8_t add_face() {
    const std::uint8_t place = std::uint8_t(std::countr_zero(~used_));
    used_ |= std::uint64_t{1} << place;
    order_[std::size_t(face_count_++)] = place;
    faces_[place].mask = 0, faces_[place].count = 0;
    return place;
  }
  int crossing(std::uint8_t inside, std::uint8_t outside) {
    // What the table says of an edge counts where the crossing agrees: it need not be cleared.
    std::uint8_t& number = number_[inside][outside];
    if (number < crossing_count_ && crossings_[number].inside == inside && crossings_[number].outside == outside)
      return number;
    const std::uint64_t free = ~(alive_ | made_);
    if (free == 0 || crossing_count_ == most_corners) {
      fits_ = false;
      return 0;
    }
    const int slot = std::countr_zero(free);
    made_ |= std::uint64_t{1} << slot;
    const double a = distance_[inside], b = distance_[outside], t = math::clamp(a / (a - b), 0.0, 1.0);
    put(std::size_t(slot), corner(inside) + t * (corner(outside) - corner(inside)));
    number = std::uint8_t(crossing_count_);
    crossings_[std::size_t(crossing_count_)] = {inside, outside, std::uint8_t(slot), -1};
    return crossing_count_++;
  }
  /// Takes the corners outside off a loop. They stand side by side in it but for what rounding does to short edges.
  void trim(Face& face, std::uint64_t outside) {
    const unsigned count = face.count, all = (1u << count) - 1;
    unsigned out = 0;
    for (unsigned k = 0; k < 8; ++k) out |= unsigned(outside >> (face.loop[k] & 63) & 1) << k;
    for (unsigned k = 8; k < count; ++k) out |= unsigned(outside >> face.loop[k] & 1) << k;
    out &= all;
    const unsigned out_before = (out << 1 | out >> (count - 1)) & all, starts = out & ~out_before;
    if ((starts & (starts - 1)) != 0) return trim_islands(face, outside);
    const unsigned start = unsigned(std::countr_zero(starts)), end = unsigned(std::countr_zero(out_before & ~out));
    const std::uint8_t from = face.loop[(start == 0 ? count : start) - 1], gone = face.loop[start],
                       last = face.loop[(end == 0 ? count : end) - 1], back = face.loop[end];
    // Along the loop, so that new corners have the same numbers whichever way they are found.
    const bool leaves_first = start < end;
    int exit = 0, entry = 0;
    if (leaves_first) exit = crossing(from, gone);
    entry = crossing(back, last);
    if (!leaves_first) exit = crossing(from, gone);
    if (!fits_) return;
    const std::uint8_t exit_corner = crossings_[std::size_t(exit)].corner,
                       entry_corner = crossings_[std::size_t(entry)].corner;
    // The edge of the cut runs from exit to entry on this face, and back on the cap.
    crossings_[std::size_t(entry)].next = std::int16_t(exit);
    const unsigned left = leaves_first ? count - (end - start) + 2 : start - end + 2;
    if (left > unsigned(longest_loop)) {
      fits_ = false;
      return;
    }
    // Moves of a fixed length, which are two or three instructions; what lies behind the loop does not count.
    std::uint8_t* const loop = face.loop.data();
    if (leaves_first) {
      std::memmove(loop + start + 2, loop + end, longest_loop);
      loop[start] = exit_corner, loop[start + 1] = entry_corner;
    } else {
      std::memmove(loop + 1, loop + end, longest_loop);
      loop[0] = entry_corner, loop[left - 1] = exit_corner;
    }
    face.count = std::uint8_t(left);
    face.mask = (face.mask & ~outside) | std::uint64_t{1} << exit_corner | std::uint64_t{1} << entry_corner;
  }
  void trim_islands(Face& face, std::uint64_t outside) {
    std::array<std::uint8_t, 2 * longest_loop> loop;
    std::size_t count = 0;
    std::uint8_t before = face.loop[face.count - 1u];
    bool out_before = (outside >> before & 1) != 0;
    int exit = -1, first_entry = -1;
    for (std::size_t k = 0; k < face.count; ++k) {
      const std::uint8_t here = face.loop[k];
      const bool out_here = (outside >> here & 1) != 0;
      if (out_before != out_here) {
        const int x = out_here ? crossing(before, here) : crossing(here, before);
        if (!fits_) return;
        loop[count++] = crossings_[std::size_t(x)].corner;
        // The edge of the cut runs from exit to entry on this face, and back on the cap.
        if (out_here) {
          exit = x;
        } else if (exit < 0) {
          first_entry = x;
        } else {
          crossings_[std::size_t(x)].next = std::int16_t(exit);
          exit = -1;
        }
      }
      if (!out_here) loop[count++] = here;
      before = here, out_before = out_here;
    }
    if (first_entry >= 0) crossings_[std::size_t(first_entry)].next = std::int16_t(exit);
    if (count > std::size_t(longest_loop)) {
      fits_ = false;
      return;
    }
    face.count = 0, face.mask = 0;
    for (std::size_t k = 0; k < count; ++k) face.push(loop[k]);
  }

  math::Vec3d corner(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  void put(std::size_t i, math::Vec3d p) { x_[i] = p.x, y_[i] = p.y, z_[i] = p.z; }

  // Of corners that are gone distances are computed as well, and masked.
  alignas(16) std::array<double, most_corners> x_{}, y_{}, z_{}, distance_{};
  std::array<Face, most_faces> faces_{};
  std::array<std::uint8_t, most_faces> order_;
  std::array<Crossing, most_corners> crossings_;
  std::uint8_t number_[most_corners][most_corners] = {};  // of the crossing of an edge, by its corners
  std::uint64_t alive_ = 0, used_ = 0, made_ = 0;
  int face_count_ = 0, crossing_count_ = 0;
  double tolerance_ = 0;
  bool fits_ = true;
};

}  // namespace carom::blast::detail
