#include "carom/scene/detail/builder.h"

#include "carom/core/spelling.h"
#include "carom/scene/detail/characters.h"
#include "carom/scene/detail/destruction.h"
#include "carom/scene/detail/environment.h"
#include "carom/scene/detail/joints.h"
#include "carom/scene/detail/matter.h"
#include "carom/scene/detail/world_settings.h"

namespace carom::scene::detail {
namespace {
using namespace rigid;

std::unique_ptr<World2>& world_slot(SceneWorld& out, Dim2*) { return out.world2; }
std::unique_ptr<World3>& world_slot(SceneWorld& out, Dim3*) { return out.world3; }

bool read_mass_properties(Reader& reader, const Object& m, geometry::MassProperties2& out) {
  out.mass = reader.number(m, "mass", 0);
  const math::Vec3d center = reader.vector(m, "center");
  out.center = {center.x, center.y};
  out.inertia = reader.value(*m.find("inertia"), m.path_of("inertia"), Measure::inertia);
  return !reader.failed();
}
bool read_mass_properties(Reader& reader, const Object& m, geometry::MassProperties3& out) {
  out.mass = reader.number(m, "mass", 0);
  out.center = reader.vector(m, "center");
  const Node& list = *m.find("inertia");
  if (!list.is_array() || (list.children.size() != 3 && list.children.size() != 6)) {
    reader.expected(list, m.path_of("inertia"), "a list of three or six moments of inertia");
    return false;
  }
  double i[6] = {};
  for (std::size_t k = 0; k < list.children.size(); ++k)
    i[k] = reader.value(list.children[k], index_path(m.path_of("inertia"), k), Measure::inertia);
  out.inertia = {{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}};
  return !reader.failed();
}

MotionLocks read_locks(Reader& reader, const Object& o) {
  MotionLocks locks;
  const Node* list = o.find("locks");
  if (list == nullptr) return locks;
  static constexpr std::string_view names[] = {"x", "y", "z", "rotation_x", "rotation_y", "rotation_z"};
  bool* const flags[] = {&locks.x, &locks.y, &locks.z, &locks.rotation_x, &locks.rotation_y, &locks.rotation_z};
  if (!list->is_array()) reader.expected(*list, o.path_of("locks"), "a list such as [\"z\", \"rotation_x\"]");
  for (std::size_t i = 0; i < list->children.size() && !reader.failed(); ++i) {
    bool known = false;
    for (std::size_t k = 0; k < 6; ++k) {
      if (list->children[i].text != names[k]) continue;
      *flags[k] = known = true;
    }
    if (!known)
      reader.expected(list->children[i], index_path(o.path_of("locks"), i),
                      "x, y, z, rotation_x, rotation_y or rotation_z",
                      core::did_you_mean(list->children[i].text, names));
  }
  return locks;
}

/// What of a scene is in its world, in the order in which it is made.
constexpr const char* world_lists[] = {"bodies", "joints", "effectors", "characters"};

template <class D>
class Builder final : public BodyNames {
 public:
  Builder(Reader& reader, const Scene& scene, SceneWorld& out, bool update)
      : reader_(reader), document_(*scene.document), out_(out), update_(update) {
    for (const Node& part : document_.parts) {
      collect(part, "materials", library_.materials);
      collect(part, "shapes", library_.shapes);
    }
    if (!update) return;
    for (std::size_t i = 0; i < out_.bodies.size(); ++i) names_.emplace(out_.bodies[i].name, i);
  }

  bool run() {
    for (const char* what : world_lists) {
      what_ = what;
      next_ = 0;
      visit_parts();
      if (update_ && !reader_.failed()) check_count(what);
      if (reader_.failed()) return false;
      if (!update_ && what_ == "bodies") out_.listed_bodies = out_.bodies.size();
    }
    if (!make_matter() || !make_destruction()) return false;
    // Shapes and joints wake what they touch, so that sleepers are laid down when everything stands.
    for (const BodyId id : sleepers_)
      if (!reader_.accept(world().set_awake(id, false), document_.main(), "bodies")) return false;
    return true;
  }

