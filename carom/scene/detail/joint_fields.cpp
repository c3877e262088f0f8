#include "carom/scene/detail/joint_fields.h"

#include "carom/scene/detail/body_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view joint_types[] = {"distance",    "ball",    "hinge",     "slider", "weld",  "motor",
                                            "mouse",       "generic", "gear",      "rack",   "screw", "pulley",
                                            "cylindrical", "planar",  "universal", "wheel",  "path"};
constexpr std::string_view effector_types[] = {"spherical_gravity",
                                               "linear_drag",
                                               "quadratic_drag",
                                               "wind",
                                               "spring",
                                               "buoyancy",
                                               "thrust",
                                               "radial_field",
                                               "vortex_field",
                                               "body_drag",
                                               "magnus_lift",
                                               "turning_frame",
                                               "electromagnetic_field",
                                               "projectile",
                                               "ball_flight",
                                               "lifting_surface",
                                               "cylinder_drag",
                                               "force_field"};
constexpr std::string_view drag_laws[] = {"constant", "sphere", "cylinder", "disc", "by_reynolds", "by_mach"};
constexpr std::string_view lift_balls[] = {"rough_ball", "baseball", "tennis_ball"};
}  // namespace

constexpr Field frame_fields[] = {
    {"position", T::vector, M::length, "in the body's frame"},
    {"rotation", T::rotation, M::angle, "in the body's frame", &rotation_kind},
};
const ObjectKind frame_kind{"frame", "A joint's frame in a body.", frame_fields};

constexpr Field spring_fields[] = {
    {"frequency", T::quantity, M::frequency, "natural frequency, 0: no spring"},
    {"damping_ratio", T::quantity, M::plain, "1: critical"},
};
const ObjectKind spring_kind{"spring", "A spring toward the rest state.", spring_fields};

constexpr Field limit_fields[] = {
    {"lower", T::quantity, M::count_, "length or angle", nullptr, {}, true},
    {"upper", T::quantity, M::count_, "length or angle", nullptr, {}, true},
    {"enabled", T::flag},
};
const ObjectKind limit_kind{"limit", "The range of a joint's coordinate.", limit_fields};

constexpr Field motor_fields[] = {
    {"speed", T::quantity, M::count_, "speed or angular speed", nullptr, {}, true},
    {"max_force", T::quantity, M::force, "of sliders and distance joints"},
    {"max_torque", T::quantity, M::torque, "of hinges"},
    {"enabled", T::flag},
};
const ObjectKind motor_kind{"motor", "Drives a joint's coordinate.", motor_fields};

constexpr Field joint_axis_fields[] = {
    {"free", T::flag, M::plain, "by default true"},
    {"limit", T::object, M::plain, "", &limit_kind},
    {"spring", T::object, M::plain, "", &spring_kind},
    {"target", T::quantity, M::count_, "length or angle, of the spring"},
    {"max_spring_force", T::quantity, M::force, "of a linear axis; with a stiff spring a motor to a position"},
    {"max_spring_torque", T::quantity, M::torque, "of an angular axis"},
    {"motor", T::object, M::plain, "", &motor_kind},
    {"friction", T::quantity, M::force, "of a linear axis, where no motor is"},
    {"friction_torque", T::quantity, M::torque, "of an angular axis, where no motor is"},
};
const ObjectKind joint_axis_kind{"joint_axis", "A coordinate of a generic joint.", joint_axis_fields};

constexpr Field joint_axes_fields[] = {
    {"x", T::object, M::plain, "along x of frame A", &joint_axis_kind},
    {"y", T::object, M::plain, "", &joint_axis_kind},
    {"z", T::object, M::plain, "", &joint_axis_kind, {}, false, 3},
    {"turn_x", T::object, M::plain, "Cardan angle about x of frame A", &joint_axis_kind, {}, false, 3},
    {"turn_y", T::object, M::plain, "then about y, within ±90°", &joint_axis_kind, {}, false, 3},
    {"turn_z", T::object, M::plain, "then about z, of frame B", &joint_axis_kind},
};
const ObjectKind joint_axes_kind{"joint_axes", "What is free, and how. Axes that are not named are held.",
                                 joint_axes_fields};

