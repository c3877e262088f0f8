// A character: an upright capsule that walks where it is told. It climbs stairs, stays on slopes and moving platforms,
// slides along walls, and pushes bodies with a limited force. It is no dynamic body: between worlds' steps it moves by
// its own rule, and the world knows it as a kinematic body, so that bodies, queries and other characters meet it. It
// jumps through one-way surfaces from behind, and belts carry it.
//
//   auto player = Character3::create(world, {.max_slope = radians(45.0f)}, {0, 0, 0}).value();
//   each step:  player.move(world, {3, jump ? 5.0f : 0.0f, 0}, dt);  world.step(dt);
#pragma once

#include <memory>
#include <vector>

#include "carom/rigid/world.h"

namespace carom::rigid {
namespace detail {
template <class D>
struct Vicinity;
template <class D>
struct Neighbour;
}  // namespace detail

template <class D>
constexpr typename D::Vector default_up() {
  if constexpr (D::dimension == 2)
    return {0, 1};
  else
    return {0, 1, 0};
}

template <class D>
struct CharacterDef {
  float radius = 0.3f;                      ///< m, > 0
  float half_length = 0.6f;                 ///< m, of the capsule's straight part, ≥ 0: 1.8 m tall in all
  typename D::Vector up = default_up<D>();  ///< unit vector
  float max_slope = 50 * math::pi_f / 180;  ///< rad, 0 … π/2: what is steeper is a wall
  float step_height = 0.35f;                ///< m: stairs up to this are climbed, and walked down without a fall
  float skin = 0.01f;                       ///< m, > 0: the distance kept from everything
  float mass = 80;                          ///< kg: its weight rests on the body it stands on; 0: weightless
  float push_force = 500;                   ///< N with which it pushes dynamic bodies that stand in its way
  Filter filter{};                          ///< what it meets, and who meets it
  std::uint64_t user_data = 0;              ///< of its body
};

enum class GroundState : std::uint8_t {
  on_ground,  ///< stands on something that is not too steep
  on_steep,   ///< touches only what is too steep: slides
  in_air
};

/// What is under a character's feet after a move.
template <class D>
struct CharacterGround {
  GroundState state = GroundState::in_air;
  BodyId body{};  ///< null in the air
  ShapeId shape{};
  typename D::Position point{};
  typename D::Vector normal{};    ///< of the contact, out of the ground
  float slope = 0;                ///< rad between the normal and up
  typename D::Vector velocity{};  ///< m/s, of the ground there, with that of a belt
  typename D::Vector belt{};      ///< m/s of it, by which the surface runs over its body
};

/// What a rollback keeps of a character beside the world's snapshot.
template <class D>
struct CharacterState {
  typename D::Position center{};
  typename D::Vector velocity{};
  float rise = 0;  ///< m/s along up while it does not stand
  CharacterGround<D> ground{};
  bool dropping = false;  ///< drop_through was called, and it is not yet within a one-way surface
};

/// Not copyable: it owns a body of the world. Every call takes the world that it was created in. Deterministic; a call
/// to `move` allocates nothing once its lists have grown to the number of shapes nearby.
template <class D>
class CAROM_API Character {
 public:
  using Vector = typename D::Vector;
  using Position = typename D::Position;

  /// Puts a character on its feet at `feet`. Errors: a field out of range.
  static Result<Character> create(World<D>& world, const CharacterDef<D>& definition, Position feet);
  Character(Character&&) noexcept;
  Character& operator=(Character&&) noexcept;
  ~Character();
  Character(const Character&) = delete;
  Character& operator=(const Character&) = delete;

  /// Walks for dt with `velocity` (m/s) relative to the ground it stands on; on a slope the speed is that along it. The
  /// part along `up` is that of a jump where it is positive and the character stands, and means nothing otherwise: the
  /// world's gravity pulls at what does not stand. Call it before the world's step of the same dt. Errors: velocity or
  /// dt not finite or out of range, or the body no longer exists; nothing has moved then.
  Status move(World<D>& world, Vector velocity, float dt);
  /// Lets go of the one-way surfaces that it stands on: the next moves fall through them. Others hold it again.
  void drop_through() { dropping_ = true; }
  /// Elsewhere at once, at rest and in the air until the next move.
  Status teleport(World<D>& world, Position feet);
  /// For rollback: with the world's own snapshot, everything that later moves depend on.
  CharacterState<D> state() const { return {position_, velocity_, rise_, ground_, dropping_}; }
  void restore(const CharacterState<D>& state);
  /// Removes its body; the character is of no use afterwards.
  Status destroy(World<D>& world);

  Position feet() const;                         ///< m, the lowest point
  Position center() const { return position_; }  ///< m, of the capsule
  Vector velocity() const { return velocity_; }  ///< m/s, of the last move, with that of its ground
  const CharacterGround<D>& ground() const { return ground_; }
  BodyId body() const { return body_; }
  const CharacterDef<D>& definition() const { return definition_; }

 private:
  /// A half-space in which the centre must stay: normal · (x − position) ≥ −gap. The gap is that at the end of the
  /// move.
  struct Plane {
    Vector normal{};
    float gap = 0;      ///< m to the skin, less closing
    float closing = 0;  ///< m by which the obstacle comes nearer in this move
    float height = 0;   ///< m of the nearest point above the feet
    bool walkable = false, low = false, dynamic = false;
    std::size_t neighbour = 0;
    Position point{};
    mutable signed char ground = -1;  ///< whether it carries; negative: not asked yet
  };
  Character();
  void look_around(const World<D>& world, const geometry::Bounds<Vector>& needed);
  bool lets_through(std::size_t neighbour, const Vector& front);
  Vector belt_of(const World<D>& world, const Plane& plane) const;
  void find_planes(const World<D>& world, const Vector& way, float around);
  void add_plane(std::size_t neighbour, const Vector& normal, float separation, const Vector& point);
  bool carries(const Plane& plane) const;
  const detail::Neighbour<D>& of(const Plane& plane) const;
  Vector fit(Vector wanted, bool keep_height) const;
  void slide(const World<D>& world, Vector way, bool keep_height);
  float advance(const World<D>& world, const Vector& direction, float way);
  bool climb(const World<D>& world, const Vector& way, float wanted, const Position& start);
  void push_bodies(World<D>& world, const Vector& walk);
  void follow_ground(const World<D>& world, bool jumped, bool stood);
  Vector carry(const World<D>& world);
  typename D::Pose pose() const { return {position_, rotation_}; }

  CharacterDef<D> definition_{};
  typename D::Rotation rotation_{};
  typename D::Shape capsule_{};
  geometry::Bounds<Vector> box_{};  ///< of the capsule, from its centre
  BodyId body_{};
  ShapeId shape_{};
  Position position_{};
  Vector velocity_{};
  float rise_ = 0;      ///< m/s along up while it does not stand
  float least_up_ = 0;  ///< cosine of max_slope
  float dt_ = 0;
  bool dropping_ = false;
  bool held_ = false;     ///< in this move a one-way surface would have held it
  bool stopped_ = false;  ///< the last advance ended at something
  float reach_ = 0;       ///< m that this move may lead, steps up and down aside
  CharacterGround<D> ground_{};
  std::vector<Plane> planes_;
  std::unique_ptr<detail::Vicinity<D>> around_;
};

extern template class CAROM_API Character<Dim2>;
extern template class CAROM_API Character<Dim3>;
using Character2 = Character<Dim2>;
using Character3 = Character<Dim3>;

}  // namespace carom::rigid
