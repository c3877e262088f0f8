#include "carom/ballistics/drag_data.h"
#include "carom/scene/detail/destruction.h"
#include "carom/scene/detail/destruction_fields.h"
#include "carom/scene/detail/matter.h"
#include "carom/scene/detail/weapon_numbers.h"

namespace carom::scene::detail {
namespace {
using math::Vec3d;

/// The object under a key that may name a preset. A name was replaced when the file was read.
bool open_named(Reader& r, const Object& o, const char* key, const ObjectKind& kind, Object& out) {
  if (!o.has(key)) return false;
  return r.open(*o.find(key), o.path_of(key), kind, out);
}

ballistics::Ammunition read_ammunition(Reader& r, const Object& o) {
  ballistics::Ammunition a;
  a.mass = r.number(o, "mass", a.mass);
  a.diameter = r.number(o, "diameter", a.diameter);
  a.length = r.number(o, "length", a.length);
  a.muzzle_speed = r.number(o, "muzzle_speed", a.muzzle_speed);
  a.speed_deviation = r.number(o, "speed_deviation", a.speed_deviation);
  a.powder_mass = r.number(o, "powder_mass", a.powder_mass);
  a.gas_speed = r.number(o, "gas_speed", a.gas_speed);
  ballistics::DragData data;
  if (o.has("drag_function")) data.function = ballistics::DragFunction(r.choice(o, "drag_function", 0));
  if (o.has("drag_coefficient")) data.coefficient = r.number(o, "drag_coefficient", 0);
  if (o.has("ballistic_coefficient")) data.ballistic_coefficient = r.number(o, "ballistic_coefficient", 1);
  data.form_factor = r.number(o, "form_factor", 1);
  const auto pairs = [&](const char* key, auto& out) {
    const std::vector<double> numbers = r.numbers(o, key);
    if (numbers.size() % 2 != 0) return r.expected(*o.find(key), o.path_of(key), "pairs, one after another");
    for (std::size_t i = 0; i < numbers.size(); i += 2) out.push_back({numbers[i], numbers[i + 1]});
  };
  if (Object shell; o.has("shell")) {
    if (r.open(*o.find("shell"), o.path_of("shell"), shell_kind, shell)) a.shell = read_shell_itself(r, shell);
  }
  pairs("drag_table", data.table);
  pairs("ballistic_coefficients", data.bands);
  if (!o.has("drag_function") && !o.has("drag_table") && !o.has("ballistic_coefficient") && data.bands.empty())
    data.coefficient = data.coefficient.value_or(0.3);
  for (const auto& [key, value] : {std::pair{"mass", a.mass}, std::pair{"diameter", a.diameter}})
    if (!r.failed() && o.has(key) && !(value > 0 && math::is_finite(value)))
      r.expected(*o.find(key), o.path_of(key), "a number above zero");
  if (r.failed()) return a;
  auto projectile = ballistics::projectile_from(data, a.mass, a.diameter);
  if (projectile.ok())
    a.projectile = std::move(projectile).value();
  else
    r.fail(*o.node, o.path, projectile.error().message);
  return a;
}

ballistics::Weapon read_weapon(Reader& r, const Object& o) {
  ballistics::Weapon w;
  Object ammunition, sight;
  if (open_named(r, o, "ammunition", ammunition_kind, ammunition)) w.ammunition = read_ammunition(r, ammunition);
  if (!r.failed() && !o.has("ammunition")) {
    r.fail(*o.node, o.path, "the key \"ammunition\" is missing in a gun (or in its preset)");
    return w;
  }
  if (open_named(r, o, "sight", sight_kind, sight)) {
    w.sight.height = r.number(sight, "height", w.sight.height);
    w.sight.offset = r.number(sight, "offset", w.sight.offset);
    w.sight.parallax_free = r.number(sight, "parallax_free", w.sight.parallax_free);
    w.sight.click = r.number(sight, "click", w.sight.click);
    w.sight.spacing = r.number(sight, "spacing", w.sight.spacing);
    w.sight.magnification = r.number(sight, "magnification", w.sight.magnification);
  }
  visit_numbers(w, [&](const char* name, const char*, double& value) { value = r.number(o, name, value); });
  return w;
}

bool read_sway(Reader& r, const Object& o, GunDef& gun) {
  Object s;
  if (!r.open(*o.find("sway"), o.path_of("sway"), sway_kind, s)) return false;
  ballistics::Sway sway = ballistics::sway_of(ballistics::Stance(r.choice(s, "stance", 0)), r.number(s, "skill", 0.5),
                                              r.number(s, "fatigue", 0));
  sway.breath = r.number(s, "breath", sway.breath);
  sway.breath_frequency = r.number(s, "breath_frequency", sway.breath_frequency);
  sway.heartbeat = r.number(s, "heartbeat", sway.heartbeat);
  sway.heartbeat_frequency = r.number(s, "heartbeat_frequency", sway.heartbeat_frequency);
  sway.tremor = r.number(s, "tremor", sway.tremor);
  sway.tremor_low = r.number(s, "tremor_low", sway.tremor_low);
  sway.tremor_high = r.number(s, "tremor_high", sway.tremor_high);
  sway.drift = r.number(s, "drift", sway.drift);
  sway.drift_low = r.number(s, "drift_low", sway.drift_low);
  sway.drift_high = r.number(s, "drift_high", sway.drift_high);
  gun.breath_held = r.number(s, "breath_held", 0);
  gun.sway = sway;
  for (const char* share : {"skill", "fatigue", "breath_held"})
    if (const double x = r.number(s, share, 0); !r.failed() && !(x >= 0 && x <= 1))
      r.expected(*s.find(share), s.path_of(share), "0 to 1");
  return !r.failed() && r.accept(ballistics::check(sway), *s.node, s.path);
}

/// The bore of a sighted gun, whose `bore` is the direction of its mark.
Status set_sights(Reader& r, const Object& o, GunDef& gun) {
  const ballistics::Sight& sight = gun.weapon.sight;
  // A zero is shot in still air.
  const ballistics::Conditions still{.air = gun.conditions.air, .gravity = gun.conditions.gravity};
  auto aiming = ballistics::zeroed(gun.weapon, still);
  if (!aiming.ok()) return aiming.error();
  int up = r.integer(o, "clicks_up", 0, -100000, 100000);
  if (o.has("dial")) {
    const auto dialled = ballistics::dial(gun.weapon, still, r.number(o, "dial", 0));
    if (!dialled.ok()) return dialled.error();
    up += dialled->up;
  }
  ballistics::Aiming set = turned(*aiming, sight, up, r.integer(o, "clicks_right", 0, -100000, 100000));
  set.cant = r.number(o, "cant", 0);
  const math::Vec2d eye{r.number(o, "eye_right", 0), r.number(o, "eye_up", 0)};
  const math::Vec2d beside = ballistics::parallax_of(sight, eye, r.number(o, "dial", gun.weapon.zero));
  const Vec3d line =
      ballistics::swung(gun.bore, r.number(o, "hold_up", 0) + beside.y, r.number(o, "hold_right", 0) + beside.x);
  gun.bore = ballistics::bore_direction(line, set);
  return {};
}

/// Where a gun stands, and the air there.
template <class D>
ballistics::Conditions conditions_of(const GunDef& gun, const rigid::World<D>& world,
                                     const environment::Environment* around) {
  math::Vec3d stands = gun.muzzle;
  if (const auto carrier = world.state(gun.body); carrier.ok())
    for (int k = 0; k < D::dimension; ++k) stands[k] = carrier->pose.position[k];
  return conditions_at(stands, -double(world.definition().gravity.y), D::dimension, around);
}

}  // namespace

ballistics::Conditions conditions_at(math::Vec3d point, double gravity, int dimension,
                                     const environment::Environment* around) {
  ballistics::Conditions conditions{.gravity = gravity};
  if (around == nullptr) return conditions;
  const environment::Environment::Definition& d = around->definition();
  conditions.air = d.vacuum ? environment::AirColumn::uniform(0) : environment::AirColumn(d.air, d.altitude);
  environment::WindField wind = d.wind;
  conditions.rotation = d.frame.rate;
  if (dimension == 2) {  // as bodies of the plane feel it
    wind.mean.velocity.z = 0;
    for (environment::WindColumn::Level& level : wind.layers) level.velocity.z = 0;
    conditions.rotation.x = conditions.rotation.y = 0;
  }
  conditions.wind = environment::column_of(wind, around->ground(point.x, point.z));
  if (around->has_gravity()) conditions.gravity -= around->gravity(point).y;
  return conditions;
}

bool read_pattern(Reader& r, const Object& o, GunDef& gun) {
  const std::vector<double> numbers = r.numbers(o, "pattern");
  if (numbers.size() % 2 != 0 || numbers.size() > 20000)
    return r.expected(*o.find("pattern"), o.path_of("pattern"),
                      "two angles a shot, right and up, of 10000 shots at most"),
           false;
  if (!numbers.empty() && gun.climbs)
    return r.fail(*o.find("pattern"), o.path_of("pattern"), "found a pattern beside climb, expected one of them"),
           false;
  for (std::size_t i = 0; i < numbers.size(); i += 2) gun.pattern.push_back({numbers[i], numbers[i + 1]});
  return !r.failed();
}

template <class D>
void read_gun(DestructionPlace<D>& place, const Object& o) {
  Reader& r = place.reader;
  GunDef gun;
  gun.weapon = read_weapon(r, o);
  if (o.has("body")) gun.body = place.names.find_body(*o.find("body"), o.path_of("body"), r.text(o, "body"));
  if (o.has("target")) gun.target = place.names.find_body(*o.find("target"), o.path_of("target"), r.text(o, "target"));
  gun.muzzle = r.vector(o, "position");
  gun.bore = r.vector(o, "direction", {1, 0, 0});
  gun.high_arc = r.choice(o, "arc", 0) == 1;
  gun.start = r.number(o, "start", 0);
  gun.rounds = r.integer(o, "rounds", 1, 1, 100000);
  gun.lifetime = r.number(o, "lifetime", gun.lifetime);
  gun.recoils = r.flag(o, "recoil", true);
  gun.climbs = r.flag(o, "climb", false);
  if (o.has("pattern") && !read_pattern(r, o, gun)) return;
  gun.seed = std::uint64_t(r.integer(o, "seed", 1, 0, 0x7FFFFFFF));
  const bool sighted = r.flag(o, "sighted", false);
  if (o.has("sway") && !read_sway(r, o, gun)) return;
  for (const char* key : {"dial", "clicks_up", "clicks_right", "hold_up", "hold_right", "eye_up", "eye_right", "cant"})
    if (o.has(key) && !sighted) return r.fail(*o.find(key), o.path_of(key), "only a gun that is \"sighted\" has it");
  std::string name;
  std::uint32_t color = 0xffd27f;
  auto& list = place.out.template of<D>().guns;
  if (r.failed() || !name_thing(r, o, "gun", list, name, color)) return;
  if (!(math::length(gun.bore) > 1e-9))
    return r.expected(*o.find("direction"), o.path_of("direction"), "a direction that is not zero");
  gun.bore = math::normalize(gun.bore);
  if (!(gun.start >= 0)) return r.expected(*o.find("start"), o.path_of("start"), "a time of zero or more");
  if (!(gun.lifetime >= 1e-3 && gun.lifetime <= 600))
    return r.expected(*o.find("lifetime"), o.path_of("lifetime"), "1 ms to 600 s");
  if (!r.accept(ballistics::check(gun.weapon), *o.node, o.path)) return;

  if (D::dimension == 2) gun.weapon.ammunition.shell.reset();  // its drift leads out of the plane
  gun.conditions = conditions_of(gun, place.world, place.around.get());
  if (sighted && (!r.accept(set_sights(r, o, gun), *o.node, o.path) || r.failed())) return;
  const ballistics::Ammunition& a = gun.weapon.ammunition;
  const ballistics::BatchRound round{.area_per_mass = a.projectile.area_per_mass,
                                     .mass = a.mass,
                                     .frontal_area = math::pi / 4 * math::square(a.diameter)};
  list.push_back({std::move(name), color, SceneGun(gun, round)});
}
template <class D>
void renew_air(Destruction& all, const rigid::World<D>& world,
               const std::shared_ptr<const environment::Environment>& around) {
  for (auto& entry : all.of<D>().guns) {
    SceneGun& gun = entry.thing;
    gun.definition.conditions = conditions_of(gun.definition, world, around.get());
    gun.batch.set_conditions(gun.definition.conditions);
  }
  if constexpr (D::dimension == 3) {
    for (auto& entry : all.space.explosions)
      if (entry.thing.casing)
        entry.thing.casing->batch().set_conditions(conditions_at(
            entry.thing.explosion.charge().position, -double(world.definition().gravity.y), 3, around.get()));
    for (auto& entry : all.space.rockets)
      if (const auto rocket = world.state(entry.thing.body()); rocket.ok())
        entry.thing.set_conditions(own_flight_conditions(rocket->pose.position, world, around, false));
    for (auto& entry : all.space.shells)
      if (const auto shell = world.state(entry.thing.body()); shell.ok())
        entry.thing.set_conditions(own_flight_conditions(shell->pose.position, world, around, true));
  }
}
template void renew_air(Destruction&, const rigid::World2&, const std::shared_ptr<const environment::Environment>&);
template void renew_air(Destruction&, const rigid::World3&, const std::shared_ptr<const environment::Environment>&);

template void read_gun(DestructionPlace<rigid::Dim2>&, const Object&);
template void read_gun(DestructionPlace<rigid::Dim3>&, const Object&);

}  // namespace carom::scene::detail
