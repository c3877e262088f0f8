// Systems of particles of a scene file.
#include "carom/core/spelling.h"
#include "carom/math/rotation.h"
#include "carom/scene/detail/document.h"
#include "carom/scene/detail/matter.h"
#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {
namespace {
using math::Vec3d;
using math::Vec3f;

/// Calls take(age, node of the value) for a constant (age 0) or for pairs.
template <class Take>
void read_pairs(Reader& r, const Object& o, const char* key, const char* what, const Take& take) {
  const Node& node = *o.find(key);
  const std::string path = o.path_of(key);
  if (!node.is_array()) return take(0.0f, node, path);
  for (std::size_t i = 0; i < node.children.size() && !r.failed(); ++i) {
    const Node& pair = node.children[i];
    const std::string at = index_path(path, i);
    if (!pair.is_array() || pair.children.size() != 2) return r.expected(pair, at, what);
    take(float(r.value(pair.children[0], index_path(at, 0), Measure::plain)), pair.children[1], index_path(at, 1));
  }
}
void read_curve(Reader& r, const Object& o, const char* key, particles::Curve& out) {
  if (!o.has(key) || r.failed()) return;
  std::vector<particles::CurveKey> keys;
  read_pairs(r, o, key, "a pair: age and value", [&](float age, const Node& node, const std::string& path) {
    keys.push_back({age, float(r.value(node, path, Measure::plain))});
  });
  if (r.failed()) return;
  const auto made = particles::Curve::make(keys);
  if (r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.find(key), o.path_of(key))) out = *made;
}
void read_gradient(Reader& r, const Object& o, const char* key, particles::Gradient& out) {
  if (!o.has(key) || r.failed()) return;
  std::vector<particles::ColorKey> keys;
  read_pairs(r, o, key, "a pair: age and color", [&](float age, const Node& node, const std::string& path) {
    std::uint32_t rgb = 0;
    bool good = node.is_text() && node.text.size() == 7 && node.text[0] == '#';
    for (std::size_t i = 1; good && i < 7; ++i) {
      const char c = node.text[i];
      const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
      good = digit >= 0;
      rgb = rgb << 4 | std::uint32_t(digit & 15);
    }
    if (!good) return r.expected(node, path, "a color such as \"#c04020\"");
    keys.push_back({age, rgb});
  });
  if (r.failed()) return;
  const auto made = particles::Gradient::make(keys);
  if (r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.find(key), o.path_of(key))) out = *made;
}
/// To unit length, so that files may say [1, 1, 0].
Vec3f unit(Reader& r, const Object& o, const char* key, Vec3f fallback) {
  if (!o.has(key) || r.failed()) return fallback;
  const Vec3d v = r.vector(o, key);
  const double length = math::length(v);
  if (!r.failed() && !(length > 0)) r.expected(*o.find(key), o.path_of(key), "a direction that is not zero");
  return length > 0 ? Vec3f(v / length) : fallback;
}

particles::EmitterDef read_emitter(Reader& r, double& budget, const Object& o) {
  using particles::EmitterForm;
  particles::EmitterDef e;
  e.form = EmitterForm(r.choice(o, "form", 0));
  if (o.has("size") && o.has("radius")) r.fail(*o.node, o.path, "found both size and radius");
  const float radius = float(r.number(o, "radius", 1));
  e.size = o.has("size") ? Vec3f(r.vector(o, "size")) : Vec3f{radius, radius, radius};
  e.surface_only = r.flag(o, "surface_only", false);
  if (r.dimension == 3 && o.has("vertices")) {
    std::vector<Vec3f> vertices;
    for (const Vec3d& v : r.points(o, "vertices")) vertices.push_back(Vec3f(v));
    std::vector<std::uint32_t> indices = read_indices(r, o, "indices");
    if (!spend(r, budget, double(vertices.size() + indices.size()), o)) return e;
    auto mesh = geometry::make_triangle_mesh(std::move(vertices), std::move(indices));
    if (r.accept(mesh.ok() ? core::Status{} : core::Status{mesh.error()}, *o.node, o.path)) e.mesh = std::move(*mesh);
  }
  e.position = r.vector(o, "position");
  e.rotation = r.dimension == 3 ? math::Quatd(r.rotation3(o, "rotation"))
                                : math::from_axis_angle(Vec3d{0, 0, 1}, r.number(o, "rotation", 0));
  e.velocity = r.vector(o, "velocity");
  e.inherited = float(r.number(o, "inherited", 1));
  e.rate = float(r.number(o, "rate", 0));
  e.start = float(r.number(o, "start", 0));
  e.duration = float(r.number(o, "duration", double(e.duration)));
  e.burst = r.integer(o, "burst", 0, 0, 1 << 24);
  e.direction = unit(r, o, "direction", e.direction);
  e.along_normal = r.flag(o, "along_normal", false);
  e.spread = float(r.number(o, "spread", 0));
  e.speed = read_range(r, o, "speed", Measure::speed, e.speed);
  e.lifetime = read_range(r, o, "lifetime", Measure::time, e.lifetime);
  e.scale = read_range(r, o, "scale", Measure::plain, e.scale);
  e.seed = std::uint64_t(r.integer(o, "seed", 1, 0, 0x7FFFFFFF));
  return e;
}

