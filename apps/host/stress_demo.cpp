#include "apps/host/stress_demo.h"

#include <algorithm>

#include "apps/host/demos/demos.h"
#include "benchmarks/scene.h"

namespace carom::host {

namespace {

using bench::SceneInfo;

/// A page holds no million bodies.
bool showable(const SceneInfo& info) {
  const std::string_view name = info.name;
  return (info.make2 != nullptr || info.make3 != nullptr) && name != "large_world";
}

std::string id_of(const SceneInfo& info) {
  std::string id = std::string(info.suite) + "-" + info.name;
  std::replace(id.begin(), id.end(), '_', '-');
  return id;
}

std::string title_of(const SceneInfo& info) {
  std::string title = info.name;
  std::replace(title.begin(), title.end(), '_', ' ');
  title[0] = char(title[0] - 'a' + 'A');
  return title + (info.dimension() == 2 ? ", 2D" : ", 3D");
}

/// Whose benchmark the suite is.
std::string suite_title(std::string_view suite) {
  if (suite == "box3d") return "Box3D";
  if (suite == "box2d") return "Box2D";
  if (suite == "jolt") return "Jolt";
  return "common";
}

/// What is in it, in a sentence.
const char* what_of(const SceneInfo& info) {
  struct What {
    const char *path, *text;
  };
  static constexpr What all[] = {
      {"common/twenty_pyramids", "Twenty pyramids of 55 cubes side by side; nothing may sleep."},
      {"common/heap", "2 000 cubes, balls and capsules fall into a walled pit; nothing may sleep."},
      {"box3d/convex_pile", "5 120 hulls of 32 points drop in a block of 8 by 8 columns."},
      {"box3d/joint_grid", "A net of 10 000 balls on 19 701 ball joints hangs from its upper edge."},
      {"box3d/junkyard", "10 584 rocks fall into a yard in which a pillar goes round."},
      {"box3d/large_pyramid", "5 050 cubes in one pyramid of a hundred rows."},
      {"box3d/many_pyramids", "196 pyramids of 55 cubes each, side by side on one floor."},
      {"box3d/rain", "Ragdolls of fourteen bodies rain on a hundred grids with a torus each."},
      {"box3d/trees25", "Fifty trunks of 22 prisms fall over on a wavy mesh, four cells of it a metre."},
      {"box3d/trees50", "Fifty trunks of 22 prisms fall over on a wavy mesh, two cells of it a metre."},
      {"box3d/trees100", "Fifty trunks of 22 prisms fall over on a wavy mesh, one cell of it a metre."},
      {"box3d/washer", "8 000 cubes in a turning drum with four paddles."},
      {"box3d/wide_pyramid", "A pyramid on a square base: 1 240 cubes in fifteen layers that fall onto each other."},
      {"box2d/compounds", "3 000 bodies of two triangles each fall into a bin."},
      {"box2d/joint_grid", "A net of 10 000 discs on hinges hangs from seven of them."},
      {"box2d/junkyard", "8 000 pentagons on a floor that a box sweeps."},
      {"box2d/large_pyramid", "5 050 boxes in one pyramid of a hundred rows."},
      {"box2d/many_pyramids", "400 pyramids of 55 boxes, one floor above another."},
      {"box2d/rain", "Ragdolls of eleven bodies rain on five grounds of small boxes."},
      {"box2d/smash", "A block of 9 600 sleeping boxes is hit by a big one, without gravity."},
      {"box2d/spinner", "A rounded bar of 40 m turns in a ring full of small bodies."},
      {"box2d/tumbler", "2 025 small boxes in a box that a motor turns."},
      {"box2d/washer", "8 100 small boxes in a turning ring with four paddles."},
      {"jolt/pyramid", "A pyramid on a square base: 1 240 cubes of 8 t in fifteen layers."},
      {"jolt/convex_vs_mesh", "1 764 boxes, spheres, capsules and small hulls drop onto a wavy mesh."},
      {"jolt/high_speed", "5 000 bodies at 250 m/s in a hollow cube of thin walls."},
      {"jolt/character_virtual", "A hundred characters walk to and fro over a wavy mesh with stairs and pillars."},
      {"jolt/ragdoll", "160 humanoids of 23 parts in sixteen piles, held in a pose by motors."},
      {"jolt/ragdoll_single_pile", "160 humanoids of 23 parts in one pile, held in a pose by motors."},
      {"jolt/large_mesh_500", "4 410 boxes drop onto a mountainous mesh of half a million triangles."},
      {"jolt/large_mesh_1000", "4 410 boxes drop onto a mountainous mesh of two million triangles."},
  };
  const std::string path = info.path();
  for (const What& what : all)
    if (path == what.path) return what.text;
  return "";
}

Declaration declaration_of(const SceneInfo& info) {
  Declaration d;
  const std::string peer = suite_title(info.suite);
  d.id = id_of(info);
  d.title = title_of(info);
  d.summary = what_of(info);
  if (d.summary.empty()) d.summary = "A benchmark scene.";
  d.group = peer == "common" ? "Stress: common scenes" : "Stress: scenes of " + peer;
  d.dimension = info.dimension();
  d.text =
      (peer == "common" ? "A benchmark scene that every engine can build. "
                        : "A benchmark scene of " + peer + ", rebuilt from its recipe. ") +
      "The same bodies, masses, friction and steps of 1/60 s as `carom bench " + info.path() +
      "` times, and as docs/benchmarks.md compares with other engines. The plot shows how long a step takes now, and "
      "in which stage; the page and this machine's other work are in those numbers.\n\nThe ids of bodies and the order "
      "of everything are fixed, so the state hash below is the same for any number of threads.";
  if (info.missing != nullptr) d.text += std::string("\n\n") + info.missing;
  d.duration = info.steps / 60.0;
  d.parameters = {
      yes_or_no("sleep", "Sleep", "what has come to rest costs nothing any more; some benchmarks forbid it", true)};
  d.plots = {
      {"Time of a step", {"time", "s"}, {"time", "ms"}, {{"whole step"}, {"solve"}, {"narrow phase"}, {"broad phase"}}},
      {"What is awake", {"time", "s"}, {"count", ""}, {{"bodies"}, {"touching contacts"}}}};
  return d;
}

template <class D>
bench::SceneMaker<D> maker_of(const SceneInfo& info) {
  if constexpr (D::dimension == 2)
    return info.make2;
  else
    return info.make3;
}

template <class D>
class StressDemo final : public DemoOf<D> {
 public:
  explicit StressDemo(const SceneInfo& info) : info_(info) {}

