// Bodies by slot, hot and cold apart.
#pragma once

#include <string>
#include <vector>

#include "carom/core/column.h"
#include "carom/core/growth.h"
#include "carom/core/pool.h"
#include "carom/rigid/definitions.h"
#include "carom/rigid/detail/solver_body.h"

namespace carom::rigid::detail {

inline constexpr std::int32_t none = -1;  ///< no slot, no list entry

template <class Inertia>
constexpr Inertia no_inertia() {
  if constexpr (requires { Inertia::zero(); })
    return Inertia::zero();  // a default matrix is the identity
  else
    return 0;
}

/// The word of a slot in a list that is no longer than it has to be; 0 beyond its end.
inline std::uint64_t word_of(const std::vector<std::uint64_t>& words, std::int32_t slot) {
  return std::size_t(slot) < words.size() ? words[std::size_t(slot)] : 0;
}
inline void give_word(std::vector<std::uint64_t>& words, std::int32_t slot, std::uint64_t word) {
  if (std::size_t(slot) >= words.size()) {
    if (word == 0) return;
    if (std::size_t(slot) >= words.capacity()) words.reserve(core::next_capacity(std::size_t(slot)));
    words.resize(std::size_t(slot) + 1, 0);
  }
  words[std::size_t(slot)] = word;
}

/// Always inlined: to gcc a function that only pre-loads has no effect, and calls of it go.
[[gnu::always_inline]] inline void prefetch_lines(const void* p, std::size_t bytes) {
  for (std::size_t k = 0; k < bytes; k += 64) __builtin_prefetch(static_cast<const char*>(p) + k);
}

/// Which worker finds how much is chance: each list of a parallel stage gets room for all that was found, so that a
/// warm step does not allocate however the work falls.
template <class T>
void level_room(std::vector<std::vector<T>>& lists) {
  if (lists.size() < 2) return;
  std::size_t total = 0;
  for (const std::vector<T>& list : lists) total += list.size();
  for (std::vector<T>& list : lists)
    if (list.capacity() < total) list.reserve(total + total / 2);
}

/// Mass, forces and what the integrator needs. Read at the start and end of a step, not inside the contact solver. In
/// the plane the centre in its frame and the inverse masses are a row of four floats (contact_gather2.inl).
template <class D>
struct BodyMotion {
  typename D::Position center{};      ///< m, centre of mass in the world
  typename D::Vector local_center{};  ///< m, centre of mass in the body's frame
  float inverse_mass = 0;             ///< 1/kg, 0 where forces do not move the body
  typename D::Inertia world_inverse_inertia =
      no_inertia<typename D::Inertia>();  ///< at the start of the step, world axes, locked axes zero
  typename D::Vector force{};             ///< N, gathered for the next step
  typename D::Angular torque{};           ///< N·m, about the centre of mass
  float mass = 0;                         ///< kg, 0: it has none
  bool gyroscopic = false;                ///< 3D: inertia is not isotropic
  /// Plane: 1 for a wheel, whose shapes are circles about the centre of mass. 3D: 0, or 1 + its long axis + 4·(63
  /// √(greatest distance from that / outer_extent)).
  std::uint8_t slender = 0;
  std::uint16_t load_level = 0;                                     ///< the contact solver sees more mass (load.h)
  typename D::Inertia inertia = no_inertia<typename D::Inertia>();  ///< about the centre of mass, body axes
  float linear_damping = 0, angular_damping = 0;
  float gravity_scale = 1;
  float inner_extent = 0;  ///< m: half the smallest extent of its shapes; how far is "fast"
  float outer_extent = 0;  ///< m: farthest point of its shapes from the centre of mass
  /// m: its surface may go so far along each axis, down and up, before a shape can leave its fat bounds; 0: look.
  typename D::Vector room_below{}, room_above{};
  std::uint16_t load_limit = 0;  ///< what its level may rise to (load_account.h),
  std::uint16_t load_asked = 0;  ///< and the step in which it last wanted more, modulo 2¹⁶
};

/// Lets the next step ask whether its shapes have left their fat bounds.
template <class D>
void look_at_bounds(BodyMotion<D>& m) {
  m.room_below = m.room_above = {};
}
/// May they have, as far as its room tells?
template <class D>
bool may_leave_bounds(const BodyMotion<D>& m) {
  for (int k = 0; k < D::dimension; ++k)
    if (!(m.room_below[k] > 0 && m.room_above[k] > 0)) return true;
  return false;
}

/// Does it spin so lightly about its length that this takes far less than a turn about another axis?
inline bool is_slender(const BodyMotion<Dim2>&) { return false; }
inline bool is_slender(const BodyMotion<Dim3>& m) { return m.slender != 0; }

/// How far a turn (rad, world axes) moves the surface of a body at most: a long one that rolls moves it little.
inline float way_of_turn(const BodyMotion<Dim2>& m, const Rot2f&, float turn) {
  return math::abs(turn) * m.outer_extent;
}
inline float way_of_turn(const BodyMotion<Dim3>& m, const Quatf& rotation, const Vec3f& turn) {
  const float ball = math::length(turn) * m.outer_extent;
  if (m.slender == 0) return ball;
  Vec3f across = inverse_rotate(rotation, turn);
  float& along = across[(m.slender & 3) - 1];
  const float share = float(m.slender >> 2) * (1.0f / 63);
  const float rolls = math::abs(along) * m.outer_extent * (share * share);
  along = 0;
  return min(ball, math::length(across) * m.outer_extent + rolls);
}

/// How far a turn brings the surface of a body to where it was not before, at most: a wheel turns in place.
inline float reach_of_turn(const BodyMotion<Dim2>& m, const Rot2f& rotation, float turn) {
  return m.slender != 0 ? 0 : way_of_turn(m, rotation, turn);
}
inline float reach_of_turn(const BodyMotion<Dim3>& m, const Quatf& rotation, const Vec3f& turn) {
  return way_of_turn(m, rotation, turn);
}

enum BodyFlag : std::uint16_t {
  body_awake = 1,
  body_enabled = 2,
  body_bullet = 4,
  body_allow_sleep = 8,
  body_mass_given = 16,  ///< set_mass_properties overrides the shapes
  body_quarantined = 32,
  body_fast = 64,           ///< moved far in this step: continuous collision looks at it
  body_has_collider = 128,  ///< a shape that collides (not a sensor)
  body_own_time = 256,      ///< BodyStore::time_scale has its clock
  body_pushed = 512,        ///< a force acted on it in the last step
};

/// Links, settings and bookkeeping.
struct BodyRecord {
  BodyType type = BodyType::dynamic;
  std::uint8_t locks = 0;   ///< bits 0…5: x, y, z, rotation x, y, z
  std::uint16_t flags = 0;  ///< BodyFlag
  std::int32_t first_shape = none;
  std::int32_t first_contact = none;  ///< edge key: 2·contact + side
  std::int32_t first_joint = none;    ///< edge key: 2·joint + side
  std::int32_t contact_count = 0, joint_count = 0;
  std::int32_t constraint_count = 0;  ///< manifolds and joints of this body in the constraint graph: 0 is free flight
  std::int32_t awake_index = none;    ///< place in BodyStore::awake
  std::int32_t sleeping_island = none;
  std::int32_t next_asleep = none;  ///< of the same sleeping island
  std::uint8_t substeps = 0;        ///< that its island has at least
  std::uint32_t color_mask = 0;     ///< colours of the constraint graph in which this body already is
  float sleep_speed = 0.05f;        ///< m/s
  float sleep_timer = 0;            ///< s below the sleep speed

