#include "carom/scene/detail/world_settings.h"

#include "carom/core/spelling.h"
#include "carom/core/string.h"
#include "carom/forces/friction_table.h"
#include "carom/scene/detail/joints.h"

namespace carom::scene::detail {
using namespace rigid;

template <class D>
bool read_world(Reader& reader, const Object& scene, const InstantiateOptions& options, WorldDef<D>& def) {
  def.threads = options.threads;
  def.scheduler = options.scheduler;
  def.profiler = options.profiler;
  if (scene.has("gravity")) def.gravity = vector_for(reader.vector(scene, "gravity"), static_cast<D*>(nullptr));
  def.substeps = reader.integer(scene, "substeps", def.substeps, 1, 64);
  Object w;
  if (scene.has("world") && reader.open(*scene.find("world"), "world", *tables().world, w)) {
    def.restitution_threshold = float(reader.number(w, "restitution_threshold", def.restitution_threshold));
    def.contact_hertz = float(reader.number(w, "contact_frequency", def.contact_hertz));
    def.contact_damping_ratio = float(reader.number(w, "contact_damping_ratio", def.contact_damping_ratio));
    def.contact_push_speed = float(reader.number(w, "contact_push_speed", def.contact_push_speed));
    def.joint_hertz = float(reader.number(w, "joint_frequency", def.joint_hertz));
    def.joint_damping_ratio = float(reader.number(w, "joint_damping_ratio", def.joint_damping_ratio));
    def.joint_solver = JointSolver(reader.choice(w, "joint_solver", int(def.joint_solver)));
    def.maximum_linear_speed = float(reader.number(w, "maximum_linear_speed", def.maximum_linear_speed));
    def.sleep_time = float(reader.number(w, "sleep_time", def.sleep_time));
    def.allow_sleep = reader.flag(w, "allow_sleep", def.allow_sleep);
    def.continuous = reader.flag(w, "continuous", def.continuous);
  }
  return !reader.failed() && reader.accept(World<D>::check(def), *scene.node, "world");
}

namespace {

/// A pair that the table of friction has, or an error that names a near one.
forces::PairFriction known_pair(Reader& reader, const Object& o) {
  const std::string pair = reader.text(o, "pair");
  std::vector<std::string> names;
  for (const forces::PairFriction& known : forces::friction_table()) {
    for (const bool turned : {false, true}) {
      const std::string_view a = turned ? known.second : known.first, b = turned ? known.first : known.second;
      names.push_back(core::text(a, " on ", b));
      if (names.back() == pair) return known;
    }
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  reader.expected(*o.find("pair"), o.path_of("pair"), "a pair of the table of friction, as \"rubber on ice\"",
                  core::did_you_mean(pair, known));
  return {};
}

}  // namespace

template <class D>
bool read_material_pairs(Reader& reader, const Object& scene, World<D>& world) {
  const Node* settings = scene.find("world");
  const Node* list = settings != nullptr ? settings->find("material_pairs") : nullptr;
  if (list == nullptr) return true;
  const std::string path = "world.material_pairs";
  if (!list->is_array()) return reader.expected(*list, path, "a list"), false;
  for (std::size_t i = 0; i < list->children.size() && !reader.failed(); ++i) {
    Object o;
    if (!reader.open(list->children[i], index_path(path, i), *tables().material_pair, o)) return false;
    const Node& ids = *o.find("materials");
    if (!ids.is_array() || ids.children.size() != 2)
      return reader.expected(ids, o.path_of("materials"), "the user_ids of two materials"), false;
    std::uint32_t id[2] = {};
    for (std::size_t k = 0; k < 2; ++k) {
      const double x = reader.value(ids.children[k], index_path(o.path_of("materials"), k), Measure::plain);
      if (!(x >= 0 && x <= 0xFFFFFFFF && x == double(std::uint32_t(x))))
        return reader.expected(ids.children[k], index_path(o.path_of("materials"), k), "a whole number"), false;
      id[k] = std::uint32_t(x);
    }
    PairRule rule;
    if (o.has("pair")) {
      const forces::PairFriction known = known_pair(reader, o);
      rule.friction = float(known.kinetic_coefficient);
      // A friction of one's own stands for both, unless that of rest is given too.
      if (!o.has("friction") && known.static_coefficient > known.kinetic_coefficient)
        rule.static_friction = float(known.static_coefficient);
    }
    rule.friction = float(reader.number(o, "friction", rule.friction));
    rule.static_friction = float(reader.number(o, "static_friction", rule.static_friction));
    rule.restitution = float(reader.number(o, "restitution", rule.restitution));
    rule.rolling_resistance = float(reader.number(o, "rolling_resistance", rule.rolling_resistance));
    rule.spinning_resistance = float(reader.number(o, "spinning_resistance", rule.spinning_resistance));
    if (reader.failed() || !reader.accept(world.set_pair_rule(id[0], id[1], &rule), *o.node, o.path)) return false;
  }
  return !reader.failed();
}

template bool read_world<Dim2>(Reader&, const Object&, const InstantiateOptions&, WorldDef<Dim2>&);
template bool read_world<Dim3>(Reader&, const Object&, const InstantiateOptions&, WorldDef<Dim3>&);
template bool read_material_pairs<Dim2>(Reader&, const Object&, World<Dim2>&);
template bool read_material_pairs<Dim3>(Reader&, const Object&, World<Dim3>&);

}  // namespace carom::scene::detail