  BodyId find_body(const Node& at, const std::string& path, const std::string& name) override {
    if (const auto found = names_.find(name); found != names_.end()) return out_.bodies[found->second].id;
    if (name == "world") {
      BodyDef<D> def;
      def.type = BodyType::fixed;
      def.name = "world";
      const Result<BodyId> body = world().create_body(def);
      if (!reader_.accept(body.ok() ? Status{} : Status{body.error()}, at, path)) return {};
      names_.emplace(name, out_.bodies.size());
      out_.bodies.push_back({name, *body, 0, false});
      return *body;
    }
    std::vector<std::string_view> known;
    for (const auto& entry : names_) known.push_back(entry.first);
    reader_.fail(at, path, "found " + quote(name) + ", expected the name of a body" + core::did_you_mean(name, known));
    return {};
  }

 private:
  static constexpr D* tag = nullptr;
  World<D>& world() { return *world_slot(out_, tag); }

  void collect(const Node& part, const char* key,
               std::map<std::string, std::pair<const Node*, std::string>, std::less<>>& into) {
    const Node* map = part.find(key);
    if (map == nullptr) return;
    if (!map->is_object()) return reader_.expected(*map, key, "an object of names");
    for (std::size_t i = 0; i < map->keys.size(); ++i)
      into[map->keys[i]] = {&map->children[i], std::string(key) + "." + map->keys[i]};
  }

  static constexpr const char* lists[] = {"bodies",     "joints",      "effectors", "characters", "ropes",
                                          "cloths",     "soft_bodies", "liquids",   "grains",     "particles",
                                          "structures", "explosions",  "guns",      "rockets",    "shells"};
  void visit_parts() {
    for (const Node& part : document_.parts)
      for (const char* list : lists)
        if (const Node* node = part.find(list)) visit(*node, list, list);
  }
  /// Ropes and so on, after the bodies that hold them; what runs already stays as it is.
  [[gnu::noinline]] bool make_matter() {
    std::shared_ptr<const environment::Environment> around = environment_of(world(), out_.environment);
    if (!update_) {
      auto made = std::make_unique<Matter>();
      MatterPlace<D> place{reader_, *this, world(), *made, 10.0 * document_.maximum_objects, {}};
      matter_ = &place;
      for (const char* what : matter_lists) {
        what_ = what;
        visit_parts();
        if (reader_.failed()) return false;
      }
      matter_ = nullptr;
      resolve_sub_emissions(place);
      if (reader_.failed()) return false;
      if (!made->names().empty()) out_.matter = std::move(made);
    }
    return out_.matter == nullptr || reader_.accept(out_.matter->set_wind(around.get()), document_.main(), "particles");
  }

  /// Structures first, so that guns may aim at them. What runs already stays as it is.
  [[gnu::noinline]] bool make_destruction() {
    const std::shared_ptr<const environment::Environment> around = environment_of(world(), out_.environment);
    if (update_) {
      if (out_.destruction != nullptr) renew_air(*out_.destruction, world(), around);
      return true;
    }
    auto made = std::make_unique<Destruction>();
    for (const Node& part : document_.parts)
      if (!read_penetration<D>(reader_, part, made->of<D>().hits)) return false;
    DestructionPlace<D> place{reader_, *this, world(), *made, out_, library_, around, 10.0 * document_.maximum_objects};
    destruction_ = &place;
    for (const char* what : destruction_lists) {
      what_ = what;
      visit_parts();
      if (reader_.failed()) return false;
      for (std::size_t i = names_.size(); i < out_.bodies.size(); ++i) names_.emplace(out_.bodies[i].name, i);
    }
    destruction_ = nullptr;
    if (!made->names().empty()) out_.destruction = std::move(made);
    return true;
  }

  void visit(const Node& list, std::string_view key, const std::string& path) {
    if (reader_.failed()) return;
    if (!list.is_array()) return reader_.expected(list, path, "a list");
    for (std::size_t i = 0; i < list.children.size() && !reader_.failed(); ++i) {
      const Node& node = list.children[i];
      if (node.is_object() && node.find("repeat") != nullptr)
        group(node, index_path(path, i));
      else if (key == what_)
        make(node, index_path(path, i));
    }
  }

  void group(const Node& node, const std::string& path) {
    Object o;
    if (!reader_.open(node, path, *tables().group, o)) return;
    const Node& loops = *o.find("repeat");
    if (!loops.is_object() || loops.children.empty() || loops.children.size() > 4)
      return reader_.expected(loops, o.path_of("repeat"), "an object of one to four counts such as {\"i\": 10}");
    for (const std::string& name : loops.keys) {
      bool good = !name.empty() && !(name[0] >= '0' && name[0] <= '9');
      for (const char c : name)
        good = good && ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_');
      if (!good)
        return reader_.fail(loops, o.path_of("repeat"),
                            "found the name " + quote(name) + ", expected letters, digits and _");
    }
    loop(o, loops, 0);
  }

