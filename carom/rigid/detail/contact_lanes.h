// One manifold's lane of a contact block, for what is done to single contacts.
#pragma once

#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

template <int W>
inline void put(float (&to)[2][W], int lane, const Vec2f& v) {
  to[0][lane] = v.x;
  to[1][lane] = v.y;
}
template <int W>
inline void put(float (&to)[3][W], int lane, const Vec3f& v) {
  to[0][lane] = v.x;
  to[1][lane] = v.y;
  to[2][lane] = v.z;
}
template <int W>
inline void put(float (&to)[6][W], int lane, const Mat3f& m) {
  to[0][lane] = m.cx.x;
  to[1][lane] = m.cy.y;
  to[2][lane] = m.cz.z;
  to[3][lane] = m.cy.x;
  to[4][lane] = m.cz.x;
  to[5][lane] = m.cz.y;
}
template <int W>
inline void put(float (&to)[W], int lane, float v) {
  to[lane] = v;
}
template <int W>
inline void put(float (&to)[2][W], int lane, const Rot2f& q) {
  to[0][lane] = q.c;
  to[1][lane] = q.s;
}
template <int W>
inline void put(float (&to)[4][W], int lane, const Quatf& q) {
  to[0][lane] = q.w;
  to[1][lane] = q.x;
  to[2][lane] = q.y;
  to[3][lane] = q.z;
}
template <int W>
inline Vec2f get(const float (&from)[2][W], int lane) {
  return {from[0][lane], from[1][lane]};
}
template <int W>
inline Vec3f get(const float (&from)[3][W], int lane) {
  return {from[0][lane], from[1][lane], from[2][lane]};
}

/// Where a manifold of the graph is in the blocks of this step; `extra` only where its colour has them.
template <class D, int W>
struct Lane {
  ContactBlock<D, W>& block;
  ContactExtra<D, W>* extra;
  int lane;
};
template <class D, int W>
inline Lane<D, W> lane_of(const WorldImplementation<D>& world, const ManifoldRecord<D>& m) {
  const ColorBlocks& blocks = world.scratch.blocks[m.place.color];
  const int lanes = m.place.color == overflow_color ? 1 : W, k = m.place.position / lanes;
  return {static_cast<ContactBlock<D, W>*>(blocks.blocks)[k],
          blocks.extra == nullptr ? nullptr : static_cast<ContactExtra<D, W>*>(blocks.extra) + k,
          m.place.position % lanes};
}

inline constexpr std::size_t many_bodies = 16;  ///< one in so many of those awake: then all blocks are looked at

/// Calls f(block, lane, mark, side of the body) for the places of a body's contacts in the blocks.
template <class D, int W, class F>
void for_lanes_of(const WorldImplementation<D>& world, std::int32_t body, F&& f) {
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
      const GraphPlace place = world.contacts.manifold(m).place;
      if (place.color < 0) continue;  // not in the graph
      const Lane<D, W> lane = lane_of<D, W>(world, world.contacts.manifold(m));
      f(lane.block, lane.lane, world.scratch.blocks[place.color].marks[place.position], key & 1);
    }
    key = c.next[key & 1];
  }
}

/// As the kernels' function of this name.
template <class Rotation, class V>
inline V turned_back_change(const Rotation& turn, const V& n) {
  const V change = inverse_rotate(turn, n) - n;
  return change - n * dot(change, n);
}

/// Calls f(manifold) for those of a colour that the preparation marked, in order.
template <class D, class F>
inline void for_marked(const WorldImplementation<D>& world, int color, std::uint8_t wanted, F&& f) {
  const std::vector<std::int32_t>& manifolds = world.graph.colors[color].manifolds;
  const std::uint8_t* marks = world.scratch.blocks[color].marks;  // eight at a time: zeros follow them
  for (std::size_t first = 0; first < manifolds.size(); first += 8) {
    std::uint64_t any;
    __builtin_memcpy(&any, marks + first, 8);
    if ((any & (0x0101010101010101u * wanted)) == 0) continue;
    for (std::size_t i = first; i < min(first + 8, manifolds.size()); ++i)
      if (marks[i] & wanted) f(manifolds[i]);
  }
}

}  // namespace carom::rigid::detail
