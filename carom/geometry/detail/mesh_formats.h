// One parser a format. Messages carry no file name: the caller puts it in front.
#pragma once

#include "carom/geometry/mesh_file.h"

namespace carom::geometry::detail {

core::Result<MeshFile> parse_obj(std::string_view text, const MeshFileOptions& options);
core::Result<MeshFile> parse_stl(std::string_view bytes, const MeshFileOptions& options);
/// `directory`: where the files lie that it refers to; null: it may refer to none.
core::Result<MeshFile> parse_gltf(std::string_view bytes, bool binary, const std::string* directory,
                                  const MeshFileOptions& options);

/// The whole file, or what is wrong: not there, a folder, too large.
core::Result<std::string> read_bytes(const std::string& path, std::size_t max_bytes);

/// Cuts a polygon with three or more corners (indices of vertices) into triangles by clipping ears; a polygon that
/// crosses itself or is not planar gives triangles all the same, whose edges still cancel.
void triangulate_polygon(std::span<const Vec3d> vertices, std::span<const std::uint32_t> polygon,
                         std::vector<std::uint32_t>& indices);

}  // namespace carom::geometry::detail
