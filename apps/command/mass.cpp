#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/command/command.h"
#include "carom/geometry/mass_properties.h"
#include "carom/geometry/mesh_file.h"
#include "carom/math/units.h"

namespace carom::command {

namespace {

nlohmann::ordered_json components_json(math::Vec3d v) { return {v.x, v.y, v.z}; }

nlohmann::ordered_json matrix_json(const math::Mat3d& m) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2)});
  return rows;
}

}  // namespace

int mass(const MassOptions& options) {
  const math::QuantityResult density = math::parse_quantity(options.density, math::dimensions::density);
  if (!density.ok) return fail(exit_usage, "--density: " + density.error);
  if (!(density.si > 0)) return fail(exit_usage, "--density: found " + options.density + ", expected more than zero");
  const math::QuantityResult unit = math::parse_quantity("1 " + options.unit, math::dimensions::length);
  if (!unit.ok) return fail(exit_usage, "--unit: " + unit.error);
  geometry::MeshFileOptions reading;
  reading.unit = unit.si;
  const core::Result<geometry::MeshFile> file = geometry::read_mesh_file(options.file, reading);
  if (!file.ok()) return fail(exit_input, file.error().message);
  const core::Result<geometry::MeshMass> found =
      geometry::mesh_mass_properties(file->vertices, file->indices, density.si);
  if (!found.ok()) return fail(exit_input, options.file + ": " + found.error().message);
  const geometry::MassProperties3& p = found->properties;
  const geometry::PrincipalAxes axes = geometry::principal_axes(p.inertia);
  if (options.json) {
    const nlohmann::ordered_json out = {
        {"file", options.file},
        {"format", geometry::name_of(file->format)},
        {"density_kg_m3", density.si},
        {"unit_m", unit.si},
        {"vertices", file->vertices.size()},
        {"triangles", found->triangles},
        {"pieces", found->components},
        {"volume_m3", found->volume},
        {"area_m2", found->area},
        {"mass_kg", p.mass},
        {"center_m", components_json(p.center)},
        {"inertia_kg_m2", matrix_json(p.inertia)},
        {"principal_moments_kg_m2", components_json(axes.moments)},
        {"principal_rotation_wxyz", {axes.rotation.w, axes.rotation.x, axes.rotation.y, axes.rotation.z}}};
    std::printf("%s\n", out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
    return exit_ok;
  }
  std::printf("%s (%s)\n", options.file.c_str(), geometry::name_of(file->format));
  std::printf("  %d triangles in %d closed piece%s, density %g kg/m³, coordinates in %s\n", found->triangles,
              found->components, found->components == 1 ? "" : "s", density.si, options.unit.c_str());
  std::printf("  volume   %.9g m³\n  area     %.9g m²\n  mass     %.9g kg\n", found->volume, found->area, p.mass);
  std::printf("  centre   %.9g  %.9g  %.9g m\n", p.center.x, p.center.y, p.center.z);
  std::printf("  inertia tensor about the centre, axes of the file, kg·m²\n");
  for (int i = 0; i < 3; ++i)
    std::printf("    %16.9g %16.9g %16.9g\n", p.inertia(i, 0), p.inertia(i, 1), p.inertia(i, 2));
  std::printf("  principal moments  %.9g  %.9g  %.9g kg·m²\n", axes.moments.x, axes.moments.y, axes.moments.z);
  return exit_ok;
}

}  // namespace carom::command
