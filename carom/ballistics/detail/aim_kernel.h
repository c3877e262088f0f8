// What the lanes of the aim solver work on: plain pointers, one function for each instruction set.
#pragma once

#include <cstdint>

#include "carom/ballistics/detail/flight_path.h"
#include "carom/ballistics/flight.h"
#include "carom/math/cpu.h"

namespace carom::ballistics::detail {

/// What a projectile feels, by tables.
struct AimMedium {
  environment::AirColumn::Table air;
  environment::WindColumn::Table wind;
  environment::WindColumn::Leg below{};      // the wind below the lowest level
  double lowest_cell = 0, highest_cell = 0;  // m, above the lowest level, of the table of its legs
  double sheared_up_to = -1e300;             // m, from there on the wind is
  double wind_above[3];                      // m/s
  DragCurve::Table drag;
  double half_area;  // m²/kg
  double gravity;    // m/s²
  /// Adds what is beside drag, where that is more than uniform gravity.
  void (*beside)(const Conditions& conditions, const double* place, const double* velocity, double* acceleration);
  const Conditions* conditions;
};

/// ∫ H d of the defect d over an element, H Hermite's cubics in the order (1, 0), slope (1, 0), (0, 1), slope (0, 1):
/// what is weighted by a cubic in s takes its values and slopes at both ends of them.
struct AimMoments {
  double of[4][3];
  math::Vec3d at(int i) const { return {of[i][0], of[i][1], of[i][2]}; }
  void add(const AimMoments& other) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 3; ++j) of[i][j] += other.of[i][j];
  }
};
/// A part of an element: what it adds to the moments, and what its points may mistake of its defect.
struct AimPart {
  int element;
  double from, to;
  double rest;
  AimMoments moments;
};

/// What lanes do, once for each instruction set.
struct AimKernel {
  /// By how much a path is off, to first order, and how: `finely` by five points within every element, else by three.
  void (*linearize)(const AimMedium& medium, FlightPath& path, bool finely);
  /// The same forward, for every node, by three points.
  void (*spread)(const AimMedium& medium, FlightPath& path);
  void (*measure)(const AimMedium& medium, const FlightPath& path, AimPart* parts, int count);
  /// Where the path arrives by what its elements owe now.
  void (*settle)(FlightPath& path);
};
namespace aim_baseline {
extern const AimKernel kernel;
}
#if CAROM_WIDE_UNITS
namespace aim_avx2 {
extern const AimKernel kernel;
}
namespace aim_avx512 {
extern const AimKernel kernel;
}
#endif

}  // namespace carom::ballistics::detail
