#include "carom/scene/destruction.h"

#include "carom/scene/detail/quantity_names.h"

namespace carom::scene {
namespace {
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;

Vec3d in_space(math::Vec2d p) { return {p.x, p.y, 0}; }
Vec3d in_space(Vec3d p) { return p; }
Vec3d in_space(math::Vec2f p) { return {double(p.x), double(p.y), 0}; }
Vec3d in_space(math::Vec3f p) { return Vec3d(p); }
Vec3d turn(math::Rot2f q, Vec3d v) { return in_space(rotate(math::Rot2d(q), math::Vec2d{v.x, v.y})); }
Vec3d turn(const math::Quatf& q, Vec3d v) { return rotate(math::Quatd(q), v); }
Vec3d spin_of(float w) { return {0, 0, double(w)}; }
Vec3d spin_of(math::Vec3f w) { return Vec3d(w); }

struct Muzzle {
  Vec3d place{}, bore{1, 0, 0}, velocity{};
};
template <class D>
Result<Muzzle> muzzle_of(const GunDef& gun, const rigid::World<D>& world) {
  if (gun.body.is_null()) return Muzzle{gun.muzzle, gun.bore, {}};
  const auto state = world.state(gun.body);
  if (!state) return state.error();
  const Vec3d place = in_space(state->pose.position) + turn(state->pose.rotation, gun.muzzle);
  const Vec3d arm = place - in_space(state->center_of_mass);
  return Muzzle{place, turn(state->pose.rotation, gun.bore),
                in_space(state->linear_velocity) + cross(spin_of(state->angular_velocity), arm)};
}

/// The bore as the hands hold it.
template <class D>
Vec3d held(const SceneGun& gun, Vec3d bore, double time) {
  if (!gun.sway && !gun.definition.climbs && gun.definition.pattern.empty()) return bore;
  const math::Vec2d swing = gun.swing(time);
  return ballistics::swung(bore, swing.y, D::dimension == 3 ? swing.x : 0);
}

/// Where the barrel points for the next shot; empty: the target is out of reach.
template <class D>
Result<std::optional<Vec3d>> aimed(const SceneGun& gun, const rigid::World<D>& world, const Muzzle& muzzle) {
  const GunDef& d = gun.definition;
  const ballistics::Gun firearm = ballistics::gun_of(d.weapon);
  if (!d.target.is_null()) {
    const auto target = world.state(d.target);
    if (!target) return std::optional<Vec3d>{};  // it is gone
    const auto aims = ballistics::aim(d.weapon.ammunition.projectile, d.conditions,
                                      {firearm.muzzle_speed, muzzle.place, muzzle.velocity},
                                      {in_space(target->center_of_mass), in_space(target->linear_velocity), {}},
                                      {.longest_time = d.lifetime, .high_arc = d.high_arc});
    if (!aims) return aims.error();
    const std::optional<ballistics::Shot>& shot = d.high_arc ? aims->high : aims->low;
    if (!shot) return std::optional<Vec3d>{};
    return std::optional<Vec3d>(held<D>(gun, shot->direction, world.time()));
  }
  return std::optional<Vec3d>(held<D>(gun, muzzle.bore, world.time()));
}

template <class D>
Status shoot(SceneGun& gun, rigid::World<D>& world) {
  const GunDef& d = gun.definition;
  const double now = world.time(), interval = 60 / d.weapon.rounds_per_minute;
  while (gun.shots < d.rounds && gun.next <= now + 1e-9) {
    const auto muzzle = muzzle_of(d, world);
    if (!muzzle) return {};  // its body is gone
    auto way = aimed(gun, world, *muzzle);
    if (!way) return way.error();
    gun.no_solution = !way->has_value();
    if (gun.no_solution) return {};
    const double up = d.weapon.dispersion * gun.random.normal(), right = d.weapon.dispersion * gun.random.normal();
    const double speed = math::max(
        1.0, ballistics::gun_of(d.weapon).muzzle_speed + d.weapon.ammunition.speed_deviation * gun.random.normal());
    Vec3d bore = **way;
    if (d.weapon.dispersion > 0) bore = ballistics::swung(bore, up, D::dimension == 3 ? right : 0);
    ballistics::BatchRound round = gun.round;
    round.tag = std::uint64_t(gun.shots);
    const ballistics::FlightPoint start{muzzle->place, muzzle->velocity + speed * bore};
    gun.batch.add(start, round);
    if (gun.spinning) gun.spinning->add(gun.batch, start, ballistics::spin_of(d.weapon, speed));
    if (d.recoils && !d.body.is_null()) {
      const Vec3d push = -ballistics::recoil_impulse(ballistics::charge_of(d.weapon)) * bore;
      typename D::Vector impulse{};
      typename D::Position point{};
      for (int k = 0; k < D::dimension; ++k) impulse[k] = float(push[k]), point[k] = muzzle->place[k];
      if (Status s = world.add_impulse_at(d.body, impulse, point); !s) return s;
    }
    ++gun.shots;
    gun.shot_times.push_back(now);
    // After a wait for the target the next shot counts from this one.
    gun.next = (gun.next < now - interval ? now : gun.next) + interval;
  }
  return {};
}

/// What a bullet's blow is to the bonds of a structure: it lasts as long as the bullet needs for its way.
template <class D>
void load_structures(DestructionOf<D>& all, const ballistics::BatchHit& hit, double dt) {
  for (auto& s : all.structures) {
    const std::uint32_t part = s.thing.part_of(hit.shape);
    if (part == blast::ground) continue;
    const double speed = 0.5 * (length(hit.velocity) + length(hit.exit_velocity));
    typename D::Vector impulse{};
    typename D::Position point{};
    for (int k = 0; k < D::dimension; ++k) impulse[k] = float(hit.impulse[k]), point[k] = hit.point[k];
    s.thing.add_load(part, impulse, point, math::clamp(hit.depth / math::max(speed, 1.0), 2e-5, dt));
  }
}

/// The wind of a wave drags particles along, as it does balls of their size.
template <class D>
void push_particles(const blast::Explosion<D>& explosion, MatterOf<D>& matter, double time, double dt) {
  std::vector<typename D::Vector> places, velocities;
  for (auto& entry : matter.particles) {
    particles::ParticleSystem& system = entry.thing.system;
    const particles::SystemDef& d = system.definition();
    if (d.drag.law == particles::DragLaw::none || !(explosion.front_radius(time + dt) > 0)) continue;
    const double coefficient = d.drag.law == particles::DragLaw::quadratic ? double(d.drag.coefficient) : 0.47;
    const double area_per_mass = coefficient * math::pi * math::square(double(d.radius)) / double(d.mass);
    places.resize(std::size_t(system.size()));
    velocities.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      for (int k = 0; k < D::dimension; ++k) {
        places[i][k] = system.array(k)[i];
        velocities[i][k] = system.array(3 + k)[i];
      }
    typename D::Position origin{};
    for (int k = 0; k < D::dimension; ++k) origin[k] = d.anchor[k];
    const std::vector<typename D::Vector> before = velocities;
    explosion.push_particles(places, velocities, origin, area_per_mass, time, dt);
    for (std::size_t i = 0; i < places.size(); ++i)
      if (!(velocities[i] == before[i])) system.set_velocity(int(i), in_space(velocities[i]));
  }
}

template <class Given>
Status take(const Given& given, Vec3d& sum) {
  if (!given) return given.error();
  sum += in_space(*given);
  return {};
}
[[gnu::noinline]] Status push_ropes_and_cloth(SceneExplosion<Dim3>& e, Matter& matter, rigid::World3& world,
                                              double dt) {
  if (!matter.ropes.empty())
    if (Status s = take(blast::push(e.explosion, world, dt, matter.rope_set), e.pushed); !s) return s;
  for (auto& cloth : matter.cloths)
    if (Status s = take(blast::push(e.explosion, world, dt, cloth.thing), e.pushed); !s) return s;
  for (auto& body : matter.soft_bodies)
    if (Status s = take(blast::push(e.explosion, world, dt, body.thing), e.pushed); !s) return s;
  return {};
}
template <class D>
[[gnu::noinline]] Status push_matter(SceneExplosion<D>& e, Matter& matter, rigid::World<D>& world, double dt) {
  push_particles(e.explosion, matter.of<D>(), world.time(), dt);
  if constexpr (D::dimension == 3)
    if (Status s = push_ropes_and_cloth(e, matter, world, dt); !s) return s;
  for (auto& liquid : matter.of<D>().liquids)
    if (Status s = take(blast::push(e.explosion, world, dt, liquid.thing), e.pushed); !s) return s;
  for (auto& grains : matter.of<D>().grains)
    if (Status s = take(blast::push(e.explosion, world, dt, grains.thing), e.pushed); !s) return s;
  return {};
}

/// The case flies apart in the step in which the charge goes off, with the velocity of the body that carries it.
template <class D>
Status throw_case(SceneExplosion<D>& e, const rigid::World<D>& world, double dt) {
  const blast::Charge<D>& charge = e.explosion.charge();
  if (!e.casing || e.casing->thrown() || charge.time >= world.time() + dt) return {};
  Vec3d velocity{};
  if (const auto body = world.state(charge.casing); body) velocity = in_space(body->linear_velocity);
  return e.casing->fly_apart(in_space(charge.position), velocity, charge.mass, world.time());
}

/// What projectiles met on the way of their step is in `all.hits` then, and told to the structures that it loads.
template <class D>
Status hit(ballistics::ProjectileBatch& batch, DestructionOf<D>& all, rigid::World<D>& world, double dt,
           rigid::BodyId without) {
  ballistics::HitOptions options;
  options.filter.ignore = without;
  if (Status s = all.hits.collect(batch, world, dt, options); !s) return s;
  for (const ballistics::BatchHit& hit : all.hits.hits()) load_structures(all, hit, dt);
  return {};
}

template <class D>
void forget_old(SceneGun& gun, double now) {
  for (std::size_t i = gun.batch.size(); i-- > 0;)
    if (now - gun.shot_times[std::size_t(gun.batch.round(i).tag)] > gun.definition.lifetime) gun.batch.remove(i);
}

}  // namespace

math::Vec2d SceneGun::swing(double time) const {
  math::Vec2d sum = sway ? sway->at(time, definition.breath_held) : math::Vec2d{};
  if (definition.climbs && !shot_times.empty()) {
    const double impulse = ballistics::recoil_impulse(ballistics::charge_of(definition.weapon));
    const std::size_t known = math::min<std::size_t>(shot_times.size(), 64);  // what was long ago has died away
    const std::span<const double> recent(shot_times.data() + shot_times.size() - known, known);
    const ballistics::RecoilMotion motion = ballistics::recoil_at(definition.weapon.mount, impulse, recent, time);
    sum += math::Vec2d{motion.swing, motion.rise};
  }
  if (const auto& pattern = definition.pattern; !pattern.empty())
    sum += pattern[math::min(std::size_t(shots), pattern.size() - 1)];
  return sum;
}

template <class D>
Status Destruction::before(rigid::World<D>& world, double dt, Matter* matter) {
  DestructionOf<D>& all = of<D>();
  for (auto& gun : all.guns)
    if (Status s = shoot<D>(gun.thing, world); !s) return s;
  if constexpr (D::dimension == 3) {
    for (auto& rocket : all.rockets)
      if (Status s = rocket.thing.before_step(world, dt); !s) return s;
    for (auto& shell : all.shells)
      if (Status s = shell.thing.before_step(world, dt); !s) return s;
  }
  for (auto& entry : all.explosions) {
    SceneExplosion<D>& e = entry.thing;
    if (Status s = throw_case(e, world, dt); !s) return s;
    if (e.explosion.finished(world.time())) continue;
    if (matter != nullptr)
      if (Status s = push_matter(e, *matter, world, dt); !s) return s;
    if (Status s = e.explosion.apply(world, dt); !s) return s;
    e.reached += int(e.explosion.events().size());
    for (const blast::ShapeLoad<D>& load : e.explosion.loads())
      for (auto& s : all.structures)
        if (const std::uint32_t part = s.thing.part_of(load.shape); part != blast::ground)
          s.thing.add_load(part, load.impulse, load.point, load.duration);
  }
  return {};
}

template <class D>
Status Destruction::step(rigid::World<D>& world, double dt) {
  DestructionOf<D>& all = of<D>();
  if (all.structures.empty()) return world.step(float(dt));
  std::vector<blast::Structure<D>*> every;
  for (auto& s : all.structures) every.push_back(&s.thing);
  return all.stepper.step(world, float(dt), every);
}

template <class D>
Status Destruction::after(rigid::World<D>& world, double dt) {
  DestructionOf<D>& all = of<D>();
  for (auto& entry : all.guns) {
    SceneGun& gun = entry.thing;
    gun.last.clear();
    if (gun.batch.size() == 0) continue;
    if (gun.spinning)
      gun.spinning->step(gun.batch, gun.definition.conditions, world.time() - dt, dt);
    else
      gun.batch.step(dt);
    if (Status s = hit(gun.batch, all, world, dt, gun.definition.body); !s) return s;
    for (const ballistics::BatchHit& hit : all.hits.hits()) {
      gun.last.push_back(hit);
      ++gun.hits;
      gun.passed += hit.outcome == ballistics::LayerOutcome::passed ? 1 : 0;
      gun.ricochets += hit.outcome == ballistics::LayerOutcome::ricochet ? 1 : 0;
      gun.energy += hit.energy;
      gun.last_hit = hit.point;
      gun.hit_speed = length(hit.velocity);
    }
    forget_old<D>(gun, world.time());
  }
  for (auto& entry : all.explosions) {
    SceneExplosion<D>& e = entry.thing;
    if (!e.casing || e.casing->batch().size() == 0) continue;
    e.casing->batch().step(dt);
    if (Status s = hit(e.casing->batch(), all, world, dt, e.explosion.charge().casing); !s) return s;
    e.casing->hits += int(all.hits.hits().size());
    e.casing->forget_old(world.time());
  }
  return {};
}

template Status Destruction::before(rigid::World2&, double, Matter*);
template Status Destruction::before(rigid::World3&, double, Matter*);
template Status Destruction::step(rigid::World2&, double);
template Status Destruction::step(rigid::World3&, double);
template Status Destruction::after(rigid::World2&, double);
template Status Destruction::after(rigid::World3&, double);

void Destruction::add_to(core::StateHash& hash) const {
  const auto add = [&hash](const auto& all) {
    for (const auto& gun : all.guns) {
      hash.add(gun.thing.shots).add(gun.thing.hits).add(gun.thing.next).add(gun.thing.random.position());
      for (int component = 0; component < 6; ++component)
        for (const float x : gun.thing.batch.array(component)) hash.add(x);
    }
    for (const auto& e : all.explosions)
      if (e.thing.casing) e.thing.casing->add_to(hash);
    for (const auto& s : all.structures) hash.add(std::uint64_t(s.thing.broken()));
    for (const auto& r : all.rockets)
      hash.add(r.thing.stages_left()).add(r.thing.under_parachute()).add(r.thing.apex());
    for (const auto& shell : all.shells) {
      const ballistics::ShellMotion& m = shell.thing.motion();
      hash.add(m.spin);
      for (int k = 0; k < 3; ++k) hash.add(m.velocity[k]).add(m.axis[k]).add(m.momentum[k]);
    }
  };
  add(plane);
  add(space);
}

namespace {
enum DestructionList { explosion_list, gun_list, structure_list, rocket_list, shell_list };
constexpr std::string_view list_names[] = {"explosion", "gun", "structure", "rocket", "shell"};
enum DestructionField {
  front,
  reached,
  impulse,
  fragments,
  fragment_hits,
  shots,
  in_flight,
  hits,
  passed,
  ricochets,
  energy,
  last_hit,
  hit_speed,
  swing_up,
  swing_right,
  parts,
  pieces,
  broken,
  load,
  thrust,
  mass,
  stages,
  parachute,
  apex,
  spin,
  yaw,
  stability,
  flying,
  impact,
  impact_time,
  impact_speed,
};
struct FieldName {
  int list;
  std::string_view name, unit;
  bool vector = false;
};
constexpr FieldName fields[] = {{explosion_list, "front", "m"},
                                {explosion_list, "reached", ""},
                                {explosion_list, "impulse", "N*s", true},
                                {explosion_list, "fragments", ""},
                                {explosion_list, "fragment_hits", ""},
                                {gun_list, "shots", ""},
                                {gun_list, "in_flight", ""},
                                {gun_list, "hits", ""},
                                {gun_list, "passed", ""},
                                {gun_list, "ricochets", ""},
                                {gun_list, "energy", "J"},
                                {gun_list, "last_hit", "m", true},
                                {gun_list, "hit_speed", "m/s"},
                                {gun_list, "swing_up", "rad"},
                                {gun_list, "swing_right", "rad"},
                                {structure_list, "parts", ""},
                                {structure_list, "pieces", ""},
                                {structure_list, "broken", ""},
                                {structure_list, "load", ""},
                                {rocket_list, "thrust", "N"},
                                {rocket_list, "mass", "kg"},
                                {rocket_list, "stages", ""},
                                {rocket_list, "parachute", ""},
                                {rocket_list, "apex", "m"},
                                {shell_list, "spin", "rad/s"},
                                {shell_list, "yaw", "rad"},
                                {shell_list, "stability", ""},
                                {shell_list, "flying", ""},
                                {shell_list, "impact", "m", true},
                                {shell_list, "impact_time", "s"},
                                {shell_list, "impact_speed", "m/s"}};

template <class See>
void each_name(const Destruction& all, const See& see) {
  const auto list = [&](int which, const auto& things) {
    for (std::size_t i = 0; i < things.size(); ++i) see(which, int(i), things[i].name);
  };
  const auto both = [&](const auto& of) {
    list(explosion_list, of.explosions);
    list(gun_list, of.guns);
    list(structure_list, of.structures);
    list(rocket_list, of.rockets);
    list(shell_list, of.shells);
  };
  both(all.plane);
  both(all.space);
}

double read_gun(const SceneGun& gun, const Probe::Source& s, double time) {
  switch (s.field) {
    case shots:
      return gun.shots;
    case in_flight:
      return double(gun.batch.size());
    case hits:
      return gun.hits;
    case passed:
      return gun.passed;
    case ricochets:
      return gun.ricochets;
    case energy:
      return gun.energy;
    case hit_speed:
      return gun.hit_speed;
    case swing_up:
      return gun.swing(time).y;
    case swing_right:
      return gun.swing(time).x;
    default:
      return gun.last_hit[s.component];
  }
}
double read_shell(const ballistics::BodyShell& shell, const Probe::Source& s) {
  const ballistics::ShellImpact* const met = shell.impact();
  switch (s.field) {
    case spin:
      return shell.motion().spin;
    case yaw:
      return shell.yaw();
    case stability:
      return shell.stability();
    case flying:
      return double(shell.flies());
    case impact:
      return met != nullptr ? met->point[s.component] : __builtin_nan("");
    case impact_time:
      return met != nullptr ? met->time : __builtin_nan("");
    default:
      return met != nullptr ? length(met->velocity) : __builtin_nan("");
  }
}
template <class D>
double read_of(const DestructionOf<D>& all, const Probe::Source& s, double time) {
  const auto place = std::size_t(s.item);
  if (s.list == gun_list) return read_gun(all.guns[place].thing, s, time);
  if (s.list == explosion_list) {
    const SceneExplosion<D>& e = all.explosions[place].thing;
    if (s.field == reached) return e.reached;
    if (s.field == fragments) return e.casing ? double(e.casing->batch().size()) : 0;
    if (s.field == fragment_hits) return e.casing ? e.casing->hits : 0;
    return s.field == front ? e.explosion.front_radius(time)
                            : (in_space(e.explosion.impulse_given()) + e.pushed)[s.component];
  }
  if (s.list == shell_list) return read_shell(all.shells[place].thing, s);
  if (s.list == rocket_list) {
    const ballistics::BodyRocket& rocket = all.rockets[place].thing;
    if (s.field == thrust) return rocket.thrust();
    if (s.field == mass) return rocket.mass();
    if (s.field == stages) return rocket.stages_left();
    return s.field == parachute ? double(rocket.under_parachute()) : rocket.apex();
  }
  const blast::Structure<D>& structure = all.structures[place].thing;
  if (s.field == parts) return double(structure.part_count());
  if (s.field == pieces) return double(structure.cluster_count());
  if (s.field == broken) return double(structure.broken());
  double worst = 0;
  for (const float l : structure.loads()) worst = math::max(worst, double(l));
  return worst;
}
template <class D>
bool any_of(const DestructionOf<D>& all) {
  return !all.explosions.empty() || !all.guns.empty() || !all.structures.empty() || !all.rockets.empty() ||
         !all.shells.empty();
}
}  // namespace

bool Destruction::find(std::string_view text, int dimension, Probe::Source& source, std::string_view& unit) const {
  const auto names = [this](const auto& see) { each_name(*this, see); };
  const auto known = [](int list, int field) { return fields[field].list == list; };
  if (!detail::find_quantity<FieldName>(text, dimension, list_names, fields, names, known, source, unit)) return false;
  source.kind = Probe::Source::Kind::destruction;
  return true;
}

double Destruction::read(const Probe::Source& s, double time) const {
  return any_of(plane) ? read_of(plane, s, time) : read_of(space, s, time);
}

std::vector<std::string> Destruction::names() const {
  return detail::quantity_names(list_names, [this](const auto& see) { each_name(*this, see); });
}

}  // namespace carom::scene
