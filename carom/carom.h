// All of Carom in one include.
#pragma once

#include "carom/core/result.h"
#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/rigid/advice.h"
#include "carom/rigid/articulation.h"
#include "carom/rigid/character.h"
#include "carom/rigid/dynamic_character.h"
#include "carom/rigid/path.h"
#include "carom/rigid/tile_ground.h"
#include "carom/rigid/world.h"

namespace carom {
using rigid::World2;
using rigid::World3;
}  // namespace carom
