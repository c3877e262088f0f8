// Where particles come from.
#pragma once

#include <limits>
#include <memory>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/random.h"
#include "carom/math/transform.h"

namespace carom::particles {

/// Drawn uniformly; one number where both are equal.
struct Range {
  float low = 0, high = 0;
};

enum class EmitterForm {
  point,
  segment,  ///< along local x, half its length is size.x
  disc,     ///< about local y, with radius size.x
  box,      ///< half extents size
  sphere,   ///< radius size.x
  mesh,     ///< the triangles of `mesh`, each as often as its area says
};

struct EmitterDef {
  EmitterForm form = EmitterForm::point;
  math::Vec3f size{1, 1, 1};  ///< m
  bool surface_only = false;  ///< disc, box, sphere: the rim or surface instead of all of it
  std::shared_ptr<const geometry::TriangleMesh> mesh{};

  math::Vec3d position{};  ///< m
  math::Quatd rotation{};
  math::Vec3d velocity{};  ///< m/s, of the emitter: it flies on by itself
  float inherited = 1;     ///< the part of that velocity that particles start with

  float rate = 0;                                           ///< 1/s
  float start = 0;                                          ///< s after it was added
  float duration = std::numeric_limits<float>::infinity();  ///< s
  int burst = 0;                                            ///< so many at once at its start

  math::Vec3f direction{0, 1, 0};  ///< unit, in the emitter's frame
  bool along_normal = false;       ///< outward from the form instead
  float spread = 0;                ///< rad: half angle of the cone of directions, uniform in solid angle; π: all
  Range speed{1, 1};               ///< m/s
  Range lifetime{1, 1};            ///< s, > 0; infinite: until something kills it
  Range scale{1, 1};               ///< of the radius; the mass goes with its cube
  std::uint64_t seed = 1;
  bool enabled = true;
};

CAROM_API core::Status check(const EmitterDef& definition);

/// One draw from an emitter, in its frame.
struct Emission {
  math::Vec3d place{};
  math::Vec3d velocity{};
  float lifetime = 1, scale = 1;
};
/// Draws places by area from a mesh: running sums of triangle areas.
class CAROM_API MeshAreas {
 public:
  MeshAreas() = default;
  explicit MeshAreas(const geometry::TriangleMesh& mesh);
  std::size_t triangle(double part) const;  ///< where this part (0 … 1) of all area lies
  double area() const { return sums_.empty() ? 0 : sums_.back(); }

 private:
  std::vector<double> sums_;
};
CAROM_API Emission draw(const EmitterDef& definition, const MeshAreas& areas, bool planar, math::Random& random);

}  // namespace carom::particles
