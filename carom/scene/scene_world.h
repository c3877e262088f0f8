// A running scene: a world of the plane or of space with all that is in it, or a flight, with the names of the file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "carom/rigid/dynamic_character.h"

namespace carom::scene {
using core::Result;
using core::Status;

enum class Kind : std::uint8_t { rigid, flight };

class Matter;
class Destruction;
namespace detail {
struct Expression;
class Flight;
}  // namespace detail

struct SceneBody {
  std::string name;
  rigid::BodyId id{};
  std::uint32_t color = 0;  ///< 0xAARRGGBB, the opacity first
  bool colored = false;
  bool trail = false;  ///< pictures draw its path
};
/// Where a flight's vehicle is: x north and z east of where it began, y the altitude, m. The body's axes are x forward,
/// y up, z to starboard; `half_extents` are those of the solid box with its mass and inertia.
struct FlightPlace {
  math::Vec3d position{};
  math::Quatf rotation{};
  math::Vec3d half_extents{};
};
struct SceneJoint {
  std::string name;
  rigid::JointId id{};
};
struct SceneEffector {
  std::string name;
  rigid::EffectorId id{};
};

/// Its body is among the scene's bodies too. `step` lets it walk.
struct SceneCharacter {
  std::string name;
  rigid::BodyId body{};
  math::Vec3d velocity{};  ///< m/s, wanted
  std::variant<std::monostate, rigid::Character2, rigid::Character3, rigid::DynamicCharacter2, rigid::DynamicCharacter3>
      walker;
};

/// A quantity of the world, compiled once and read every step. See docs/scene-files.md for what it may say.
class CAROM_API Probe {
 public:
  std::string text;
  std::string unit;  ///< SI unit of the value, "" for a plain number

  /// What one name in the expression stands for.
  struct Source {
    enum class Kind : std::uint8_t { world, body, joint, flight, matter, destruction } kind = Kind::world;
    int field = 0, component = 0;
    rigid::BodyId body{};
    rigid::JointId joint{};
    int list = 0, item = 0;  ///< of matter and destruction
  };
  std::vector<Source> sources;
  std::shared_ptr<const detail::Expression> expression;
};

class CAROM_API SceneWorld {
 public:
  SceneWorld();
  ~SceneWorld();
  SceneWorld(SceneWorld&&) noexcept;
  SceneWorld& operator=(SceneWorld&&) noexcept;

  Kind kind = Kind::rigid;
  int dimension = 3;
  double dt = 1.0 / 60;                   ///< s
  double duration = 10;                   ///< s
  std::unique_ptr<rigid::World2> world2;  ///< one of these three is there
  std::unique_ptr<rigid::World3> world3;
  std::unique_ptr<detail::Flight> flight;
  std::unique_ptr<Matter> matter;            ///< ropes, cloth, liquids and so on (matter.h); null where there are none
  std::unique_ptr<Destruction> destruction;  ///< charges, guns, structures (destruction.h); null where there are none
  std::vector<SceneBody> bodies;             ///< in creation order
  std::size_t listed_bodies = 0;             ///< the first so many are of the file's bodies
  std::vector<SceneJoint> joints;
  std::vector<SceneEffector> effectors;
  std::vector<SceneCharacter> characters;
  rigid::EffectorId environment{};  ///< of the key "environment"; null where the scene has none

  Status step();  ///< by dt
  double time() const;
  std::uint64_t step_count() const;
  std::uint64_t state_hash() const;
  /// Empty where the scene is no flight.
  std::optional<FlightPlace> flight_place() const;

  /// Null where there is none.
  const SceneBody* find_body(std::string_view name) const;
  const SceneJoint* find_joint(std::string_view name) const;
  const SceneBody* find_body(rigid::BodyId id) const;

  /// "ball.position.y", "energy.kinetic", "time", … or an expression of them.
  Result<Probe> probe(std::string_view expression) const;
  double read(const Probe& probe) const;  ///< SI; NaN where a body is gone
};

/// The `scene` message of docs/protocol.md (JSON text) and the binary mesh messages it refers to.
/// A body's id in messages and frames is its place in SceneWorld::bodies (or in creation order of the world).
struct SceneMessages {
  std::string scene;
  std::vector<std::string> meshes;
};
CAROM_API SceneMessages scene_messages(const SceneWorld& world, const double* ground = nullptr);

/// Of the effector that stands for the key "environment"; null where the scene has none.
template <class D>
std::shared_ptr<const environment::Environment> environment_of(const rigid::World<D>& world, rigid::EffectorId id) {
  if (id.is_null()) return nullptr;
  const auto definition = world.effector_definition(id);
  const auto* found = definition.ok() ? std::get_if<rigid::Surroundings<D>>(&*definition) : nullptr;
  return found != nullptr ? found->environment : nullptr;
}

}  // namespace carom::scene
