#include "carom/sports/presets.h"

#include "carom/core/string.h"

namespace carom::sports {
namespace {

std::vector<BallPreset> make_presets() {
  using Shape = LiftLaw::Shape;
  std::vector<BallPreset> list;
  list.push_back(
      {"golf",
       "A dimpled golf ball.",
       "rules of golf (mass, diameter); curves of the form of Bearman & Harvey, Aeronautical Quarterly 27 (1976) 112, "
       "their constants fitted to two years of TrackMan's tour averages, twelve clubs each (every club within "
       "2.7 % of carry, 3 yd of apex, 2.3 deg of landing); spin decay: Smits & Ogg 2004",
       .08,
       .10,
       {.mass = .04593,
        .radius = .021335,
        .drag = {.fast = .175,
                 .crisis = .246,
                 .critical_reynolds = 7.26e4,
                 .steepness = 14,
                 .spin_rise = .0975,
                 .spin_scale = .1328},
        .lift = {Shape::hyperbolic, .2864, .1566, .71},
        .spin_damping = .0197}});
  list.push_back(
      {"baseball",
       "A baseball with four seams.",
       "A. M. Nathan, trajectory calculator (2026): C_D .3008 + .0292 per 1000 rpm, here as a slope over S at "
       "100 mph; C_L 1.12 S/(.583 + 2.333 S); spin decay: designer value",
       .08,
       .10,
       {.mass = .145,
        .radius = .0368877,
        .drag = {.fast = .3008, .spin_slope = .338},
        .lift = {Shape::rational, .480069, .249893, 0},
        .spin_damping = .02}});
  list.push_back(
      {"knuckleball",
       "A baseball thrown with less than one turn on its way.",
       "side force with four cycles a turn: Watts & Sawyer, Am. J. Phys. 43 (1975) 960 (its size from memory); "
       "drag as baseball",
       .08,
       .3,
       {.mass = .145,
        .radius = .0368877,
        .drag = {.fast = .3008},
        .side = {.kind = SideForce::Kind::turning_seam, .coefficient = .15, .cycles = 4},
        .spin_damping = .02}});
  list.push_back({"soccer",
                  "A soccer ball.",
                  "critical Reynolds number 2.2e5 to 3.0e5: Asai et al., Sports Eng. 10 (2007) 101; C_D .43 to .17 and "
                  "C_L up to .3 in free kicks: class values",
                  .15,
                  .2,
                  {.mass = .43,
                   .radius = .11,
                   .inertia_factor = 2.0 / 3,
                   .drag = {.fast = .17, .crisis = .26, .critical_reynolds = 2.6e5, .steepness = 8, .spin_slope = .1},
                   .lift = {Shape::hyperbolic, .30, .20, 0},
                   .spin_damping = .02}});
  list.push_back({"floating_soccer",
                  "A soccer ball struck without spin, that flutters.",
                  "drag as soccer; wake forces of the order that Asai & Kamijo, SpringerPlus 2 (2013) 1, report",
                  .15,
                  .4,
                  {.mass = .43,
                   .radius = .11,
                   .inertia_factor = 2.0 / 3,
                   .drag = {.fast = .17, .crisis = .26, .critical_reynolds = 2.6e5, .steepness = 8},
                   .side = {.kind = SideForce::Kind::wandering_wake, .coefficient = .12, .strouhal = .012},
                   .spin_damping = .02}});
  list.push_back(
      {"tennis",
       "A tennis ball.",
       "C_D .507 +- .024, independent of spin, in free flight; C_L 1/(2 + 1/S): Cross & Lindsey, Sports Eng. "
       "17 (2013) 89; wind tunnels give C_D .6 to .7 (Mehta)",
       .05,
       .15,
       {.mass = .0577,
        .radius = .0335,
        .inertia_factor = .55,
        .drag = {.fast = .507},
        .lift = {Shape::rational, .5, .5, 0},
        .spin_damping = .02}});
  list.push_back({"table_tennis",
                  "A 40 mm table tennis ball.",
                  "mass and size of the rules; C_D and C_L class values of launch experiments (Miyazaki et al. 2017)",
                  .15,
                  .25,
                  {.mass = .0027,
                   .radius = .020,
                   .inertia_factor = 2.0 / 3,
                   .drag = {.fast = .43},
                   .lift = {Shape::rational, .6, .8, 0},
                   .spin_damping = .02}});
  list.push_back({"basketball",
                  "A basketball, size 7.",
                  "mass and size of the rules; C_D .5 and C_L as the tennis form: class values",
                  .15,
                  .3,
                  {.mass = .62,
                   .radius = .1195,
                   .inertia_factor = 2.0 / 3,
                   .drag = {.fast = .50},
                   .lift = {Shape::rational, .5, .5, 0},
                   .spin_damping = .02}});
  list.push_back(
      {"cricket",
       "A cricket ball whose seam is held by its spin.",
       "seam force up to about .3 at 20 deg, reversing near 36 m/s: R. D. Mehta, Ann. Rev. Fluid Mech. 17 (1985) "
       "151 (sizes from memory); C_D class value",
       .15,
       .3,
       {.mass = .1595,
        .radius = .036,
        .drag = {.fast = .45},
        .lift = {Shape::rational, .4, .4, 0},
        .side =
            {.kind = SideForce::Kind::held_seam, .coefficient = .30, .best_angle = .349, .reverse_reynolds = 1.78e5},
        .spin_damping = .02}});
  list.push_back(
      {"bowling",
       "A bowling ball.",
       "USBC specifications: 8.5 in, up to 16 lb; C_D of a smooth sphere",
       .2,
       0,
       {.mass = 6.8, .radius = .1085, .inertia_factor = .0635 * .0635 / (.1085 * .1085), .drag = {.fast = .47}}});
  list.push_back(
      {"arrow",
       "A target arrow with short vanes, by the cross-section of its shaft.",
       "C_D 1.56 (short vanes; 2.05 large) on the shaft's section at Re 1.2e4: MDPI Proceedings 49 (2020) 56; "
       "mass and diameter of a target arrow: class values",
       .1,
       0,
       {.mass = .0182, .radius = .00275, .inertia_factor = .4, .drag = {.fast = 1.56}}});
  list.push_back(
      {"arrow_large_vanes",
       "A target arrow with large vanes, by the cross-section of its shaft.",
       "C_D 2.05 (large vanes; 1.56 short) on the shaft's section at Re 1.2e4: MDPI Proceedings 49 (2020) 56; "
       "mass and diameter of a target arrow: class values",
       .1,
       0,
       {.mass = .0182, .radius = .00275, .inertia_factor = .4, .drag = {.fast = 2.05}}});
  list.push_back(
      {"shuttlecock",
       "A feather shuttlecock, nose first.",
       "falls at 6.7 m/s at the end, drag with the square of the speed: Cohen et al., New J. Phys. 17 (2015) "
       "063001 (from memory)",
       .05,
       0,
       {.mass = .005, .radius = .033, .inertia_factor = .6, .drag = {.fast = .5213}}});
  list.push_back({"sphere",
                  "A smooth sphere of the size of a baseball.",
                  "drag crisis of a smooth sphere at Re 3.5e5 to 4.0e5 (Achenbach 1972)",
                  .1,
                  0,
                  {.mass = .145,
                   .radius = .0368877,
                   .drag = {.fast = .1, .crisis = .38, .critical_reynolds = 3.7e5, .steepness = 14}}});
  return list;
}

const std::vector<BallPreset>& presets() {
  static const std::vector<BallPreset> list = make_presets();
  return list;
}

}  // namespace

std::span<const BallPreset> ball_presets() { return presets(); }

core::Result<Ball> ball_preset(std::string_view name) {
  std::string known;
  for (const BallPreset& preset : presets()) {
    if (preset.name == name) return preset.ball;
    known += core::text(known.empty() ? "" : ", ", preset.name);
  }
  return core::Error{core::text("the ball ", core::quoted(name), " is not known, expected one of ", known)};
}

}  // namespace carom::sports
