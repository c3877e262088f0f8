// One run of one demo: the dimension is hidden, so that a host, the command line and a picture see every demo alike.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "apps/host/demo.h"

namespace carom::host {

struct GrabAnswer {
  std::int64_t body = -1;  ///< −1: nothing there
  math::Vec3d point{};
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

  virtual std::size_t body_count() const = 0;
  virtual void places(std::vector<BodyPlace>& out) const = 0;  ///< of every shown body
  virtual void describe(const std::vector<std::uint32_t>* only, std::vector<BodyView>& out) = 0;  ///< null: all
  /// What to draw beside the bodies: the demo's lines, ropes and rods, the springs of pointers.
  virtual void lines(std::vector<Line>& out) const = 0;
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
  /// The world itself, for a recorder; the other one is null.
  virtual rigid::World2* world2() { return nullptr; }
  virtual rigid::World3* world3() { return nullptr; }

 protected:
  explicit Simulation(Declaration declaration) : declaration_(std::move(declaration)) {}
  virtual void changed(std::string_view name) = 0;
  Declaration declaration_;
  StageBase* base_ = nullptr;
  MeshLibrary meshes_;
};

/// The name in `known` that is closest to `name`, for "did you mean …"; empty where none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace carom::host
