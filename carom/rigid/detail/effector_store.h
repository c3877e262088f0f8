// Effectors by slot.
#pragma once

#include <vector>

#include "carom/core/pool.h"
#include "carom/environment/sea_patch.h"
#include "carom/rigid/detail/body_store.h"
#include "carom/rigid/effector.h"

namespace carom::rigid::detail {

template <class D>
struct EffectorData {
  EffectorDef<D> definition{};
  std::int32_t joint = none;  ///< slot of the internal joint of a spring–damper
};

template <class D>
struct EffectorStore {
  core::SlotPool<EffectorTag> slots;
  std::vector<EffectorData<D>> data;   ///< by slot
  std::vector<std::int32_t> in_order;  ///< slots in order of creation: the order in which they act
  /// Water that goes along with a body this step: shares of what it displaces, by body.
  struct AddedMass {
    std::int32_t body = none;
    double displaced = 0;  ///< kg
    typename D::Position share{}, water_velocity{}, water_acceleration{};
    typename D::Angular inertia{};  ///< m²
  };
  std::vector<AddedMass> added;
  // Triangles of a hull while its wet part is measured, and how deep its corners are in waves.
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<double> depths;
  std::vector<float> sea_x, sea_z, sea_height;
  environment::SeaPatch sea;

  explicit EffectorStore(std::uint16_t world) : slots(world) {}
  int count() const { return slots.size(); }
};

}  // namespace carom::rigid::detail
