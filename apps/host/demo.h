// A demo: what it declares, how it builds its world, and what it does round every step.
#pragma once

#include <memory>
#include <vector>

#include "apps/host/stage.h"
#include "carom/scene/recording.h"

namespace carom::host {

class Simulation;

class Demo {
 public:
  virtual ~Demo() = default;
  virtual Declaration declaration() const = 0;
  /// Another of the same kind, for a restart.
  virtual std::unique_ptr<Demo> again() const = 0;
  /// What it was read from, a scene file first; nothing where a program made it.
  virtual std::vector<scene::RecordedFile> files() const { return {}; }
  /// What the demo itself remembers, for going back in time: a copy, and back into this one. Null: it cannot be copied.
  virtual std::unique_ptr<Demo> copy() const { return nullptr; }
  virtual void assign(const Demo&) {}
  /// A fresh run with these values (in the order of the declaration's parameters; empty: its defaults).
  virtual core::Result<std::unique_ptr<Simulation>> open(std::unique_ptr<Demo> self, const std::vector<double>& values,
                                                         const SimulationOptions& options) = 0;
};

template <class D>
class DemoOf : public Demo {
 public:
  using StageD = Stage<D>;
  virtual void build(StageD& stage) = 0;
  virtual void before_step(StageD&) {}
  virtual void after_step(StageD&) {}
  /// The step itself: of the stage's world, unless the demo keeps more than that in step.
  virtual core::Status step(StageD& stage) { return stage.world().step(float(stage.declaration().dt)); }
  /// The hash of everything that the demo simulates, given that of the stage's world.
  virtual std::uint64_t state_hash(std::uint64_t world) const { return world; }
  /// A live parameter was set.
  virtual void changed(StageD&, std::string_view) {}
  /// Checks after a run of the declared duration with default values.
  virtual void expectations(StageD&, std::vector<Expectation>&) {}
  core::Result<std::unique_ptr<Simulation>> open(std::unique_ptr<Demo> self, const std::vector<double>& values,
                                                 const SimulationOptions& options) final;
};
using Demo2 = DemoOf<rigid::Dim2>;
using Demo3 = DemoOf<rigid::Dim3>;

}  // namespace carom::host
