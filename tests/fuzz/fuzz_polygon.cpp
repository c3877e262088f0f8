// Outlines and holes of any points: refused with a reason, or convex polygons that together have their area.
#include <cmath>
#include <cstring>

#include "carom/geometry/decomposition.h"
#include "carom/geometry/shape2.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/target.h"

namespace {
using namespace carom::geometry;
using Points = std::vector<carom::math::Vec2f>;

/// Small integers, which meet, touch and line up; or floats of every scale and those that are no numbers. A loop ends
/// where the first number is −128, or −∞.
std::vector<Points> loops_from(const std::uint8_t* data, std::size_t size, bool as_integers) {
  std::vector<Points> loops(1);
  const std::size_t step = as_integers ? 2 : 8;
  for (std::size_t i = 0; i + step <= size; i += step) {
    float v[2];
    for (std::size_t k = 0; k < 2; ++k)
      if (as_integers)
        v[k] = float(std::int8_t(data[i + k]));
      else
        std::memcpy(&v[k], data + i + 4 * k, 4);
    if (v[0] == (as_integers ? -128 : -HUGE_VALF))
      loops.emplace_back();
    else
      loops.back().push_back({v[0], v[1]});
  }
  return loops;
}
double area_of(const carom::math::Vec2f* p, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += cross(carom::math::Vec2d(p[i]), carom::math::Vec2d(p[(i + 1) % n]));
  return std::fabs(sum) / 2;
}
}  // namespace

FUZZ_TARGET(polygon) {
  if (size < 2 || size > 2000) return;
  std::vector<Points> loops = loops_from(data + 1, size - 1, data[0] % 4 != 0);
  const Points outline = loops[0];
  loops.erase(loops.begin());
  const auto parts = decompose_convex(outline, loops);
  if (!parts.ok()) {
    require(parts.error().message.find("could not be cut") == std::string::npos, "every simple polygon has ears");
    return;
  }
  double whole = area_of(outline.data(), outline.size()), sum = 0;
  for (const Points& hole : loops) whole -= area_of(hole.data(), hole.size());
  for (const Polygon& part : *parts) {
    require(validate(Shape2(part)).ok(), "every part is a sound polygon");
    sum += area_of(part.vertices, std::size_t(part.count));
  }
  // Corners that stand out by less than a polygon's tolerance are left out of the parts.
  carom::math::Vec2f low = outline[0], high = low;
  for (const auto& p : outline) low = min(low, p), high = max(high, p);
  const double extent = double(max(high.x - low.x, high.y - low.y));
  const double far = double(max(max(-low.x, high.x), max(-low.y, high.y)));
  const double tolerance = 1e-5 * extent + 1e-6 * far;
  require(std::fabs(sum - whole) <= tolerance * extent * double(size), "the parts have the area of the whole");
}
