// Any bytes as a cloud of points: the answer is a sound hull that holds them all, or an error that says why not.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "carom/geometry/hull.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/mesh_builders.h"
#include "tests/fuzz/target.h"

namespace {

// Small integers make coplanar, collinear and repeated points; floats reach every scale and the numbers that are none.
std::vector<carom::geometry::Vec3f> points_from(const std::uint8_t* data, std::size_t size, bool as_integers) {
  std::vector<carom::geometry::Vec3f> points;
  const std::size_t step = as_integers ? 3 : 12;
  for (std::size_t i = 0; i + step <= size && points.size() < 600; i += step) {
    float v[3];
    if (as_integers)
      for (std::size_t k = 0; k < 3; ++k) v[k] = float(std::int8_t(data[i + k]));
    else
      std::memcpy(v, data + i, sizeof v);
    points.push_back({v[0], v[1], v[2]});
  }
  return points;
}

}  // namespace

FUZZ_TARGET(hull) {
  using namespace carom::geometry;
  if (size < 2) return;
  const auto points = points_from(data + 2, size - 2, data[0] % 2 == 0);
  const HullOptions options{.radius = data[0] & 2 ? 0.25f : 0, .max_vertices = 255, .simplify = (data[0] & 4) != 0};
  const auto hull = make_hull(points, options);
  if (!hull.ok()) {
    if (hull.error().message.find("no sound hull") == std::string::npos) return;
    std::puts(hull.error().message.c_str());
    std::abort();
  }
  const std::span<const Vec3f> all(points);
  const auto sound = validate_hull(**hull, options.simplify ? all.subspan(0, 0) : all, 8 * hull_tolerance(points));
  if (!sound.ok()) {
    std::puts(sound.error().message.c_str());
    std::abort();
  }
  const MassProperties3 m = mass_properties(Shape3(*hull), 1);
  if (!(m.mass > 0) || !is_finite(m.center)) std::abort();
  for (int i = 0; i < 3; ++i)
    if (!(m.inertia(i, i) > 0)) std::abort();
  if (to_triangles(**hull).indices.empty()) std::abort();
}