void read_drag(Reader& r, const Object& o, particles::Drag& drag) {
  drag.law = particles::DragLaw(r.choice(o, "drag", int(particles::DragLaw::quadratic)));
  const char* key = drag.law == particles::DragLaw::linear ? "linear_coefficient" : "drag_coefficient";
  drag.coefficient = float(r.number(o, key, double(drag.coefficient)));
}

}  // namespace

template <class D>
void read_particles(MatterPlace<D>& place, const Object& o) {
  Reader& r = place.reader;
  particles::SystemDef def;
  def.capacity = r.integer(o, "capacity", def.capacity, 1, 1 << 24);
  def.planar = D::dimension == 2;
  def.gravity = {};
  for (int k = 0; k < D::dimension; ++k) def.gravity[k] = double(place.world.definition().gravity[k]);
  def.gravity_scale = float(r.number(o, "gravity_scale", 1));
  def.radius = float(read_radius(r, o, double(def.radius)));
  def.mass = float(r.number(o, "mass", double(def.mass)));
  if (o.has("density")) {
    if (o.has("mass")) r.fail(*o.node, o.path, "found both mass and density, expected one of them");
    const double a = double(def.radius);
    def.mass = float(r.number(o, "density", 1000) * 4 / 3 * math::pi * a * a * a);
  }
  read_drag(r, o, def.drag);
  read_curve(r, o, "drag_over_age", def.drag_over_age);
  read_curve(r, o, "size_over_age", def.size_over_age);
  read_curve(r, o, "opacity_over_age", def.opacity_over_age);
  read_gradient(r, o, "color_over_age", def.color_over_age);
  Object t;
  if (o.has("touch") && !r.failed() && r.open(*o.find("touch"), o.path_of("touch"), touch_kind, t)) {
    def.contacts.enabled = true;
    def.contacts.restitution = float(r.number(t, "restitution", double(def.contacts.restitution)));
    def.contacts.friction = float(r.number(t, "friction", double(def.contacts.friction)));
    def.contacts.rolling = float(r.number(t, "rolling", double(def.contacts.rolling)));
    def.contacts.substeps = r.integer(t, "substeps", def.contacts.substeps, 1, 64);
    def.contacts.iterations = r.integer(t, "iterations", def.contacts.iterations, 1, 64);
  }
  particles::CouplingDef coupling;
  coupling.restitution = float(r.number(o, "restitution", double(coupling.restitution)));
  coupling.friction = float(r.number(o, "friction", double(coupling.friction)));
  coupling.answer = particles::CollisionAnswer(r.choice(o, "answer", 0));
  coupling.two_way = r.flag(o, "two_way", false);
  // What events are for is known before the systems are: others may be born from them.
  each_entry(r, o, "sub_emissions", sub_emission_kind,
             [&](const Object& s) { (r.choice(s, "on", 0) == 0 ? def.report_deaths : def.report_hits) = true; });
  particles::Turbulence turbulence;
  turbulence.speed = float(r.number(o, "turbulence_speed", 0));
  turbulence.length = float(r.number(o, "turbulence_length", double(turbulence.length)));
  std::string name;
  std::uint32_t color = 0;
  auto& list = place.out.template of<D>().particles;
  if (!name_thing(r, o, "particles", list, name, color) || !spend(r, place.budget, def.capacity, o)) return;
  if (!r.accept(particles::Coupling<D>::check(coupling), *o.node, o.path)) return;
  auto system = particles::ParticleSystem::create(def);
  if (!r.accept(system.ok() ? core::Status{} : core::Status{system.error()}, *o.node, o.path)) return;
  each_entry(r, o, "emitters", emitter_kind, [&](const Object& e) {
    const particles::EmitterDef emitter = read_emitter(r, place.budget, e);
    if (r.failed()) return;
    const auto added = system->add_emitter(emitter);
    r.accept(added.ok() ? core::Status{} : core::Status{added.error()}, *e.node, e.path);
  });
  std::vector<particles::Attractor> attractors;
  each_entry(r, o, "attractors", attractor_kind, [&](const Object& a) {
    particles::Attractor pull;
    pull.center = r.vector(a, "center");
    pull.radial.strength = r.number(a, "strength", pull.radial.strength);
    pull.radial.reference = r.number(a, "reference", pull.radial.reference);
    pull.radial.exponent = r.number(a, "exponent", pull.radial.exponent);
    pull.radial.range = r.number(a, "range", pull.radial.range);
    attractors.push_back(pull);
  });
  if (r.failed() || !r.accept(system->set_attractors(attractors), *o.node, o.path)) return;
  list.push_back(
      {std::move(name), color,
       SceneParticles<D>{
           .system = std::move(*system), .coupling = particles::Coupling<D>(coupling), .turbulence = turbulence}});
  std::vector<TimedBurst>& bursts = list.back().thing.bursts;
  each_entry(r, o, "bursts", burst_kind, [&](const Object& b) {
    TimedBurst timed;
    timed.time = r.number(b, "time", 0);
    timed.burst.count = r.integer(b, "count", timed.burst.count, 2, 1 << 24);
    timed.burst.center = r.vector(b, "center");
    timed.burst.velocity = r.vector(b, "velocity");
    timed.burst.energy = r.number(b, "energy", 0);
    timed.burst.speed = r.number(b, "speed", timed.burst.speed);
    timed.burst.mass = double(def.mass);
    timed.burst.equal_speeds = r.flag(b, "equal_speeds", true);
    timed.burst.planar = D::dimension == 2;
    timed.burst.seed = std::uint64_t(r.integer(b, "seed", 1, 0, 0x7FFFFFFF));
    const float lifetime = float(r.number(b, "lifetime", 1e30));
    timed.lifetime = {lifetime, lifetime};
    if (r.failed()) return;
    if (b.has("energy") && b.has("speed")) return r.fail(*b.node, b.path, "found both energy and speed");
    if (!(lifetime > 0)) return r.expected(*b.find("lifetime"), b.path_of("lifetime"), "a time above zero");
    const auto tried = particles::burst_velocities(timed.burst);
    if (r.accept(tried.ok() ? core::Status{} : core::Status{tried.error()}, *b.node, b.path)) bursts.push_back(timed);
  });
  if (o.has("sub_emissions")) place.unresolved.push_back({o, list.size() - 1, r.variables});
}
template void read_particles(MatterPlace<rigid::Dim2>&, const Object&);
template void read_particles(MatterPlace<rigid::Dim3>&, const Object&);

