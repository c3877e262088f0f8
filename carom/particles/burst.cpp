#include "carom/particles/burst.h"

#include <string>

#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::particles {
using math::Vec3d;

core::Result<std::vector<Vec3d>> burst_velocities(const BurstDef& d) {
  const auto bad = [](const char* field, double found, const char* expected) {
    return core::Error{std::string("burst: ") + field + " is " + std::to_string(found) + ", expected " + expected};
  };
  if (d.count < 2 || d.count > 1 << 24) return bad("count", d.count, "2 to 2^24");
  if (!(d.energy >= 0 && math::is_finite(d.energy))) return bad("energy", d.energy, "a finite number of at least 0 J");
  if (!(d.speed >= 0 && math::is_finite(d.speed))) return bad("speed", d.speed, "a finite number of at least 0 m/s");
  if (!(d.mass > 0 && math::is_finite(d.mass))) return bad("mass", d.mass, "a finite number above 0 kg");
  math::Random random(d.seed);
  const auto draw = [&] {
    if (d.planar) {
      const math::Vec2d c = random.on_circle();
      const double r = d.equal_speeds ? 1 : math::sqrt(random.uniform());
      return Vec3d{c.x * r, c.y * r, 0};
    }
    return d.equal_speeds ? random.on_sphere() : random.in_sphere();
  };
  std::vector<Vec3d> w;
  w.reserve(std::size_t(d.count));
  if (d.count % 2 != 0) {
    // Three at 120° to each other.
    const Vec3d a = draw();
    const Vec3d other = d.planar ? Vec3d{0, 0, 1} : random.on_sphere();
    const Vec3d across = math::normalize(math::cross(a, other)) * math::length(a);
    const Vec3d b = -0.5 * a + math::sqrt(0.75) * across;
    w.insert(w.end(), {a, b, -(a + b)});
  }
  while (int(w.size()) < d.count) {
    const Vec3d a = draw();
    w.push_back(a);
    w.push_back(-a);
  }
  double squares = 0;
  for (const Vec3d& v : w) squares += math::dot(v, v);
  const double wanted = d.energy > 0 ? 2 * d.energy / d.mass : double(d.count) * d.speed * d.speed;
  const double factor = math::sqrt(wanted / squares);
  for (Vec3d& v : w) v *= factor;
  return w;
}

}  // namespace carom::particles
