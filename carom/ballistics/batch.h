// Projectiles by the hundred thousand: one kind of projectile, a structure of arrays, Runge–Kutta steps in lanes
// (chapter 18.1). The same bits for any width.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/ballistics/flight.h"
#include "carom/math/cpu.h"

namespace carom::ballistics {

/// What a projectile of a batch is, beside its flight.
struct BatchRound {
  double area_per_mass = 1e-3;  ///< m²/kg, for the drag; a form factor is part of it
  double mass = 0;              ///< kg: what it pushes with where it hits; 0: it pushes nothing
  double frontal_area = 0;      ///< m², for what it penetrates; 0: area_per_mass · mass
  std::uint64_t tag = 0;        ///< the caller's; goes with it when indices change
};

/// A chunk that tumbles, such as a fragment of a case: the area that a cube of its mass shows on average, a quarter of
/// its surface (Cauchy), 1.5 (m/ρ)^{2/3}. `mass` (kg) and `density` (kg/m³) > 0.
CAROM_API BatchRound chunk_round(double mass, double density = 7850);

/// Point masses that share a drag curve. Positions are floats about an origin in double: a millimetre at 10 km from it.
/// The air and the wind are those of the height in the middle of a step (it knows nothing of Conditions::field);
/// gravity is uniform, and the frame may turn.
class CAROM_API ProjectileBatch {
 public:
  /// `lanes`: 4, 8 or 16; 0: the widest that the machine has. The results do not depend on it.
  ProjectileBatch(const DragCurve& drag, const Conditions& conditions, math::Vec3d origin = {}, int lanes = 0);

  /// Other air, wind, gravity and turning from now on.
  void set_conditions(const Conditions& conditions);

  /// Index of the new one: the number of those before it.
  std::size_t add(const FlightPoint& start, double area_per_mass);
  std::size_t add(const FlightPoint& start, const BatchRound& round);
  /// The last one takes its index.
  void remove(std::size_t index);
  /// Puts it there, as after a ricochet; where it was before stays.
  void place(std::size_t index, const FlightPoint& point);
  /// New indices, so that neighbours in space are neighbours in memory (along a curve through cubes of `cell` m, Morton
  /// 1966): what asks a world about them asks less. Tags tell who is who. Costs about two steps; now and then is
  /// enough.
  void sort(double cell = 16);
  const BatchRound& round(std::size_t index) const { return rounds_[index]; }
  void clear();
  void reserve(std::size_t count);
  std::size_t size() const { return count_; }

  /// All by `dt` s: one classic Runge–Kutta step each, in which drag takes at most as much as would stop it in one:
  /// what is so light that it would stop within a part of a step slows down by e in it. An index of `from … to` can be
  /// stepped by another thread.
  void step(double dt) { step(dt, 0, count_); }
  /// Those of [from, to) only; `from` must be a multiple of 16.
  void step(double dt, std::size_t from, std::size_t to);

  FlightPoint at(std::size_t index) const;
  /// Where it was before the last step (m): with `at` the segment to be swept for hits.
  math::Vec3d previous_position(std::size_t index) const;
  math::Vec3d origin() const { return origin_; }

  /// The arrays themselves, in floats about the origin, `size()` long: x, y, z in m, velocities in m/s, then where
  /// they were before the last step.
  std::span<const float> array(int component) const { return {data_[component].data(), count_}; }

 private:
  math::Vec3d origin_{};
  std::size_t count_ = 0;
  std::vector<float> data_[10];  // position, velocity, previous position, A/2m; padded to whole registers
  std::vector<BatchRound> rounds_;
  std::vector<std::uint64_t> keys_, keys_scratch_;  // of `sort`
  std::vector<float> moved_;
  std::vector<BatchRound> moved_rounds_;
  std::vector<float> drag_;  // C_D by Mach number: a value and the difference to the next, node by node
  std::vector<float> air_;   // by height: density, 1/speed of sound and wind, each with what a metre changes
  float nodes_per_mach_ = 0, base_ = 0;
  float gravity_ = 0, turning_[3] = {0, 0, 0};
  int lanes_ = 4;
};

}  // namespace carom::ballistics
