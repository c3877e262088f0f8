// Shapes as plain records, for snapshots that leave the process.
#include <cstring>

#include "carom/core/hash.h"
#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/geometry/voxels.h"
#include "carom/rigid/detail/snapshot_code.h"
#include "carom/rigid/detail/snapshot_data.h"

namespace carom::rigid::detail {
namespace {

template <class T>
void add_plain(core::StateHash& hash, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  hash.add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
}

/// Calls f(value) with the member of the union that the type names. False for shared and unknown types.
template <class S, class F>
  requires std::is_same_v<std::remove_const_t<S>, geometry::Shape2>
bool with_small_value(S& shape, F&& f) {
  switch (shape.type) {
    case geometry::ShapeType2::circle:
      return f(shape.circle), true;
    case geometry::ShapeType2::capsule:
      return f(shape.capsule), true;
    case geometry::ShapeType2::polygon:
      return f(shape.polygon), true;
    case geometry::ShapeType2::segment:
      return f(shape.segment), true;
    case geometry::ShapeType2::chain_segment:
      return f(shape.chain_segment), true;
    default:
      return false;
  }
}
template <class S, class F>
  requires std::is_same_v<std::remove_const_t<S>, geometry::Shape3>
bool with_small_value(S& shape, F&& f) {
  switch (shape.type) {
    case geometry::ShapeType3::sphere:
      return f(shape.sphere), true;
    case geometry::ShapeType3::capsule:
      return f(shape.capsule), true;
    case geometry::ShapeType3::box:
      return f(shape.box), true;
    case geometry::ShapeType3::cylinder:
      return f(shape.cylinder), true;
    case geometry::ShapeType3::cone:
      return f(shape.cone), true;
    case geometry::ShapeType3::ellipsoid:
      return f(shape.ellipsoid), true;
    case geometry::ShapeType3::plane:
      return f(shape.plane), true;
    default:
      return false;
  }
}

bool is_edited(const geometry::Shape2&) { return false; }
bool is_edited(const geometry::Shape3& s) {
  if (s.type == geometry::ShapeType3::height_field) return s.height_field->edited;
  return s.type == geometry::ShapeType3::voxels && s.voxels->edited;
}

/// A list as what changed against that of a base, of the same length where there is one.
template <class T>
void write_list(ByteWriter& out, const std::vector<T>& now, const std::vector<T>* base) {
  const auto words = [](const std::vector<T>& v) {
    std::vector<std::uint32_t> w((v.size() * sizeof(T) + 3) / 4);
    if (!v.empty()) std::memcpy(w.data(), v.data(), v.size() * sizeof(T));
    return w;
  };
  const bool against = base != nullptr && base->size() == now.size();
  const std::vector<std::uint32_t> a = words(now), b = against ? words(*base) : std::vector<std::uint32_t>{};
  out.number(now.size());
  out.byte(against ? 1 : 0);
  SectionModel model(1);
  out.difference(a.data(), against ? b.data() : nullptr, a.size(), model);
}
template <class T>
bool read_list(ByteReader& in, std::vector<T>& v, const std::vector<T>* base) {
  const std::uint64_t size = in.number();
  const bool against = in.byte() != 0;
  const bool fits = against ? base != nullptr && base->size() == size
                            : size <= (std::uint64_t{1} << 31) && in.plausible(size * sizeof(T) / 4);
  if (!in.sound() || !fits) return false;
  std::vector<std::uint32_t> w(std::size_t((size * sizeof(T) + 3) / 4));
  if (against && !base->empty()) std::memcpy(w.data(), base->data(), base->size() * sizeof(T));
  SectionModel model(1);
  in.difference(w.data(), w.size(), model);
  v.resize(std::size_t(size));
  if (size > 0) std::memcpy(v.data(), w.data(), v.size() * sizeof(T));
  return in.sound();
}

template <class S>
GeometryRecord record_of(const S& shape) {
  GeometryRecord record;
  record.type = std::uint32_t(shape.type);
  const bool small = with_small_value(shape, [&](const auto& value) {
    static_assert(sizeof(value) <= sizeof(record.value) && std::is_trivially_copyable_v<std::decay_t<decltype(value)>>);
    std::memcpy(record.value, &value, sizeof(value));
  });
  if (!small) {
    record.shared = is_edited(shape) ? 2 : 1;
    record.fingerprint = fingerprint(shape);
  }
  return record;
}
template <class S>
bool small_shape_of(const GeometryRecord& record, S& shape) {
  S result;
  result.type = decltype(result.type)(record.type);
  const bool small = with_small_value(result, [&](auto& value) { std::memcpy(&value, record.value, sizeof(value)); });
  if (!small || record.shared != 0 || !geometry::validate(result).ok()) return false;
  shape = result;
  return true;
}

}  // namespace

std::uint64_t fingerprint(const geometry::Shape2& shape) {
  core::StateHash hash;
  hash.add(std::uint32_t(shape.type));
  if (shape.chain != nullptr) {
    hash.add(shape.chain->loop);
    add_plain(hash, shape.chain->points);
    add_plain(hash, shape.chain->materials);
  }
  return hash.digest();
}

std::uint64_t fingerprint(const geometry::Shape3& shape) {
  core::StateHash hash;
  hash.add(std::uint32_t(shape.type));
  switch (shape.type) {
    case geometry::ShapeType3::hull:
      hash.add(shape.hull->radius);
      add_plain(hash, shape.hull->vertices);
      break;
    case geometry::ShapeType3::mesh:
      add_plain(hash, shape.mesh->vertices);
      add_plain(hash, shape.mesh->indices);
      add_plain(hash, shape.mesh->materials);
      break;
    case geometry::ShapeType3::height_field:
      hash.add(std::int32_t(shape.height_field->columns)).add(std::int32_t(shape.height_field->rows));
      hash.add(shape.height_field->cell.x).add(shape.height_field->cell.y);
      add_plain(hash, shape.height_field->heights);
      add_plain(hash, shape.height_field->holes);
      add_plain(hash, shape.height_field->materials);
      break;
    case geometry::ShapeType3::voxels:
      hash.add(std::int32_t(shape.voxels->columns)).add(std::int32_t(shape.voxels->layers));
      hash.add(std::int32_t(shape.voxels->rows)).add(shape.voxels->cell);
      add_plain(hash, shape.voxels->cells);
      break;
    case geometry::ShapeType3::compound:
      for (const geometry::CompoundChild& child : shape.compound->children) {
        const GeometryRecord record = geometry_record(child.shape);
        hash.add(record.type).add(record.fingerprint);
        for (const std::uint32_t word : record.value) hash.add(word);
        hash.add(child.local.p.x).add(child.local.p.y).add(child.local.p.z);
        hash.add(child.local.q.w).add(child.local.q.x).add(child.local.q.y).add(child.local.q.z);
      }
      break;
    default:
      break;
  }
  return hash.digest();
}

GeometryRecord geometry_record(const geometry::Shape2& shape) { return record_of(shape); }
GeometryRecord geometry_record(const geometry::Shape3& shape) { return record_of(shape); }
bool shape_of(const GeometryRecord& record, geometry::Shape2& shape) { return small_shape_of(record, shape); }
bool shape_of(const GeometryRecord& record, geometry::Shape3& shape) { return small_shape_of(record, shape); }

void write_terrain(ByteWriter& out, const geometry::Shape3& shape, const geometry::Shape3* base) {
  SectionModel head(4);
  if (shape.type == geometry::ShapeType3::height_field) {
    const geometry::HeightField& f = *shape.height_field;
    const geometry::HeightField* b =
        base != nullptr && base->type == geometry::ShapeType3::height_field ? base->height_field : nullptr;
    std::uint32_t words[4] = {std::uint32_t(f.columns), std::uint32_t(f.rows), 0, 0};
    std::memcpy(words + 2, &f.cell, 8);
    out.difference(words, nullptr, 4, head);
    write_list(out, f.heights, b != nullptr ? &b->heights : nullptr);
    write_list(out, f.holes, b != nullptr ? &b->holes : nullptr);
    write_list(out, f.materials, b != nullptr ? &b->materials : nullptr);
  } else {
    const geometry::VoxelGrid& g = *shape.voxels;
    const geometry::VoxelGrid* b =
        base != nullptr && base->type == geometry::ShapeType3::voxels ? base->voxels : nullptr;
    std::uint32_t words[4] = {std::uint32_t(g.columns), std::uint32_t(g.layers), std::uint32_t(g.rows), 0};
    std::memcpy(words + 3, &g.cell, 4);
    out.difference(words, nullptr, 4, head);
    write_list(out, g.cells, b != nullptr ? &b->cells : nullptr);
  }
}
bool read_terrain(ByteReader& in, std::uint32_t type, const geometry::Shape3* base, geometry::Shape3& shape) {
  std::uint32_t words[4] = {};
  SectionModel head(4);
  in.difference(words, 4, head);
  const auto small = [](std::uint32_t x) { return int(x & 0x7fffffff); };
  if (geometry::ShapeType3(type) == geometry::ShapeType3::height_field) {
    const geometry::HeightField* b =
        base != nullptr && base->type == geometry::ShapeType3::height_field ? base->height_field : nullptr;
    Vec2f cell;
    std::memcpy(static_cast<void*>(&cell), words + 2, 8);
    std::vector<float> heights;
    std::vector<std::uint8_t> holes, materials;
    if (!read_list(in, heights, b != nullptr ? &b->heights : nullptr) ||
        !read_list(in, holes, b != nullptr ? &b->holes : nullptr) ||
        !read_list(in, materials, b != nullptr ? &b->materials : nullptr))
      return false;
    const auto made = geometry::make_height_field(small(words[0]), small(words[1]), cell, std::move(heights),
                                                  std::move(holes), std::move(materials));
    if (!made.ok()) return false;
    auto field = std::make_shared<geometry::HeightField>(**made);
    field->edited = true;
    shape = std::shared_ptr<const geometry::HeightField>(std::move(field));
    return true;
  }
  if (geometry::ShapeType3(type) != geometry::ShapeType3::voxels) return false;
  const geometry::VoxelGrid* b = base != nullptr && base->type == geometry::ShapeType3::voxels ? base->voxels : nullptr;
  float cell;
  std::memcpy(&cell, words + 3, 4);
  std::vector<std::uint8_t> cells;
  if (!read_list(in, cells, b != nullptr ? &b->cells : nullptr)) return false;
  const auto made =
      geometry::make_voxel_grid(small(words[0]), small(words[1]), small(words[2]), cell, std::move(cells));
  if (!made.ok()) return false;
  auto grid = std::make_shared<geometry::VoxelGrid>(**made);
  grid->edited = true;
  shape = std::shared_ptr<const geometry::VoxelGrid>(std::move(grid));
  return true;
}
void write_terrain(ByteWriter&, const geometry::Shape2&, const geometry::Shape2*) {}
bool read_terrain(ByteReader&, std::uint32_t, const geometry::Shape2*, geometry::Shape2&) { return false; }

std::uint64_t hash_words(std::span<const std::uint64_t> words) {
  core::StateHash lane[4];
  std::size_t i = 0;
  for (; i + 4 <= words.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) lane[k].add(words[i + k]);
  for (; i < words.size(); ++i) lane[i % 4].add(words[i]);
  core::StateHash all;
  for (const core::StateHash& l : lane) all.add(l.digest());
  return all.digest();
}

}  // namespace carom::rigid::detail
