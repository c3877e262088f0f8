// Directions along which a shape keeps off the triangles that it passes.
#pragma once

#include <bit>

#include "carom/geometry/detail/contact_points.h"
#include "carom/geometry/detail/placed_corners.h"

namespace carom::geometry::detail {

/// Directions along which a shape keeps off parts of what it passes: its neighbours are mostly off along the same.
class OffDirections {
 public:
  using Four = math::WideFloat<4>;

  OffDirections(const PlacedCorners& corners, const ShapeWay& approach, float radius, float margin, bool solid)
      : corners_(corners), most_(approach.margin + approach.bend + radius), solid_(solid) {
    used_ = corners.known() && approach.margin < margin;
    for (float& x : lanes_) x = 0;
    for (float& x : now_) x = -3.4e38f;
    for (float& x : floor_) x = -3.4e38f;
  }
  /// Begins with the two that were kept when the pair was looked at last; the second is the coarser, in 12 bits each.
  void begin_with(const PairCache& cache) {
    if (!used_ || cache.kind != cached_direction) return;
    begin_with(unpack_direction(cache.d));
    const std::uint32_t a = cache.a, b = cache.b, c = cache.c;
    if ((a | b | c) != 0) begin_with(unpack_direction(a << 24 | (b & 0xf0) << 16 | (b & 0xf) << 12 | c << 4));
  }
  /// Keeps the two that were of most use.
  void keep(PairCache& cache) const {
    const int first = most_useful(-1);
    if (first < 0) return;
    cache = {.kind = cached_direction, .d = pack_direction(direction(first))};
    const int second = most_useful(first);
    if (second < 0) return;
    const std::uint32_t p = pack_direction(direction(second));
    cache.a = std::uint8_t(p >> 24);
    cache.b = std::uint8_t((p >> 16 & 0xf0) | (p >> 12 & 0xf));
    cache.c = std::uint8_t(p >> 4);
  }
  /// What groups of triangles are to know of them, and how many each of those kept off.
  void tell(PlacedShape& shape) const {
    shape.directions = lanes_, shape.floor = floor_, shape.now = now_, shape.direction_count = count_;
  }
  void count_uses(const int (&uses)[8]) {
    for (int i = 0; i < count_; ++i) uses_[i] += uses[i];
  }
  /// m: what is farther off, now and then, does not count.
  float most() const { return most_; }
  /// Counts what was learned.
  int learned() const { return learned_; }
  /// Is a triangle (seen from the origin of the corners) out of reach, now and as the shape goes on?
  bool keeps_off(Vec3f p, Vec3f q, Vec3f r) {
    for (int i = 0; i < count_; i += 4) {
      const std::uint32_t lanes = bitmask(Four::load(floor_ + i) - farthest(i, p, q, r) > Four::splat(most_));
      if (lanes == 0) continue;
      ++uses_[i + std::countr_zero(lanes)];
      return true;
    }
    return false;
  }
  /// Is it worth a look: off now by so much (m, times its length)?
  bool may_learn(double now, const Vec3d& direction) const {
    return used_ && now * now > double(most_) * double(most_) * length_squared(direction);
  }
  /// Looks along a direction of any length, and remembers it if it does.
  bool learn(Vec3f n, Vec3f p, Vec3f q, Vec3f r) {
    if (!used_ || (solid_ && n.y <= 0)) return false;
    const float off = corners_.least(n) - max(dot(n, p), max(dot(n, q), dot(n, r)));
    if (!(off > 0 && off * off > 0.99f * most_ * most_ * length_squared(n))) return false;
    const float size = length(n);
    if (!(size > 1e-12f)) return false;
    n = n * (1 / size);
    const float now = corners_.least(n), then = corners_.least_then(n);
    if (!(min(now, then) - max(dot(n, p), max(dot(n, q), dot(n, r))) > most_)) return false;
    add(n, now, then, 1);
    ++learned_;
    return true;
  }

 private:
  void begin_with(Vec3f n) {
    if (!(solid_ && n.y <= 0)) add(n, corners_.least(n), corners_.least_then(n), 0);
  }
  Vec3f direction(int i) const {
    const float* lane = lanes_ + 12 * (i / 4) + i % 4;
    return {lane[0], lane[4], lane[8]};
  }
  /// Which kept off the most triangles, other than `but`; −1: none did.
  int most_useful(int but) const {
    int best = -1;
    for (int i = 0; i < count_; ++i)
      if (i != but && uses_[i] > (best < 0 ? 0 : uses_[best])) best = i;
    return best;
  }
  void add(Vec3f n, float now, float then, int uses) {
    const int i = next_;
    next_ = (next_ + 1) % capacity;
    count_ = max(count_, i + 1);
    float* lane = lanes_ + 12 * (i / 4) + i % 4;
    lane[0] = n.x, lane[4] = n.y, lane[8] = n.z;
    now_[i] = now, floor_[i] = min(now, then), uses_[i] = uses;
  }
  Four farthest(int i, Vec3f p, Vec3f q, Vec3f r) const {
    const float* lane = lanes_ + 3 * i;
    const Four x = Four::load(lane), y = Four::load(lane + 4), z = Four::load(lane + 8);
    const auto along = [&](Vec3f v) { return x * Four::splat(v.x) + y * Four::splat(v.y) + z * Four::splat(v.z); };
    return max(along(p), max(along(q), along(r)));
  }

  static constexpr int capacity = 8;
  const PlacedCorners& corners_;
  float most_;
  bool used_, solid_;
  int count_ = 0, next_ = 0, learned_ = 0, uses_[capacity] = {};
  float lanes_[3 * capacity], now_[capacity], floor_[capacity];
};

}  // namespace carom::geometry::detail
