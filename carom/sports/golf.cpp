#include "carom/sports/golf.h"

#include "carom/sports/presets.h"

namespace carom::sports {

core::Result<GolfShotResult> play_golf(const GolfShot& def, GroundAt ground) {
  GolfShotResult out;
  auto swung = swing(def.swing);
  if (!swung) return swung.error();
  out.swing = std::move(*swung);
  if (!out.swing.impact) return core::Error{"the swing misses the ball: its head never passes it"};
  out.delivery = {.speed = out.swing.speed,
                  .attack = def.delivery_given ? def.attack : out.swing.attack,
                  .path = def.delivery_given ? def.path : out.swing.path + def.aim,
                  .face = def.face,
                  .lean = def.lean + out.swing.added_loft,
                  .toe = def.toe,
                  .high = def.high};
  auto impact = strike(def.ball, def.club, out.delivery, def.tee);
  if (!impact) return impact.error();
  out.impact = *impact;
  auto shot = play(def.ball, def.conditions, out.impact.ball, ground);
  if (!shot) return shot.error();
  out.shot = std::move(*shot);
  out.landing = landing(out.shot.first_flight());
  const Vec3d way = out.shot.rest().position - def.tee;
  out.total = math::hypot(way.x, way.z);
  return out;
}

core::Result<GolfShotResult> play_golf(const GolfShot& shot, const Surface& surface) {
  return play_golf(shot, [&](double, double) { return Ground{0, {0, 1, 0}, surface}; });
}

core::Result<GolfShot> tour_shot(std::string_view club) {
  const auto preset = club_preset(club);
  if (!preset) return preset.error();
  Swing base = textbook_swing();
  SwingLink& link = base.links.back();
  // The club's own length and head on the textbook's shaft of 140 g less what tour shafts weigh.
  const double head = preset->head.mass, shaft = 0.09, length = preset->length;
  link.mass = head + shaft;
  link.length = length;
  link.centre = (head + 0.5 * shaft) * length / link.mass;
  link.inertia = (head + shaft / 3) * length * length - link.mass * link.centre * link.centre;
  auto swung = swing_for_speed(base, preset->delivery.speed);
  if (!swung) return swung.error();
  GolfShot shot;
  shot.swing = std::move(*swung);
  shot.club = preset->head;
  shot.ball = *ball_preset("golf");
  shot.lean = preset->delivery.lean;
  shot.delivery_given = true;
  shot.attack = preset->delivery.attack;
  return shot;
}

}  // namespace carom::sports
