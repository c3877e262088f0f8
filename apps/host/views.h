// How bodies look, for a page or a picture: the shapes of both dimensions as one plain form.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "carom/geometry/shape2.h"
#include "carom/geometry/shape3.h"
#include "carom/rigid/definitions.h"

namespace carom::host {

enum class ShapeKind : std::uint8_t {
  sphere,
  capsule,
  box,
  cylinder,
  cone,
  ellipsoid,
  plane,
  mesh,
  circle,
  polygon,
  segment,
  chain
};
const char* name_of(ShapeKind kind);

struct ShapeView {
  ShapeKind kind = ShapeKind::sphere;
  math::Vec3f size{};  ///< box, ellipsoid: half extents; capsule: y = half length; cylinder, cone: y = half height;
                       ///< cylinder, cone: x = rounding;
                       ///< plane: normal
  float radius = 0;
  std::uint32_t mesh = 0;           ///< index into MeshLibrary::meshes
  std::vector<math::Vec2f> points;  ///< polygon, segment, chain
  bool loop = false;
  bool sensor = false;
  int material = -1;       ///< of this part of a surface, as its geometry numbers them; −1: all of it
  std::uint32_t look = 0;  ///< 0xOORRGGBB, opacity first; 0: as the body
  math::Transform3f local{};
};

struct BodyView {
  std::uint32_t id = 0;
  std::string name;
  rigid::BodyType type = rigid::BodyType::dynamic;
  std::uint32_t color = 0;  ///< 0xAARRGGBB (an opacity of 0 stands for solid), or 0: the viewer's choice
  math::Vec3d position{};
  math::Quatf rotation{};
  std::vector<ShapeView> shapes;
};

/// Where a body is now.
struct BodyPlace {
  std::uint32_t id = 0;
  math::Vec3d position{};
  math::Quatf rotation{};
  bool awake = true;
};

struct Mesh {
  std::vector<math::Vec3f> vertices;
  std::vector<std::uint32_t> indices;
};

/// Hulls, meshes and height fields, each once however many bodies share it.
class MeshLibrary {
 public:
  /// `material`: only the triangles or cells of that number; −1: all.
  std::uint32_t id_of(const geometry::Shape3& shape, int material = -1);
  /// One that somebody else numbered: by its place.
  void add(Mesh mesh) { meshes_.push_back(std::move(mesh)); }
  const std::vector<Mesh>& meshes() const { return meshes_; }

 private:
  std::vector<Mesh> meshes_;
  struct Owner {
    std::shared_ptr<const void> data;
    int material;
  };
  std::vector<Owner> owners_;
};

math::Quatf quaternion_of(math::Rot2f rotation);
inline math::Vec3d in_space(math::Vec2d p) { return {p.x, p.y, 0}; }
inline math::Vec3d in_space(math::Vec3d p) { return p; }
inline math::Vec3d in_space(math::Vec2f v) { return {double(v.x), double(v.y), 0}; }
inline math::Vec3d in_space(math::Vec3f v) { return math::Vec3d(v); }

/// Surfaces whose parts have different materials become one view a material.
void view_shape(const geometry::Shape2& shape, const math::Transform2f& local, bool sensor, MeshLibrary& meshes,
                std::vector<ShapeView>& out);
void view_shape(const geometry::Shape3& shape, const math::Transform3f& local, bool sensor, MeshLibrary& meshes,
                std::vector<ShapeView>& out);

}  // namespace carom::host
