// A charge that goes off in a world: the wave runs out, and pushes what it reaches as long as it passes (chapter 18.6).
#pragma once

#include <span>
#include <vector>

#include "carom/blast/loading.h"
#include "carom/rigid/world.h"

namespace carom::blast {

template <class D>
struct Charge {
  typename D::Position position{};
  double mass = 1;  ///< kg of TNT (or what is equivalent to it), > 0
  Burst burst = Burst::ground;
  double ground = 0;                       ///< m, the height of the ground under a burst in the air
  double time = 0;                         ///< s, the world's time at which it goes off
  double reach = 0;                        ///< m, at most 40 W^{1/3}, which 0 stands for
  bool clearing = true;                    ///< edges of what is hit relieve the reflected pressure
  double shelter = 0.4;                    ///< 0 … 1 of the side-on pressure behind an obstacle: a designer's number
  rigid::BodyId casing{};                  ///< neither pushed nor in the way
  std::uint64_t mask = ~std::uint64_t{0};  ///< categories of shapes that feel it
  std::uint64_t obstacles = ~std::uint64_t{0};  ///< categories of shapes that shelter
};

/// A body that the front reached.
template <class D>
struct FrontEvent {
  rigid::BodyId body{};
  double time = 0;      ///< s after the detonation
  double distance = 0;  ///< m
  double pressure = 0;  ///< Pa, side-on, there; less where it is sheltered
  bool sheltered = false;
  Damage damage = Damage::none;  ///< by damage_of: glass, structure, eardrums, …
};
/// What a shape got in a step: those of bodies that move, and of fixed ones that want hit events (as structures do).
template <class D>
struct ShapeLoad {
  rigid::ShapeId shape{};
  rigid::BodyId body{};
  typename D::Vector impulse{};  ///< N·s
  typename D::Position point{};  ///< m, where the pressure acts
  double duration = 0;           ///< s of the step in which it acted
};

/// The waves that come to a place, each with the unit vector toward where it comes from.
template <class D>
struct WavesAt {
  int count = 0;
  Wave wave[2];
  typename D::Position toward[2] = {};
};

/// The loads of bodies come from patches of their shapes: whether the charge sees a patch (rays), at what angle and how
/// far away, gives its pressure; what is turned away feels the side-on pressure, what is sheltered part of it. Nothing
/// is kept between steps but the charge, so that it copies, and goes on in a restored world. Nearer than Z = 0.2
/// m/kg^{1/3} the wave is that of Z = 0.2. The plane is a slice of space, a metre thick.
template <class D>
class CAROM_API Explosion {
 public:
  using World = rigid::World<D>;
  using Vector = typename D::Vector;
  using Position = typename D::Position;

  Explosion() = default;
  /// Errors: numbers out of range.
  static core::Result<Explosion> make(const Charge<D>& charge);

  /// Before each step of `dt` s: what the wave gives to bodies within it. Wakes them.
  core::Status apply(World& world, double dt);
  /// The wave has passed all that it can reach.
  bool finished(double world_time) const { return world_time - charge_.time > last_; }
  /// Where the front is (m from the charge), at a time of the world; 0 before it goes off.
  double front_radius(double world_time) const;

  /// The wave at a distance (m), clamped to where the fits hold.
  Wave wave_at(double distance) const;
  /// What comes to a place within reach. Of a burst in the air over ground: under the triple point the Mach stem, which
  /// runs along the ground; above it the charge's own wave and then the ground's, as if from the charge's image in it.
  WavesAt<D> waves_at(Position place) const;
  /// Of a burst in the air: where the triple point passes (m above the ground) at a distance along the ground (m); 0
  /// where the reflection is regular, and of other bursts.
  double stem_height(double ground_distance) const;
  /// Side-on pressure (Pa) at a place and a time of the world. With a world, obstacles count.
  double pressure_at(Position place, double world_time, const World* world = nullptr) const;
  /// What share of the wave places get: 1 in sight of the charge, `shelter` behind what a ray meets.
  core::Status shares_at(const World& world, std::span<const Position> places, std::vector<double>& shares) const;
  /// The wind of the wave on particles from t to t + dt (the world's time): their drag area by mass (m²/kg, C_D A/m).
  /// None becomes faster than the wind. Positions are relative to `origin`.
  void push_particles(std::span<const Vector> positions, std::span<Vector> velocities, Position origin,
                      double area_per_mass, double world_time, double dt) const;

  std::span<const FrontEvent<D>> events() const { return events_; }  ///< of the last apply
  std::span<const ShapeLoad<D>> loads() const { return loads_; }     ///< of the last apply
  /// What has been given to bodies that move so far: N·s, and its moment about the charge.
  Position impulse_given() const { return given_; }
  const Charge<D>& charge() const { return charge_; }
  double reach() const { return reach_; }  ///< m

 private:
  /// The ground's reflection by the tangent of the incidence, at nodes even in ln(1 + tan α).
  struct Ground {
    double factor = 1, stem = 0;  // m
  };
  struct Pass;
  /// Adds what the wave is passing of a shape.
  void see(const World& world, rigid::ShapeId shape, double front, Pass& pass) const;
  /// Gives what was seen its loads.
  core::Status load(World& world, Pass& pass);
  Ground ground_at(double tangent) const;
  double height() const;  // m, of the burst
  Position eye() const;
  Charge<D> charge_{};
  double scale_ = 1;  // m per m/kg^{1/3}
  double reach_ = 0, last_ = 0;
  std::vector<Ground> ground_;  // of a burst in the air
  double tangent_scale_ = 0;
  Position given_{};
  std::vector<FrontEvent<D>> events_;
  std::vector<ShapeLoad<D>> loads_;
};

extern template class CAROM_API Explosion<rigid::Dim2>;
extern template class CAROM_API Explosion<rigid::Dim3>;
using Explosion2 = Explosion<rigid::Dim2>;
using Explosion3 = Explosion<rigid::Dim3>;

}  // namespace carom::blast
