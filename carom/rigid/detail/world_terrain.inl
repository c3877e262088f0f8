// World's members that change terrain.
#pragma once

#include "carom/rigid/detail/world_shapes.inl"

namespace carom::rigid {
namespace detail {

/// The world's own copy of a shape's terrain, to be changed. Who shares it (snapshots, other shapes, the caller) keeps
/// what was.
template <class Terrain>
Terrain& own_terrain(WorldImplementation<Dim3>& world, std::int32_t slot, const Terrain& terrain) {
  ShapeStore<Dim3>& shapes = world.shapes;
  if (shapes.geometry_copy != nullptr && shapes.geometry_copy.use_count() == 1) shapes.geometry_copy.reset();
  geometry::Shape3& shape = shapes.at(slot).geometry;
  if (terrain.edited && shape.data.use_count() == 1) return const_cast<Terrain&>(terrain);  // it was made below
  if (!terrain.edited) shapes.originals.push_back(shape);
  auto copy = std::make_shared<Terrain>(terrain);
  copy->edited = true;
  Terrain& own = *copy;
  shape = geometry::Shape3(std::shared_ptr<const Terrain>(std::move(copy)));
  shapes.geometry_copy.reset();
  return own;
}

/// After a change within `box` (the shape's frame): who is near wakes, and every contact is looked at anew.
inline void terrain_changed(WorldImplementation<Dim3>& world, std::int32_t slot, const geometry::Bounds3f& box) {
  constexpr double near = 0.05;  // m, beyond what any contact at rest looks ahead
  ShapeRecord<Dim3>& shape = world.shapes.at(slot);
  const Pose3 pose = shape_pose(world, shape);
  const Mat3f r = to_matrix(pose.rotation);
  const Vec3f half = box.extents(),
              reach = math::abs(r.cx) * half.x + math::abs(r.cy) * half.y + math::abs(r.cz) * half.z;
  const Vec3d middle = pose.position + Vec3d(r * box.center());
  const geometry::Bounds3d around =
      geometry::grow(geometry::Bounds3d{middle - Vec3d(reach), middle + Vec3d(reach)}, near);
  std::vector<std::int32_t> bodies;
  world.shapes.trees[tree_dynamic].query(around, [&](std::uint32_t item) {
    bodies.push_back(world.shapes.at(std::int32_t(item)).body);
    return true;
  });
  std::sort(bodies.begin(), bodies.end());
  for (const std::int32_t body : bodies) wake_body(world, body);
  for (const std::int32_t contact : world.contacts.awake) {
    ContactRecord<Dim3>& c = world.contacts.at(contact);
    if (c.shape[0] != slot && c.shape[1] != slot) continue;
    look_anew(world, c);
  }
  if (shape.leaf == none) return;
  auto& tree = world.shapes.trees[shape.tree];
  if (geometry::contains(tree.bounds(shape.leaf), shape_bounds(world, shape))) return;
  tree.update(shape.leaf, fat_bounds(world, shape));
  look_at_bounds(world.bodies.motion[std::size_t(shape.body)]);
  shape.outer_extent = extents_of(shape.geometry).outer;
  world.scratch.old_bounds.clear();
  if ((shape.flags & shape_moved) == 0) {
    shape.flags |= shape_moved;
    world.scratch.moved.push_back(slot);
  }
}

/// Materials that the shape has no surface for.
inline Status check_materials(const WorldImplementation<Dim3>& world, std::int32_t slot,
                              std::span<const std::uint8_t> materials, int first) {
  const ShapeExtra<Dim3>* extra = world.shapes.extra(slot);
  const int count = extra != nullptr ? extra->surface_count : 0;
  for (const std::uint8_t m : materials)
    if (count > 0 && int(m) - first >= count)
      return core::Error{
          core::text("a cell has material ", int(m) - first, ", expected one of the shape's ", count, " surfaces")};
  return {};
}

/// Runs `change(slot, terrain)` on a shape of the right kind.
template <class Change>
Status change_terrain(WorldImplementation<Dim3>& world, std::string_view call, ShapeId shape, geometry::ShapeType3 type,
                      const char* expected, Change&& change) {
  const Result<std::int32_t> slot = slot_of(world, call, shape);
  if (!slot.ok()) return slot.error();
  if (world.shapes.at(*slot).geometry.type != type)
    return core::Error{core::text("World::", call, ": the shape is of another kind, expected ", expected)};
  const Status status = change(*slot);
  return status.ok() ? status : Status{core::Error{core::text("World::", call, ": ", status.error().message)}};
}

/// The cells whose surface a rectangle of vertices or cells touches, with all heights before or after.
inline geometry::Bounds3f field_box(const geometry::HeightField& field, const geometry::GridRectangle& r,
                                    bool vertices) {
  const int wide = vertices ? 1 : 0;
  const int i0 = max(r.column - wide, 0), i1 = min(r.column + r.columns - 1 + 1, field.columns - 1);
  const int j0 = max(r.row - wide, 0), j1 = min(r.row + r.rows - 1 + 1, field.rows - 1);
  geometry::Bounds3f box{{float(i0) * field.cell.x, 3.4e38f, float(j0) * field.cell.y},
                         {float(i1) * field.cell.x, -3.4e38f, float(j1) * field.cell.y}};
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const float h = field.heights[std::size_t(j) * std::size_t(field.columns) + std::size_t(i)];
      box.low.y = min(box.low.y, h), box.high.y = max(box.high.y, h);
    }
  return box;
}

}  // namespace detail

