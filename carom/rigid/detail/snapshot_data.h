// What a snapshot holds: plain state as one row of sections, in the order of state_visitor.h, and the few things that
// are not plain.
#pragma once

#include <memory>
#include <vector>

#include "carom/rigid/detail/effector_store.h"
#include "carom/rigid/detail/shape_store.h"

namespace carom::rigid::detail {

/// An array of plain values in SnapshotData::image. Every state of the visitor is one, in its order.
struct SnapshotSection {
  std::uint64_t first = 0;    ///< word of the image
  std::uint64_t count = 0;    ///< elements
  std::uint64_t element = 0;  ///< bytes of one
};

/// A shape's geometry in a form that can be compared and sent: small ones by value, shared ones by fingerprint.
struct GeometryRecord {
  std::uint32_t type = 0;
  std::uint32_t shared = 0;       ///< 1: `fingerprint` stands for the value; 2: likewise, and the value is sent along
  std::uint64_t fingerprint = 0;  ///< of what all the world's users of a hull or mesh share
  std::uint32_t value[40] = {};   ///< bytes of the small shape
  friend bool operator==(const GeometryRecord&, const GeometryRecord&) = default;
};

template <class D>
struct SnapshotData {
  std::vector<std::uint64_t> image;
  std::vector<SnapshotSection> sections;
  std::size_t bodies_at = 0;     ///< section of solver bodies; poses, motions and records follow
  std::size_t shapes_at = 0;     ///< section of shapes
  std::size_t manifolds_at = 0;  ///< section of manifolds; that of contacts is before it
  std::size_t trees_at = 0;      ///< section of the first tree's nodes; its root follows
  std::size_t pairs_at = 0;      ///< section of the keys of PairSet
  std::shared_ptr<const std::vector<typename D::Shape>> geometry;  ///< by slot of the shape
  std::vector<GeometryRecord> missing;  ///< after decoding: by slot, where `geometry` has no value yet
  std::vector<EffectorData<D>> effectors;
  bool decoded = false;  ///< came as bytes: functions of the caller are not in it
  std::uint16_t world_number = 0;
  std::uint64_t step_count = 0;

  std::size_t image_bytes() const { return image.size() * sizeof(std::uint64_t); }
};

template <class T, class D>
T* section_values(std::vector<std::uint64_t>& image, const SnapshotData<D>& data, std::size_t section) {
  return reinterpret_cast<T*>(image.data() + data.sections[section].first);
}

/// A hash of all that a shape is.
std::uint64_t fingerprint(const geometry::Shape2& shape);
std::uint64_t fingerprint(const geometry::Shape3& shape);
GeometryRecord geometry_record(const geometry::Shape2& shape);
GeometryRecord geometry_record(const geometry::Shape3& shape);
/// The shape of a record that is not shared; false where the record is no shape.
bool shape_of(const GeometryRecord& record, geometry::Shape2& shape);
bool shape_of(const GeometryRecord& record, geometry::Shape3& shape);
inline bool is_shared(const geometry::Shape2& s) { return s.chain != nullptr; }
inline bool is_shared(const geometry::Shape3& s) { return s.data != nullptr; }

class ByteWriter;  // snapshot_code.h
class ByteReader;
/// A height field or voxel grid that the world changed, itself: against that of a base where it is of the same kind.
void write_terrain(ByteWriter& out, const geometry::Shape2& shape, const geometry::Shape2* base);
void write_terrain(ByteWriter& out, const geometry::Shape3& shape, const geometry::Shape3* base);
/// False where that cannot be one.
bool read_terrain(ByteReader& in, std::uint32_t type, const geometry::Shape2* base, geometry::Shape2& shape);
bool read_terrain(ByteReader& in, std::uint32_t type, const geometry::Shape3* base, geometry::Shape3& shape);

/// 64 bits over many words: four interleaved core::StateHash, because one waits for each of its own words.
std::uint64_t hash_words(std::span<const std::uint64_t> words);

}  // namespace carom::rigid::detail