constexpr Field joint_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this joint out"},
    {"type", T::choice, M::plain, "", nullptr, joint_types, true},
    {"body_a", T::name, M::plain, "name of a body, or \"world\""},
    {"body_b", T::name, M::plain, "name of a body, or \"world\""},
    {"anchor", T::vector, M::length, "where the joint is, in the world"},
    {"anchor_a", T::vector, M::length, "where it holds body A, in the world"},
    {"anchor_b", T::vector, M::length, "where it holds body B, in the world"},
    {"axis", T::vector, M::plain, "in the world: of turning (hinge), of sliding, of the cone (ball)"},
    {"frame_a", T::object, M::plain, "instead of anchor and axis", &frame_kind},
    {"frame_b", T::object, M::plain, "instead of anchor and axis", &frame_kind},
    {"collide_connected", T::flag},
    {"break_force", T::quantity, M::force, "above it the joint gives way; 0: never"},
    {"break_torque", T::quantity, M::torque, "likewise"},
    {"axes", T::object, M::plain, "generic, cylindrical, planar, universal and wheel joints", &joint_axes_kind},
    {"slide_axis", T::vector, M::plain, "in the world: of a rack, whose pinion turns about \"axis\""},
    {"ratio", T::quantity, M::plain, "gear: spin of B over spin of A; pulley: of B's side"},
    {"radius", T::quantity, M::length, "rack: of its pinion"},
    {"pitch", T::quantity, M::length, "screw: of a turn"},
    {"ground_a", T::vector, M::length, "pulley, in the world"},
    {"ground_b", T::vector, M::length, "pulley, in the world"},
    {"length", T::quantity, M::length, "distance joint and pulley; by default as the anchors are"},
    {"rope", T::flag, M::plain, "distance joint that only pulls"},
    {"points", T::point_list, M::length, "path, in the world, or in frame_a"},
    {"tangents", T::point_list, M::length, "path: from point to point, at each; none: Catmull and Rom's"},
    {"straight", T::flag, M::plain, "path: lines from point to point"},
    {"closed", T::flag, M::plain, "path: from the last point on to the first"},
    {"follow", T::flag, M::plain, "path: turns x of frame_b (or \"axis\", or the body's x) along it"},
    {"target_distance", T::quantity, M::length, "path, of the spring: from the first point"},
    {"max_spring_force", T::quantity, M::force, "slider and path, of the spring; 0: as much as it takes"},
    {"max_spring_torque", T::quantity, M::torque, "hinge, likewise; with a stiff spring a motor to a position"},
    {"friction", T::quantity, M::force, "path, where it has no motor"},
    {"spring", T::object, M::plain, "", &spring_kind},
    {"linear_spring", T::object, M::plain, "weld and motor joints", &spring_kind},
    {"angular_spring", T::object, M::plain, "weld and motor joints", &spring_kind},
    {"limit", T::object, M::plain, "", &limit_kind},
    {"motor", T::object, M::plain, "", &motor_kind},
    {"cone_angle", T::quantity, M::angle, "ball joint; negative: no limit"},
    {"twist", T::object, M::plain, "ball joint", &limit_kind},
    {"friction_torque", T::quantity, M::torque, "ball joint"},
    {"target_angle", T::quantity, M::angle, "hinge, of the spring"},
    {"target_translation", T::quantity, M::length, "slider, of the spring"},
    {"target", T::vector, M::length, "mouse joint, in the world"},
    {"target_position", T::vector, M::length, "motor joint, of frame_b in frame_a"},
    {"target_rotation", T::rotation, M::angle, "ball (of its spring) and motor joint, likewise", &rotation_kind},
    {"target_velocity", T::vector, M::speed, "motor joint, as seen from A, in the axes of frame_a"},
    {"target_spin", T::vector, M::angular_speed, "motor joint, likewise; a number in the plane"},
    {"hold_position", T::flag, M::plain, "motor joint; false: drives at target_velocity, wherever B is"},
    {"hold_rotation", T::flag, M::plain, "motor joint; false: drives at target_spin"},
    {"max_force", T::quantity, M::force, "motor and mouse joints"},
    {"max_torque", T::quantity, M::torque, "motor joint"},
};
const ObjectKind joint_kind{"joint", "Joins two bodies.", joint_fields};