  bool awake() const { return (flags & body_awake) != 0; }
  bool enabled() const { return (flags & body_enabled) != 0; }
};
inline void set_flag(BodyRecord& r, std::uint16_t flag, bool on) {
  r.flags = std::uint16_t(on ? r.flags | flag : r.flags & ~flag);
}

template <class D>
struct BodyStore {
  core::SlotPool<BodyTag> slots;
  // All indexed by slot.
  core::Column<SolverBody<D>> solver;
  core::Column<typename D::Pose> pose;  ///< of the body's origin, at the start of the step (final after it)
  core::Column<BodyMotion<D>> motion;
  core::Column<BodyRecord> record;
  std::vector<std::string> names;        ///< empty until the first body with a name
  std::vector<std::uint64_t> user_data;  ///< as far as one was given
  core::Column<std::uint64_t> birth;     ///< counts up with every creation: the order in which bodies are listed
  std::vector<float> time_scale;         ///< empty until the first body with its own clock
  std::vector<std::int32_t> awake;       ///< slots of awake, enabled dynamic and kinematic bodies, in no special order

  int substep_wishes = 0;  ///< bodies whose record asks for substeps

  explicit BodyStore(std::uint16_t world) : slots(world) {}
  /// Does the solver move this body (dynamic or kinematic) or is it like the ground?
  bool is_fixed(std::int32_t slot) const { return record[std::size_t(slot)].type == BodyType::fixed; }
  bool is_awake(std::int32_t slot) const { return record[std::size_t(slot)].awake_index != none; }
  bool is_dynamic(std::int32_t slot) const { return record[std::size_t(slot)].type == BodyType::dynamic; }
  /// Seconds of the body's own in a second of the world.
  float pace(std::int32_t slot) const {
    if ((record[std::size_t(slot)].flags & body_own_time) == 0 || std::size_t(slot) >= time_scale.size()) return 1;
    return time_scale[std::size_t(slot)];
  }
  void set_pace(std::int32_t slot, float pace) {
    BodyRecord& r = record[std::size_t(slot)];
    r.flags = std::uint16_t(pace == 1 ? r.flags & ~body_own_time : r.flags | body_own_time);
    if (pace == 1) return;
    if (time_scale.size() < record.size()) time_scale.resize(record.size(), 1);
    time_scale[std::size_t(slot)] = pace;
  }
};

}  // namespace carom::rigid::detail
