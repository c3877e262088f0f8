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

  int root(int k) const {
    while (parent[std::size_t(k)] != k) k = parent[std::size_t(k)];
    return k;
  }
  void join(double dt, Vec3d gravity);
  void tell(float h);
};

/// Finds which things are near one another: they have the same root.
void SoftGroupState::join(double dt, Vec3d gravity) {
  bounds.clear();
  parent.clear();
  for (std::size_t k = 0; k < things.size(); ++k) {
    const SoftThing& thing = *things[k];
    geometry::Bounds3d box{thing.position[0], thing.position[0]};
    float fastest = 0;
    for (std::size_t i = 0; i < thing.position.size(); ++i) {
      box = {min(box.low, thing.position[i]), max(box.high, thing.position[i])};
      fastest = math::max(fastest, length_squared(thing.velocity[i]));
    }
    bounds.push_back(grow(box, thing.apart + 2 * dt * (double(math::sqrt(fastest)) + dt * (10 + length(gravity)))));
    parent.push_back(int(k));
  }
  for (std::size_t a = 0; a < things.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      if (!overlaps(bounds[a], bounds[b]) || !filters_meet(things[a]->filter, things[b]->filter)) continue;
      const int i = root(int(a)), j = root(int(b));
      parent[std::size_t(math::max(i, j))] = math::min(i, j);
    }
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
SoftGroup::SoftGroup(const SoftGroup& other) : state_(std::make_unique<detail::SoftGroupState>(*other.state_)) {}
SoftGroup& SoftGroup::operator=(const SoftGroup& other) {
  if (this == &other) return *this;
  if (state_)
    *state_ = *other.state_;
  else
    state_ = std::make_unique<detail::SoftGroupState>(*other.state_);
  return *this;
}
SoftGroup::SoftGroup(SoftGroup&&) noexcept = default;
SoftGroup& SoftGroup::operator=(SoftGroup&&) noexcept = default;

core::Status SoftGroup::step(std::span<Cloth* const> cloths, std::span<SoftBody* const> bodies, rigid::World3& world,
                             double dt) {
  if (!(dt > 0 && dt <= 1)) return core::Error{core::refused("dt", dt, "above 0 and at most 1 s")};
  detail::SoftGroupState& s = *state_;
  s.things.clear();
  s.contacts.clear();
  for (Cloth* cloth : cloths) s.things.push_back(cloth->state_.get());
  for (SoftBody* body : bodies) s.things.push_back(body->state_.get());
  s.join(dt, Vec3d(world.definition().gravity));
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
    const int substeps = step_together(s.near, &s.meeting, world, dt);
    s.tell(float(dt / substeps));
  }
  return {};
}

std::span<const SoftContact> SoftGroup::contacts() const { return state_->contacts; }

}  // namespace carom::particles
