// What somebody does to a run between two steps, in the words of a page's message (docs/protocol.md), so that it can be
// done again: when the past is shown, and when a recording is run anew.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/host/simulation.h"

namespace carom::host {

struct Deed {
  enum class Kind { set, input, grab, drag, release, release_all, spawn } kind = Kind::release_all;
  std::string name;          ///< set: parameter; input: action
  double value = 0;          ///< set, input
  std::int64_t pointer = 0;  ///< grab, drag, release
  math::Vec3d at{}, along{};
  SpawnRequest spawned;
};
/// Whether messages of this type are deeds.
bool is_deed(const std::string& type);
/// Errors name the field of the message.
core::Result<Deed> read_deed(const nlohmann::json& message);
/// The message again.
nlohmann::json deed_json(const Deed& deed);

struct DeedOutcome {
  core::Status status;
  GrabAnswer grabbed;
  bool live = true;  ///< false: a parameter was set that acts only from a new start
};
DeedOutcome do_deed(Simulation& simulation, const Deed& deed);

}  // namespace carom::host
