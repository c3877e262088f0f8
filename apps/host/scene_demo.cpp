#include "apps/host/scene_demo.h"

#include <cstdio>
#include <memory>
#include <utility>

#include "apps/host/scene_destruction.h"
#include "apps/host/scene_matter.h"
#include "carom/environment/environment.h"

namespace carom::host {

Declaration declaration_of(const scene::Scene& scene, std::string id) {
  Declaration d;
  d.id = std::move(id);
  d.title = scene.name;
  d.text = scene.description;
  d.summary = scene.description.substr(0, scene.description.find('\n'));
  d.group = "Scenes";
  d.dimension = scene.dimension;
  d.dt = scene.step;
  d.duration = scene.duration;
  d.loop = scene.loop || scene.kind == scene::Kind::flight;
  d.camera = {scene.camera.position, scene.camera.target, scene.camera.field_of_view, scene.camera.height,
              scene.camera.width};
  d.ground = scene.ground;
  for (const scene::Parameter& p : scene.parameters)
    d.parameters.push_back(
        {p.name, p.label, p.unit, p.display_unit, p.description, p.minimum, p.maximum, p.step, p.value, p.live});
  for (const scene::Plot& p : scene.plots) {
    Plot plot{p.title, {p.x.label, p.x.display_unit}, {p.y.label, p.y.display_unit}, {}};
    for (const scene::Series& s : p.series) {
      Series series{s.name, s.style == "points" ? Series::Style::points : Series::Style::line};
      for (const auto& [x, y] : s.points) series.points.push_back({x / p.x.display_scale, y / p.y.display_scale});
      plot.series.push_back(std::move(series));
    }
    d.plots.push_back(std::move(plot));
  }
  return d;
}

namespace {

template <class D>
class SceneDemo final : public DemoOf<D> {
 public:
  SceneDemo(scene::Scene scene, std::string id) : scene_(std::move(scene)), id_(std::move(id)) {}

  Declaration declaration() const override { return declaration_of(scene_, id_); }
  std::unique_ptr<Demo> again() const override { return std::make_unique<SceneDemo<D>>(scene_, id_); }
  std::vector<scene::RecordedFile> files() const override {
    std::vector<scene::RecordedFile> out;
    for (const scene::SourceFile& one : scene_.sources()) out.push_back({one.name, one.bytes});
    return out;
  }

  void build(Stage<D>& stage) override {
    core::Result<scene::SceneWorld> made =
        scene_.instantiate(values(stage), {.threads = stage.threads(), .profiler = stage.profiler()});
    if (!made.ok()) return stage.fail(made.error());
    world_ = std::move(made).value();
    if (world_.kind == scene::Kind::flight)
      marker(stage);
    else if constexpr (D::dimension == 2)
      stage.use(*world_.world2);
    else
      stage.use(*world_.world3);
    for (const scene::SceneBody& body : world_.bodies) {
      if (body.colored) stage.set_color(body.id, body.color);
      if (body.trail)
        trails_.push_back({body.id, body.colored ? body.color & 0xffffff : 0x6b7682, Trail(trail_step())});
    }
    if (const scene::SceneBody* body = world_.find_body(scene_.camera.follow); body && !scene_.camera.follow.empty())
      for (const auto& actor : stage.actors())
        if (actor.body == body->id) stage.follow(int(actor.id));
    for (const scene::Plot& plot : scene_.plots) {
      Feed feed{stage.keep(world_.probe(plot.x_expression)), {}};
      for (const scene::Series& series : plot.series)
        feed.y.push_back(series.expression.empty() ? scene::Probe{} : stage.keep(world_.probe(series.expression)));
      feeds_.push_back(std::move(feed));
    }
    for (const scene::Expectation& e : scene_.expectations) {
      probes_.push_back(stage.keep(world_.probe(e.quantity)));
      found_.push_back(0);
      taken_.push_back(false);
    }
    sample(stage);
    start_water(stage);
    if (world_.matter) {
      picture_.begin(stage, *world_.matter);
      picture_.draw<D>(stage, *world_.matter);
    }
    if (world_.destruction) fired_.draw(stage, world_);
  }

