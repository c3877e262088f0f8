// Models that no scene runs: each room prints a line for each of its own, in models_<room>.cpp.
#pragma once

#include <cstdio>

#include "carom/core/hash.h"

namespace carom::determinism {

inline void print_model(const char* name, const core::StateHash& hash) {
  std::printf("model %s %016llx\n", name, static_cast<unsigned long long>(hash.digest()));
}

void particle_models(int width);  ///< lanes of the kernels, 0: what the machine has
void billiards_models(int width);
void ballistics_models(int width);  ///< lanes of the batch, 0: what the machine has
void gun_models();
void environment_models(int width);
void blast_models(int width);  ///< lanes of the world
void sports_models();
void rope_models(int width);   ///< lanes of the batch, 0: what the machine has
void fluid_models(int width);  ///< lanes of the worlds that the liquids are in

}  // namespace carom::determinism
