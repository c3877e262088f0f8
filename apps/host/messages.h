// The two sides of docs/protocol.md: declarations and bodies as JSON, motion as binary frames.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/host/debug_draw.h"
#include "apps/host/replay.h"
#include "apps/host/simulation.h"

namespace carom::host {

inline constexpr int protocol_version = 1;
/// Of the binary message that carries a file: a recording, either way.
inline constexpr char file_message_kind = 3;

// All of these are JSON text, always valid UTF-8.

/// An array: id, title, summary, group, chapter and dimension of each, as `welcome` lists them.
std::string menu_json(std::span<const Declaration> demos);
/// `menu`: such an array.
std::string welcome_message(const char* engine, std::string_view menu);
std::string opened_message(const Declaration& declaration);
std::string scene_message(const Declaration& declaration, std::span<const BodyView> bodies);
std::string bodies_message(std::span<const BodyView> added, std::span<const std::uint32_t> removed);
std::string grabbed_message(std::int64_t pointer, const GrabAnswer& answer);
std::string values_message(const Declaration& declaration, std::span<const double> values);
/// What a frame's stats have no room for: stages of the last step, momentum, scale of arrows, the force of hands.
struct NumbersFields {
  rigid::StepProfile profile;
  Budget budget;
  ArrowScale arrows;
  double hand_force = 0, worst_joint_error = 0;
  std::size_t bytes = 0;
  std::vector<LegendEntry> legend{};
};
std::string numbers_message(const NumbersFields& fields);
std::string probed_message(std::string_view kind, const ProbeAnswer& answer);
/// `report`: the JSON object of Simulation::inspect, or empty where the body is gone.
std::string inspected_message(std::string_view report);
std::string verified_message(const ReplayReport& report);
/// `written`: of the world as it is now, which a program made.
std::string source_message(std::string_view name, std::string_view text, bool written);
std::string error_message(std::string_view message);
struct StatusFields {
  bool running = false;
  double speed = 1, time = 0;
  std::uint64_t step = 0, first = 0, last = 0;
  bool recording = false, playing = false;  ///< is made; is shown
  std::string_view message;
};
std::string status_message(const StatusFields& fields);
/// The declaration as `carom list --json` prints it.
std::string declaration_json(const Declaration& declaration, int indent);

struct FrameStats {
  std::uint32_t bodies = 0, awake = 0, contacts = 0, joints = 0, islands = 0, threads = 1;
  float step_ms = 0, real_time_factor = 0;
  double kinetic = 0, potential = 0;
  std::uint64_t hash = 0;
  double worst_penetration = 0;
};
struct FrameFields {
  bool key = false;
  const FrameStats* stats = nullptr;
  int dimension = 3;
  std::uint32_t sequence = 0, step = 0;
  double time = 0;
  math::Vec3d origin{};
  std::span<const BodyPlace> bodies;
  std::span<const Sample> samples;
  std::span<const Line> lines;
};
std::string frame_message(const FrameFields& fields);
std::string mesh_message(std::uint32_t id, const Mesh& mesh);
/// Of what is drawn beside bodies; sent before the frame of the same step.
std::string points_message(const Points& points);
std::string surface_message(std::uint32_t id, const Surface& surface, bool with_triangles);

}  // namespace carom::host
