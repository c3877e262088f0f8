#include "carom/sports/golf_impact.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/sports/detail/number_fields.h"
#include "carom/sports/detail/sport_units.h"

namespace carom::sports {
namespace {

/// −[r×] I⁻¹ [r×]: what the turning of a body adds to the inverse mass at a point.
math::Mat3d turning(Vec3d r, const math::Mat3d& inverse_inertia) {
  const auto column = [&](Vec3d axis) { return math::cross(inverse_inertia * math::cross(r, axis), r); };
  return {column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1})};
}

/// R diag(1/I) Rᵀ with the columns of R as axes.
math::Mat3d inverse_inertia(Vec3d inertia, Vec3d x, Vec3d y, Vec3d z) {
  const auto column = [&](Vec3d axis) {
    return (math::dot(x, axis) / inertia.x) * x + (math::dot(y, axis) / inertia.y) * y +
           (math::dot(z, axis) / inertia.z) * z;
  };
  return {column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1})};
}

core::Status check(const ClubHead& h, const ClubDelivery& d) {
  if (const core::Status head = detail::check_fields(h, "a club head"); !head) return head;
  const struct {
    const char* name;
    double value, low, high;
  } rules[] = {{"speed of a delivery", d.speed, 0, 1000}, {"attack of a delivery", d.attack, -1.5, 1.5},
               {"path of a delivery", d.path, -1.5, 1.5}, {"face of a delivery", d.face, -1.5, 1.5},
               {"lean of a delivery", d.lean, -1.5, 1.5}, {"toe of a delivery", d.toe, -0.2, 0.2},
               {"high of a delivery", d.high, -0.2, 0.2}};
  for (const auto& rule : rules)
    if (!(rule.value >= rule.low && rule.value <= rule.high))
      return core::Error{
          core::text(rule.name, " is ", rule.value, ", expected a number in [", rule.low, ", ", rule.high, "]")};
  return {};
}

Vec3d heading(double elevation, double azimuth) {
  const math::SinCos<double> e = math::sincos(elevation), a = math::sincos(azimuth);
  return {e.cos * a.cos, e.sin, e.cos * a.sin};
}

}  // namespace

core::Result<ClubImpact> strike(const Ball& ball, const ClubHead& head, const ClubDelivery& d, Vec3d position) {
  if (const core::Status good = check(ball); !good) return good.error();
  if (const core::Status good = check(head, d); !good) return good.error();
  // The face at the sweet spot, and where it is struck (bulge and roll turn the normal).
  const double loft = head.loft + d.lean;
  const Vec3d n0 = heading(loft, d.face), toe{-math::sin(d.face), 0, math::cos(d.face)}, up = math::cross(toe, n0);
  const Vec3d n = heading(loft + head.roll * d.high, d.face + head.bulge * d.toe);
  const Vec3d arm = head.depth * n0 + d.toe * toe + d.high * up;  // of the blow, from the head's centre of mass
  const Vec3d ahead{toe.z, 0, -toe.x};
  const math::Mat3d head_turn = inverse_inertia(head.inertia, ahead, {0, 1, 0}, toe);
  const Vec3d reach = -ball.radius * n;
  const double turn = 1 / inertia(ball);
  math::Mat3d k = turning(arm, head_turn) + turning(reach, {{turn, 0, 0}, {0, turn, 0}, {0, 0, turn}});
  const double inverse_mass = 1 / ball.mass + 1 / head.mass;
  k = k + math::Mat3d{{inverse_mass, 0, 0}, {0, inverse_mass, 0}, {0, 0, inverse_mass}};

  ClubImpact result;
  const Vec3d velocity = d.speed * heading(d.attack, d.path);
  const Vec3d u = -velocity;  // of the ball's point over the face
  const double approach = -math::dot(u, n);
  if (!(approach > 0)) return core::Error{"the face moves away from the ball, expected a delivery toward it"};
  const Vec3d slip = u + approach * n;
  const double e = head.restitution;
  Vec3d impulse = math::inverse(k) * ((1 + e) * approach * n - (1 + head.tangential_restitution) * slip);
  const double normal = math::dot(impulse, n);
  const Vec3d rub = impulse - normal * n;
  const double size = math::length(rub);
  if (size > head.friction * normal) {
    result.slides = true;
    const Vec3d way = n + (head.friction / size) * rub;
    impulse = ((1 + e) * approach / math::dot(n, k * way)) * way;
  }
  result.ball.position = position;
  result.ball.velocity = impulse / ball.mass;
  result.ball.spin = turn * math::cross(reach, impulse);
  result.launch = launch_of(result.ball);
  result.smash = result.launch.speed / d.speed;
  result.spin_loft = math::acos(math::clamp(approach / d.speed, -1.0, 1.0));
  result.contact_speed = approach;
  result.head_velocity = velocity - impulse / head.mass;
  result.head_spin = -1.0 * (head_turn * math::cross(arm, impulse));
  return result;
}

