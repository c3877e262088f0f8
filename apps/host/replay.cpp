#include "apps/host/replay.h"

#include <algorithm>
#include <cstdio>

#include "apps/host/registry.h"
#include "apps/host/scene_demo.h"
#include "carom/scene/scene.h"

namespace carom::host {

namespace {

std::string build_name(const OriginText& build) {
  return "Carom " + build.version + " (" + build.engine + ", " + build.compiler + ")";
}

core::Result<std::unique_ptr<Demo>> demo_of(const scene::RecordingHeader& header, const std::string& id) {
  if (header.files.empty()) {
    std::unique_ptr<Demo> demo = make_demo(id);
    if (!demo)
      return core::Error{"replay: the recording was made by demo \"" + id.substr(0, 64) + "\", which is not here"};
    return demo;
  }
  const scene::Resolver resolver = [&](std::string_view path) -> core::Result<std::string> {
    for (std::size_t i = 1; i < header.files.size(); ++i)
      if (header.files[i].name == path) return header.files[i].bytes;
    return core::Error{std::string(path) + ": the recording does not hold this file"};
  };
  core::Result<scene::Scene> scene = scene::parse_scene(header.files[0].bytes, header.files[0].name, resolver);
  if (!scene.ok()) return core::Error{"replay: " + scene.error().message};
  return make_scene_demo(std::move(scene).value(), id);
}

std::string shown_number(const char* format, double x) {
  char text[64];
  std::snprintf(text, sizeof text, format, x);
  return text;
}

}  // namespace

std::string ReplayReport::text() const {
  const std::string range = "steps " + std::to_string(first) + " to " + std::to_string(last);
  if (!done && !difference) return "run again up to step " + std::to_string(step) + " of " + std::to_string(last);
  if (!difference)
    return "the same: " + range + ", " + std::to_string(frames) + " frames bit for bit, " + std::to_string(hashes) +
           " state hashes";
  std::string out = "differs at step " + std::to_string(difference->step) + ": " + difference->what;
  if (difference->after + 1 < difference->step)
    out += "; it was the same at step " + std::to_string(difference->after) + ", the last that was compared before";
  if (recorded_by != run_by) out += "; recorded by " + recorded_by + ", run again by " + run_by;
  return out;
}

core::Result<Replay> Replay::open(std::shared_ptr<scene::Recording> recording, const SimulationOptions& options) {
  const scene::RecordingHeader& header = recording->header();
  if (header.origin.empty())
    return core::Error{"replay: the recording does not say what opened it, so it can only be looked at"};
  if (recording->frame_count() == 0) return core::Error{"replay: the recording has no whole frame"};
  core::Result<OriginText> origin = read_origin(header.origin);
  if (!origin.ok()) return core::Error{"replay: " + origin.error().message};
  core::Result<std::unique_ptr<Demo>> demo = demo_of(header, origin->demo);
  if (!demo.ok()) return demo.error();
  const Declaration declaration = (*demo)->declaration();
  std::vector<double> values;
  for (const Parameter& p : declaration.parameters) values.push_back(p.value);
  for (const auto& [name, value] : origin->values) {
    std::size_t i = 0;
    while (i < values.size() && declaration.parameters[i].name != name) ++i;
    if (i == values.size())
      return core::Error{"replay: " + declaration.id + " has no parameter \"" + name.substr(0, 64) +
                         "\" in this build; the recording was made by " + build_name(*origin)};
    const Parameter& p = declaration.parameters[i];
    if (!(value >= p.minimum && value <= p.maximum))
      return core::Error{"replay: parameter " + name + ": found " + shown_number("%.9g", value) + ", expected " +
                         shown_number("%.9g", p.minimum) + " to " + shown_number("%.9g", p.maximum) + " " + p.unit};
    values[i] = value;
  }
  Replay out;
  Demo& opener = **demo;
  core::Result<std::unique_ptr<Simulation>> opened = opener.open(std::move(demo).value(), values, options);
  if (!opened.ok()) return core::Error{"replay: " + opened.error().message};
  out.simulation_ = std::move(opened).value();
  out.recording_ = std::move(recording);
  out.due_ = std::move(origin->past);
  out.report_.recorded_by = build_name(*origin);
  out.report_.run_by = build_name(this_build());
  const core::Result<scene::RecordedFrame> last = out.recording_->frame(out.recording_->frame_count() - 1);
  if (!last.ok()) return last.error();
  core::Result<scene::RecordedFrame> first = out.recording_->frame(0);
  if (!first.ok()) return first.error();
  out.report_.last = last->step;
  out.frame_ = std::move(first).value();
  out.report_.first = out.agreed_ = out.frame_.step;
  return out;
}

void Replay::differ(std::string what) {
  report_.difference = {frame_.step, agreed_, std::move(what)};
  report_.done = true;
}

core::Status Replay::do_due() {
  for (; next_deed_ < due_.size() && due_[next_deed_].step <= simulation_->step_count(); ++next_deed_)
    (void)do_deed(*simulation_, due_[next_deed_].deed);  // what was refused then is refused now
  return {};
}

core::Status Replay::step() {
  const std::uint64_t before = simulation_->step_count();
  (void)do_due();
  if (const core::Status status = simulation_->step(); !status.ok()) {
    differ("the run ended itself: " + status.error().message);
    return {};
  }
  simulation_->base().state.samples.clear();
  report_.step = simulation_->step_count();
  if (report_.step <= before) differ("the run turned its own time back");
  return {};
}

core::Status Replay::compare() {
  // Who is held, thrown in or set between two frames is so before what comes after.
  (void)do_due();
  simulation_->places(places_);
  std::sort(places_.begin(), places_.end(), [](const BodyPlace& a, const BodyPlace& b) { return a.id < b.id; });
  // Body by body in the order in which they came: numbers are given anew, and a run that went back has skipped some.
  ++report_.frames;
  if (places_.size() != frame_.bodies.size()) {
    differ("found " + std::to_string(places_.size()) + " bodies, recorded were " +
           std::to_string(frame_.bodies.size()));
    return {};
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const BodyPlace& now = places_[i];
    const scene::RecordedBody& then = frame_.bodies[i];
    if (now.position == then.position && now.rotation == then.rotation && now.awake == !then.asleep) continue;
    std::vector<BodyView> views;
    const std::vector<std::uint32_t> only{now.id};
    simulation_->describe(&only, views);
    std::string name = "body " + std::to_string(now.id);
    if (!views.empty() && !views[0].name.empty()) name += " (" + views[0].name + ")";
    if (now.position == then.position && now.rotation == then.rotation)
      differ(name + (now.awake ? " is awake, recorded as asleep" : " sleeps, recorded as awake"));
    else
      differ(name + " is " + shown_number("%.3g", math::length(now.position - then.position)) +
             " m from where it was recorded");
    return {};
  }
  if (frame_.has_hash) {
    ++report_.hashes;
    if (const std::uint64_t hash = simulation_->state_hash(); hash != frame_.state_hash) {
      char text[120];
      std::snprintf(text, sizeof text,
                    "the state hash is %016llx, recorded was %016llx, though every body lies the same",
                    static_cast<unsigned long long>(hash), static_cast<unsigned long long>(frame_.state_hash));
      differ(text);
      return {};
    }
  }
  agreed_ = frame_.step;
  return {};
}

core::Status Replay::advance(double milliseconds) {
  double spent = 0;
  for (int steps = 0; !report_.done && steps < 64 && spent <= milliseconds; ++steps) {
    // A recording holds what was done in the frame that follows it.
    for (const std::string& text : frame_.actions) {
      core::Result<DeedAtStep> done = read_deed_at_step(text);
      if (!done.ok()) return core::Error{"replay: step " + std::to_string(frame_.step) + ": " + done.error().message};
      due_.push_back(std::move(done).value());
    }
    frame_.actions.clear();
    while (!report_.done && simulation_->step_count() < frame_.step && spent <= milliseconds) {
      if (const core::Status status = step(); !status.ok()) return status;
      spent += math::max(0.02, simulation_->profile().total);
    }
    if (report_.done || simulation_->step_count() < frame_.step) continue;
    if (simulation_->step_count() > frame_.step) {
      differ("no such step comes in the run");
      break;
    }
    if (const core::Status status = compare(); !status.ok()) return status;
    if (report_.done) break;
    if (++index_ == recording_->frame_count()) {
      report_.done = true;
      break;
    }
    core::Result<scene::RecordedFrame> next = recording_->frame(index_);
    if (!next.ok()) return next.error();
    frame_ = std::move(next).value();
  }
  return {};
}

}  // namespace carom::host
