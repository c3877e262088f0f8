// What contacts between cloths and soft bodies add to their linear system.
#include "carom/particles/detail/soft_meeting.h"

#include "carom/math/elementary.h"

namespace carom::particles::detail {

namespace {
constexpr float meeting_rub = 1.2f;     // times friction: more of it is found anew
constexpr float meeting_slack = 0.02f;  // of what keeps apart: so little is left to the next substep
}  // namespace

template <class See>
void SoftMeeting::each_node(const SoftMeet& meet, const See& see) const {
  SoftThing& face = *things_[std::size_t(meet.thing[1])];
  see(*things_[std::size_t(meet.thing[0])], meet.vertex, 1.0f);
  for (int k = 0; k < 3; ++k) see(face, meet.corner[k], -meet.share[k]);
}

namespace {
/// What holds a contact: along the normal while it is active, and across it.
Vec3f held(const SoftMeet& meet, Vec3f velocity) {
  const float along = dot(meet.normal, velocity);
  Vec3f out = meet.active ? (meet.stiff * along) * meet.normal : Vec3f{};
  if (meet.grip > 0) out += meet.grip * (velocity - along * meet.normal);
  return out;
}
/// The impulse on the vertex for a change of its velocity against the face.
Vec3f impulse_of(const SoftMeet& meet, Vec3f change) {
  Vec3f out = meet.active ? (meet.stiff * (meet.wanted - meet.before)) * meet.normal : Vec3f{};
  if (meet.grip > 0) out -= meet.grip * meet.slip;
  return out - held(meet, change);
}
}  // namespace

Vec3f SoftMeeting::change_of(const SoftMeet& meet) const {
  Vec3f change{};
  each_node(meet, [&](const SoftThing& thing, std::uint32_t i, float share) {
    change += share * thing.solver.change[i].vector();
  });
  return change;
}

void SoftMeeting::give(SoftMeet& meet, Vec3f impulse) {
  const Vec3f more = impulse - meet.impulse;
  each_node(meet, [&](SoftThing& thing, std::uint32_t i, float share) { thing.solver.right[i] += share * more; });
  meet.impulse = impulse;
}

void SoftMeeting::enter() {
  for (SoftThing* thing : things_) {
    std::fill(thing->solver.met.begin(), thing->solver.met.end(), Mat3f::zero());
    thing->solver.remade = true;
  }
  for (SoftMeet& meet : meets_) {
    give(meet, impulse_of(meet, {}));
    if (!meet.active && !(meet.grip > 0)) continue;
    const Mat3f along = math::outer(meet.normal, meet.normal);
    const Mat3f own = (meet.active ? meet.stiff : 0.0f) * along + meet.grip * (Mat3f::identity() - along);
    each_node(meet, [&](SoftThing& thing, std::uint32_t i, float share) {
      thing.solver.met[i] = thing.solver.met[i] + math::square(share) * own;
    });
  }
}

void SoftMeeting::take_from_residuals() {
  for (const SoftMeet& meet : meets_) {
    const Vec3f impulse = held(meet, change_of(meet));
    each_node(meet,
              [&](SoftThing& thing, std::uint32_t i, float share) { thing.solver.add_residual(i, -share * impulse); });
  }
}

void SoftMeeting::answer() {
  for (const SoftMeet& meet : meets_) {
    if (!meet.active && !(meet.grip > 0)) continue;
    Vec3f motion{};
    each_node(meet, [&](const SoftThing& thing, std::uint32_t i, float share) {
      motion += share * thing.solver.back_at(thing.matrix, i);
    });
    const Vec3f impulse = held(meet, motion);
    each_node(meet, [&](SoftThing& thing, std::uint32_t i, float share) {
      const Vec3f own = held(meet, share * thing.solver.back_at(thing.matrix, i));  // of the diagonal
      thing.solver.add_answer(thing.matrix, i, share * (impulse - own));
    });
  }
}

void SoftMeeting::clear_answers() {
  for (const SoftMeet& meet : meets_)
    each_node(meet, [&](SoftThing& thing, std::uint32_t i, float) { thing.solver.clear_answer(thing.matrix, i); });
}

void SoftMeeting::settle() {
  for (SoftMeet& meet : meets_) give(meet, impulse_of(meet, change_of(meet)));
}

bool SoftMeeting::revise(float h) {
  bool again = false;
  for (SoftMeet& meet : meets_) {
    const Vec3f change = change_of(meet);
    if (meet.grip > 0) {  // what slides faster than was foreseen is not rubbed more for it
      const float slides = length(meet.slip + change - dot(meet.normal, change) * meet.normal);
      if (meet.grip * slides > meeting_rub * meet.rub) {
        meet.grip = meet.rub / slides;
        again = true;
      }
    }
    if (meet.active) {
      const float pull = -dot(meet.normal, meet.impulse);
      if (pull <= 0) continue;
      meet.active = false;
      // What hardly pulls is let go for the next substep, not for this one.
      again |= pull > soft_pull * h * things_[std::size_t(meet.thing[0])]->mass[meet.vertex];
      continue;
    }
    if (meet.gap + h * (meet.before + dot(meet.normal, change)) >= -meeting_slack * meet.apart) continue;
    meet.active = again = true;
    meet.wanted = -math::max(meet.gap, 0.0f) / h;
  }
  return again;
}

void SoftMeeting::remember(float h) {
  for (SoftThing* thing : things_) thing->met.clear();
  for (const SoftMeet& meet : meets_) {
    const float push = math::max(dot(meet.normal, meet.impulse), 0.0f) / h;
    things_[std::size_t(meet.thing[0])]->met.push_back(
        {numbers_[std::size_t(meet.thing[1])], meet.vertex, meet.active, meet.active ? push : 0, meet.normal});
  }
}

int solve_system(std::span<SoftThing* const> things, SoftMeeting* meeting, double tolerance, float least, int most,
                 bool again) {
  double small = 0, scale = 0, size = 0;
  for (SoftThing* thing : things) {
    thing->solver.meets = meeting != nullptr;
    scale += thing->solver.open(thing->matrix, least, again, small);
  }
  scale = math::max(scale, small);
  for (SoftThing* thing : things) thing->solver.find_residual(thing->matrix, again, thing->tasks());
  if (meeting != nullptr) meeting->take_from_residuals();
  for (SoftThing* thing : things) size += thing->solver.begin_iterations(thing->matrix);
  int iterations = 0;
  float keep = 0;
  while (iterations < most && size > tolerance * tolerance * scale && size > 1e-30) {
    for (SoftThing* thing : things) thing->solver.go_up(thing->matrix, iterations == 0, keep);
    if (meeting != nullptr) meeting->answer();
    double curvature = 0, next = 0;
    for (SoftThing* thing : things) curvature += thing->solver.go_down(thing->matrix);
    if (meeting != nullptr) meeting->clear_answers();
    ++iterations;
    if (!(curvature > 0)) break;
    for (SoftThing* thing : things) next += thing->solver.go_on(thing->matrix, size / curvature);
    keep = float(next / size);
    size = next;
  }
  for (SoftThing* thing : things) thing->solver.end_iterations(thing->matrix);
  if (meeting != nullptr) meeting->settle();
  for (SoftThing* thing : things) thing->solver.find_reactions(thing->matrix);
  return iterations;
}

}  // namespace carom::particles::detail
