#include "apps/host/deed.h"

#include <iterator>

#include "apps/host/message_fields.h"

namespace carom::host {

namespace {

using Json = nlohmann::json;

constexpr const char* deed_names[] = {"set", "input", "grab", "drag", "release", "release_all", "spawn"};
constexpr const char* spawn_forms[] = {"ball", "box", "capsule"};

Json vector_list(math::Vec3d v) { return Json::array({v.x, v.y, v.z}); }

}  // namespace

bool is_deed(const std::string& type) {
  for (const char* kind : deed_names)
    if (type == kind) return true;
  return false;
}

core::Result<Deed> read_deed(const Json& message) {
  MessageFields field(message);
  const std::string type = field.text("type");
  Deed deed;
  std::size_t kind = 0;
  while (kind < std::size(deed_names) && type != deed_names[kind]) ++kind;
  if (kind == std::size(deed_names)) field.wrong("type", "something that is done to a run");
  deed.kind = Deed::Kind(kind);
  switch (deed.kind) {
    case Deed::Kind::set:
    case Deed::Kind::input:
      deed.name = field.text(deed.kind == Deed::Kind::set ? "name" : "action");
      deed.value = field.number("value");
      break;
    case Deed::Kind::grab:
      deed.pointer = field.pointer();
      deed.at = field.vector("origin");
      deed.along = field.direction("direction");
      break;
    case Deed::Kind::drag:
      deed.pointer = field.pointer();
      deed.at = field.vector("target");
      break;
    case Deed::Kind::release:
      deed.pointer = field.pointer();
      break;
    case Deed::Kind::release_all:
      break;
    case Deed::Kind::spawn: {
      const std::string form = field.text("form");
      deed.spawned.size = field.number("size");
      deed.spawned.density = field.number("density");
      deed.spawned.position = field.vector("position");
      deed.spawned.velocity = field.vector("velocity");
      std::size_t known = 0;
      while (known < std::size(spawn_forms) && form != spawn_forms[known]) ++known;
      if (known == std::size(spawn_forms)) field.wrong("form", "ball, box or capsule");
      deed.spawned.form = SpawnRequest::Form(known);
      break;
    }
  }
  if (!field.status.ok()) return field.status.error();
  return deed;
}

Json deed_json(const Deed& deed) {
  Json out = {{"type", deed_names[std::size_t(deed.kind)]}};
  switch (deed.kind) {
    case Deed::Kind::set:
    case Deed::Kind::input:
      out[deed.kind == Deed::Kind::set ? "name" : "action"] = deed.name;
      out["value"] = deed.value;
      break;
    case Deed::Kind::grab:
      out["pointer"] = deed.pointer;
      out["origin"] = vector_list(deed.at);
      out["direction"] = vector_list(deed.along);
      break;
    case Deed::Kind::drag:
      out["pointer"] = deed.pointer;
      out["target"] = vector_list(deed.at);
      break;
    case Deed::Kind::release:
      out["pointer"] = deed.pointer;
      break;
    case Deed::Kind::release_all:
      break;
    case Deed::Kind::spawn:
      out["form"] = spawn_forms[std::size_t(deed.spawned.form)];
      out["size"] = deed.spawned.size;
      out["density"] = deed.spawned.density;
      out["position"] = vector_list(deed.spawned.position);
      out["velocity"] = vector_list(deed.spawned.velocity);
      break;
  }
  return out;
}

DeedOutcome do_deed(Simulation& simulation, const Deed& deed) {
  DeedOutcome out;
  switch (deed.kind) {
    case Deed::Kind::set: {
      const core::Result<bool> live = simulation.set(deed.name, deed.value);
      if (live.ok())
        out.live = *live;
      else
        out.status = live.error();
      break;
    }
    case Deed::Kind::input:
      out.status = simulation.input(deed.name, deed.value);
      break;
    case Deed::Kind::grab:
      out.grabbed = simulation.grab(deed.pointer, deed.at, deed.along);
      break;
    case Deed::Kind::drag:
      out.status = simulation.drag(deed.pointer, deed.at);
      break;
    case Deed::Kind::release:
      simulation.release(deed.pointer);
      break;
    case Deed::Kind::release_all:
      simulation.release_all();
      break;
    case Deed::Kind::spawn:
      out.status = simulation.spawn(deed.spawned);
      break;
  }
  return out;
}

}  // namespace carom::host
