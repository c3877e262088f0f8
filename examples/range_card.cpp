// A rifle is zeroed at 100 m; the program prints where its bullet goes in a breeze, what to click, and how a gun turret
// would lead a target that flies by.
#include <cstdio>

#include "carom/ballistics/aim.h"
#include "carom/ballistics/sights.h"

int main() {
  using namespace carom::ballistics;
  const Gun rifle{.projectile = projectile_from_coefficient(DragFunction::g7, 0.218),
                  .mass = 0.0109,
                  .muzzle_speed = 808,
                  .sight_height = 0.04};
  Conditions day;  // the standard atmosphere
  const auto elevation = zero_elevation(rifle, day, 100);
  if (!elevation) return std::fprintf(stderr, "%s\n", elevation.error().message.c_str()), 1;

  day.wind = carom::environment::WindColumn({0, 0, 4});  // 4 m/s from the left
  const auto flight = SightedFlight::fire(rifle, day, {.elevation = elevation.value()}, 1000);
  if (!flight) return std::fprintf(stderr, "%s\n", flight.error().message.c_str()), 1;
  std::printf("%6s %8s %8s %8s %8s %6s %6s\n", "m", "m/s", "s", "up cm", "right cm", "clicks", "clicks");
  for (int distance = 100; distance <= 1000; distance += 100) {
    const auto point = flight->at(distance);
    if (!point) break;
    std::printf("%6d %8.1f %8.3f %8.1f %8.1f %6d %6d\n", distance, point->speed, point->time, 100 * point->height,
                100 * point->side, clicks(point->hold_up, 0.1 * milliradian),
                clicks(point->hold_right, 0.1 * milliradian));
  }

  // 30 m/s across, 400 m away.
  const auto aims = aim(rifle.projectile, day, {.muzzle_speed = 808}, Target{{400, 20, -60}, {0, 0, 30}});
  if (!aims) return std::fprintf(stderr, "%s\n", aims.error().message.c_str()), 1;
  if (!aims->low) return std::puts("out of reach"), 0;
  const Laying laying = carom::ballistics::laying(aims->low->direction);
  std::printf("lead: %.2f mrad right, %.2f mrad up, hits after %.3f s\n", 1e3 * laying.azimuth, 1e3 * laying.elevation,
              aims->low->time);
}
