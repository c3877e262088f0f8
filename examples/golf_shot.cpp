// Twelve clubs of a tour player, from the swing to where the ball lies; then a sliced drive into the wind.
#include <cstdio>

#include "carom/sports/golf.h"
#include "carom/sports/presets.h"

int main() {
  using namespace carom::sports;
  constexpr double yard = 0.9144, degree = 3.14159265358979 / 180;
  const Surface fairway = *surface_preset("fairway");
  std::printf("%-8s %9s %9s %7s %9s %9s %8s %9s\n", "club", "head m/s", "ball m/s", "rpm", "carry yd", "apex yd",
              "lands", "total yd");
  for (const ClubPreset& club : club_presets()) {
    const auto shot = tour_shot(club.name);
    if (!shot) return std::fprintf(stderr, "%s\n", shot.error().message.c_str()), 1;
    const auto result = play_golf(*shot, fairway);
    if (!result) return std::fprintf(stderr, "%s\n", result.error().message.c_str()), 1;
    std::printf("%-8.*s %9.1f %9.1f %7.0f %9.1f %9.1f %7.1f° %9.1f\n", int(club.name.size()), club.name.data(),
                result->swing.speed, result->impact.launch.speed, result->impact.launch.spin * 9.5493,
                result->landing.carry / yard, result->landing.apex / yard, result->landing.angle / degree,
                result->total / yard);
  }

  GolfShot slice = *tour_shot("driver");
  slice.face = 2 * degree;
  slice.path = -4 * degree;
  slice.conditions.wind = carom::environment::WindColumn({-5, 0, 0});
  const auto result = play_golf(slice, fairway);
  if (!result) return std::fprintf(stderr, "%s\n", result.error().message.c_str()), 1;
  std::printf("a slice into the wind: carries %.0f yd, %.0f yd to the right\n", result->landing.carry / yard,
              result->landing.side / yard);
}
