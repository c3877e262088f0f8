// Where bodies went in the last step: what rays need that go their way meanwhile.
#pragma once

#include <vector>

#include "carom/geometry/box_cells.h"
#include "carom/geometry/static_tree.h"
#include "carom/rigid/state.h"

namespace carom::rigid {

/// All bodies whose surface may have moved by more than `shortest`, with the boxes that their shapes passed through.
/// World::find_ways fills it and keeps its memory; it holds until something moves, comes or goes.
template <class D>
struct StepWays {
  static constexpr float shortest = 1e-4f;  ///< m; what moved less stands

  struct Way {
    std::int32_t body = -1;                            ///< slot
    typename D::Rotation from_rotation{}, rotation{};  ///< when the step began, and now
    typename D::Position from{}, to{};                 ///< m, of the centre of mass
    typename D::Angular turn{};                        ///< rad, where it may be more than half a revolution; else zero
    float angle = 0;                                   ///< rad, the size of its turn
    float end = 1;                                     ///< of the step: after it the body stood
  };
  float dt = 0;  ///< s, of the step
  std::vector<Way> ways;
  std::vector<std::int32_t> of_body;  ///< by slot: its place in `ways`, −1: it stands
  bool whole_tree[3]{};               ///< all shapes of that tree of the world are on their ways
  std::vector<std::int32_t> shapes;   ///< slots of shapes, beside their boxes
  std::vector<geometry::Bounds<typename D::Position>> boxes;
  geometry::BoxCells<typename D::Position> cells;  ///< where the boxes are
  geometry::WideTree<typename D::Position> tree;   ///< over the boxes; empty where they are few
  std::vector<geometry::detail::BuildItem<typename D::Position>> order;

  /// As if nothing had moved.
  void clear() {
    for (const Way& way : ways) of_body[std::size_t(way.body)] = -1;
    ways.clear();
    shapes.clear();
    boxes.clear();
    cells.clear();
    tree.nodes.clear();
    for (bool& whole : whole_tree) whole = false;
  }
  const Way* way_of(BodyId body) const {
    const std::size_t slot = std::size_t(body.index) - 1;
    return slot < of_body.size() && of_body[slot] >= 0 ? &ways[std::size_t(of_body[slot])] : nullptr;
  }
  /// m: how far the centre of mass of a body still goes after a fraction of the step.
  typename D::Position rest_of_way(BodyId body, double fraction) const {
    const Way* way = way_of(body);
    if (way == nullptr || !(fraction < double(way->end))) return {};
    return (way->to - way->from) * (1 - fraction / double(way->end));
  }
};

}  // namespace carom::rigid
