// What a stage of the step sees.
#pragma once

#include <cstdint>
#include <span>

#include "carom/core/arena.h"
#include "carom/core/scheduler.h"
#include "carom/rigid/detail/body_store.h"

namespace carom::rigid::detail {

template <class D>
struct WorldImplementation;

/// Soft contacts swing by at most so many turns in a substep.
inline constexpr float most_contact_turns = 0.15f;

/// A soft constraint's constants for a substep h (implicit spring and damper, Catto, "Soft constraints", GDC 2011;
/// "Solver2D" 2024): Δλ = −mass_scale·m_eff·(v + bias_rate·C) − impulse_scale·λ.
struct Softness {
  float bias_rate = 0, mass_scale = 1, impulse_scale = 0;
};
inline Softness make_softness(float hertz, float damping_ratio, float h) {
  if (hertz == 0) return {};
  const float omega = 2 * pi_f * hertz;
  const float a1 = 2 * damping_ratio + h * omega, a2 = h * omega * a1, a3 = 1 / (1 + a2);
  return {omega / a1, a2 * a3, a3};
}

/// Joints swing by at most so many turns in a substep; couplings by fewer. Rows that see little of the mass that they
/// move, as a thread sees of its nut, agree slowly: Δλ adds up over many substeps, and such a sum only comes to rest
/// where (ωh)² < (1 + 2a₂)/(1 + a₂), a₂ as in make_softness, which .22 turns are.
inline constexpr float most_joint_turns = 0.25f, most_coupling_turns = 0.2f;
/// Where no tree takes over what is far heavier than the bodies of a joint, all joints are such rows.
inline constexpr float most_turns_of_joints(JointSolver solver) {
  return solver == JointSolver::iterative ? most_coupling_turns : most_joint_turns;
}

/// Of contacts between two bodies that impulses move, and of those with one that they do not.
struct ContactSoftness {
  Softness free, firm;
};

/// What a substep does to the motion of an awake body besides its constraints: the same in every substep, so that the
/// cold parts of bodies are read once a step.
template <class D>
struct alignas(16) BodyDrive {
  enum Flag : std::uint8_t {
    dynamic = 1,
    in_flight = 2,
    gyroscopic = 4,
    flies_through = 8,
    carries = 16,
    bounded = 32
  };
  std::int32_t body = none;                 ///< slot
  std::uint8_t flags = 0, locks = 0;        ///< in_flight: dynamic and without a constraint; flies_through: so, in
                                            ///< space and without locks, all substeps at once; carries: nothing but
                                            ///< contacts moves it, whose impulses go on by their sum (list_stages);
                                            ///< bounded: slender, so that contacts may give its spin more energy than
                                            ///< they know of
  float linear_keep = 1, angular_keep = 1;  ///< what damping leaves of velocities
  typename D::Vector linear_gain{};         ///< m/s, of gravity and forces
  typename D::Angular angular_gain{};       ///< rad/s
  float kind = 0;  ///< the same for lanes: 0 kinematic, 1 dynamic, 2 carries, 3 in flight; above: with locks
};
static_assert(sizeof(BodyDrive<Dim2>) == 32 && sizeof(BodyDrive<Dim3>) == 48);  // rows of eight and twelve floats

/// A body's velocities before and after a substep's forces. `spin` turns on with the body: what it has more at the
/// substep's end is what constraints gave it. Rows of four floats, as SolverBody.
template <class D>
struct Flight;
template <>
struct alignas(32) Flight<Dim2> {
  Vec2f after, before;
  float spin, unused[3];
};
template <>
struct alignas(16) Flight<Dim3> {
  Vec3f after;
  float unused_after;
  Vec3f before;
  float unused_before;
  Vec3f spin;
  float unused_spin;
};

/// Hz, of contacts between moving bodies in a step of so many substeps.
template <class D>
float contact_hertz(const WorldDef<D>& definition, int substeps, float inverse_h) {
  const float stiffer = float(substeps) / float(definition.substeps);  // than the world's: BodyDef::substeps
  return min(stiffer * definition.contact_hertz, most_contact_turns * inverse_h);
}
/// 1/s², ω² of a spring of so many Hz.
inline float stiffness_of(float hertz) { return 4 * math::pi_f * math::pi_f * hertz * hertz; }

/// Those of which contacts see the inertia of every substep.
struct SlenderBodies {
  std::span<const std::int32_t> bodies{};  ///< slots
  std::span<Mat3f> inverse_inertia{};      ///< 1/(kg·m²), world axes, as contacts see it, of what has turned
  std::span<std::int32_t> place{};         ///< by slot: 1 + that in these lists of what has turned; 0
  bool many = false;                       ///< have turned
  bool any_jointed = false;
};

template <class D>
struct StepContext {
  WorldImplementation<D>& world;
  core::TaskScheduler& scheduler;
  core::Arena& arena;  ///< of this step, for the calling thread only
  float dt = 0, inverse_dt = 0;
  float h = 0, inverse_h = 0;  ///< of a substep
  int substeps = 1;
  float contact_stiffness = 0;  ///< 1/s²: ω² of contacts between moving bodies
  ContactSoftness contact_softness{};
  Softness joint_softness{}, coupling_softness{};
  float rest_speed = 0;                  ///< m/s between bodies at rest with each other (load.h)
  float push_speed = 0;                  ///< m/s, limit of the speed at which overlaps separate
  Flight<D>* flights = nullptr;          ///< by place in BodyStore::awake
  SolverBody<D>* bodies = nullptr;       ///< by slot; never write to fixed or kinematic ones
  BodyDrive<D>* drives = nullptr;        ///< in the order of BodyStore::awake
  typename D::Angular* spins = nullptr;  ///< of those that are `bounded`, likewise: rad/s when they last turned
  SlenderBodies slender;
};

}  // namespace carom::rigid::detail
