#include "carom/rigid/detail/load_account.h"

#include <algorithm>
#include <limits>

#include "carom/rigid/detail/contact_block.h"
#include "carom/rigid/detail/contacts.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int wish_grain = 64;
constexpr float least_slope = 0.3f;  ///< cosine between gravity and what presses on a body from above
constexpr float play = 2;            ///< a neighbour accounts for so many times its weight: loads swing as they settle
constexpr int throwing_level = 70;   ///< four times its mass: what pressed that throws it once it is itself again

/// N: those above a body account for their weight and for the load that they are given already, those beside and below
/// it for their weight alone, so that no load comes back to where it is from. What is jointed or pushed may bring any
/// load.
template <class D>
float accounted_load(const WorldImplementation<D>& world, std::int32_t body, float contact_stiffness) {
  using V = typename D::Vector;
  const float own_scale = world.bodies.motion[std::size_t(body)].gravity_scale;
  const V gravity = own_scale < 0 ? -world.definition.gravity : world.definition.gravity;
  const float g = math::length(gravity);
  bool may_be_any = (world.bodies.record[std::size_t(body)].flags & body_pushed) != 0;
  float most_load_above = 0, most_weight = 0;
  double weights_above = 0;  // of floats, so that their order does not show
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    const int side = key & 1;
    key = c.next[side];
    V pushed{};
    float push = 0;
    for (std::int32_t k = c.first_manifold; k != none; k = world.contacts.manifold(k).next) {
      const ManifoldRecord<D>& m = world.contacts.manifold(k);
      float impulse = 0;
      for (int i = 0; i < m.manifold.count; ++i) impulse += m.impulses.normal[i];
      push += impulse;
      pushed += impulse * m.manifold.normal;
    }
    if (!(push > 0)) continue;
    pushed = rotate(shape_pose(world, world.shapes.at(c.shape[0])).rotation, side == 0 ? -pushed : pushed);
    const std::int32_t other = c.body[1 - side];
    if (!world.bodies.is_dynamic(other)) continue;
    const BodyRecord& record = world.bodies.record[std::size_t(other)];
    may_be_any = may_be_any || record.joint_count > 0 || (record.flags & body_pushed) != 0;
    const BodyMotion<D>& m = world.bodies.motion[std::size_t(other)];
    const float pace = world.bodies.pace(other);
    const float pull = (pace * pace) * math::abs(m.gravity_scale) * g, weight = m.mass * pull;
    most_weight = max(most_weight, play * weight);
    if (!(dot(pushed, gravity) > least_slope * g * math::length(pushed))) continue;
    weights_above += double(play * weight);
    most_load_above = max(most_load_above, m.mass * borne_as_it_is(m, max(g, pull), contact_stiffness) / load_share(m));
  }
  return may_be_any ? std::numeric_limits<float>::infinity() : max(most_weight, float(weights_above) + most_load_above);
}

/// Of a contact whose effective mass changes, to so many times what it was.
template <class D>
void scale_impulses(WorldImplementation<D>& world, const ContactRecord<D>& contact, float factor) {
  for (std::int32_t k = contact.first_manifold; k != none; k = world.contacts.manifold(k).next) {
    ManifoldImpulses<D>& impulses = world.contacts.manifold(k).impulses;
    for (float& x : impulses.normal) x *= factor;
    impulses.friction *= factor;
    impulses.rolling *= factor;
    impulses.twist *= factor;
  }
}

}  // namespace

template <class D>
void drop_loads(WorldImplementation<D>& world, std::vector<std::int32_t>& bodies) {
  if (bodies.empty()) return;
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  const auto motion = [&](std::int32_t body) -> BodyMotion<D>& { return world.bodies.motion[std::size_t(body)]; };
  const auto falls_far = [&](std::int32_t body) { return motion(body).load_level > throwing_level; };
  for (const std::int32_t body : bodies) {
    if (!falls_far(body)) continue;
    const BodyMotion<D>& m = motion(body);
    for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
      const ContactRecord<D>& c = world.contacts.at(key >> 1);
      const int side = key & 1;
      key = c.next[side];
      const std::int32_t slot = c.body[1 - side];
      const bool both = std::binary_search(bodies.begin(), bodies.end(), slot);
      if (both && falls_far(slot) && side == 1) continue;  // once, so that no order shows
      const BodyMotion<D>& other = motion(slot);
      const float before = load_share(other) * other.inverse_mass, after = both ? other.inverse_mass : before;
      scale_impulses(world, c, (load_share(m) * m.inverse_mass + before) / (m.inverse_mass + after));
    }
  }
  for (const std::int32_t body : bodies) motion(body).load_level = motion(body).load_limit = 0;
  bodies.clear();
}

template <class D>
void grant_loads(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  StepScratch<D>& scratch = world.scratch;
  // Which worker found whom is chance; no wish changes what another is told.
  for (std::vector<LoadWish>& list : scratch.load_wishes)
    context.scheduler.parallel_for(int(list.size()), wish_grain, [&](int begin, int end, int) {
      for (int i = begin; i < end; ++i) {
        const LoadWish& wish = list[std::size_t(i)];
        if (wish.borne == 0) continue;
        const float load = accounted_load(world, wish.body, context.contact_stiffness);
        BodyMotion<D>& m = world.bodies.motion[std::size_t(wish.body)];
        m.load_limit = wish.borne < load ? level_of_share(wish.borne / load) : std::uint16_t(0);
        if (m.load_limit <= m.load_level) m.load_asked = std::uint16_t(m.load_asked + refused_wait);
      }
    });
  for (const std::vector<LoadWish>& list : scratch.load_wishes)
    for (const LoadWish& wish : list)
      if (wish.borne == 0) scratch.dropped.push_back(wish.body);
  drop_loads(world, scratch.dropped);
  level_room(scratch.load_wishes);
}

#define CAROM_INSTANTIATE(D)                                                        \
  template void drop_loads<D>(WorldImplementation<D>&, std::vector<std::int32_t>&); \
  template void grant_loads<D>(StepContext<D>&);
CAROM_INSTANTIATE(Dim2)
CAROM_INSTANTIATE(Dim3)
#undef CAROM_INSTANTIATE

}  // namespace carom::rigid::detail