  void loop(const Object& o, const Node& loops, std::size_t depth) {
    if (reader_.failed()) return;
    if (depth == loops.children.size()) {
      if (++turns_ > document_.maximum_objects)
        return reader_.fail(loops, o.path_of("repeat"),
                            "found more than " + std::to_string(document_.maximum_objects) + " turns");
      if (!reader_.wanted(o)) return;
      for (const char* list : lists)
        if (const Node* inner = o.find(list)) visit(*inner, list, o.path_of(list));
      return;
    }
    const std::string path = o.path_of("repeat") + "." + loops.keys[depth];
    const double count = math::max(reader_.value(loops.children[depth], path, Measure::plain), 0.0);
    if (reader_.failed()) return;
    if (!(count <= 1e6) || count != __builtin_floor(count))
      return reader_.expected(loops.children[depth], path, "a whole number of turns up to a million");
    reader_.variables.push_back({loops.keys[depth], 0, Dimension{}});
    for (int i = 0; i < int(count) && !reader_.failed(); ++i) {
      reader_.variables.back().value = i;
      loop(o, loops, depth + 1);
    }
    reader_.variables.pop_back();
  }

  // What reads the parts of a scene is not drawn into one function, here and below: in the page a part of the engine
  // comes when it is first called, and a scene without guns should not wait for what reads them.
  void make(const Node& node, const std::string& path) {
    if (++made_ > document_.maximum_objects)
      return reader_.fail(
          node, path,
          "found more than " + std::to_string(document_.maximum_objects) + " bodies, shapes, joints and effectors");
    if (matter_ != nullptr) return read_matter(*matter_, what_, node, path);
    if (destruction_ != nullptr) return read_destruction(*destruction_, what_, node, path);
    if (what_ == "bodies")
      body(node, path);
    else if (what_ == "joints")
      joint(node, path);
    else if (what_ == "effectors")
      effector(node, path);
    else
      character(node, path);
  }

  void check_count(std::string_view what) {
    const std::size_t had = what == "bodies"      ? out_.listed_bodies
                            : what == "joints"    ? out_.joints.size()
                            : what == "effectors" ? out_.effectors.size()
                                                  : out_.characters.size();
    if (next_ != had) count_changed(what);
  }
  void count_changed(std::string_view what) {
    reader_.fail(document_.main(), what,
                 "this value changes how many " + std::string(what) + " there are: restart the scene");
  }

  /// Tiles have several outlines, concave polygons several parts: each is a shape of its own.
  void spread(std::vector<ReadShape<D>>& shapes) {
    const std::vector<typename D::Shape> more = std::move(shapes.back().more);
    for (const typename D::Shape& shape : more) {
      ReadShape<D> next = shapes.back();
      next.shape = shape;
      next.more.clear();
      shapes.push_back(std::move(next));
    }
  }

  bool read_shapes(const Object& o, std::vector<ReadShape<D>>& out) {
    SurfaceDefaults defaults = read_surface(reader_, library_, o, {});
    const bool body_density = o.has("density");
    if (o.has("shape")) {
      out.emplace_back();
      if (!read_shape<D>(reader_, library_, *o.find("shape"), o.path_of("shape"), defaults, out.back())) return false;
      spread(out);
    }
    if (const Node* list = o.find("shapes")) {
      const std::string path = o.path_of("shapes");
      if (!list->is_array()) return reader_.expected(*list, path, "a list of shapes"), false;
      for (std::size_t i = 0; i < list->children.size(); ++i) {
        if (++made_ > document_.maximum_objects)
          return reader_.fail(*list, path,
                              "found more than " + std::to_string(document_.maximum_objects) +
                                  " bodies, shapes, joints and effectors"),
                 false;
        out.emplace_back();
        if (!read_shape<D>(reader_, library_, list->children[i], index_path(path, i), defaults, out.back()))
          return false;
        spread(out);
      }
    }
    if (!o.has("mass")) return !reader_.failed();
    const double mass = reader_.number(o, "mass", 0);
    if (body_density && !reader_.failed())
      reader_.fail(*o.find("mass"), o.path_of("mass"), "found both mass and density, expected one of them");
    double total = 0;
    for (const ReadShape<D>& s : out)
      if (!s.definition.sensor) total += geometry::mass_properties(s.shape, double(s.definition.density)).mass;
    if (!reader_.failed() && !(total > 0))
      reader_.fail(*o.find("mass"), o.path_of("mass"), "the body has no shape with a volume to carry its mass");
    for (ReadShape<D>& s : out) s.definition.density = float(s.definition.density * (mass / total));
    return !reader_.failed();
  }

