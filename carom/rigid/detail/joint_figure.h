// Bodies that joints hold together, as far as it takes to know what they may hand down to one of them (load.h).
#pragma once

#include <algorithm>
#include <span>

#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/load.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

template <class D>
class Figure {
 public:
  /// That of a dynamic body.
  Figure(const WorldImplementation<D>& world, std::int32_t body) : world_(world) {
    add(body);
    for (int i = 0; i < count_; ++i) for_joints(bodies_[i], [&](std::int32_t, std::int32_t other) { add(other); });
  }
  std::span<const std::int32_t> bodies() const { return {bodies_, std::size_t(count_)}; }
  /// The most that a member's mass may follow its load: to a part of the others' mass. That of one with springs, whose
  /// stiffness goes by its mass, never does.
  std::uint16_t most_level(std::int32_t body) const {
    bool springy = false;
    for_joints(body, [&](std::int32_t joint, std::int32_t) { springy |= is_springy(world_.joints.at(joint)); });
    if (springy) return 0;
    float others = 0;
    for (const std::int32_t member : bodies())
      if (member != body) others += world_.bodies.motion[std::size_t(member)].mass;
    const float share = jointed_share * others, own = world_.bodies.motion[std::size_t(body)].mass;
    return share > own ? level_of_share(own / share) : std::uint16_t(0);
  }

 private:
  static constexpr int most = 64;  ///< bodies

  void add(std::int32_t body) {
    if (body == none || !world_.bodies.is_dynamic(body) || count_ == most) return;
    if (std::find(bodies_, bodies_ + count_, body) == bodies_ + count_) bodies_[count_++] = body;
  }
  /// f(joint, other body).
  template <class F>
  void for_joints(std::int32_t body, F&& f) const {
    for_each_joint(world_, body, [&](std::int32_t joint, int, std::int32_t other) { f(joint, other); });
  }

  const WorldImplementation<D>& world_;
  std::int32_t bodies_[most];
  int count_ = 0;
};

}  // namespace carom::rigid::detail
