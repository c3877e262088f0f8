// Shapes, materials and filters of a scene file.
#pragma once

#include <map>

#include "carom/rigid/world.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// The reusable things of all parts of a scene, by name.
struct Library {
  std::map<std::string, std::pair<const Node*, std::string>, std::less<>> materials, shapes;  ///< node and its path
};

struct SurfaceDefaults {
  rigid::Material material{};
  rigid::Filter filter{};
  double density = 1000;
};

template <class D>
struct ReadShape {
  typename D::Shape shape;
  rigid::ShapeDef<D> definition{};
  bool density_given = false;             ///< or mass
  std::vector<typename D::Shape> more{};  ///< further outlines of tiles, with the same definition
};

/// From "filter", over what is there.
void read_filter(Reader& reader, const Object& o, rigid::Filter& filter);
/// From "material", "filter" and "density" of a body, over what it inherits.
SurfaceDefaults read_surface(Reader& reader, const Library& library, const Object& o, SurfaceDefaults defaults);
template <class D>
bool read_shape(Reader& reader, const Library& library, const Node& node, const std::string& path,
                const SurfaceDefaults& defaults, ReadShape<D>& out);

}  // namespace carom::scene::detail
