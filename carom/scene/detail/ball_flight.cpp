#include "carom/scene/detail/ball_flight.h"

#include "carom/scene/detail/ball_release.h"
#include "carom/scene/detail/joint_fields.h"
#include "carom/sports/effector.h"
#include "carom/sports/numbers.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view side_kinds[] = {"none", "held_seam", "turning_seam", "wandering_wake"};
constexpr std::string_view lift_shapes[] = {"rational", "hyperbolic"};

constexpr Field ball_air_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"mass", T::quantity, M::mass, "of the model; the body's is that of its shapes"},
    {"radius", T::quantity, M::length, "of the frontal area and of the spin parameter"},
    {"inertia_factor", T::quantity, M::plain, "I/(m r^2): .4 solid, 2/3 a shell"},
    {"drag", T::quantity, M::plain, "C_D beyond the crisis, without spin"},
    {"drag_crisis", T::quantity, M::plain, "more below the crisis"},
    {"critical_reynolds", T::quantity, M::plain, "where the crisis is halfway"},
    {"crisis_steepness", T::quantity},
    {"drag_spin_rise", T::quantity, M::plain, "most that spin adds to C_D"},
    {"drag_spin_scale", T::quantity, M::plain, "S where it does"},
    {"drag_spin_slope", T::quantity, M::plain, "C_D per S"},
    {"lift", T::quantity, M::plain, "C_L at most"},
    {"lift_shape", T::choice, M::plain, "s = S/(S + scale), or tanh(S/scale)", nullptr, lift_shapes},
    {"lift_spin_scale", T::quantity, M::plain, "S where lift saturates"},
    {"lift_fade", T::quantity, M::plain, "part of the lift lost below the crisis"},
    {"spin_damping", T::quantity, M::plain, "C_m of the torque that takes the spin"},
    {"side_force", T::quantity, M::plain, "C_S of a seam or wake"},
    {"side_kind", T::choice, M::plain, "", nullptr, side_kinds},
    {"seam_best_angle", T::quantity, M::angle},
    {"seam_reverse_reynolds", T::quantity},
    {"seam_cycles", T::quantity, M::plain, "cycles of the force a turn of the ball"},
    {"wake_strouhal", T::quantity},
};

}  // namespace

const ObjectKind ball_air_kind{"ball_air", "What the air does to a ball, as in presets/flight.", ball_air_fields};

template <class D>
rigid::EffectorDef<D> read_ball_flight(Reader& reader, const Object& o, rigid::BodyId body, rigid::World<D>* world) {
  const auto fail = [&](std::string_view what) {
    reader.fail(*o.node, o.path, what);
    return rigid::LinearDrag<D>{};
  };
  if (!o.has("body")) return fail("the key \"body\" is missing in a ball_flight");
  if (!o.has("flight"))
    return fail("the key \"flight\" is missing in a ball_flight: {\"preset\": \"flight/golf\"}, say");
  Object e;
  if (!reader.open(*o.find("flight"), o.path_of("flight"), ball_air_kind, e)) return rigid::LinearDrag<D>{};
  std::vector<sports::Number> numbers;
  for (const sports::NumberName& number : sports::ball_number_names())
    if (e.has(number.name)) numbers.push_back({number.name, reader.number(e, number.name, 0)});
  const int side = reader.choice(e, "side_kind", 0), lift = reader.choice(e, "lift_shape", 0);
  sports::Conditions conditions;
  conditions.air = environment::AirColumn::uniform(reader.number(o, "density", 1.225));
  conditions.viscosity = reader.number(o, "viscosity", conditions.viscosity);
  conditions.wind = environment::WindColumn(reader.vector(o, "velocity"));
  const math::Vec3d seam = reader.vector(o, "axis", {0, 0, 1});
  if (reader.failed()) return rigid::LinearDrag<D>{};
  auto ball = sports::ball_from_numbers(numbers, side_kinds[std::size_t(side)], lift_shapes[std::size_t(lift)]);
  if (!ball) return fail(ball.error().message);
  const double length = math::length(seam);
  if (!(length > 0)) {
    reader.expected(*o.find("axis"), o.path_of("axis"), "a direction across the seam");
    return rigid::LinearDrag<D>{};
  }
  ball->side.seam_normal = seam / length;
  if (!reader.accept(sports::check(*ball), *e.node, e.path)) return rigid::LinearDrag<D>{};
  if constexpr (D::dimension == 3) {
    const std::optional<BallRelease> release = read_ball_release(reader, o, *ball, conditions);
    if (reader.failed()) return rigid::LinearDrag<D>{};
    if (release && o.has("delivery")) ball->side.seam_normal = release->seam_normal;
    if (release && world != nullptr) {
      const auto state = world->state(body);
      core::Status put = state ? core::Status{} : core::Status{state.error()};
      if (put && release->position) put = world->set_pose(body, *release->position, state->pose.rotation);
      if (put) put = world->set_velocity(body, math::Vec3f(release->velocity), math::Vec3f(release->spin));
      if (!reader.accept(put, *o.node, o.path)) return rigid::LinearDrag<D>{};
    }
    return sports::flight_effector(*ball, conditions, body, reader.step, o.has("density"), o.has("velocity"),
                                   release ? release->spin : math::Vec3d{});
  } else {
    return fail("a ball_flight is of space only: balls curve out of the plane");
  }
}

template rigid::EffectorDef<rigid::Dim2> read_ball_flight<rigid::Dim2>(Reader&, const Object&, rigid::BodyId,
                                                                       rigid::World2*);
template rigid::EffectorDef<rigid::Dim3> read_ball_flight<rigid::Dim3>(Reader&, const Object&, rigid::BodyId,
                                                                       rigid::World3*);

}  // namespace carom::scene::detail