  core::Status step(Stage<D>& stage) override {
    if (world_.kind == scene::Kind::flight)
      // The stage's own world holds only a mark; it keeps the time.
      if (const core::Status status = stage.world().step(float(scene_.step)); !status.ok()) return status;
    return world_.step();
  }
  void after_step(Stage<D>& stage) override {
    sample(stage);
    show_water(stage);
    if (world_.matter) picture_.draw<D>(stage, *world_.matter);
    if (world_.destruction) fired_.draw(stage, world_);
    if constexpr (D::dimension == 3)
      if (const auto place = world_.flight_place()) fly(stage, *place);
    for (Followed& f : trails_) {
      if (const auto state = stage.world().state(f.body); state.ok()) f.trail.add(state->center_of_mass);
      f.trail.draw(stage, f.color << 8 | 0xb0);
    }
  }
  void changed(Stage<D>& stage, std::string_view) override { stage.check(scene_.apply(world_, values(stage))); }
  std::uint64_t state_hash(std::uint64_t) const override { return world_.state_hash(); }

  void expectations(Stage<D>&, std::vector<Expectation>& out) override {
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      const scene::Expectation& e = scene_.expectations[i];
      const bool reached = e.time < 0 || taken_[i];
      const double found = e.time < 0 ? world_.read(probes_[i]) : reached ? found_[i] : 0.0 / 0.0;
      std::string name = e.quantity;
      if (e.time >= 0) {
        char when[40];
        std::snprintf(when, sizeof when, " at %g s", e.time);
        name += when;
      }
      const double scale = e.display_scale != 0 ? e.display_scale : 1;
      out.push_back({name, e.display_unit, e.source, found / scale, e.expected / scale, e.tolerance / scale});
    }
  }

 private:
  struct Feed {
    scene::Probe x;
    std::vector<scene::Probe> y;
    double next = 0;
  };

  std::vector<scene::ParameterValue> values(Stage<D>& stage) const {
    std::vector<scene::ParameterValue> out;
    for (std::size_t i = 0; i < scene_.parameters.size(); ++i)
      out.push_back({scene_.parameters[i].name, stage.state.values[i]});
    return out;
  }

  /// A flight has no body in a world: a mark stands for it, much larger than life, so that one sees the whole way at
  /// once and still how the vehicle lies.
  void marker(Stage<D>& stage) {
    if constexpr (D::dimension == 3) {
      // The way is known from the start; walk it once to frame it.
      core::Result<scene::SceneWorld> ahead = scene_.instantiate(values(stage));
      if (!ahead.ok()) return stage.fail(ahead.error());
      start_ = ahead->flight_place()->position;
      math::Vec3d low = start_, high = start_, half = ahead->flight_place()->half_extents;
      while (ahead->step().ok()) {
        const math::Vec3d p = ahead->flight_place()->position;
        low = math::min(low, p);
        high = math::max(high, p);
      }
      const double size = math::max(half.x, math::max(half.y, half.z));
      extent_ = math::max(math::length(high - low), 4 * size);
      const double scale = size > 0 ? 0.05 * extent_ / size : 1;
      rigid::BodyDef<D> body;
      body.type = rigid::BodyType::kinematic;
      body.name = scene_.name;
      const math::Vec3f shown(half * scale);
      const bool round = shown.x == shown.y && shown.y == shown.z;
      mark_ = round ? stage.add(body, geometry::Sphere{shown.x}, {}, 0xe8833a)
                    : stage.add(body, geometry::Box{shown}, {}, 0xe8833a);
      char text[80];
      std::snprintf(text, sizeof text, "the vehicle is drawn %.0f times as large", scale);
      stage.say(text);
      const math::Vec3d middle = 0.5 * (low + high) - start_;
      stage.set_camera({middle + math::Vec3d{0.65, 0.3, 1.65} * extent_, middle, 0.75});
      trails_.push_back({mark_, 0xe8833a, Trail(0.005 * extent_)});
      fly(stage, *world_.flight_place());
    }
  }

  /// Relative to where it began: a ladder of whole seconds stays behind.
  void fly(Stage<D>& stage, const scene::FlightPlace& place) {
    if constexpr (D::dimension == 3) {
      const math::Vec3d at = place.position - start_;
      stage.check(stage.world().set_pose(mark_, at, place.rotation));
      if (world_.time() + 1e-6 * scene_.step >= double(rungs_.size())) rungs_.push_back(at);
      for (std::size_t i = 0; i < rungs_.size(); ++i) {
        const double half = (i % 10 == 0 ? 0.1 : i % 5 == 0 ? 0.07 : 0.04) * extent_;
        stage.line(rungs_[i] - math::Vec3d{half, 0, 0}, rungs_[i] + math::Vec3d{half, 0, 0}, 0x6b7682ff);
      }
    }
  }

  double trail_step() const {
    return D::dimension == 2 ? 0.005 * scene_.camera.height
                             : 0.003 * math::distance(scene_.camera.position, scene_.camera.target);
  }

