#include "apps/command/report.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace carom::command {

std::string hex(std::uint64_t hash) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json vector_json(math::Vec3d v) { return {v.x, v.y, v.z}; }

Json budget_json(const host::Budget& b) {
  return {{"mass_kg", b.mass},
          {"kinetic_energy_J", b.kinetic},
          {"potential_energy_J", b.potential},
          {"total_energy_J", b.kinetic + b.potential},
          {"momentum_kg_m_s", vector_json(b.momentum)},
          {"angular_momentum_kg_m2_s", vector_json(b.angular_momentum)}};
}

[[gnu::format(printf, 2, 3)]] void put(std::string& out, const char* pattern, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(line, sizeof line, pattern, arguments);
  va_end(arguments);
  out += line;
}

/// Terminal columns of UTF-8 text, taking every code point as one.
std::size_t columns(const std::string& s) {
  return std::size_t(std::count_if(s.begin(), s.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}
std::string padded(std::string s, std::size_t width) {
  const std::size_t n = columns(s);
  return n < width ? s.append(width - n, ' ') : s;
}

void row(std::string& out, const char* name, double start, double end, const char* unit) {
  if (start == 0 && end == 0) return;  // says nothing, or does not apply
  put(out, "  %-22s %14.6g %14.6g %14.4g  %s\n", name, start, end, end - start, unit);
}

}  // namespace

bool Report::passed() const {
  return std::all_of(expectations.begin(), expectations.end(), [](const host::Expectation& e) { return e.passed(); });
}

std::string report_json(const Report& r) {
  Json parameters = Json::object(), expectations = Json::array(), hashes = Json::array();
  for (const auto& [name, value] : r.parameters) parameters[name] = value;
  for (const host::Expectation& e : r.expectations)
    expectations.push_back({{"name", e.name},
                            {"unit", e.unit},
                            {"found", e.found},
                            {"expected", e.expected},
                            {"tolerance", e.tolerance},
                            {"passed", e.passed()},
                            {"source", e.source}});
  for (const StepHash& h : r.hashes) hashes.push_back({{"step", h.step}, {"hash", hex(h.hash)}});
  Json out = {{"scene", r.scene},
              {"title", r.title},
              {"dimension", r.dimension},
              {"parameters", parameters},
              {"threads", r.threads},
              {"dt_s", r.dt},
              {"steps", r.steps},
              {"simulated_s", r.simulated},
              {"wall_s", r.wall},
              {"interrupted", r.interrupted},
              {"bodies", r.counters.bodies},
              {"awake_bodies", r.counters.awake_bodies},
              {"shapes", r.counters.shapes},
              {"contacts", r.counters.touching_contacts},
              {"most_contacts", r.most_contacts},
              {"joints", r.counters.joints},
              {"islands", r.counters.islands},
              {"bytes", r.counters.bytes},
              {"peak_bytes", r.counters.peak_bytes},
              {"start", budget_json(r.start)},
              {"end", budget_json(r.end)},
              {"worst_penetration_m", r.worst_penetration},
              {"worst_joint_error_m", r.worst_joint_error},
              {"step_ms_median", r.step_median},
              {"step_ms_worst", r.step_worst},
              {"real_time_factor", r.real_time_factor},
              {"state_hash", hex(r.hash)},
              {"hashes", hashes},
              {"expectations", expectations},
              {"passed", r.passed()},
              {"files", r.files}};
  if (!r.advice.empty()) out["advice"] = r.advice;
  if (!r.message.empty()) out["message"] = r.message;
  if (!r.stopped.empty()) out["stopped"] = r.stopped;
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string report_text(const Report& r) {
  std::string out;
  put(out, "%s (%s)\n", r.title.c_str(), r.scene.c_str());
  put(out, "  %llu steps of %.4g ms, %.4g s simulated in %.3g s on %d thread%s%s\n",
      static_cast<unsigned long long>(r.steps), 1e3 * r.dt, r.simulated, r.wall, r.threads, r.threads == 1 ? "" : "s",
      r.interrupted ? ", interrupted" : "");
  put(out,
      "  bodies %d (%d awake)   shapes %d   contacts %d (at most %d)   joints %d   islands %d   %.1f kB (at most "
      "%.1f)\n",
      r.counters.bodies, r.counters.awake_bodies, r.counters.shapes, r.counters.touching_contacts, r.most_contacts,
      r.counters.joints, r.counters.islands, double(r.counters.bytes) / 1024, double(r.counters.peak_bytes) / 1024);
  std::string budget;
  row(budget, "kinetic energy", r.start.kinetic, r.end.kinetic, "J");
  row(budget, "potential energy", r.start.potential, r.end.potential, "J");
  row(budget, "total energy", r.start.kinetic + r.start.potential, r.end.kinetic + r.end.potential, "J");
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < r.dimension; ++i)
    row(budget, (std::string("momentum ") + axes[i]).c_str(), r.start.momentum[i], r.end.momentum[i], "kg·m/s");
  for (int i = r.dimension == 2 ? 2 : 0; i < 3; ++i)
    row(budget, (std::string("angular momentum ") + axes[i]).c_str(), r.start.angular_momentum[i],
        r.end.angular_momentum[i], "kg·m²/s");
  if (!budget.empty()) {
    put(out, "\n  %-22s %14s %14s %14s\n", "", "start", "end", "change");
    out += budget;
  }
  put(out, "\n  worst penetration %.3g mm   worst joint error %.3g mm\n", 1e3 * r.worst_penetration,
      1e3 * r.worst_joint_error);
  put(out, "  step: median %.3f ms, worst %.3f ms   real-time factor %.3g\n", r.step_median, r.step_worst,
      r.real_time_factor);
  put(out, "  state hash %s\n", hex(r.hash).c_str());
  for (const StepHash& h : r.hashes)
    put(out, "    step %8llu  %s\n", static_cast<unsigned long long>(h.step), hex(h.hash).c_str());
  if (!r.message.empty()) put(out, "  %s\n", r.message.c_str());
  if (!r.stopped.empty()) put(out, "  stopped: %s\n", r.stopped.c_str());
  if (!r.expectations.empty()) {
    out += "\n  " + padded("expectation", 46) + "         found      expected  tolerance\n";
    for (const host::Expectation& e : r.expectations) {
      const std::string name = e.unit.empty() ? e.name : e.name + " / " + e.unit;
      out += std::string("  ") + padded(name, 46);
      put(out, " %13.7g %13.7g  %9.2g  %s   %s\n", e.found, e.expected, e.tolerance, e.passed() ? "ok    " : "FAILED",
          e.source.c_str());
    }
  } else if (!r.checked) {
    out += "\n  (expectations are checked with default values and the full duration only)\n";
  }
  for (const std::string& line : r.advice) out += "  advice: " + line + "\n";
  if (!r.files.empty()) {
    out += "\n";
    for (const std::string& file : r.files) out += "  " + file + "\n";
  }
  return out;
}

}  // namespace carom::command
