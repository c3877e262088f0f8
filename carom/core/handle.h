// Typed handles with generations: a stale or foreign handle is recognised, never followed.
#pragma once

#include <cstdint>

namespace carom::core {

/// Names one object of one world. Zero is the null handle. Copy it freely; 8 bytes.
template <class Tag>
struct Handle {
  std::uint32_t index = 0;       ///< slot + 1
  std::uint16_t generation = 0;  ///< of the slot, when the object was created
  std::uint16_t world = 0;       ///< of the world that made it

  constexpr bool is_null() const { return index == 0; }
  explicit constexpr operator bool() const { return index != 0; }
  friend constexpr bool operator==(Handle a, Handle b) {
    return a.index == b.index && a.generation == b.generation && a.world == b.world;
  }
  constexpr std::uint64_t packed() const {
    return std::uint64_t(index) << 32 | std::uint64_t(generation) << 16 | world;
  }
};

}  // namespace carom::core
