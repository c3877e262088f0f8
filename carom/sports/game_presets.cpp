#include "carom/sports/game_presets.h"

#include "carom/core/string.h"
#include "carom/sports/detail/number_fields.h"
#include "carom/sports/detail/sport_units.h"

namespace carom::sports {
namespace {

using detail::degree;
using detail::mph;
constexpr double rpm = math::pi / 30, inch = 0.0254, foot = 0.3048, pound = 0.45359237, kmh = 1 / 3.6;

template <class T>
core::Result<T> find(std::span<const GamePreset<T>> presets, std::string_view kind, std::string_view name) {
  std::string known;
  for (const GamePreset<T>& preset : presets) {
    if (preset.name == name) return preset.value;
    known += core::text(known.empty() ? "" : ", ", preset.name);
  }
  return core::Error{core::text("the ", kind, " ", core::quoted(name), " is not known, expected one of ", known)};
}

constexpr std::string_view major_league =
    "speed and spin of the class of the averages that Major League Baseball's tracking publishes (from memory); of the "
    "spin as much curves the ball as makes this model break by the class told";

/// Spin of `total` rpm of which `active` curves the ball, and a hand's tilt: 0 backspin, 90° to the pitcher's right.
GamePreset<Pitch> pitch(std::string_view name, std::string_view description, double speed, double total, double active,
                        double tilt, std::string_view source = major_league) {
  Pitch p;
  p.speed = speed * mph;
  p.spin = active * total * rpm;
  p.gyro = math::sqrt(1 - active * active) * total * rpm;
  p.tilt = tilt * degree;
  p.release = {0, 1.8, 0.55};
  return {name, description, source, p};
}

constexpr std::string_view cricket_class =
    "a seam at about 20 deg swings most, at some 30 m/s: R. D. Mehta, Ann. Rev. Fluid Mech. 17 (1985) 151; speeds and "
    "spins: class values";

}  // namespace

// Seen by the pitcher a right-hander's own side is the right: two-seamers and changeups run there.
std::span<const GamePreset<Pitch>> pitch_presets() {
  static const std::vector<GamePreset<Pitch>> list = {
      pitch("four_seam", "Fastball: backspin holds it up.", 94, 2300, 0.90, 25),
      pitch("sinker", "Two-seam fastball: runs to the pitcher's hand and sinks.", 93.5, 2150, 0.90, 62),
      pitch("cutter", "Cut fastball: a late, small break to the glove side.", 89.5, 2400, 0.25, -20),
      pitch("slider", "Mostly spin about its way, a break to the glove side.", 85.5, 2430, 0.15, -75),
      pitch("sweeper", "A slider that breaks far aside.", 82, 2550, 0.38, -85),
      pitch("curveball", "Topspin: it drops.", 79.5, 2550, 0.38, -142),
      pitch("changeup", "Thrown as a fastball, slower; runs and drops.", 85.5, 1780, 0.90, 62),
      pitch("splitter", "Little spin: it falls as a ball would.", 86.5, 1300, 0.45, 60),
      pitch("gyroball", "All of its spin about its way: no break by it.", 85, 2500, 0, 0, "a limit, by definition"),
      pitch("knuckleball", "Half a turn on its way; thrown with the ball knuckleball its seams push it about.", 68, 70,
            1, 0, "speed and spin: Watts & Sawyer, Am. J. Phys. 43 (1975) 960, and class values"),
  };
  return list;
}

std::span<const GamePreset<Bat>> bat_presets() {
  constexpr std::string_view source =
      "collision efficiency of about .2 at game speeds: A. M. Nathan, Am. J. Phys. 71 (2003) 134; sizes by the rules, "
      "effective masses and restitution: class values";
  static const std::vector<GamePreset<Bat>> list = {
      {"wood",
       "Ash or maple, 33 in and 31 oz.",
       source,
       {.effective_mass = 0.70, .radius = 0.0333, .restitution = 0.50}},
      {"aluminium",
       "A metal bat of the college rules that hold it to what wood does.",
       source,
       {.effective_mass = 0.67, .radius = 0.0333, .restitution = 0.51}},
      {"composite_free",
       "A composite barrel of no rules: it gives like a trampoline.",
       source,
       {.effective_mass = 0.67, .radius = 0.0349, .restitution = 0.60}},
      {"fungo",
       "Long, thin and light, for practice.",
       source,
       {.effective_mass = 0.45, .radius = 0.0286, .restitution = 0.50}},
  };
  return list;
}

// Backspin of seam bowlers keeps the seam upright; spinners turn it about the way.
std::span<const GamePreset<CricketDelivery>> cricket_presets() {
  static const std::vector<GamePreset<CricketDelivery>> list = {
      {"outswinger",
       "Away from a right-handed batter: the seam points to the slips.",
       cricket_class,
       {.speed = 110 * kmh, .spin = 72, .seam = -20 * degree}},
      {"inswinger",
       "Into a right-handed batter.",
       cricket_class,
       {.speed = 110 * kmh, .spin = 72, .seam = 20 * degree}},
      {"reverse_swinger",
       "So fast that the flow turns round: the seam of an outswinger, and it comes in.",
       "reversal above some 36 m/s: R. D. Mehta, Ann. Rev. Fluid Mech. 17 (1985) 151; speed and spin: class values",
       {.speed = 150 * kmh, .spin = 90, .seam = -20 * degree}},
      {"bouncer", "Fast and short.", cricket_class, {.speed = 142 * kmh, .elevation = -12 * degree, .spin = 100}},
      {"yorker",
       "Fast, at the batter's feet.",
       cricket_class,
       {.speed = 140 * kmh, .elevation = -5 * degree, .spin = 100}},
      {"slower_ball",
       "Out of the back of the hand: the arm of a fast ball, three quarters of its speed.",
       cricket_class,
       {.speed = 105 * kmh, .spin = 130, .tilt = 180 * degree}},
      {"leg_cutter",
       "Fingers across the ball: it turns a little to the slips.",
       cricket_class,
       {.speed = 122 * kmh, .spin = 70, .gyro = -90}},
      {"off_break",
       "Finger spin, from off to leg.",
       "30 revolutions a second of class: designer value",
       {.speed = 85 * kmh, .elevation = 1 * degree, .spin = 70, .tilt = 150 * degree, .gyro = 160}},
      {"arm_ball",
       "An off-spinner's ball that goes on with the arm, seam toward the slips.",
       cricket_class,
       {.speed = 92 * kmh, .spin = 60, .seam = -20 * degree}},
      {"leg_break",
       "Wrist spin, from leg to off.",
       "35 to 40 revolutions a second of class: designer value",
       {.speed = 80 * kmh, .elevation = 2 * degree, .spin = 110, .tilt = -150 * degree, .gyro = -190}},
      {"googly",
       "A leg break's arm, and it turns the other way.",
       "designer value",
       {.speed = 80 * kmh, .elevation = 2 * degree, .spin = 110, .tilt = 150 * degree, .gyro = 170}},
      {"top_spinner",
       "Dips, and comes off the pitch high and straight.",
       "designer value",
       {.speed = 80 * kmh, .elevation = 3 * degree, .spin = 220, .tilt = 180 * degree}},
  };
  return list;
}

std::span<const GamePreset<BowlingBall>> bowling_ball_presets() {
  constexpr std::string_view usbc =
      "USBC specifications: 8.5 to 8.595 in, at most 16 lb, radius of gyration 2.46 to 2.80 in, differential at "
      "most .06 in; cover and differential: designer values";
  constexpr double radius = 0.5 * 8.55 * inch;
  static const std::vector<GamePreset<BowlingBall>> list = {
      {"reactive",
       "A strike ball: porous cover, low radius of gyration.",
       usbc,
       {.mass = 15 * pound, .radius = radius, .gyration = 2.48 * inch, .differential = .050 * inch, .cover = 1}},
      {"urethane",
       "Earlier and smoother.",
       usbc,
       {.mass = 15 * pound, .radius = radius, .gyration = 2.58 * inch, .differential = .035 * inch, .cover = 0.85}},
      {"plastic",
       "A spare ball of polyester, or one of the house: it goes straight.",
       usbc,
       {.mass = 14 * pound, .radius = radius, .gyration = 2.70 * inch, .differential = .010 * inch, .cover = 0.55}},
      {"duckpin",
       "No holes, 5 in.",
       "rules of the game: 4.75 to 5 in, at most 3 lb 12 oz; a uniform ball",
       {.mass = 3.75 * pound, .radius = 2.5 * inch, .gyration = 0.6324555320336759 * 2.5 * inch, .cover = 0.55}},
      {"candlepin",
       "No holes, 4.5 in.",
       "rules of the game: 4.5 in, at most 2 lb 7 oz; a uniform ball",
       {.mass = 2.4375 * pound, .radius = 2.25 * inch, .gyration = 0.6324555320336759 * 2.25 * inch, .cover = 0.55}},
  };
  return list;
}

std::span<const GamePreset<Lane>> lane_presets() {
  constexpr std::string_view source =
      "60 ft and 3.5 ft, dry friction at most .32: USBC; friction .04 in oil and .20 beyond, and how far oil lies: "
      "class "
      "values";
  const auto oiled = [](double feet, double wet, double dry) {
    Lane lane;
    lane.stretches = {{feet * foot, wet}, {lane.length, dry}};
    return lane;
  };
  static const std::vector<GamePreset<Lane>> list = {
      {"oil_32ft", "Little oil: hooks early.", source, oiled(32, 0.04, 0.20)},
      {"oil_40ft", "As houses lay it.", source, oiled(40, 0.04, 0.20)},
      {"oil_45ft", "Long oil: hooks late.", source, oiled(45, 0.04, 0.20)},
      {"worn_oil", "After some games the front has dried and oil is carried down.", "designer value",
       [] {
         Lane lane;
         lane.stretches = {{4, 0.10}, {12.192, 0.05}, {14.5, 0.12}, {lane.length, 0.20}};
         return lane;
       }()},
      {"dry", "No oil at all.", source,
       [] {
         Lane lane;
         lane.stretches = {{lane.length, 0.20}};
         return lane;
       }()},
  };
  return list;
}

std::span<const GamePreset<Delivery>> bowling_presets() {
  constexpr std::string_view source =
      "speed, turns and rotation of the axis of the class told for such players; from memory";
  static const std::vector<GamePreset<Delivery>> list = {
      {"straight",
       "End over end, at the pocket.",
       source,
       {.speed = 16 * mph, .angle = 0.25 * degree, .spin = 150 * rpm, .axis_rotation = 0, .start = 0}},
      {"stroker",
       "Smooth, little hook.",
       source,
       {.speed = 17 * mph, .angle = -0.5 * degree, .spin = 250 * rpm, .axis_rotation = 40 * degree, .start = -0.25}},
      {"tweener",
       "Between the two.",
       source,
       {.speed = 17.5 * mph, .angle = -0.9 * degree, .spin = 330 * rpm, .axis_rotation = 50 * degree, .start = -0.2}},
      {"cranker",
       "Many turns, a large hook.",
       source,
       {.speed = 18 * mph, .angle = -1.6 * degree, .spin = 420 * rpm, .axis_rotation = 60 * degree, .start = -0.05}},
      {"two_handed",
       "The most turns of all.",
       source,
       {.speed = 19 * mph, .angle = -1.8 * degree, .spin = 500 * rpm, .axis_rotation = 60 * degree, .start = 0}},
      {"backup",
       "Hooks the other way.",
       source,
       {.speed = 15 * mph, .angle = 0.5 * degree, .spin = 200 * rpm, .axis_rotation = -35 * degree, .start = 0.25}},
      {"spinner",
       "Side spin alone, on a dry lane's pins like a top.",
       source,
       {.speed = 15 * mph, .angle = -0.3 * degree, .spin = 350 * rpm, .axis_rotation = 88 * degree, .start = -0.2}},
  };
  return list;
}

std::span<const GamePreset<Swing>> swing_presets() {
  static const std::vector<GamePreset<Swing>> list = {
      {"textbook", "Two links: arms as a rod, wrists that open by themselves, 100 N m.",
       "the classic two-rod model: D. Williams, Q. J. Mech. Appl. Math. 20 (1967) 247; T. Jorgensen, Am. J. Phys. 38 "
       "(1970) 644",
       textbook_swing()},
      {"three_link", "Shoulders, arm and club with a shaft that bends.", "designer values", three_link_swing()},
  };
  return list;
}

core::Result<Pitch> pitch_preset(std::string_view name) { return find(pitch_presets(), "pitch", name); }
core::Result<Bat> bat_preset(std::string_view name) { return find(bat_presets(), "bat", name); }
core::Result<CricketDelivery> cricket_preset(std::string_view name) {
  return find(cricket_presets(), "cricket delivery", name);
}
core::Result<BowlingBall> bowling_ball_preset(std::string_view name) {
  return find(bowling_ball_presets(), "bowling ball", name);
}
core::Result<Lane> lane_preset(std::string_view name) { return find(lane_presets(), "lane", name); }
core::Result<Delivery> bowling_preset(std::string_view name) { return find(bowling_presets(), "delivery", name); }
core::Result<Swing> swing_preset(std::string_view name) { return find(swing_presets(), "swing", name); }

template <class T>
std::span<const NumberName> game_number_names() {
  return detail::number_names_of<T>();
}
template <class T>
std::vector<double> game_numbers(const T& value) {
  return detail::numbers_of(value);
}
namespace {
constexpr std::string_view what(const Pitch*) { return "a pitch"; }
constexpr std::string_view what(const Bat*) { return "a bat"; }
constexpr std::string_view what(const CricketDelivery*) { return "a delivery"; }
constexpr std::string_view what(const BowlingBall*) { return "a bowling ball"; }
constexpr std::string_view what(const Lane*) { return "a lane"; }
constexpr std::string_view what(const Delivery*) { return "a delivery"; }
}  // namespace
template <class T>
core::Result<T> game_from_numbers(std::span<const Number> numbers) {
  T value{};
  if (const core::Status taken = detail::take_numbers(value, numbers, what(static_cast<const T*>(nullptr))); !taken)
    return taken.error();
  return value;
}

#define CAROM_GAME(T)                                                    \
  template CAROM_API std::span<const NumberName> game_number_names<T>(); \
  template CAROM_API std::vector<double> game_numbers(const T&);         \
  template CAROM_API core::Result<T> game_from_numbers(std::span<const Number>);
CAROM_GAME(Pitch)
CAROM_GAME(Bat)
CAROM_GAME(CricketDelivery)
CAROM_GAME(BowlingBall)
CAROM_GAME(Lane)
CAROM_GAME(Delivery)
#undef CAROM_GAME

}  // namespace carom::sports
