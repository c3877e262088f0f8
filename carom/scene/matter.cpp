#include "carom/scene/matter.h"

#include "carom/core/hash.h"
#include "carom/scene/detail/quantity_names.h"

namespace carom::scene {
namespace {
using math::Vec3d;

/// What a body of many points can be asked for, without walking its points twice.
struct Extent {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300}, sum{};
  int count = 0;
  void add(Vec3d p) {
    low = math::min(low, p);
    high = math::max(high, p);
    sum += p;
    ++count;
  }
  void add(math::Vec2d p) { add(Vec3d{p.x, p.y, 0}); }
  Vec3d middle() const { return count > 0 ? sum / double(count) : Vec3d{}; }
};

template <class List>
Extent extent_of(const List& positions) {
  Extent out;
  for (const auto& p : positions) out.add(p);
  return out;
}
template <class Many>
Extent extent_of_many(const Many& many) {
  Extent out;
  for (int i = 0; i < many.size(); ++i) out.add(many.position(i));
  return out;
}

enum MatterField {
  of_count,
  of_mass,
  of_kinetic_energy,
  of_center,
  of_lower,
  of_upper,
  of_length,
  of_tension,
  of_area,
  of_volume
};
struct MatterFieldName {
  std::string_view name, unit;
  bool vector;
};
constexpr MatterFieldName matter_fields[] = {
    {"count", "", false},   {"mass", "kg", false},   {"kinetic_energy", "J", false}, {"center", "m", true},
    {"lower", "m", true},   {"upper", "m", true},    {"length", "m", false},         {"tension", "N", false},
    {"area", "m^2", false}, {"volume", "m^3", false}};
enum MatterList { rope_list, cloth_list, soft_list, liquid_list, grain_list, particle_list, list_count };
constexpr std::string_view matter_lists[] = {"rope", "cloth", "soft_body", "liquid", "grains", "particles"};
constexpr unsigned common =
    1u << of_count | 1u << of_mass | 1u << of_kinetic_energy | 1u << of_center | 1u << of_lower | 1u << of_upper;
constexpr unsigned has[] = {common | 1u << of_length | 1u << of_tension,
                            common | 1u << of_tension | 1u << of_area,
                            common | 1u << of_volume,
                            common | 1u << of_volume,
                            common,
                            common};

/// Calls see(list, place, name) for every thing.
template <class See>
void each_name(const Matter& m, const See& see) {
  const auto list = [&](int which, const auto& things) {
    for (std::size_t i = 0; i < things.size(); ++i) see(which, int(i), things[i].name);
  };
  list(rope_list, m.ropes);
  list(cloth_list, m.cloths);
  list(soft_list, m.soft_bodies);
  list(liquid_list, m.plane.liquids);
  list(liquid_list, m.space.liquids);
  list(grain_list, m.plane.grains);
  list(grain_list, m.space.grains);
  list(particle_list, m.plane.particles);
  list(particle_list, m.space.particles);
}

double component(const Extent& e, const Probe::Source& s) {
  const Vec3d v = s.field == of_center ? e.middle() : s.field == of_lower ? e.low : e.high;
  return v[s.component];
}
double rope_kinetic_energy(const particles::RopeSet& set, int rope) {
  double sum = 0;
  const auto v = set.velocities(rope);
  for (const Vec3d& u : v) sum += math::dot(u, u);
  return 0.5 * set.mass(rope) * sum / double(v.size());
}
double read_rope(const particles::RopeSet& set, int rope, const Probe::Source& s) {
  switch (s.field) {
    case of_count:
      return double(set.positions(rope).size());
    case of_mass:
      return set.mass(rope);
    case of_kinetic_energy:
      return rope_kinetic_energy(set, rope);
    case of_length:
      return set.length(rope);
    case of_tension: {
      double most = 0;
      for (const double t : set.tensions(rope)) most = math::max(most, t);
      return most;
    }
    default:
      return component(extent_of(set.positions(rope)), s);
  }
}
double read_cloth(const particles::Cloth& cloth, const Probe::Source& s) {
  switch (s.field) {
    case of_count:
      return cloth.vertex_count();
    case of_mass:
      return cloth.mass();
    case of_kinetic_energy:
      return cloth.kinetic_energy();
    case of_tension:
      return cloth.greatest_tension();
    case of_area:
      return cloth.area();
    default:
      return component(extent_of(cloth.positions()), s);
  }
}
double read_soft(const particles::SoftBody& body, const Probe::Source& s) {
  switch (s.field) {
    case of_count:
      return body.vertex_count();
    case of_mass:
      return body.mass();
    case of_kinetic_energy:
      return body.kinetic_energy();
    case of_volume:
      return body.volume();
    case of_center:
      return body.center()[s.component];
    default:
      return component(extent_of(body.positions()), s);
  }
}
template <class D>
double read_many(const MatterOf<D>& m, const Probe::Source& s) {
  const auto place = std::size_t(s.item);
  if (s.list == liquid_list) {
    const particles::Fluid<D>& fluid = m.liquids[place].thing;
    if (s.field == of_count) return fluid.size();
    if (s.field == of_mass) return double(fluid.particle_mass()) * fluid.size();
    if (s.field == of_kinetic_energy) return fluid.kinetic_energy();
    if (s.field == of_volume) return fluid.volume();
    return component(extent_of_many(fluid), s);
  }
  if (s.list == grain_list) {
    const particles::Granular<D>& grains = m.grains[place].thing;
    if (s.field == of_count) return grains.size();
    if (s.field == of_mass) return grains.mass();
    if (s.field == of_kinetic_energy) return grains.kinetic_energy();
    return component(extent_of_many(grains), s);
  }
  const particles::ParticleSystem& system = m.particles[place].thing.system;
  if (s.field == of_count) return system.size();
  if (s.field == of_mass) return system.totals().mass;
  if (s.field == of_kinetic_energy) return system.totals().kinetic_energy;
  return component(extent_of_many(system), s);
}

/// The wind of the environment round something now: where it is the same everywhere, as that, else as a patch.
environment::Wind wind_round(const environment::Environment& around, const Extent& extent, double time,
                             environment::WindPatch& patch) {
  const environment::WindField& field = around.definition().wind;
  patch.clear();
  if (field.steady() && field.layers.empty() && field.mean.profile == environment::WindProfile::uniform)
    return {.velocity = field.mean.velocity};
  const Vec3d middle = extent.middle();
  patch.set_whole(field, extent.low, extent.high, time, around.ground(middle.x, middle.z));
  return {};
}

// By kind, each apart: in the page a scene without ropes does not fetch what moves them.
[[gnu::noinline]] Status step_ropes_and_cloth(Matter& matter, rigid::World3& world, double dt,
                                              const environment::Environment* around) {
  const double time = world.time();
  if (!matter.ropes.empty()) {
    if (around != nullptr) {
      Extent all;
      for (int r = 0; r < matter.rope_set.size(); ++r)
        for (const Vec3d& p : matter.rope_set.positions(r)) all.add(p);
      matter.rope_air.density = around->air(all.middle()).density;
      matter.rope_air.wind = wind_round(*around, all, time, matter.rope_air.beyond);
      matter.rope_set.set_air(matter.rope_air);
    }
    if (Status s = matter.rope_set.step(world, dt); !s) return s;
  }
  for (auto& cloth : matter.cloths) {
    if (around != nullptr) {
      const Extent extent = extent_of(cloth.thing.positions());
      const environment::Wind wind = wind_round(*around, extent, time, matter.cloth_patch);
      if (Status s = cloth.thing.set_air(around->air(extent.middle()).density, wind, matter.cloth_patch); !s) return s;
    }
  }
  matter.group_cloths.clear();
  matter.group_bodies.clear();
  for (auto& cloth : matter.cloths) matter.group_cloths.push_back(&cloth.thing);
  for (auto& body : matter.soft_bodies) matter.group_bodies.push_back(&body.thing);
  return matter.soft_group.step(matter.group_cloths, matter.group_bodies, world, dt);
}

template <class D>
[[gnu::noinline]] Status step_particles(MatterOf<D>& many, rigid::World<D>& world, double dt) {
  for (auto& entry : many.particles) {
    SceneParticles<D>& p = entry.thing;
    for (TimedBurst& timed : p.bursts) {
      if (timed.done || timed.time >= world.time() + 1e-9) continue;
      timed.done = true;
      if (const auto born = p.system.burst(timed.burst, timed.lifetime); !born) return born.error();
    }
    if (Status s = p.coupling.step(world, p.system, dt); !s) return s;
  }
  // Births last: every system has told what happened in this step.
  for (auto& entry : many.particles)
    for (const SubEmissionRule& rule : entry.thing.rules) {
      particles::ParticleSystem& from = entry.thing.system;
      const auto born = many.particles[std::size_t(rule.into)].thing.system.emit_at(
          rule.at_death ? from.deaths() : from.hits(), rule.emission);
      if (!born) return born.error();
    }
  return {};
}

}  // namespace

