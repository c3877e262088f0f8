// Contact between the particles of a system: grains, heaps.
#pragma once

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::particles {

/// Grains are spheres that do not turn: friction holds a heap without rolling.
struct ContactDef {
  bool enabled = false;
  float restitution = 0.2f;  ///< 0 … 1, between particles
  float friction = 0.5f;     ///< ≥ 0, between particles
  int substeps = 4;          ///< 1 … 64 a step
};
CAROM_API core::Status check(const ContactDef& definition);

class ContactSolver {};

}  // namespace carom::particles
