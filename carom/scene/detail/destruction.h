// Reads explosions, guns, structures, rockets and shells of a scene file into a world.
#pragma once

#include "carom/scene/destruction.h"
#include "carom/scene/detail/joints.h"
#include "carom/scene/detail/matter.h"
#include "carom/scene/detail/shapes.h"

namespace carom::scene::detail {

inline constexpr const char* destruction_lists[] = {"structures", "explosions", "guns", "rockets", "shells"};

/// What readers of these share.
template <class D>
struct DestructionPlace {
  Reader& reader;
  BodyNames& names;
  rigid::World<D>& world;
  Destruction& out;
  SceneWorld& scene;  ///< gets the bodies of structures
  const Library& library;
  std::shared_ptr<const environment::Environment> around;  ///< null: still air of the standard day
  double budget = 0;                                       ///< pieces and rounds that may still be made
};

/// Makes one thing of the list. Fails the reader where it is wrong.
template <class D>
[[gnu::noinline]] void read_destruction(DestructionPlace<D>& place, std::string_view list, const Node& node,
                                        const std::string& path);
/// The key "penetration": what projectiles go through.
template <class D>
[[gnu::noinline]] bool read_penetration(Reader& reader, const Node& part, ballistics::BatchHits<D>& hits);

template <class D>
[[gnu::noinline]] void read_gun(DestructionPlace<D>& place, const Object& o);
template <class D>
[[gnu::noinline]] void read_structure(DestructionPlace<D>& place, const Object& o);
[[gnu::noinline]] void read_rocket(DestructionPlace<rigid::Dim3>& place, const Object& o);
[[gnu::noinline]] void read_shell(DestructionPlace<rigid::Dim3>& place, const Object& o);
/// What spins, by its numbers.
ballistics::Shell read_shell_itself(Reader& reader, const Object& o);
/// Air, steady wind by height, gravity and the turning of the frame as what flies through the scene from a point meets
/// them.
ballistics::Conditions conditions_at(math::Vec3d point, double gravity, int dimension,
                                     const environment::Environment* around);
/// What flies as a body of its own has a name that neither another thing of its list nor a body has.
template <class List>
bool name_flying_body(DestructionPlace<rigid::Dim3>& place, const Object& o, std::string_view kind, const List& others,
                      std::string& name, std::uint32_t& color) {
  if (!name_thing(place.reader, o, kind, others, name, color)) return false;
  if (place.scene.find_body(name) == nullptr) return true;
  place.reader.fail(*o.node, o.path, "found the name " + quote(name) + " a second time, expected one that no body has");
  return false;
}
/// Those of a body that flies by a model: with all of the wind. `turning`: with that of the frame, which the world
/// gives to every body.
ballistics::Conditions own_flight_conditions(math::Vec3d point, const rigid::World3& world,
                                             const std::shared_ptr<const environment::Environment>& around,
                                             bool turning);
/// Guns, rockets and shells that run meet what is around them now.
template <class D>
[[gnu::noinline]] void renew_air(Destruction& all, const rigid::World<D>& world,
                                 const std::shared_ptr<const environment::Environment>& around);

}  // namespace carom::scene::detail
