// Shapes as plain records, for snapshots that leave the process.
#include <cstring>

#include "carom/core/hash.h"
#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
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
    case geometry::ShapeType3::plane:
      return f(shape.plane), true;
    default:
      return false;
  }
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
    record.shared = 1;
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
      break;
    case geometry::ShapeType3::height_field:
      hash.add(std::int32_t(shape.height_field->columns)).add(std::int32_t(shape.height_field->rows));
      hash.add(shape.height_field->cell.x).add(shape.height_field->cell.y);
      add_plain(hash, shape.height_field->heights);
      add_plain(hash, shape.height_field->holes);
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