  Declaration declaration() const override { return declaration_of(info_); }
  std::unique_ptr<Demo> again() const override { return std::make_unique<StressDemo<D>>(info_); }

  void build(Stage<D>& stage) override {
    scene_ = maker_of<D>(info_)();
    rigid::WorldDef<D> world;
    bench::define_suite<D>(info_.suite, world);
    scene_->define(world);
    world.allow_sleep = stage.value("sleep") > 0.5;
    stage.start(world);
    scene_->build(stage.world());
    stage.adopt_all(false);
    frame(stage);
  }

  void before_step(Stage<D>& stage) override { scene_->before_step(stage.world(), int(stage.world().step_count())); }

  void after_step(Stage<D>& stage) override {
    stage.adopt_all();
    const double t = stage.world().time();
    const rigid::StepProfile p = stage.world().profile();
    stage.sample(0, 0, t, p.total);
    stage.sample(0, 1, t, p.solve);
    stage.sample(0, 2, t, p.narrow_phase);
    stage.sample(0, 3, t, p.broad_phase);
    const rigid::Counters c = stage.world().counters();
    stage.sample(1, 0, t, c.awake_bodies);
    stage.sample(1, 1, t, c.touching_contacts);
  }

 private:
  /// Looks at everything that moves, and down to the ground; where it is yet to come, at what waits for it.
  void frame(Stage<D>& stage) {
    Box moving, waiting;
    std::vector<rigid::ShapeId> shapes;
    for (const auto& actor : stage.actors()) {
      const auto s = stage.at(actor.body);
      if (s.type != rigid::BodyType::fixed) {
        moving.add(in_space(s.center_of_mass));
        continue;
      }
      stage.world().shapes(actor.body, shapes);
      for (const rigid::ShapeId shape : shapes)
        if (const auto definition = stage.world().shape_definition(shape); definition.ok())
          waiting.add(in_space(world_point(s.pose, middle_of(stage, shape, definition->local))));
      if constexpr (D::dimension == 3) surroundings(stage, actor.body, s, shapes);
      shapes.clear();
    }
    Box seen = moving.empty() ? waiting : moving;
    seen.add({seen.low.x, 0, seen.low.z});
    const math::Vec3d middle = 0.5 * (seen.low + seen.high), size = seen.high - seen.low;
    Camera camera;
    camera.target = middle;
    if constexpr (D::dimension == 2) {
      camera.height = 1.15 * size.y + 4;
      camera.width = moving.empty() ? camera.height : 1.1 * size.x + 4;
    } else {
      const double reach = math::clamp(math::max(math::max(size.x, size.z), 1.3 * size.y), 6.0, 160.0);
      camera.position = middle + math::Vec3d{0.5, 0.35, 1.0} * reach;
      camera.field_of_view = 0.8;
    }
    stage.set_camera(camera);
  }

