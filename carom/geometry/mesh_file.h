// Triangles from mesh files: Wavefront OBJ, STL (text and binary), glTF 2.0 and GLB.
#pragma once

#include <string>
#include <string_view>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/mesh_builders.h"

namespace carom::geometry {

enum class MeshFormat : std::uint8_t { unknown, obj, stl, gltf, glb };
CAROM_API const char* name_of(MeshFormat format);

/// Everything in the file as one set of triangles, faces with more corners cut into triangles, glTF's node transforms
/// applied. STL and many exporters share no vertices: mesh_mass_properties welds them.
struct MeshFile {
  std::vector<Vec3d> vertices;  ///< m
  std::vector<std::uint32_t> indices;
  MeshFormat format = MeshFormat::unknown;
  int parts = 1;  ///< objects of an OBJ, solids of an STL, placed primitives of a glTF file
};
struct MeshFileOptions {
  double unit = 1;                               ///< metres in one unit of the file: 0.001 for a drawing in millimetres
  std::size_t max_bytes = std::size_t(1) << 30;  ///< of the file, and of each buffer a glTF file refers to
  std::size_t max_triangles = 50'000'000;
};

/// By the name's ending, or where that says nothing by the content. Errors name the file, the line or glTF path, what
/// was found and what was expected. Materials, textures, skins, animations, lines and points are passed over. OBJ and
/// STL are always read; glTF and GLB in builds with CAROM_MESH_FILES. The buffers of a .gltf file must lie beside it or
/// below.
CAROM_API core::Result<MeshFile> read_mesh_file(const std::string& path, const MeshFileOptions& = {});
/// The same from memory; a .gltf may not refer to other files. `name` is used in errors.
CAROM_API core::Result<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format, const MeshFileOptions& = {},
                                            std::string_view name = "mesh");
/// A guess from the ending of the name and the first bytes.
CAROM_API MeshFormat detect_mesh_format(std::string_view name, std::string_view bytes);

/// For make_triangle_mesh and make_hull, which take single precision.
CAROM_API Triangles to_triangles(const MeshFile& file);

}  // namespace carom::geometry
