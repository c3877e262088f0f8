// What a demo builds on: a world, the bodies in it that are shown, the parameters as they are set, and pens for plots,
// lines and verdicts. The first failure is kept and reported; a demo need not test every call.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/host/declaration.h"
#include "apps/host/views.h"
#include "carom/math/elementary.h"
#include "carom/rigid/world.h"

namespace carom::host {

struct SimulationOptions {
  int threads = 1;
  core::Profiler* profiler = nullptr;  ///< of the world's stages; outlives the simulation
};

/// Everything of a stage that does not depend on the dimension.
class StageBase {
 public:
  StageBase(Declaration& declaration, const SimulationOptions& options);

  const Declaration& declaration() const { return declaration_; }
  /// A parameter's value now (SI). An unknown name is a mistake in the demo: it fails the stage and gives 0.
  double value(std::string_view name);
  float valuef(std::string_view name) { return float(value(name)); }
  int count(std::string_view name) { return int(math::round(value(name))); }
  /// What an input holds now (−1 … 1), 0 when released.
  double input(std::string_view action) const;
  /// How often a `press` input was pressed since last asked.
  int presses(std::string_view action);

  void sample(int plot, int series, double x, double y);
  void line(math::Vec3d a, math::Vec3d b, std::uint32_t rgba);
  void line(math::Vec2d a, math::Vec2d b, std::uint32_t rgba) { line(in_space(a), in_space(b), rgba); }
  /// Balls drawn until the next step, at most `max_points`: of more, every k-th is shown. One radius and colour for
  /// all, or arrays as long as `positions`.
  void points(std::span<const math::Vec3f> positions, float radius, std::uint32_t rgba);
  void points(std::span<const math::Vec3f> positions, std::span<const float> radii,
              std::span<const std::uint32_t> rgbas);
  /// A surface that is drawn from both sides; `triangles` names three corners each. Gives its number.
  int add_surface(std::vector<std::uint32_t> triangles, std::uint32_t rgba);
  /// Where its corners are now; with `triangles`, where it was torn. A triangle that names a corner beyond the last
  /// fails the stage.
  void set_surface(int surface, std::span<const math::Vec3f> corners);
  void set_surface(int surface, std::span<const math::Vec3f> corners, std::vector<std::uint32_t> triangles);
  /// A verdict or a read-out, one short line; shown until the next.
  void say(std::string message);
  void fail(const core::Error& error);
  void check(const core::Status& status) {
    if (!status.ok()) fail(status.error());
  }
  template <class T>
  T keep(core::Result<T> result) {
    if (result.ok()) return std::move(result).value();
    fail(result.error());
    return T{};
  }
  /// What the sliders should show from now on, where a demo changes a parameter itself.
  void set_value(std::string_view name, double value);
  /// Lets the camera follow a body, by the id that `actors` gives it.
  void follow(int id) { declaration_.camera.follow = id; }
  /// Where to look from, known only now that the demo is built.
  void set_camera(const Camera& camera) { declaration_.camera = camera; }
  void set_ground(double level) { declaration_.ground = level; }
  /// What a series is called, where a parameter decides what it shows: while the demo is built.
  void name_series(int plot, int series, std::string name) {
    declaration_.plots[std::size_t(plot)].series[std::size_t(series)].name = std::move(name);
  }
  int threads() const { return options_.threads; }
  core::Profiler* profiler() const { return options_.profiler; }

  // For the simulation that owns the stage.
  struct State {
    std::vector<double> values;  ///< in the order of the declaration's parameters
    std::vector<double> inputs;  ///< held value of each input
    std::vector<int> presses;
    std::vector<Sample> samples;
    std::vector<Line> lines;
    Points points;
    std::vector<Surface> surfaces;
    std::string message;
    bool message_changed = false, values_changed = false;
    core::Status status;
  };
  State state;
  /// Material::user_id of a shape is its colour, 0xOORRGGBB with the opacity first.
  bool looks_in_materials = false;

