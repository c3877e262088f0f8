// What a flying ball may meet of a table, and how balls that keep touching are kept apart.
#pragma once

#include "carom/math/elementary.h"
#include "carom/sports/table.h"

namespace carom::sports::detail {

/// A pair that met less than a millisecond ago and approaches more slowly than a millimetre per second parts with that
/// speed. Restitution below 1 would let a pushed ball bounce infinitely often in a finite time.
inline constexpr double chatter_time = 1e-3, chatter_speed = 1e-3;

/// How deep (m) a blow presses two balls together after Hertz: v T/2.94, T ∝ v^(−1/5).
inline double pressed_depth(double speed, double contact_time) {
  return speed * contact_time * math::pow(speed, -0.2) / 2.94;
}

/// The rail behind an edge: a rectangle at the height of the nose, `rail_width` deep.
inline math::Vec3d nearest_on_rail(const BilliardTable& table, std::size_t edge, math::Vec3d p) {
  const BilliardTable::Edge& e = table.edges()[edge];
  const math::Vec2d seen{p.x, p.z};
  const double along = math::clamp(dot(seen - e.from, e.along), 0.0, e.length);
  const double depth = math::clamp(e.offset - dot(e.inward, seen), 0.0, table.definition().rail_width);
  const math::Vec2d q = e.from + along * e.along - depth * e.inward;
  return {q.x, table.nose_height(), q.y};
}

/// A jaw: a disc at the height of the nose.
inline math::Vec3d nearest_on_jaw(const BilliardTable& table, std::size_t jaw, math::Vec3d p) {
  const BilliardTable::Jaw& j = table.jaws()[jaw];
  math::Vec2d away{p.x - j.center.x, p.z - j.center.y};
  const double far = math::length(away);
  if (far > j.radius) away *= j.radius / far;
  return {j.center.x + away.x, table.nose_height(), j.center.y + away.y};
}

}  // namespace carom::sports::detail
