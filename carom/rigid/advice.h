// A tuning adviser: what a world's settings cannot hold, by how much, and what to change; from masses, step and
// settings alone, before or after the first step.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "carom/rigid/world.h"

namespace carom::rigid {

enum class AdviceKind : std::uint8_t {
  sag,               ///< bodies on soft contacts sink: predicted m of the topmost
  stretch,           ///< joints give way under what hangs on them: predicted m over the way to the ground
  stiff_spring,      ///< a spring swings too fast for the substep: predicted 1, the angle ω h in rad
  capped_stiffness,  ///< contact_hertz or joint_hertz is above what the substep permits: predicted Hz that are used
  fast_body,         ///< moves farther than its size in a step while continuous collision is off: predicted m
};

struct Advice {
  AdviceKind kind{};
  BodyId body{};         ///< the body it is about, or null
  JointId joint{};       ///< the joint, or null
  double predicted = 0;  ///< see the kind
  int substeps = 0;      ///< that would cure it, 0: not by substeps
  std::string message;   ///< what will happen, by how much, and what to change
};

struct AdviceOptions {
  double sag_share = 0.01;      ///< of a stack's height that may sag unsaid
  double stretch_share = 0.01;  ///< of a chain's length
  int most = 16;                ///< of each kind, worst first
};

/// What to expect of steps of dt seconds. The stack law: a soft contact under the load P closes by P/(Σ m_eff ω²), with
/// ω = 2π · contact_hertz (twice that on the ground) and the effective masses of its points; loads come from the
/// weights of what rests on a body, shared evenly by what carries it. Joints likewise with joint_hertz and what hangs
/// on them, where they are solved by iteration (in an automatic world that is known after the first step). See
/// docs/computation.md. Allocates; time in proportion to bodies and their neighbours.
template <class D>
CAROM_API std::vector<Advice> advise(const World<D>& world, float dt, const AdviceOptions& options = {});

/// Gives the islands of sag and stretch the substeps that the advice names (World::set_substeps): those alone pay for
/// it. Returns how many bodies it set. `advise` goes on to tell what the world's own settings would do.
template <class D>
CAROM_API int apply_advice(World<D>& world, std::span<const Advice> advice);

extern template CAROM_API std::vector<Advice> advise(const World<Dim2>&, float, const AdviceOptions&);
extern template CAROM_API std::vector<Advice> advise(const World<Dim3>&, float, const AdviceOptions&);
extern template CAROM_API int apply_advice(World<Dim2>&, std::span<const Advice>);
extern template CAROM_API int apply_advice(World<Dim3>&, std::span<const Advice>);

}  // namespace carom::rigid
