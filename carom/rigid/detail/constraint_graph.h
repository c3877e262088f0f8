// The constraint graph: every touching manifold and awake joint lives in a colour, and no dynamic body is twice in one
// colour, so that a colour's constraints can be solved at once, in lanes and on threads, in any order.
#pragma once

#include <bit>
#include <vector>

#include "carom/rigid/detail/body_store.h"

namespace carom::rigid::detail {

inline constexpr int color_count = 24;              ///< colours solved in parallel
inline constexpr int overflow_color = color_count;  ///< solved one after the other

enum class ConstraintKind : std::uint8_t { manifold, joint };

/// Where a constraint is in the graph.
struct GraphPlace {
  std::int16_t color = -1;       ///< −1: not in the graph
  std::int32_t position = none;  ///< in the colour's list
};

struct GraphColor {
  std::vector<std::int32_t> manifolds;  ///< indices into the manifold store
  std::vector<std::int32_t> joints;     ///< slots of joints
  int extra = 0;                        ///< manifolds that bounce or roll with resistance
};

/// Persistent greedy colouring, first fit. Constraints between two dynamic bodies take colours from below, those with
/// only one dynamic body from above: the ground comes last in a sweep, which makes stacks stiffer (after Box2D v3).
struct ConstraintGraph {
  GraphColor colors[color_count + 1];

  /// Chooses a colour and appends `item`. a and b: body slots; `none`, fixed and kinematic bodies block no colour.
  template <class D>
  GraphPlace add(ConstraintKind kind, std::int32_t item, std::int32_t a, std::int32_t b, BodyStore<D>& bodies) {
    const bool dynamic_a = a != none && bodies.is_dynamic(a), dynamic_b = b != none && bodies.is_dynamic(b);
    std::uint32_t used = 0;
    if (dynamic_a) used |= bodies.record[std::size_t(a)].color_mask;
    if (dynamic_b) used |= bodies.record[std::size_t(b)].color_mask;
    const std::uint32_t free = ~used & ((std::uint32_t{1} << color_count) - 1);
    int color = overflow_color;
    if (free != 0) color = dynamic_a && dynamic_b ? std::countr_zero(free) : 31 - std::countl_zero(free);
    if (color != overflow_color) {
      if (dynamic_a) bodies.record[std::size_t(a)].color_mask |= std::uint32_t{1} << color;
      if (dynamic_b) bodies.record[std::size_t(b)].color_mask |= std::uint32_t{1} << color;
    }
    if (a != none) ++bodies.record[std::size_t(a)].constraint_count;
    if (b != none) ++bodies.record[std::size_t(b)].constraint_count;
    std::vector<std::int32_t>& list = kind == ConstraintKind::manifold ? colors[color].manifolds : colors[color].joints;
    if (list.capacity() == 0) list.reserve(16);  // no colour grows for its first few
    list.push_back(item);
    return {std::int16_t(color), std::int32_t(list.size()) - 1};
  }

  /// Takes the item at `place` out; the last of the list moves there. Returns which item moved (its place is now
  /// `place`), or `none`.
  template <class D>
  std::int32_t remove(ConstraintKind kind, GraphPlace place, std::int32_t a, std::int32_t b, BodyStore<D>& bodies) {
    if (place.color != overflow_color) {
      const std::uint32_t keep = ~(std::uint32_t{1} << place.color);
      if (a != none && bodies.is_dynamic(a)) bodies.record[std::size_t(a)].color_mask &= keep;
      if (b != none && bodies.is_dynamic(b)) bodies.record[std::size_t(b)].color_mask &= keep;
    }
    if (a != none) --bodies.record[std::size_t(a)].constraint_count;
    if (b != none) --bodies.record[std::size_t(b)].constraint_count;
    GraphColor& color = colors[place.color];
    std::vector<std::int32_t>& list = kind == ConstraintKind::manifold ? color.manifolds : color.joints;
    const std::int32_t moved = list.back();
    list[std::size_t(place.position)] = moved;
    list.pop_back();
    return std::size_t(place.position) < list.size() ? moved : none;
  }
};

}  // namespace carom::rigid::detail