std::span<const ClubPreset> club_presets() {
  static const ClubPreset list[] = {
      {"driver",
       1.143,
       {.mass = 0.200,
        .inertia = {2.6e-4, 4.6e-4, 2.9e-4},
        .depth = 0.035,
        .loft = 10.0 * detail::degree,
        .restitution = 0.8723,
        .tangential_restitution = -0.2316,
        .bulge = 3.3,
        .roll = 3.3},
       {.speed = 113 * detail::mph, .attack = -1.3 * detail::degree, .lean = 2.74 * detail::degree},
       167,
       10.9,
       2686,
       275,
       32,
       38},
      {"3-wood",
       1.092,
       {.mass = 0.208,
        .inertia = {1.6e-4, 2.6e-4, 1.6e-4},
        .depth = 0.024,
        .loft = 15.0 * detail::degree,
        .restitution = 0.8621,
        .tangential_restitution = 0.0423,
        .bulge = 4.0,
        .roll = 4.0},
       {.speed = 107 * detail::mph, .attack = -2.9 * detail::degree, .lean = -3.15 * detail::degree},
       158,
       9.2,
       3655,
       243,
       30,
       43},
      {"5-wood",
       1.067,
       {.mass = 0.216,
        .inertia = {1.6e-4, 2.6e-4, 1.6e-4},
        .depth = 0.022,
        .loft = 18.0 * detail::degree,
        .restitution = 0.8584,
        .tangential_restitution = 0.1812,
        .bulge = 4.0,
        .roll = 4.0},
       {.speed = 103 * detail::mph, .attack = -3.3 * detail::degree, .lean = -5.32 * detail::degree},
       152,
       9.4,
       4350,
       230,
       31,
       47},
      {"hybrid",
       1.029,
       {.mass = 0.230,
        .inertia = {1.3e-4, 2.6e-4, 1.2e-4},
        .depth = 0.018,
        .loft = 19.0 * detail::degree,
        .restitution = 0.8280,
        .tangential_restitution = 0.1612,
        .bulge = 2.9,
        .roll = 2.9},
       {.speed = 100 * detail::mph, .attack = -3.3 * detail::degree, .lean = -5.32 * detail::degree},
       146,
       10.2,
       4437,
       225,
       29,
       47},
      {"3-iron",
       0.991,
       {.mass = 0.240,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.010,
        .loft = 21.0 * detail::degree,
        .restitution = 0.8036,
        .tangential_restitution = 0.1842,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 98 * detail::mph, .attack = -3.1 * detail::degree, .lean = -6.86 * detail::degree},
       142,
       10.4,
       4630,
       212,
       27,
       46},
      {"4-iron",
       0.978,
       {.mass = 0.247,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.010,
        .loft = 24.0 * detail::degree,
        .restitution = 0.7797,
        .tangential_restitution = 0.1808,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 96 * detail::mph, .attack = -3.4 * detail::degree, .lean = -8.95 * detail::degree},
       137,
       11,
       4836,
       203,
       28,
       48},
      {"5-iron",
       0.965,
       {.mass = 0.254,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.009,
        .loft = 27.0 * detail::degree,
        .restitution = 0.7640,
        .tangential_restitution = 0.2071,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 94 * detail::mph, .attack = -3.7 * detail::degree, .lean = -10.24 * detail::degree},
       132,
       12.1,
       5361,
       194,
       31,
       49},
      {"6-iron",
       0.953,
       {.mass = 0.261,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.009,
        .loft = 30.5 * detail::degree,
        .restitution = 0.7661,
        .tangential_restitution = 0.2385,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 92 * detail::mph, .attack = -4.1 * detail::degree, .lean = -10.77 * detail::degree},
       127,
       14.1,
       6231,
       183,
       30,
       50},
      {"7-iron",
       0.940,
       {.mass = 0.268,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.008,
        .loft = 34.0 * detail::degree,
        .restitution = 0.7467,
        .tangential_restitution = 0.2633,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 90 * detail::mph, .attack = -4.3 * detail::degree, .lean = -10.91 * detail::degree},
       120,
       16.3,
       7097,
       172,
       32,
       50},
      {"8-iron",
       0.927,
       {.mass = 0.275,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.008,
        .loft = 38.0 * detail::degree,
        .restitution = 0.7746,
        .tangential_restitution = 0.3298,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 87 * detail::mph, .attack = -4.5 * detail::degree, .lean = -11.91 * detail::degree},
       115,
       18.1,
       7998,
       160,
       31,
       50},
      {"9-iron",
       0.914,
       {.mass = 0.283,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.007,
        .loft = 42.0 * detail::degree,
        .restitution = 0.7798,
        .tangential_restitution = 0.3285,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 85 * detail::mph, .attack = -4.7 * detail::degree, .lean = -12.47 * detail::degree},
       109,
       20.4,
       8647,
       148,
       30,
       51},
      {"wedge",
       0.908,
       {.mass = 0.290,
        .inertia = {0.7e-4, 2.3e-4, 1.9e-4},
        .depth = 0.007,
        .loft = 46.0 * detail::degree,
        .restitution = 0.8194,
        .tangential_restitution = 0.2874,
        .bulge = 0.0,
        .roll = 0.0},
       {.speed = 83 * detail::mph, .attack = -5.0 * detail::degree, .lean = -11.29 * detail::degree},
       102,
       24.2,
       9304,
       136,
       29,
       52},
  };
  return list;
}

core::Result<ClubPreset> club_preset(std::string_view name) {
  std::string known;
  for (const ClubPreset& preset : club_presets()) {
    if (preset.name == name) return preset;
    known += core::text(known.empty() ? "" : ", ", preset.name);
  }
  return core::Error{core::text("the club ", core::quoted(name), " is not known, expected one of ", known)};
}

}  // namespace carom::sports
