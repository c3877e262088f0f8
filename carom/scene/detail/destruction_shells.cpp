#include "carom/core/string.h"
#include "carom/scene/detail/destruction.h"
#include "carom/scene/detail/destruction_fields.h"

namespace carom::scene::detail {

ballistics::Shell read_shell_itself(Reader& r, const Object& o) {
  ballistics::Shell shell;
  for (const char* needed : {"mass", "diameter", "axial_inertia", "transverse_inertia"})
    if (!r.failed() && !o.has(needed)) r.fail(*o.node, o.path, core::text("the key \"", needed, "\" is missing"));
  shell.mass = r.number(o, "mass", 0);
  shell.diameter = r.number(o, "diameter", 0);
  shell.axial_inertia = r.number(o, "axial_inertia", 0);
  shell.transverse_inertia = r.number(o, "transverse_inertia", 0);
  shell.twist = r.number(o, "twist", shell.twist);
  shell.length = r.number(o, "length", 0);
  shell.centre = r.number(o, "centre", 0);
  const Node* const list = o.find("aerodynamics");
  if (!r.failed() && (list == nullptr || !list->is_array() || list->children.empty() || list->children.size() > 200))
    r.expected(list != nullptr ? *list : *o.node, o.path_of("aerodynamics"), "a list of 1 to 200 rows");
  each_entry(r, o, "aerodynamics", shell_row_kind, [&](const Object& row) {
    shell.aerodynamics.push_back({.mach = r.number(row, "mach", 0),
                                  .axial = r.number(row, "axial", 0),
                                  .axial_yaw = r.number(row, "axial_yaw", 0),
                                  .normal = r.number(row, "normal", 0),
                                  .magnus_force = r.number(row, "magnus_force", 0),
                                  .roll_damping = r.number(row, "roll_damping", 0),
                                  .overturning = r.number(row, "overturning", 0),
                                  .pitch_damping = r.number(row, "pitch_damping", 0),
                                  .magnus_moment = r.number(row, "magnus_moment", 0)});
  });
  if (!r.failed()) r.accept(ballistics::check(shell), *o.node, o.path);
  return shell;
}

void read_shell(DestructionPlace<rigid::Dim3>& place, const Object& o) {
  Reader& r = place.reader;
  std::string name;
  std::uint32_t color = 0;
  auto& list = place.out.of<rigid::Dim3>().shells;
  if (!name_flying_body(place, o, "shell", list, name, color)) return;
  Object itself;
  if (!r.open(*o.find("shell"), o.path_of("shell"), shell_kind, itself)) return;
  ballistics::BodyShellDef def;
  def.shell = read_shell_itself(r, itself);
  def.model = ballistics::ShellModel(r.choice(o, "model", 0));
  def.start.position = r.vector(o, "position");
  const math::Vec3d direction = r.vector(o, "direction", {1, 0, 0});
  const double speed = r.number(o, "speed", 0);
  def.spin = r.number(o, "spin", 0);
  def.tip = r.vector(o, "tip");
  def.fired_at = r.number(o, "start", 0);
  def.sticks = r.flag(o, "sticks", false);
  const SurfaceDefaults surface = read_surface(r, place.library, o, {});
  const auto argb = r.color(o, "color");
  const bool trail = r.flag(o, "trail", false);
  if (r.failed()) return;
  if (!(speed > 0 && speed <= 1e4)) return r.expected(*o.find("speed"), o.path_of("speed"), "more than 0 to 10^4 m/s");
  if (!(math::length(direction) > 1e-9))
    return r.expected(*o.find("direction"), o.path_of("direction"), "a direction that is not zero");
  def.start.velocity = speed * math::normalize(direction);
  def.shape.material = surface.material;
  def.shape.filter = surface.filter;
  def.conditions = own_flight_conditions(def.start.position, place.world, place.around, true);
  def.world_turns = true;
  def.name = name;
  auto made = ballistics::BodyShell::make(place.world, def);
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return;
  place.scene.bodies.push_back({name, made->body(), argb.value_or(0), argb.has_value(), trail});
  list.push_back({std::move(name), color, std::move(*made)});
}

}  // namespace carom::scene::detail
