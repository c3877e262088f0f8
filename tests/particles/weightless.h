// Worlds in which nothing falls.
#pragma once

#include "carom/rigid/world.h"

namespace carom::particles {

inline rigid::World3 weightless() {
  rigid::WorldDef<rigid::Dim3> def;
  def.gravity = {};
  return rigid::World3(def);
}

}  // namespace carom::particles