  [[gnu::noinline]] void body(const Node& node, const std::string& path) {
    Object o;
    if (!reader_.open(node, path, *tables().body, o) || !reader_.wanted(o)) return;
    std::vector<ReadShape<D>> shapes;
    BodyDef<D> def;
    constexpr BodyType types[] = {BodyType::fixed, BodyType::kinematic, BodyType::dynamic};
    def.type = types[reader_.choice(o, "type", 2)];
    def.linear_damping = float(reader_.number(o, "linear_damping", 0));
    def.angular_damping = float(reader_.number(o, "angular_damping", 0));
    def.gravity_scale = float(reader_.number(o, "gravity_scale", 1));
    def.time_scale = float(reader_.number(o, "time_scale", 1));
    def.linear_velocity = vector_for(reader_.vector(o, "velocity"), tag);
    def.angular_velocity = angular_for(reader_.angular(o, "angular_velocity"), tag);
    if (!read_shapes(o, shapes)) return;
    if (update_) return update_body(o, def, shapes);

    def.position = position_of(reader_.vector(o, "position"), tag);
    def.rotation = rotation_for(reader_, o, "rotation", tag);
    def.sleep_speed = float(reader_.number(o, "sleep_speed", def.sleep_speed));
    def.substeps = reader_.integer(o, "substeps", def.substeps, 0, 64);
    def.locks = read_locks(reader_, o);
    def.awake = reader_.flag(o, "awake", true);
    def.allow_sleep = reader_.flag(o, "allow_sleep", true);
    def.bullet = reader_.flag(o, "bullet", false);
    def.enabled = reader_.flag(o, "enabled", true);
    def.user_data = reader_.bits(o, "user_data", 0);
    std::string name = reader_.text(o, "name");
    const auto color = reader_.color(o, "color");
    const bool trail = reader_.flag(o, "trail", false);
    if (reader_.failed()) return;
    if (name.empty()) {
      name = "body_" + std::to_string(out_.bodies.size());
      while (names_.count(name) != 0) name += "_";
    } else if (names_.count(name) != 0) {
      return reader_.fail(*o.find("name"), o.path_of("name"),
                          "found the name " + quote(name) + " a second time, expected one that no body has");
    }
    def.name = name;
    const Result<BodyId> id = world().create_body(def);
    if (!reader_.accept(id.ok() ? Status{} : Status{id.error()}, node, path)) return;
    for (const ReadShape<D>& s : shapes) {
      const Result<ShapeId> shape = world().add_shape(*id, s.shape, s.definition);
      if (!reader_.accept(shape.ok() ? Status{} : Status{shape.error()}, node, path)) return;
    }
    Object m;
    if (o.has("mass_properties") &&
        reader_.open(*o.find("mass_properties"), o.path_of("mass_properties"), *tables().mass_properties, m)) {
      typename D::MassProperties properties;
      if (!read_mass_properties(reader_, m, properties) ||
          !reader_.accept(world().set_mass_properties(*id, properties), *m.node, m.path))
        return;
    }
    // Shapes move the centre of mass, and with it what the velocity is the velocity of.
    if (def.type != BodyType::fixed && !(def.angular_velocity == typename D::Angular{}) &&
        !reader_.accept(world().set_velocity(*id, def.linear_velocity, def.angular_velocity), node, path))
      return;
    if (!def.awake) sleepers_.push_back(*id);
    names_.emplace(name, out_.bodies.size());
    out_.bodies.push_back({std::move(name), *id, color.value_or(0), color.has_value(), trail});
  }