template <class D>
Status World<D>::set_heights(ShapeId shape, const geometry::GridRectangle& vertices, std::span<const float> heights)
  requires(D::dimension == 3)
{
  using namespace detail;
  return change_terrain(*self_, "set_heights", shape, geometry::ShapeType3::height_field, "a height field",
                        [&](std::int32_t slot) {
                          const geometry::HeightField& now = *self_->shapes.at(slot).geometry.height_field;
                          if (Status s = check_heights(now, vertices, heights); !s.ok()) return s;
                          const geometry::Bounds3f before = field_box(now, vertices, true);
                          geometry::HeightField& field = own_terrain(*self_, slot, now);
                          Status done = geometry::set_heights(field, vertices, heights);
                          terrain_changed(*self_, slot, merge(before, field_box(field, vertices, true)));
                          return done;
                        });
}

template <class D>
Status World<D>::set_holes(ShapeId shape, const geometry::GridRectangle& cells, std::span<const std::uint8_t> holes)
  requires(D::dimension == 3)
{
  using namespace detail;
  return change_terrain(*self_, "set_holes", shape, geometry::ShapeType3::height_field, "a height field",
                        [&](std::int32_t slot) {
                          const geometry::HeightField& now = *self_->shapes.at(slot).geometry.height_field;
                          if (Status s = check_cells(now, cells, holes); !s.ok()) return s;
                          geometry::HeightField& field = own_terrain(*self_, slot, now);
                          Status done = geometry::set_holes(field, cells, holes);
                          terrain_changed(*self_, slot, field_box(field, cells, false));
                          return done;
                        });
}

template <class D>
Status World<D>::set_cell_materials(ShapeId shape, const geometry::GridRectangle& cells,
                                    std::span<const std::uint8_t> materials)
  requires(D::dimension == 3)
{
  using namespace detail;
  return change_terrain(*self_, "set_cell_materials", shape, geometry::ShapeType3::height_field, "a height field",
                        [&](std::int32_t slot) {
                          const geometry::HeightField& now = *self_->shapes.at(slot).geometry.height_field;
                          if (Status s = check_cells(now, cells, materials); !s.ok()) return s;
                          if (Status s = check_materials(*self_, slot, materials, 0); !s.ok()) return s;
                          geometry::HeightField& field = own_terrain(*self_, slot, now);
                          Status done = geometry::set_materials(field, cells, materials);
                          terrain_changed(*self_, slot, field_box(field, cells, false));
                          return done;
                        });
}

template <class D>
Status World<D>::set_cells(ShapeId shape, const geometry::VoxelBlock& block, std::span<const std::uint8_t> cells)
  requires(D::dimension == 3)
{
  using namespace detail;
  return change_terrain(
      *self_, "set_cells", shape, geometry::ShapeType3::voxels, "a voxel grid", [&](std::int32_t slot) {
        const geometry::VoxelGrid& now = *self_->shapes.at(slot).geometry.voxels;
        if (Status s = check_cells(now, block, cells); !s.ok()) return s;
        if (Status s = check_materials(*self_, slot, cells, 1); !s.ok()) return s;
        geometry::VoxelGrid& grid = own_terrain(*self_, slot, now);
        Status done = geometry::set_cells(grid, block, cells);
        const Vec3f low = Vec3f{float(block.column), float(block.layer), float(block.row)} * grid.cell;
        const Vec3f size = Vec3f{float(block.columns), float(block.layers), float(block.rows)} * grid.cell;
        terrain_changed(*self_, slot, {low, low + size});
        return done;
      });
}

}  // namespace carom::rigid
