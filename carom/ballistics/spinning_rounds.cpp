#include "carom/ballistics/spinning_rounds.h"

#include <algorithm>

namespace carom::ballistics {

void SpinningRounds::add(const ProjectileBatch& batch, const FlightPoint& start, double spin) {
  const std::size_t newest = batch.size() - 1;
  rounds_.push_back(
      {batch.round(newest).tag, launched(shell_, start, spin, ShellModel::modified_point_mass), batch.at(newest)});
}

SpinningRounds::Round* SpinningRounds::look(std::uint64_t tag) {
  const auto at = std::ranges::lower_bound(rounds_, tag, {}, &Round::tag);
  return at != rounds_.end() && at->tag == tag ? &*at : nullptr;
}

const ShellMotion* SpinningRounds::find(std::uint64_t tag) const {
  const Round* const round = const_cast<SpinningRounds*>(this)->look(tag);
  return round != nullptr ? &round->motion : nullptr;
}

void SpinningRounds::step(ProjectileBatch& batch, const Conditions& conditions, double time, double dt) {
  for (Round& round : rounds_) round.flies = false;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    Round* const round = look(batch.round(i).tag);
    if (round == nullptr) continue;
    const FlightPoint now = batch.at(i);
    round->index = i;
    round->flies = now.position == round->told.position && now.velocity == round->told.velocity;
  }
  std::erase_if(rounds_, [](const Round& round) { return !round.flies; });
  batch.step(dt);
  for (Round& round : rounds_) {
    round.motion = flown(shell_, conditions, ShellModel::modified_point_mass, round.motion, time, dt);
    batch.place(round.index, {round.motion.position, round.motion.velocity});
    round.told = batch.at(round.index);
  }
}

}  // namespace carom::ballistics
