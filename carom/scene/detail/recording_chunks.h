// How a recording's file is built of chunks: what its writer and its reader share.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "carom/core/hash.h"

namespace carom::scene::detail {

inline constexpr char preamble_magic[] = "CAROMREC", trailer_magic[] = "CAROMEND";
inline constexpr std::uint32_t recording_version = 2;
inline constexpr std::size_t preamble_size = 16, chunk_header_size = 16, trailer_size = 24;
inline constexpr std::uint32_t max_payload = 1u << 30;
enum Tag : std::uint8_t { tag_header = 'H', tag_key = 'K', tag_delta = 'D', tag_bodies = 'B', tag_index = 'I' };

inline std::uint64_t chunk_hash(std::uint8_t tag, std::span<const std::uint8_t> payload) {
  core::StateHash hash;
  hash.add(std::uint32_t(tag));
  hash.add(std::string_view(reinterpret_cast<const char*>(payload.data()), payload.size()));
  return hash.digest();
}

struct FrameEntry {
  std::uint64_t offset = 0, step = 0;
  double time = 0;
  bool key = false;
};

}  // namespace carom::scene::detail