constexpr Field wave_fields[] = {
    {"amplitude", T::quantity, M::length, "", nullptr, {}, true},
    {"wavelength", T::quantity, M::length, "", nullptr, {}, true},
    {"phase", T::quantity, M::angle},
};
const ObjectKind wave_kind{"wave", "A wave that runs along x.", wave_fields};

constexpr Field effector_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this effector out"},
    {"type", T::choice, M::plain, "", nullptr, effector_types, true},
    {"body", T::name, M::plain, "the body acted on; all awake dynamic bodies where absent"},
    {"center", T::vector, M::length, "spherical gravity and fields"},
    {"gm", T::quantity, M::gravitational_parameter, "spherical gravity"},
    {"minimum_radius", T::quantity, M::length, "spherical gravity"},
    {"coefficient", T::quantity, M::damping, "linear drag"},
    {"angular_coefficient", T::quantity, M::count_, "linear drag: N*m*s; quadratic drag: N*m*s^2"},
    {"density", T::quantity, M::density,
     "of the medium; projectile, ball_flight: of an air of their own, else that of the environment; where there is "
     "none, the standard atmosphere and 1.225"},
    {"drag_coefficient", T::quantity, M::plain, "quadratic drag, projectile; body drag whose law is constant"},
    {"area", T::quantity, M::area,
     "quadratic drag; body drag, that of a disc of its diameter unless given; lifting surface"},
    {"forward", T::vector, M::plain, "lifting surface: to its leading edge, in the body; x unless given"},
    {"up", T::vector, M::plain, "lifting surface: out of its upper side; y unless given", nullptr, {}, false, 3},
    {"chord", T::quantity, M::length, "lifting surface, from edge to edge"},
    {"length", T::quantity, M::length, "cylinder drag"},
    {"aspect_ratio", T::quantity, M::plain, "lifting surface: span^2 by area; 6 unless given"},
    {"zero_lift_angle", T::quantity, M::angle, "lifting surface"},
    {"stall_angle", T::quantity, M::angle, "lifting surface; 15 deg of a profile, 9 deg of a thin plate"},
    {"profile_drag", T::quantity, M::plain, "lifting surface: C_d without lift"},
    {"efficiency", T::quantity, M::plain, "lifting surface: Oswald's, of the induced drag"},
    {"point", T::vector, M::length,
     "quadratic and body drag and thrust, in the body; middle of a lifting surface or cylinder"},
    {"law", T::choice, M::plain, "body drag, sphere unless given", nullptr, drag_laws},
    {"table", T::number_list, M::plain,
     "body drag by Reynolds or Mach number, projectile by Mach number: x, C_d, x, C_d …"},
    {"logarithmic", T::flag, M::plain, "the table is linear over the logarithm of x"},
    {"diameter", T::quantity, M::length,
     "body drag, of the Reynolds number; projectile, of its frontal area; cylinder drag"},
    {"viscosity", T::quantity, M::viscosity,
     "ball_flight, beside a density; body drag, where the scene has no environment"},
    {"speed_of_sound", T::quantity, M::speed, "body drag, where the scene has no environment"},
    {"radius", T::quantity, M::length, "magnus lift"},
    {"ball", T::choice, M::plain, "magnus lift: whose measurements; rough_ball unless given", nullptr, lift_balls},
    {"lift", T::number_list, M::plain, "magnus lift: a and b of 1/(a + b/S) instead of a ball"},
    {"angular_velocity", T::vector, M::angular_speed, "turning frame; a number in the plane"},
    {"latitude", T::quantity, M::angle,
     "turning frame: the Earth's there, instead of an angular_velocity; projectile: where the Earth turns below it"},
    {"bearing", T::quantity, M::angle,
     "turning frame, projectile: of the x axis, from north over east; turning frame: 90 deg unless given"},
    {"centrifugal", T::flag, M::plain, "turning frame: the centrifugal force too"},
    {"charge", T::quantity, M::charge, "electromagnetic field, of each body"},
    {"electric", T::vector, M::electric_field, "electromagnetic field"},
    {"magnetic", T::vector, M::flux_density, "electromagnetic field; a number in the plane"},
    {"added_mass", T::vector, M::plain, "buoyancy: shares of the displaced mass along the body's axes"},
    {"added_inertia", T::vector, M::area, "buoyancy: the same for turning; a number in the plane"},
    {"velocity", T::vector, M::speed,
     "wind; projectile, ball_flight: of an air of their own, else the environment's wind"},
    {"body_a", T::name, M::plain, "spring"},
    {"body_b", T::name, M::plain, "spring; the world where absent"},
    {"point_a", T::vector, M::length, "spring, in body A"},
    {"point_b", T::vector, M::length, "spring, in body B or the world"},
    {"rest_length", T::quantity, M::length, "spring"},
    {"stiffness", T::quantity, M::stiffness, "spring"},
    {"damping", T::quantity, M::damping, "spring"},
    {"break_force", T::quantity, M::force, "spring: above it it gives way; 0: never"},
    {"level", T::quantity, M::length, "buoyancy: height of the still surface"},
    {"linear_drag", T::quantity, M::rate, "buoyancy"},
    {"angular_drag", T::quantity, M::rate, "buoyancy"},
    {"waves", T::list, M::plain, "buoyancy, at most four", &wave_kind},
    {"current", T::vector, M::speed, "buoyancy"},
    {"force", T::vector, M::force, "thrust, in the body's axes"},
    {"formula", T::any, M::plain,
     "force field: of each component, a force or an acceleration, of x, y, z, vx, vy, vz, t, m (of the body) and the "
     "parameters: [\"-k*x\", \"-k*y\", \"0 N\"]"},
    {"strength", T::quantity, M::acceleration, "radial field"},
    {"reference", T::quantity, M::length, "radial field: where the strength holds"},
    {"exponent", T::quantity, M::plain, "radial field"},
    {"range", T::quantity, M::length, "radial field"},
    {"axis", T::vector, M::plain,
     "vortex field (of space); ball_flight: across a held seam; cylinder drag, in the body: x unless given"},
    {"circulation", T::quantity, M::circulation, "vortex field"},
    {"core_radius", T::quantity, M::length, "vortex field"},
    {"rate", T::quantity, M::rate, "vortex field"},
    {"drag_function", T::choice, M::plain, "projectile", nullptr, drag_functions},
    {"ballistic_coefficient", T::quantity, M::plain, "projectile, lb/in^2; or its diameter and mass"},
    {"mass", T::quantity, M::mass, "projectile"},
    {"form_factor", T::quantity, M::plain, "projectile: multiplies the drag"},
    {"flight",
     T::object,
     M::plain,
     "ball_flight: the ball, {\"preset\": \"flight/golf\"}",
     &ball_air_kind,
     {},
     false,
     3},
    {"delivery",
     T::reference,
     M::plain,
     "ball_flight: how it is bowled, which sets its place, velocity, spin and seam at the start: a name of "
     "presets/cricket, or written here",
     &bowled_kind,
     {},
     false,
     3},
    {"pitch",
     T::reference,
     M::plain,
     "ball_flight: how it is pitched, which sets its place, velocity and spin: a name of presets/pitch, or written "
     "here",
     &pitched_kind,
     {},
     false,
     3},
    {"shot",
     T::reference,
     M::plain,
     "ball_flight: how it is struck, which sets its velocity and spin: the name of a club, or written here",
     &golf_shot_kind,
     {},
     false,
     3},
};
const ObjectKind effector_kind{"effector", "A force that acts on its own every step.", effector_fields};

}  // namespace carom::scene::detail
