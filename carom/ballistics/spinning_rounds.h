// Rounds of a batch that fly as spinning shells: by the modified point mass, with their drift.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/ballistics/batch.h"
#include "carom/ballistics/shell.h"

namespace carom::ballistics {

/// Beside the batch, which sweeps them for hits as it does the others. A round that has met something, or was put
/// elsewhere, flies on as the point mass that the batch knows.
class CAROM_API SpinningRounds {
 public:
  explicit SpinningRounds(Shell shell) : shell_(std::move(shell)) {}
  const Shell& shell() const { return shell_; }
  /// The newest round of the batch, as it leaves the barrel with a spin (rad/s). Tags must rise from round to round.
  void add(const ProjectileBatch& batch, const FlightPoint& start, double spin);
  /// In place of ProjectileBatch::step: all rounds by `dt` s from the time `time` of the field of the conditions.
  void step(ProjectileBatch& batch, const Conditions& conditions, double time, double dt);
  /// Of a round that spins; null: none of that tag does.
  const ShellMotion* find(std::uint64_t tag) const;
  std::size_t size() const { return rounds_.size(); }

 private:
  struct Round {
    std::uint64_t tag = 0;
    ShellMotion motion{};
    FlightPoint told{};     // as the batch has it, in floats
    std::size_t index = 0;  // in the batch, during a step
    bool flies = false;
  };
  Round* look(std::uint64_t tag);
  Shell shell_;
  std::vector<Round> rounds_;  // by tag
};

}  // namespace carom::ballistics
