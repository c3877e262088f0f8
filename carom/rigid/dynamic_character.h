// A character that is a body: an upright capsule of its mass which legs drive, and which everything can push. It stands
// on what carries it, climbs stairs, is carried by platforms, jumps off with a recoil, and is thrown aside by a truck.
// Where that is not wanted, there is Character (character.h), which moves by its own rule.
//
//   auto player = DynamicCharacter3::create(world, {.mass = 90}, {0, 0, 0}).value();
//   each step:  player.move(world, {3, jump ? 5.0f : 0.0f, 0}, dt);  world.step(dt);
#pragma once

#include <vector>

#include "carom/rigid/character.h"

namespace carom::rigid {

template <class D>
struct DynamicCharacterDef {
  float radius = 0.3f;                      ///< m, > 0
  float half_length = 0.6f;                 ///< m, of the capsule's straight part, ≥ 0: 1.8 m tall in all
  typename D::Vector up = default_up<D>();  ///< unit vector
  float max_slope = 50 * math::pi_f / 180;  ///< rad, 0 … π/2: what is steeper does not carry
  float step_height = 0.35f;                ///< m: stairs up to this are climbed, and walked down without a fall
  float mass = 80;                          ///< kg, > 0
  float leg_force = 1600;                   ///< N, ≥ 0: the most that its legs push with, to walk, climb and push
  float air_force = 120;                    ///< N, ≥ 0: with which it steers in the air
  Filter filter{};
  std::uint64_t user_data = 0;  ///< of its body
};

/// What a rollback keeps of a character beside the world's snapshot.
template <class D>
struct DynamicCharacterState {
  CharacterGround<D> ground{};
};

/// Not copyable: it owns a body of the world, with locked rotation and a surface without friction: its legs do what
/// friction would. Every call takes the world that it was created in. Deterministic.
template <class D>
class CAROM_API DynamicCharacter {
 public:
  using Vector = typename D::Vector;
  using Position = typename D::Position;

  /// Puts a character on its feet at `feet`. Errors: a field out of range.
  static Result<DynamicCharacter> create(World<D>& world, const DynamicCharacterDef<D>& definition, Position feet);
  DynamicCharacter(DynamicCharacter&&) noexcept = default;
  DynamicCharacter& operator=(DynamicCharacter&&) noexcept = default;
  DynamicCharacter(const DynamicCharacter&) = delete;
  DynamicCharacter& operator=(const DynamicCharacter&) = delete;

  /// Lets the legs work for the next step of dt, toward `velocity` (m/s) relative to the ground it stands on; on a
  /// slope the speed is that along it. The part along `up` is that of a jump where it is positive and the character
  /// stands, and means nothing otherwise. What it stands on gets the opposite force. Errors: velocity or dt not finite
  /// or out of range, or the body no longer exists; nothing has changed then.
  Status move(World<D>& world, Vector velocity, float dt);
  /// Elsewhere at once, at rest.
  Status teleport(World<D>& world, Position feet);
  /// For rollback: with the world's own snapshot, everything that later moves depend on.
  DynamicCharacterState<D> state() const { return {ground_}; }
  void restore(const DynamicCharacterState<D>& state) { ground_ = state.ground; }
  /// Removes its body; the character is of no use afterwards.
  Status destroy(World<D>& world);

  Position feet(const World<D>& world) const;                   ///< m, the lowest point, now
  Position center(const World<D>& world) const;                 ///< m, of the capsule
  Vector velocity(const World<D>& world) const;                 ///< m/s
  const CharacterGround<D>& ground() const { return ground_; }  ///< as the last move found it
  BodyId body() const { return body_; }
  const DynamicCharacterDef<D>& definition() const { return definition_; }

 private:
  /// A surface that is touched.
  struct Touch {
    Vector normal{};  ///< out of the other
    Position point{};
    float rise = 0;    ///< normal · up
    float height = 0;  ///< m of the point above the feet
    ShapeId shape{};
  };
  DynamicCharacter() = default;
  void look(const World<D>& world, Position feet, const Vector& walk, bool jumps);
  bool has_top(const World<D>& world, const Touch& touch, float highest) const;
  Touch touch_of(const RayHit<D>& hit, Position center) const;
  bool find_ahead(const World<D>& world, const Vector& walk, Touch& found) const;
  bool find_below(const World<D>& world, Touch& found, float& distance) const;
  void stand_on(const World<D>& world, const Touch& touch, GroundState state);
  Vector legs(const Vector& walk, const Vector& velocity, const Vector& gravity, float dt) const;

  DynamicCharacterDef<D> definition_{};
  typename D::Rotation rotation_{};
  typename D::Shape probe_{};  ///< the capsule, a little thinner, so that walls beside it are not met
  BodyId body_{};
  ShapeId shape_{};
  float least_up_ = 0;  ///< cosine of max_slope
  float drop_ = 0;      ///< m down to the ground that it is kept on
  CharacterGround<D> ground_{};
  std::vector<ContactView<D>> contacts_;
};

extern template class CAROM_API DynamicCharacter<Dim2>;
extern template class CAROM_API DynamicCharacter<Dim3>;
using DynamicCharacter2 = DynamicCharacter<Dim2>;
using DynamicCharacter3 = DynamicCharacter<Dim3>;

}  // namespace carom::rigid