template <class D>
void resolve_sub_emissions(MatterPlace<D>& place) {
  Reader& r = place.reader;
  auto& list = place.out.template of<D>().particles;
  for (const UnresolvedEmission& u : place.unresolved) {
    const auto before = std::exchange(r.variables, u.variables);
    each_entry(r, u.object, "sub_emissions", sub_emission_kind, [&](const Object& s) {
      SubEmissionRule rule;
      rule.at_death = r.choice(s, "on", 0) == 0;
      rule.into = int(u.system);
      if (s.has("into")) {
        const std::string into = r.text(s, "into");
        std::vector<std::string_view> known;
        int found = -1;
        for (std::size_t i = 0; i < list.size(); ++i) {
          known.push_back(list[i].name);
          if (list[i].name == into) found = int(i);
        }
        if (found < 0)
          return r.fail(*s.find("into"), s.path_of("into"),
                        "found " + quote(into) + ", expected the name of a system of particles" +
                            core::did_you_mean(into, known));
        rule.into = found;
      }
      Object e;
      if (s.has("emitter") && r.open(*s.find("emitter"), s.path_of("emitter"), emitter_kind, e))
        rule.emission.emitter = read_emitter(r, place.budget, e);
      rule.emission.count = r.integer(s, "count", rule.emission.count, 0, 1 << 16);
      rule.emission.chance = float(r.number(s, "chance", double(rule.emission.chance)));
      rule.emission.inherited = float(r.number(s, "inherited", double(rule.emission.inherited)));
      rule.emission.along_normal = r.flag(s, "along_normal", rule.emission.along_normal);
      if (r.failed()) return;
      // Tried once without an event, so that what is wrong is found before the scene runs.
      const auto tried = list[std::size_t(rule.into)].thing.system.emit_at({}, rule.emission);
      if (r.accept(tried.ok() ? core::Status{} : core::Status{tried.error()}, *s.node, s.path))
        list[u.system].thing.rules.push_back(std::move(rule));
    });
    r.variables = before;
  }
}
template void resolve_sub_emissions(MatterPlace<rigid::Dim2>&);
template void resolve_sub_emissions(MatterPlace<rigid::Dim3>&);

}  // namespace carom::scene::detail