  [[gnu::noinline]] void update_body(const Object& o, const BodyDef<D>& def, const std::vector<ReadShape<D>>& shapes) {
    if (next_ >= out_.bodies.size()) return count_changed("bodies");
    const BodyId id = out_.bodies[next_++].id;
    std::vector<ShapeId> ids;
    world().shapes(id, ids);
    if (!reader_.accept(world().set_damping(id, def.linear_damping, def.angular_damping), *o.node, o.path)) return;
    if (!reader_.accept(world().set_gravity_scale(id, def.gravity_scale), *o.node, o.path)) return;
    if (!reader_.accept(world().set_time_scale(id, def.time_scale), *o.node, o.path)) return;
    if (!reader_.accept(world().set_substeps(id, def.substeps), *o.node, o.path)) return;
    if (def.type == BodyType::kinematic &&
        !reader_.accept(world().set_velocity(id, def.linear_velocity, def.angular_velocity), *o.node, o.path))
      return;
    for (std::size_t i = 0; i < ids.size() && i < shapes.size(); ++i) {
      const auto now = world().shape_definition(ids[i]);
      const std::vector<SurfaceMaterial<D>>& surfaces = shapes[i].definition.surfaces;
      for (std::size_t k = 0; now.ok() && k < surfaces.size() && k < now->surfaces.size(); ++k)
        if (!(surfaces[k] == now->surfaces[k]) &&
            !reader_.accept(world().set_surface(ids[i], int(k), surfaces[k]), *o.node, o.path))
          return;
      if (now.ok() && now->material == shapes[i].definition.material) continue;
      if (!reader_.accept(world().set_material(ids[i], shapes[i].definition.material), *o.node, o.path)) return;
    }
  }

  [[gnu::noinline]] void joint(const Node& node, const std::string& path) {
    Object o;
    if (!reader_.open(node, path, *tables().joint, o) || !reader_.wanted(o)) return;
    ReadJoint<D> joint;
    if (!read_joint<D>(reader_, *this, world(), o, joint)) return;
    if (update_) {
      if (next_ >= out_.joints.size()) return count_changed("joints");
      const JointId id = out_.joints[next_++].id;
      if (joint.has_spring && !reader_.accept(world().set_spring(id, joint.spring), node, path)) return;
      if (joint.has_limit && !reader_.accept(world().set_limit(id, joint.limit), node, path)) return;
      if (joint.has_motor) reader_.accept(world().set_motor(id, joint.motor), node, path);
      return;
    }
    const Result<JointId> id = std::visit([&](const auto& d) { return world().create_joint(d); }, joint.definition);
    if (!reader_.accept(id.ok() ? Status{} : Status{id.error()}, node, path)) return;
    std::string name = reader_.text(o, "name");
    if (name.empty()) name = "joint_" + std::to_string(out_.joints.size());
    out_.joints.push_back({std::move(name), *id});
  }

  [[gnu::noinline]] void effector(const Node& node, const std::string& path) {
    Object o;
    if (!reader_.open(node, path, *tables().effector, o) || !reader_.wanted(o)) return;
    EffectorDef<D> def;
    if (!read_effector<D>(reader_, *this, o, update_ ? nullptr : &world(), def)) return;
    if (update_) {
      if (next_ >= out_.effectors.size()) return count_changed("effectors");
      reader_.accept(world().set_effector(out_.effectors[next_++].id, def), node, path);
      return;
    }
    const Result<EffectorId> id = world().add_effector(def);
    if (!reader_.accept(id.ok() ? Status{} : Status{id.error()}, node, path)) return;
    std::string name = reader_.text(o, "name");
    if (name.empty()) name = "effector_" + std::to_string(out_.effectors.size());
    out_.effectors.push_back({std::move(name), *id});
  }

  [[gnu::noinline]] void character(const Node& node, const std::string& path) {
    Object o;
    if (!reader_.open(node, path, *tables().character, o) || !reader_.wanted(o)) return;
    const math::Vec3d velocity = reader_.vector(o, "velocity");
    if (update_) {
      if (next_ >= out_.characters.size()) return count_changed("characters");
      out_.characters[next_++].velocity = velocity;
      return;
    }
    std::string name = reader_.text(o, "name");
    if (name.empty()) name = "character_" + std::to_string(out_.characters.size());
    if (names_.count(name) != 0)
      return reader_.fail(node, path, "found the name " + quote(name) + " a second time, expected one that nobody has");
    SceneCharacter made;
    if (!read_character<D>(reader_, o, world(), made)) return;
    made.name = name, made.velocity = velocity;
    const auto color = reader_.color(o, "color");
    const bool trail = reader_.flag(o, "trail", false);
    names_.emplace(name, out_.bodies.size());
    out_.bodies.push_back({std::move(name), made.body, color.value_or(0), color.has_value(), trail});
    out_.characters.push_back(std::move(made));
  }