  /// Where about a shape lies in its body: a polygon need not hold its origin.
  static typename D::Vector middle_of(Stage<D>& stage, rigid::ShapeId shape, const typename D::Transform& local) {
    if constexpr (D::dimension == 2)
      if (const auto g = stage.world().shape_geometry(shape); g.ok() && g->type == geometry::ShapeType2::polygon)
        return transform_point(local, g->polygon.vertices[0]);
    return local.p;
  }

  /// A wide box whose top is at zero gets scale marks; walls let one look in.
  static void surroundings(Stage<D>& stage, rigid::BodyId body, const rigid::BodyState<D>& state,
                           const std::vector<rigid::ShapeId>& shapes) {
    for (const rigid::ShapeId shape : shapes) {
      const auto g = stage.world().shape_geometry(shape);
      if constexpr (D::dimension == 3) {
        if (!g.ok() || g->type != geometry::ShapeType3::box) continue;
        const math::Vec3f half = g->box.half_extents;
        if (half.y > 3) stage.set_color(body, 0x388d99a6);
        if (half.x > 30 && math::abs(state.pose.position.y + double(half.y)) < 1e-3) stage.set_ground(0.02);
      }
    }
  }

  struct Box {
    math::Vec3d low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
    bool empty() const { return low.x > high.x; }
    void add(math::Vec3d p) {
      low = math::min(low, p);
      high = math::max(high, p);
    }
  };

  const SceneInfo& info_;
  std::unique_ptr<bench::Scene<D>> scene_;
};

std::unique_ptr<Demo> make(const SceneInfo& info) {
  if (info.dimension() == 2) return std::make_unique<StressDemo<rigid::Dim2>>(info);
  return std::make_unique<StressDemo<rigid::Dim3>>(info);
}

}  // namespace

std::vector<std::unique_ptr<Demo>> stress_demos() {
  std::vector<std::unique_ptr<Demo>> out;
  for (const SceneInfo& info : bench::all_scenes())
    if (showable(info)) out.push_back(make(info));
  return out;
}

std::unique_ptr<Demo> make_stress_demo(std::string_view id) {
  for (const SceneInfo& info : bench::all_scenes())
    if (showable(info) && id_of(info) == id) return make(info);
  return nullptr;
}

}  // namespace carom::host