 protected:
  Declaration& declaration_;
  SimulationOptions options_;
};

inline constexpr std::size_t max_samples = 20'000;
inline constexpr std::size_t max_lines = 8'192;
inline constexpr std::size_t max_points = 60'000;

template <class D>
class Stage : public StageBase {
 public:
  using BodyId = rigid::BodyId;
  struct Part {
    typename D::Shape shape;
    rigid::ShapeDef<D> definition{};
  };

  Stage(Declaration& declaration, const SimulationOptions& options) : StageBase(declaration, options) { start({}); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// A new empty world; the threads are the host's to choose.
  void start(rigid::WorldDef<D> definition);
  /// A world that the demo keeps (a scene file's); it must live as long as the stage uses it.
  void use(rigid::World<D>& world);
  rigid::World<D>& world() { return *world_; }
  const rigid::World<D>& world() const { return *world_; }

  /// A body that is shown. `color` is 0xRRGGBB; 0 leaves it to the viewer.
  BodyId add(const rigid::BodyDef<D>& definition, std::initializer_list<Part> parts, std::uint32_t color = 0);
  BodyId add(const rigid::BodyDef<D>& definition, const typename D::Shape& shape,
             const rigid::ShapeDef<D>& shape_definition = {}, std::uint32_t color = 0);
  /// Shows a body that somebody made in this world.
  void adopt(BodyId body, std::uint32_t color = 0);
  void remove(BodyId body);
  /// Shows every body that the world holds, and forgets those that it holds no more (after somebody else than the stage
  /// made or removed some).
  void adopt_all(bool keep_known = true);
  void set_color(BodyId body, std::uint32_t color);
  /// Shows the body anew, after its shapes changed (terrain).
  void redraw(BodyId body);
  /// A fixed floor: a half-space in space, a wide box in the plane, with its surface at `level`.
  BodyId floor(double level, const rigid::Material& material = {});
  /// The state of a body; of a body that is gone, a default one and the stage fails.
  rigid::BodyState<D> at(BodyId body) { return keep(world_->state(body)); }

  struct Actor {
    BodyId body;
    std::uint32_t id = 0;
    std::uint32_t color = 0;
  };
  const std::vector<Actor>& actors() const { return actors_; }
  /// The state of the stage without its world, and back. Bodies that differ count as added and removed.
  struct Memory {
    std::vector<Actor> actors;
    std::vector<double> values, inputs;
    std::vector<int> presses;
    std::vector<Surface> surfaces;
    std::string message;
    int follow = -1;
  };
  Memory remember() const;
  void recall(const Memory& memory);
  std::vector<std::uint32_t> take_added() { return std::exchange(added_, {}); }
  std::vector<std::uint32_t> take_removed() { return std::exchange(removed_, {}); }
  bool changed() const { return !added_.empty() || !removed_.empty(); }

 private:
  rigid::World<D> own_;
  rigid::World<D>* world_ = &own_;
  std::vector<Actor> actors_;
  std::vector<std::uint32_t> added_, removed_;
  std::uint32_t next_id_ = 0;
};

extern template class Stage<rigid::Dim2>;
extern template class Stage<rigid::Dim3>;
using Stage2 = Stage<rigid::Dim2>;
using Stage3 = Stage<rigid::Dim3>;

/// The path of a point, thinned as it grows so that it never takes more than a few hundred lines.
class Trail {
 public:
  explicit Trail(double spacing = 0.05, std::size_t limit = 400) : spacing_(spacing), limit_(limit) {}
  void add(math::Vec3d p);
  void add(math::Vec2d p) { add(in_space(p)); }
  void clear() { points_.clear(); }
  void draw(StageBase& stage, std::uint32_t rgba) const;
  const std::vector<math::Vec3d>& points() const { return points_; }

 private:
  std::vector<math::Vec3d> points_;
  double spacing_;
  std::size_t limit_;
};

}  // namespace carom::host
