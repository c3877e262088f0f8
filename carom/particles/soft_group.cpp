#include "carom/particles/soft_group.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/detail/cloth_state.h"
#include "carom/particles/detail/soft_meeting.h"
#include "carom/particles/detail/soft_state.h"

namespace carom::particles {

using math::Vec3d;

namespace detail {

struct SoftGroupState {
  SoftMeeting meeting;
  std::vector<SoftThing*> things, near;
  std::vector<int> parent, numbers;
  std::vector<geometry::Bounds3d> bounds;
  std::vector<SoftContact> contacts;
  std::size_t cloths = 0;

  int root(int k) const {
    while (parent[std::size_t(k)] != k) k = parent[std::size_t(k)];
    return k;
  }
  core::Status join(double dt, Vec3d gravity);
  std::string name(std::size_t thing) const;
  void tell(float h);
};

std::string SoftGroupState::name(std::size_t thing) const {
  return thing < cloths ? core::text("cloths[", thing, "]") : core::text("bodies[", thing - cloths, "]");
}

/// Finds which things are near one another: they have the same root.
core::Status SoftGroupState::join(double dt, Vec3d gravity) {
  bounds.clear();
  parent.clear();
  for (std::size_t k = 0; k < things.size(); ++k) {
    const SoftThing& thing = *things[k];
    geometry::Bounds3d box{thing.position[0], thing.position[0]};
    float fastest = 0;
    double sum = 0;  // not finite where anything is not
    for (std::size_t i = 0; i < thing.position.size(); ++i) {
      box = {min(box.low, thing.position[i]), max(box.high, thing.position[i])};
      sum += thing.position[i].x + thing.position[i].y + thing.position[i].z +
             double(thing.velocity[i].x + thing.velocity[i].y + thing.velocity[i].z);
      fastest = math::max(fastest, length_squared(thing.velocity[i]));
    }
    if (!math::is_finite(sum))
      return core::Error{core::text("SoftGroup: ", name(k), " has a place or a velocity that is not finite")};
    bounds.push_back(grow(box, thing.apart + 2 * dt * (double(math::sqrt(fastest)) + dt * (10 + length(gravity)))));
    parent.push_back(int(k));
  }
  for (std::size_t a = 0; a < things.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      if (!overlaps(bounds[a], bounds[b]) || !filters_meet(things[a]->filter, things[b]->filter)) continue;
      const int i = root(int(a)), j = root(int(b));
      parent[std::size_t(math::max(i, j))] = math::min(i, j);
    }
  return {};
}

void SoftGroupState::tell(float h) {
  for (const SoftMeet& meet : meeting.contacts()) {
    if (meet.impulse == Vec3f{}) continue;
    SoftContact contact;
    contact.thing = numbers[std::size_t(meet.thing[0])];
    contact.other = numbers[std::size_t(meet.thing[1])];
    contact.vertex = int(meet.vertex);
    for (int k = 0; k < 3; ++k) {
      contact.corner[k] = int(meet.corner[k]);
      contact.share[k] = double(meet.share[k]);
    }
    contact.normal = Vec3d(meet.normal);
    contact.distance = double(meet.gap + meet.apart);
    contact.force = Vec3d(meet.impulse) / double(h);
    contacts.push_back(contact);
  }
}

}  // namespace detail

SoftGroup::SoftGroup() : state_(std::make_unique<detail::SoftGroupState>()) {}
SoftGroup::~SoftGroup() = default;
SoftGroup::SoftGroup(const SoftGroup& other)
    : state_(other.state_ ? std::make_unique<detail::SoftGroupState>(*other.state_) : nullptr) {}
SoftGroup& SoftGroup::operator=(const SoftGroup& other) {
  if (this != &other) state_ = other.state_ ? std::make_unique<detail::SoftGroupState>(*other.state_) : nullptr;
  return *this;
}
SoftGroup::SoftGroup(SoftGroup&&) noexcept = default;
SoftGroup& SoftGroup::operator=(SoftGroup&&) noexcept = default;

core::Status SoftGroup::step(std::span<Cloth* const> cloths, std::span<SoftBody* const> bodies, rigid::World3& world,
                             double dt) {
  if (!(dt > 0 && dt <= 1)) return core::Error{core::refused("dt", dt, "above 0 and at most 1 s")};
  if (!state_) state_ = std::make_unique<detail::SoftGroupState>();
  detail::SoftGroupState& s = *state_;
  s.contacts.clear();
  s.things.clear();
  s.cloths = cloths.size();
  for (Cloth* cloth : cloths) s.things.push_back(cloth != nullptr ? cloth->state_.get() : nullptr);
  for (SoftBody* body : bodies) s.things.push_back(body != nullptr ? body->state_.get() : nullptr);
  for (std::size_t k = 0; k < s.things.size(); ++k) {
    if (s.things[k] == nullptr) return core::Error{core::text("SoftGroup: ", s.name(k), " is null or was moved away")};
    for (std::size_t j = 0; j < k; ++j)
      if (s.things[j] == s.things[k])
        return core::Error{core::text("SoftGroup: ", s.name(k), " is the same as ", s.name(j))};
  }
  if (core::Status status = s.join(dt, Vec3d(world.definition().gravity)); !status.ok()) return status;
  for (std::size_t first = 0; first < s.things.size(); ++first) {
    if (s.parent[first] != int(first)) continue;
    s.near.clear();
    s.numbers.clear();
    for (std::size_t k = first; k < s.things.size(); ++k)
      if (s.root(int(k)) == int(first)) {
        s.near.push_back(s.things[k]);
        s.numbers.push_back(int(k));
      }
    if (s.near.size() == 1) {
      s.near[0]->met.clear();
      step_together(s.near, nullptr, world, dt);
      continue;
    }
    s.meeting.set_numbers(s.numbers);
    s.tell(step_together(s.near, &s.meeting, world, dt));
  }
  return {};
}

std::span<const SoftContact> SoftGroup::contacts() const {
  return state_ ? std::span<const SoftContact>(state_->contacts) : std::span<const SoftContact>{};
}

}  // namespace carom::particles
