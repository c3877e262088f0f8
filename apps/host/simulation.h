// One run of one demo: the dimension is hidden, so that a host, the command line and a picture see every demo alike.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/host/debug_draw.h"
#include "apps/host/demo.h"

namespace carom::host {

struct GrabAnswer {
  std::int64_t body = -1;  ///< −1: nothing there
  math::Vec3d point{};
};

/// What a page's probe found.
struct ProbeAnswer {
  std::int64_t body = -1;  ///< −1: nothing there
  math::Vec3d point{}, normal{};
  double distance = 0;  ///< m along the ray, or to the closest point
};
enum class ProbeKind { ray, sphere, closest };

/// A body that a hand throws into the scene.
struct SpawnRequest {
  enum class Form { ball, box, capsule } form = Form::ball;
  double size = 0.5;      ///< m: radius, half edge
  double density = 1000;  ///< kg/m³ (2D: kg/m²)
  math::Vec3d position{}, velocity{};
};

/// The whole state of a run at one step (Simulation::save).
class Memento {
 public:
  virtual ~Memento() = default;
  virtual std::size_t bytes() const = 0;  ///< memory held, about
};

struct StepRange {
  std::uint64_t first = 0, last = 0;
};

struct Budget {
  double mass = 0, kinetic = 0, potential = 0;
  math::Vec3d momentum{}, angular_momentum{};
};

class Simulation {
 public:
  static constexpr int max_pointers = 10;

  virtual ~Simulation() = default;
  const Declaration& declaration() const { return declaration_; }
  const std::vector<double>& values() const { return base().state.values; }
  StageBase& base() { return *base_; }
  const StageBase& base() const { return *base_; }

  /// One fixed step with the demo's hooks. An error ends the run.
  virtual core::Status step() = 0;
  virtual double time() const = 0;
  virtual std::uint64_t step_count() const = 0;

  /// A parameter by name: an error for an unknown name (with the nearest known one) or a value out of range. True
  /// when it acted at once; false when the demo must be restarted for it.
  core::Result<bool> set(std::string_view name, double value);
  core::Status input(std::string_view action, double value);

  virtual GrabAnswer grab(std::int64_t pointer, math::Vec3d origin, math::Vec3d direction) = 0;
  virtual core::Status drag(std::int64_t pointer, math::Vec3d target) = 0;
  virtual void release(std::int64_t pointer) = 0;
  virtual void release_all() = 0;
  /// N: what the strongest of the hands pulled with in the last step.
  virtual double hand_force() const = 0;

  /// Errors: a form, size or density out of range, a scene with too many bodies already.
  virtual core::Status spawn(const SpawnRequest& request) = 0;
  /// Ray and sphere go from `origin` along `direction`; `closest` looks round where the ray hits the nearest body, or
  /// round `origin` where there is none. In the plane the point is where the view ray meets it.
  virtual core::Result<ProbeAnswer> probe(ProbeKind kind, math::Vec3d origin, math::Vec3d direction, double radius) = 0;
  /// What a page shows of one body: a JSON object (docs/protocol.md, `inspected`); empty where there is no such body.
  virtual std::string inspect(std::uint32_t body) = 0;
  /// How long the arrows of debug drawing are.
  virtual ArrowScale arrows() const = 0;
  /// Which layers of debug drawing `lines` holds (debug_draw.h).
  void set_layers(std::uint32_t layers) { layers_ = layers; }

  /// The steps of a recording (playback.h); a run of the engine has none.
  virtual std::optional<StepRange> recorded() const { return {}; }
  virtual std::shared_ptr<scene::Recording> recording() const { return nullptr; }
  virtual core::Status show(std::uint64_t) { return core::Error{"show: this is no recording"}; }
  /// What its demo was read from (Demo::files).
  virtual std::vector<scene::RecordedFile> files() const { return {}; }
  /// What a page is told when it is opened: the `opened` and `scene` messages.
  virtual std::string opened_text() const;
  virtual std::string scene_text();

  /// The state for going back to this step; null where the demo cannot be copied. `restore` takes what this run saved.
  virtual std::unique_ptr<Memento> save() = 0;
  virtual core::Status restore(const Memento& memento) = 0;

  virtual std::size_t body_count() const = 0;
  virtual void places(std::vector<BodyPlace>& out) const = 0;  ///< of every shown body
  virtual void describe(const std::vector<std::uint32_t>* only, std::vector<BodyView>& out) = 0;  ///< null: all
  /// What to draw beside the bodies: the demo's lines, ropes and rods, the springs of pointers.
  virtual void lines(std::vector<Line>& out) const = 0;
  /// What colours of debug drawing stand for in this scene.
  virtual std::vector<LegendEntry> legend() const { return {}; }
  virtual bool take_changes(std::vector<std::uint32_t>& added, std::vector<std::uint32_t>& removed) = 0;
  const MeshLibrary& meshes() const { return meshes_; }

  virtual rigid::Counters counters() const = 0;
  virtual rigid::StepProfile profile() const = 0;
  virtual Budget budget() const = 0;
  virtual double worst_penetration() const = 0;
  virtual double worst_joint_error() const = 0;
  virtual std::uint64_t state_hash() const = 0;
  virtual int threads() const = 0;
  /// The same demo from its start with these values.
  virtual core::Result<std::unique_ptr<Simulation>> reopen(const std::vector<double>& values) const = 0;
  virtual void expectations(std::vector<Expectation>& out) = 0;
  /// The world as it is now as a scene file: its bodies, joints, effectors and settings. What a demo has beside its
  /// world (particles, ropes, its own rules) is not in it.
  virtual core::Result<std::string> scene_file() const {
    return core::Error{"this is a recording, and has no world to write"};
  }
  /// The world itself, for a recorder; the other one is null.
  virtual rigid::World2* world2() { return nullptr; }
  virtual rigid::World3* world3() { return nullptr; }

 protected:
  explicit Simulation(Declaration declaration) : declaration_(std::move(declaration)) {}
  virtual void changed(std::string_view name) = 0;
  Declaration declaration_;
  StageBase* base_ = nullptr;
  MeshLibrary meshes_;
  std::uint32_t layers_ = 0;
};

/// The name in `known` that is closest to `name`, for "did you mean …"; empty where none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace carom::host
