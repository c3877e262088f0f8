// The whole state of a world at one time, for rollback, saved games and late packets (docs/snapshots.md).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/rigid/dimension.h"

namespace carom::rigid {

template <class D>
class World;
namespace detail {
template <class D>
struct SnapshotData;
struct SnapshotAccess;  // of tests
}  // namespace detail

/// Made by World::snapshot, put back by World::restore: from there the world goes on with the same bits, warm starts,
/// contact caches and sleep timers included, whatever was created, destroyed or set in between. What never changes
/// (hulls, meshes, …) is shared, not copied. A snapshot that is taken into again keeps its memory.
template <class D>
class CAROM_API Snapshot {
 public:
  Snapshot();
  ~Snapshot();
  Snapshot(Snapshot&&) noexcept;
  Snapshot& operator=(Snapshot&&) noexcept;
  Snapshot(const Snapshot&);
  Snapshot& operator=(const Snapshot&);

  bool empty() const;                ///< nothing was ever taken into it
  std::uint64_t step_count() const;  ///< of the world when it was taken
  std::size_t bytes() const;         ///< memory held
  std::uint64_t digest() const;      ///< of all the state; two snapshots of equal states may differ in unused bytes

  /// The snapshot as bytes for a file or a packet, with a checksum against accidents. Whoever forges them can make a
  /// world other than the sender's, but not a broken one (World::restore). Shared geometry goes by its fingerprint, so
  /// the world that restores it must hold the same hulls and meshes; a CustomEffector, likewise, must stand in the same
  /// slot.
  std::vector<std::byte> encode() const;
  /// Only what differs from `base`, which the receiver has: sleeping and fixed bodies cost nothing.
  std::vector<std::byte> encode(const Snapshot& base) const;
  /// Errors: not a snapshot, of another version, dimension or machine layout, truncated, corrupt, or a difference to
  /// another base than the one given (an empty snapshot for what encode() made).
  static core::Result<Snapshot> decode(std::span<const std::byte> bytes, const Snapshot& base = {});

 private:
  friend class World<D>;
  friend struct detail::SnapshotAccess;
  std::unique_ptr<detail::SnapshotData<D>> self_;
};

extern template class CAROM_API Snapshot<Dim2>;
extern template class CAROM_API Snapshot<Dim3>;
using Snapshot2 = Snapshot<Dim2>;
using Snapshot3 = Snapshot<Dim3>;

}  // namespace carom::rigid