template <class D>
Status Matter::step(rigid::World<D>& world, double dt, const environment::Environment* around,
                    core::FunctionRef<Status()> advance) {
  if constexpr (D::dimension == 3)
    if (Status s = step_ropes_and_cloth(*this, world, dt, around); !s) return s;
  MatterOf<D>& many = of<D>();
  for (auto& liquid : many.liquids)
    if (Status s = liquid.thing.step(world, float(dt)); !s) return s;
  for (auto& grains : many.grains)
    if (Status s = grains.thing.step(world, float(dt)); !s) return s;
  if (Status s = advance(); !s) return s;
  return step_particles(many, world, dt);
}

Status Matter::set_wind(const environment::Environment* around) {
  const auto set = [around](auto& many) -> Status {
    for (auto& entry : many.particles) {
      particles::Air air{.turbulence = entry.thing.turbulence};
      if (around != nullptr) {
        air.field = around->definition().wind;
        air.ground = around->definition().ground;
      }
      if (Status s = entry.thing.system.set_air(air); !s) return s;
    }
    return {};
  };
  if (Status s = set(plane); !s) return s;
  return set(space);
}

template Status Matter::step(rigid::World2&, double, const environment::Environment*, core::FunctionRef<Status()>);
template Status Matter::step(rigid::World3&, double, const environment::Environment*, core::FunctionRef<Status()>);