  Reader& reader_;
  const SceneDocument& document_;
  SceneWorld& out_;
  bool update_;
  Library library_;
  std::map<std::string, std::size_t, std::less<>> names_;
  std::vector<BodyId> sleepers_;
  std::string_view what_;
  MatterPlace<D>* matter_ = nullptr;            ///< while matter is made
  DestructionPlace<D>* destruction_ = nullptr;  ///< likewise
  std::size_t next_ = 0;
  int turns_ = 0, made_ = 0;
};

template <class D>
bool build(Reader& reader, const Scene& scene, const Object& o, const InstantiateOptions& options, SceneWorld& out) {
  WorldDef<D> def;
  if (!read_world<D>(reader, o, options, def)) return false;
  world_slot(out, static_cast<D*>(nullptr)) = std::make_unique<World<D>>(def);
  if (!read_material_pairs(reader, o, *world_slot(out, static_cast<D*>(nullptr)))) return false;
  if (o.has("environment")) {
    auto around = read_environment(reader, o);
    if (around == nullptr) return false;
    const Result<EffectorId> id =
        world_slot(out, static_cast<D*>(nullptr))->add_effector(Surroundings<D>{std::move(around)});
    if (!reader.accept(id.ok() ? Status{} : Status{id.error()}, *o.find("environment"), "environment")) return false;
    out.environment = *id;
  }
  return Builder<D>(reader, scene, out, false).run();
}
template <class D>
bool update(Reader& reader, const Scene& scene, const Object& o, SceneWorld& out) {
  World<D>& world = *world_slot(out, static_cast<D*>(nullptr));
  if (o.has("gravity")) {
    const auto gravity = vector_for(reader.vector(o, "gravity"), static_cast<D*>(nullptr));
    if (reader.failed() || !reader.accept(world.set_gravity(gravity), *o.find("gravity"), "gravity")) return false;
  }
  if (o.has("environment")) {
    auto around = read_environment(reader, o);
    if (around == nullptr || !reader.accept(world.set_effector(out.environment, Surroundings<D>{std::move(around)}),
                                            *o.find("environment"), "environment"))
      return false;
  }
  return Builder<D>(reader, scene, out, true).run();
}

}  // namespace

core::Status set_variables(Reader& reader, const Scene& scene, std::span<const ParameterValue> values) {
  reader.variables.clear();
  for (std::size_t i = 0; i < scene.parameters.size(); ++i)
    reader.variables.push_back(
        {scene.parameters[i].name, scene.parameters[i].value, scene.document->parameter_dimensions[i]});
  for (const ParameterValue& v : values) {
    bool known = false;
    for (std::size_t i = 0; i < scene.parameters.size(); ++i) {
      const Parameter& p = scene.parameters[i];
      if (p.name != v.name) continue;
      known = true;
      if (!math::is_finite(v.value) || v.value < p.minimum || v.value > p.maximum)
        return core::Error{scene.file + ": parameter " + p.name + ": found " + shortest(v.value / p.display_scale) +
                           ", expected " + shortest(p.minimum / p.display_scale) + " to " +
                           shortest(p.maximum / p.display_scale) +
                           (p.display_unit.empty() ? "" : " " + p.display_unit)};
      reader.variables[i].value = v.value;
    }
    if (known) continue;
    std::vector<std::string_view> names;
    for (const Parameter& p : scene.parameters) names.push_back(p.name);
    return core::Error{scene.file + ": found no parameter " + quote(v.name) + core::did_you_mean(v.name, names)};
  }
  return {};
}

bool build_world(Reader& reader, const Scene& scene, const InstantiateOptions& options, SceneWorld& out) {
  Object o;
  if (!reader.open(scene.document->main(), "", *tables().scene, o)) return false;
  out.kind = Kind::rigid;
  out.dimension = scene.dimension;
  out.dt = reader.number(o, "step", 1.0 / 60);
  reader.step = out.dt;
  out.duration = reader.number(o, "duration", 10);
  return scene.dimension == 2 ? build<Dim2>(reader, scene, o, options, out)
                              : build<Dim3>(reader, scene, o, options, out);
}

bool update_world(Reader& reader, const Scene& scene, SceneWorld& world) {
  Object o;
  if (!reader.open(scene.document->main(), "", *tables().scene, o)) return false;
  reader.step = world.dt;
  return scene.dimension == 2 ? update<Dim2>(reader, scene, o, world) : update<Dim3>(reader, scene, o, world);
}

}  // namespace carom::scene::detail
