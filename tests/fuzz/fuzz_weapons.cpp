// Presets of guns, ammunition, sights, walls and rockets from anybody: numbers that can be, or a clear error that names
// the file.
#include <cstdint>
#include <string_view>

#include "carom/ballistics/body_shell.h"
#include "carom/scene/rocket_presets.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/target.h"

FUZZ_TARGET(weapons) {
  using namespace carom;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto named = [](const auto& result) {
    require(result.ok() || result.error().message.starts_with("f"), "an error that does not name the file");
    return result.ok();
  };
  const auto any_shell = [](std::string_view path) -> core::Result<std::string> {
    require(path.starts_with("presets/shell/") && path.find("..") == std::string_view::npos,
            "a path out of the presets");
    return std::string(
        R"({"values": {"mass": "4 kg", "diameter": "9 cm", "axial_inertia": "0.01 kg*m^2", "transverse_inertia": "0.1 kg*m^2",
            "twist": 20, "aerodynamics": [{"mach": 0, "axial": 0.2, "overturning": 3}]}})");
  };
  const auto round = scene::parse_ammunition(text, "f", any_shell);
  if (named(round)) {
    require(ballistics::check(*round).ok(), "ammunition that cannot be");
    const auto flight =
        ballistics::fly(round->projectile, {}, {{}, {round->muzzle_speed, 0, 0}}, {.time = 0.05, .tolerance = 1e-6});
    require(!flight.ok() || math::is_finite(math::length(flight->end().position)), "a flight that is not finite");
  }
  const auto sight = scene::parse_sight(text, "f");
  if (named(sight)) require(ballistics::check(*sight).ok(), "a sight that cannot be");
  // The gun's own file stands for those it names, too.
  const auto resolver = [&](std::string_view path) -> core::Result<std::string> {
    require(path.starts_with("presets/") && path.find("..") == std::string_view::npos, "a path out of the presets");
    if (path.starts_with("presets/sight")) return std::string(R"({"values": {"height": "5 cm"}})");
    return std::string(
        R"({"values": {"mass": "10 g", "diameter": "8 mm", "muzzle_speed": "800 m/s", "drag_function": "g7"}})");
  };
  const auto gun = scene::parse_gun(text, "f", resolver);
  if (named(gun)) {
    require(ballistics::check(*gun).ok(), "a gun that cannot be");
    require(math::is_finite(ballistics::free_recoil(*gun).energy), "a recoil that is not finite");
    const double shots[] = {0, 0.1};
    const auto motion =
        ballistics::recoil_at(gun->mount, ballistics::recoil_impulse(ballistics::charge_of(*gun)), shots, 0.3);
    require(math::is_finite(motion.back) && math::is_finite(motion.rise), "a motion that is not finite");
  }
  const auto shell = scene::parse_shell(text, "f");
  if (named(shell)) {
    require(ballistics::check(*shell).ok(), "a shell that cannot be");
    const auto flight =
        ballistics::fly_shell(*shell, {}, {{}, {300, 100, 0}}, ballistics::ShellModel::modified_point_mass,
                              {.time = 0.05, .tolerance = 1e-6});
    require(!flight.ok() || math::is_finite(math::length(flight->path.end().velocity)), "a flight that is not finite");
    rigid::World3 world;
    auto body = ballistics::BodyShell::make(
        world, {.shell = *shell, .model = ballistics::ShellModel::six_degrees, .start = {{}, {300, 100, 0}}});
    if (body.ok() && body->before_step(world, 1.0 / 240).ok()) {
      require(world.step(1.0f / 240).ok(), "a shell that stops a world");
      require(math::is_finite(math::length(world.state(body->body())->center_of_mass)), "a body that is not finite");
    }
  }
  const auto wall = scene::parse_wall(text, "f");
  if (named(wall)) {
    const auto passages = ballistics::penetrate({}, *wall);
    require(passages.ok(), "a wall that cannot be");
    double speed = 800;
    for (const auto& p : *passages) {
      require(p.speed_out >= 0 && p.speed_out <= speed * (1 + 1e-12), "a wall that gives speed");
      speed = p.speed_out;
    }
  }
  const auto motor = [](std::string_view path) -> core::Result<std::string> {
    require(path.starts_with("presets/motor/") && path.find("..") == std::string_view::npos,
            "a path out of the presets");
    return std::string("A1 18 70 5 0.003 0.016 X\n 0.1 5\n 0.5 0\n");
  };
  const auto rocket = scene::parse_rocket(text, "f", motor);
  if (named(rocket)) {
    const auto flight = ballistics::fly_rocket(*rocket, {}, {}, ballistics::RocketModel::point_mass,
                                               {.time = 0.05, .ground = -1e300, .tolerance = 1e-6});
    require(!flight.ok() || math::is_finite(math::length(flight->path.end().velocity)), "a flight that is not finite");
  }
}