void Matter::add_to(core::StateHash& hash) const {
  if (!ropes.empty()) hash.add(rope_set.state_hash());
  for (const auto& c : cloths) hash.add(c.thing.state_hash());
  for (const auto& s : soft_bodies) hash.add(s.thing.state_hash());
  const auto add = [&hash](const auto& many) {
    for (const auto& l : many.liquids) hash.add(l.thing.state_hash());
    for (const auto& g : many.grains) hash.add(g.thing.state_hash());
    for (const auto& p : many.particles) hash.add(p.thing.system.state_hash());
  };
  add(plane);
  add(space);
}

bool Matter::find(std::string_view text, int dimension, Probe::Source& source, std::string_view& unit) const {
  const auto names = [this](const auto& see) { each_name(*this, see); };
  const auto known = [](int list, int field) { return (has[list] >> field & 1) != 0; };
  if (!detail::find_quantity<MatterFieldName>(text, dimension, matter_lists, matter_fields, names, known, source, unit))
    return false;
  source.kind = Probe::Source::Kind::matter;
  if (source.list == cloth_list && source.field == of_tension) unit = "N/m";
  if (dimension == 2 && source.field == of_volume) unit = "m^2";
  return true;
}

double Matter::read(const Probe::Source& s) const {
  if (s.list == rope_list) return read_rope(rope_set, ropes[std::size_t(s.item)].thing, s);
  if (s.list == cloth_list) return read_cloth(cloths[std::size_t(s.item)].thing, s);
  if (s.list == soft_list) return read_soft(soft_bodies[std::size_t(s.item)].thing, s);
  const bool in_plane = !plane.liquids.empty() || !plane.grains.empty() || !plane.particles.empty();
  return in_plane ? read_many(plane, s) : read_many(space, s);
}

std::vector<std::string> Matter::names() const {
  return detail::quantity_names(matter_lists, [this](const auto& see) { each_name(*this, see); });
}

}  // namespace carom::scene