  void sample(Stage<D>& stage) {
    const double t = world_.time(), slack = 1e-6 * scene_.step;
    for (std::size_t i = 0; i < feeds_.size(); ++i) {
      Feed& feed = feeds_[i];
      const scene::Plot& plot = scene_.plots[i];
      if (t + slack < feed.next) continue;
      feed.next += plot.interval > 0 ? plot.interval : 0;
      const double x = world_.read(feed.x) / plot.x.display_scale;
      for (std::size_t k = 0; k < feed.y.size(); ++k)
        if (feed.y[k].expression) stage.sample(int(i), int(k), x, world_.read(feed.y[k]) / plot.y.display_scale);
    }
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      const scene::Expectation& e = scene_.expectations[i];
      if (e.time < 0 || taken_[i] || t + 0.5 * scene_.step < e.time) continue;
      found_[i] = world_.read(probes_[i]);
      taken_[i] = true;
    }
  }

  /// The environment of the scene as it is now; null where it has none.
  std::shared_ptr<const environment::Environment> around(Stage<D>& stage) const {
    return scene::environment_of(stage.world(), world_.environment);
  }
  void start_water(Stage<D>& stage) {
    const auto here = around(stage);
    if (here == nullptr || here->water() == nullptr) return;
    water_ = 0;
    if constexpr (D::dimension == 3) {
      std::vector<std::uint32_t> triangles;
      for (std::uint32_t row = 0; row + 1 < water_cells; ++row)
        for (std::uint32_t column = 0; column + 1 < water_cells; ++column) {
          const std::uint32_t a = row * water_cells + column, b = a + 1, c = a + water_cells, e = c + 1;
          triangles.insert(triangles.end(), {a, c, b, b, c, e});
        }
      water_ = stage.add_surface(std::move(triangles), 0x2f7faec8);
    }
    show_water(stage);
  }
  /// The water round what the camera looks at: the surface that the bodies float on.
  void show_water(Stage<D>& stage) {
    if (water_ < 0) return;
    const auto here = around(stage);
    if (here == nullptr || here->water() == nullptr) return;
    const Camera& camera = stage.declaration().camera;
    const double t = world_.time(), wide = D::dimension == 3 ? 5 * math::distance(camera.position, camera.target)
                                                             : 2 * math::max(camera.width, 2 * camera.height);
    const double spacing = wide / double(water_cells - 1), left = camera.target.x - 0.5 * wide;
    if constexpr (D::dimension == 3) {
      const double near = camera.target.z - 0.5 * wide;
      std::vector<double> heights(water_cells * water_cells);
      here->water()->grid(left, near, spacing, int(water_cells), int(water_cells), t, heights);
      std::vector<math::Vec3f> corners(heights.size());
      for (std::size_t i = 0; i < heights.size(); ++i) {
        const std::size_t row = i / water_cells, column = i % water_cells;
        corners[i] = {float(left + spacing * double(column)), float(heights[i]), float(near + spacing * double(row))};
      }
      stage.set_surface(water_, corners);
    } else {
      for (std::uint32_t i = 0; i + 1 < water_cells; ++i) {
        const double x = left + spacing * i;
        stage.line(math::Vec2d{x, here->water()->height(x, 0, t)},
                   math::Vec2d{x + spacing, here->water()->height(x + spacing, 0, t)}, 0x2f7faeff);
      }
    }
  }

  struct Followed {
    rigid::BodyId body;
    std::uint32_t color;
    Trail trail;
  };

  scene::Scene scene_;
  std::string id_;
  scene::SceneWorld world_;
  std::vector<Feed> feeds_;
  std::vector<scene::Probe> probes_;
  std::vector<double> found_;
  std::vector<bool> taken_;
  std::vector<Followed> trails_;
  // Of a flight: its mark, its start, the size of its way, the places at whole seconds.
  rigid::BodyId mark_;
  math::Vec3d start_{};
  double extent_ = 1;
  std::vector<math::Vec3d> rungs_;
  static constexpr std::uint32_t water_cells = 80;
  MatterPicture picture_;
  DestructionPicture fired_;
  int water_ = -1;  ///< its surface; negative: no water
};

}  // namespace

std::unique_ptr<Demo> make_scene_demo(scene::Scene scene, std::string id) {
  if (scene.dimension == 2) return std::make_unique<SceneDemo<rigid::Dim2>>(std::move(scene), std::move(id));
  return std::make_unique<SceneDemo<rigid::Dim3>>(std::move(scene), std::move(id));
}

}  // namespace carom::host
