// Any bytes as OBJ, STL, glTF or GLB, then everything that is done with meshes. The first byte chooses the format.
#include <cstdint>
#include <cstdlib>

#include "carom/geometry/mass_properties.h"
#include "carom/geometry/mesh_file.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/fuzz/target.h"

FUZZ_TARGET(mesh) {
  using namespace carom::geometry;
  if (size == 0) return;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  const MeshFormat formats[] = {MeshFormat::obj, MeshFormat::stl, MeshFormat::gltf, MeshFormat::glb};
  // Corpus files start with a letter that names the format; other bytes choose one all the same.
  const std::uint8_t letter = data[0];
  const int choice = letter == 'o' ? 0 : letter == 's' ? 1 : letter == 'g' ? 2 : letter == 'b' ? 3 : letter % 4;
  const auto mesh = parse_mesh(bytes, formats[choice], {.max_triangles = 20000});
  if (!mesh.ok()) {
    if (mesh.error().message.empty()) std::abort();
    return;
  }
  for (const std::uint32_t i : mesh->indices)
    if (i >= mesh->vertices.size()) std::abort();
  const auto mass = mesh_mass_properties(mesh->vertices, mesh->indices, 1000);
  if (mass.ok() && !(mass->volume > 0)) std::abort();
  const Triangles triangles = to_triangles(*mesh);
  const auto surface = make_triangle_mesh(triangles.positions, triangles.indices);
  if (surface.ok() && (*surface)->triangle_count() == 0) std::abort();
}
