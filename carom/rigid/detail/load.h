// Masses that follow the load: what is squeezed between others counts for more in the contact solver.
//
// A soft contact gives way by (load)/(m_eff ω²), and rows solved one after the other agree slowly where masses differ
// much: both fail where a light body carries a heavy one. But what a squeezed body does depends little on its own
// inertia: it can move only with those that squeeze it. So a body through which the load L passes is given, for the
// solver, s times its mass and inertia while its weight and the forces on it stay (its acceleration is divided by s):
// statics stay exact, its contacts become s times as stiff, and no contact sees a load of more than some bodies'
// weights. L is what presses from all sides at once, (Σ|λ| − |Σ λ n|)/2 over the contacts of the body: nothing for what
// lies on top, is struck or pushed from one side. A body with joints is pressed by these too, as far as contacts tell.
// See docs/computation.md, §3.
#pragma once

#include <algorithm>
#include <functional>

#include "carom/rigid/detail/step_context.h"

namespace carom::rigid::detail {

/// What the contacts of a body did to it in the last substep. Rows of four floats, which lanes transpose.
template <class D>
struct alignas(16) BodyLoad {
  typename D::Vector sum{};  ///< N·s
  float size = 0;            ///< N·s; below zero: something slides along it or strikes it
};
static_assert(sizeof(BodyLoad<Dim2>) == 16 && sizeof(BodyLoad<Dim3>) == 16);
inline constexpr float restless_load = -1e30f;

inline constexpr float load_weights = 2;      ///< of its own, that a body carries as it is
inline constexpr float load_yield = 0.0012f;  ///< m of its contacts over its size, that it yields as it is
inline constexpr int load_rise = 1;           ///< levels a step, so that what settles does not swing,
inline constexpr int load_lag = 105;          ///< but never more than so many (a factor of 8) behind the load
inline constexpr int load_play = 10;          ///< levels above the load that are let be
inline constexpr int load_fall = 5;           ///< levels a step: what is thrown up by a hair comes down prepared
inline constexpr int free_level = 35;    ///< twice its mass: more is granted by what brings the load (load_account.h)
inline constexpr int load_wait = 8;      ///< steps between two questions for more,
inline constexpr int refused_wait = 24;  ///< and so many more where the answer was no
inline constexpr float most_load_factor = 1e4f;  ///< about what the last level means
inline constexpr float rest_falls = 4;           ///< steps of free fall: what parts no faster is at rest
inline constexpr float jointed_bearing = 16;     ///< times what others bear, that a body with joints bears as it is
inline constexpr int jointed_fall = 20;          ///< levels a step of one that nothing touches any more
inline constexpr float jointed_share = 0.125f;   ///< of the mass that its joints hold, that it has at most for a load

/// 1/s by level: two percent each, to ten thousand.
struct LoadShares {
  static constexpr int count = 466;
  float share[count];
  constexpr LoadShares() : share() {
    double s = 1;
    for (float& x : share) x = float(1 / s), s *= 1.02;
  }
};
inline constexpr LoadShares load_shares;

/// 1/s.
template <class D>
float load_share(const BodyMotion<D>& m) {
  return load_shares.share[m.load_level];
}

/// m/s between bodies that are at rest with each other.
template <class D>
float rest_speed(const WorldDef<D>& definition, float dt) {
  return rest_falls * math::length(definition.gravity) * dt;
}

/// A body wants to count for more than its limit, or is to be its own self again.
struct LoadWish {
  std::int32_t body;
  float borne;  ///< N, what it bears as it is; 0: it is to be its own self
};

/// `since`: steps since BodyMotion::load_asked, modulo 2¹⁶. That is to come where the answer was no.
inline bool may_ask(std::uint16_t since) { return since >= load_wait && since < 0x10000 - refused_wait; }

/// m/s², what a body bears as it is. gravity: m/s², of what acts on the body from afar.
template <class D>
float borne_as_it_is(const BodyMotion<D>& m, float gravity, float contact_stiffness) {
  return min(load_weights * gravity, load_yield * m.inner_extent * contact_stiffness);
}

/// What a body bears as it is over what presses it together, at most 1: at the least level that has this share or less,
/// it bears the load. gravity: m/s², of what acts on the body from afar.
template <class D>
float borne_share(const StepContext<D>& context, const BodyMotion<D>& m, const BodyLoad<D>& load, float gravity) {
  const float squeeze = 0.5f * (load.size - math::length(load.sum)) * m.inverse_mass * context.inverse_h;  // m/s²
  const float borne = borne_as_it_is(m, gravity, context.contact_stiffness);
  return borne > 0 && squeeze > borne ? borne / squeeze : 1;
}

/// The least level that has this share of a body's mobility or less.
inline std::uint16_t level_of_share(float share) {
  const float* const shares = load_shares.share;
  return std::uint16_t(std::lower_bound(shares, shares + LoadShares::count - 1, share, std::greater<>()) - shares);
}

/// The level for a load that is there from the start.
template <class D>
std::uint16_t level_of_load(const StepContext<D>& context, const BodyMotion<D>& m, const BodyLoad<D>& load,
                            float gravity) {
  return level_of_share(borne_share(context, m, load, gravity));
}

/// The next level.
template <class D>
std::uint16_t follow_load(const StepContext<D>& context, const BodyMotion<D>& m, const BodyLoad<D>& load,
                          float gravity) {
  if (load.size < 0) return 0;
  if (m.load_level == 0 && load.size == 0) return 0;
  const float share = borne_share(context, m, load, gravity);
  const int level = m.load_level;
  const float* const shares = load_shares.share;
  const int last = LoadShares::count - 1;
  if (share == 1 || level == last || !(shares[level] > share)) {
    const int low = level - load_play;
    const bool stays = low < 0 || (share < 1 && shares[low] > share);
    return std::uint16_t(stays ? level : level - load_fall);
  }
  // Compared with where it is: most change little, and a search costs more than all the rest here.
  static_assert(load_rise == 1 && load_fall <= load_play);
  const int far = level + load_rise + load_lag;
  if (far >= last || !(shares[far] > share)) return std::uint16_t(level + load_rise);
  return std::uint16_t(int(std::lower_bound(shares + far, shares + last, share, std::greater<>()) - shares) - load_lag);
}

/// The load of a body with joints, whose impulses balance what contacts give it beyond `weight` (N·s in a substep): as
/// of one that bears as much as others do. What nothing touches hangs, and swings with its own mass.
template <class D>
BodyLoad<D> jointed_load(const BodyLoad<D>& load, const typename D::Vector& weight) {
  if (load.size <= 0) return load;
  return {(-1 / jointed_bearing) * weight, (load.size + math::length(load.sum + weight)) / jointed_bearing};
}

}  // namespace carom::rigid::detail
