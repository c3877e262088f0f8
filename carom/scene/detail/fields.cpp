#include "carom/scene/detail/fields.h"

#include "carom/scene/detail/body_fields.h"
#include "carom/scene/detail/destruction_fields.h"
#include "carom/scene/detail/environment_fields.h"
#include "carom/scene/detail/joint_fields.h"
#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view kind_choices[] = {"rigid", "flight"};
constexpr std::string_view joint_solvers[] = {"automatic", "iterative", "direct"};
constexpr std::string_view series_styles[] = {"line", "points"};
constexpr std::string_view earth_models[] = {"flat", "round", "wgs84"};
constexpr std::string_view gravity_models[] = {"uniform", "inverse_square"};
constexpr std::string_view method_choices[] = {"rk4", "heun", "midpoint", "euler", "dormand_prince"};
constexpr std::string_view rate_frames[] = {"inertial", "ground"};

constexpr Field parameter_fields[] = {
    {"value", T::quantity, M::count_, "the default", nullptr, {}, true},
    {"minimum", T::quantity, M::count_, "smallest value allowed", nullptr, {}, true},
    {"maximum", T::quantity, M::count_, "largest value allowed", nullptr, {}, true},
    {"step", T::quantity, M::count_, "step of a slider"},
    {"unit", T::text, M::plain, "unit to show; by default the unit of the value"},
    {"label", T::text, M::plain, "name for people"},
    {"description", T::text, M::plain, "what it does"},
    {"live", T::flag, M::plain, "may change while the scene runs"},
};
const ObjectKind parameter_kind{"parameter", "A number that a command line, a sweep or a slider may change.",
                                parameter_fields};

constexpr Field group_fields[] = {
    {"repeat",
     T::map,
     M::plain,
     "loop variables and their counts, the outermost first; a count may use earlier variables",
     nullptr,
     {},
     true},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this turn out"},
    {"bodies", T::list, M::plain, "", &body_kind},
    {"joints", T::list, M::plain, "", &joint_kind},
    {"effectors", T::list, M::plain, "", &effector_kind},
    {"ropes", T::list, M::plain, "ropes", &rope_kind, {}, false, 3},
    {"cloths", T::list, M::plain, "cloths", &cloth_kind, {}, false, 3},
    {"soft_bodies", T::list, M::plain, "soft bodies", &soft_body_kind, {}, false, 3},
    {"liquids", T::list, M::plain, "liquids", &liquid_kind},
    {"grains", T::list, M::plain, "sand, gravel, beads", &grains_kind},
    {"particles", T::list, M::plain, "systems of particles", &particles_kind},
    {"structures", T::list, M::plain, "solids that break", &structure_kind},
    {"explosions", T::list, M::plain, "charges", &explosion_kind},
    {"guns", T::list, M::plain, "guns", &gun_kind},
    {"rockets", T::list, M::plain, "rockets", &rocket_kind, {}, false, 3},
    {"shells", T::list, M::plain, "spinning shells", &fired_shell_kind, {}, false, 3},
    {"characters", T::list, M::plain, "", &character_kind},
};
const ObjectKind group_kind{
    "group", "Bodies, joints, effectors, ropes and so on made again for every value of the loop variables.",
    group_fields};

constexpr Field camera_fields[] = {
    {"position", T::vector, M::length, "of the eye", nullptr, {}, false, 3},
    {"target", T::vector, M::length, "middle of the picture"},
    {"field_of_view", T::quantity, M::angle, "", nullptr, {}, false, 3},
    {"height", T::quantity, M::length, "shown from bottom to top", nullptr, {}, false, 2},
    {"width", T::quantity, M::length, "shown from left to right at least", nullptr, {}, false, 2},
    {"follow", T::name, M::plain, "name of a body"},
};
const ObjectKind camera_kind{"camera", "Where pictures are taken from.", camera_fields};
constexpr Field axis_fields[] = {
    {"quantity", T::text, M::plain, "expression of the world's quantities (x axis; time unless given)"},
    {"label", T::text},
    {"unit", T::text, M::plain, "to show the numbers in, and of the numbers in points"},
};
const ObjectKind axis_kind{"axis", "An axis of a plot.", axis_fields};
constexpr Field series_fields[] = {
    {"name", T::text, M::plain, "", nullptr, {}, true},
    {"quantity", T::text, M::plain, "expression of the world's quantities"},
    {"points", T::any, M::plain, "a fixed curve instead: a list of [x, y] in the units of the axes"},
    {"style", T::choice, M::plain, "", nullptr, series_styles},
    {"source", T::text, M::plain, "of published points"},
};
const ObjectKind series_kind{"series", "A curve of a plot.", series_fields};
constexpr Field plot_fields[] = {
    {"title", T::text, M::plain, "", nullptr, {}, true},
    {"x", T::object, M::plain, "", &axis_kind},
    {"y", T::object, M::plain, "", &axis_kind},
    {"interval", T::quantity, M::time, "between samples; every step where absent"},
    {"series", T::list, M::plain, "", &series_kind, {}, true},
};
const ObjectKind plot_kind{"plot", "Quantities drawn over time or over one another.", plot_fields};
constexpr Field expectation_fields[] = {
    {"time", T::quantity, M::time, "when to look; at the end where absent"},
    {"quantity", T::text, M::plain, "expression of the world's quantities", nullptr, {}, true},
    {"expected", T::quantity, M::count_, "", nullptr, {}, true},
    {"tolerance", T::quantity, M::count_, "largest difference allowed", nullptr, {}, true},
    {"source", T::text, M::plain, "where the number comes from"},
};
const ObjectKind expectation_kind{"expectation", "A number that the run must reach.", expectation_fields};

constexpr Field material_pair_fields[] = {
    {"materials", T::number_list, M::plain, "the user_ids of the two materials", nullptr, {}, true},
    {"pair", T::text, M::plain, "both frictions of a pair of the table of friction, as rubber on asphalt, wet"},
    {"friction", T::quantity, M::plain, "Coulomb's coefficient, at least 0: of what slides"},
    {"static_friction", T::quantity, M::plain, "of what sticks, at least friction; as friction unless given"},
    {"restitution", T::quantity, M::plain, "0 to 1"},
    {"rolling_resistance", T::quantity, M::plain, "lever arm over radius, at least 0"},
    {"spinning_resistance", T::quantity, M::plain, "likewise, of what spins about the normal (3D)"},
};
const ObjectKind material_pair_kind{"material_pair", "What holds between two materials instead of the mixture.",
                                    material_pair_fields};

constexpr Field world_fields[] = {
    {"restitution_threshold", T::quantity, M::speed, "slower impacts do not bounce"},
    {"contact_frequency", T::quantity, M::frequency, "stiffness of contacts"},
    {"contact_damping_ratio", T::quantity, M::plain},
    {"contact_push_speed", T::quantity, M::speed, "overlapping bodies separate no faster"},
    {"joint_frequency", T::quantity, M::frequency, "stiffness of joints"},
    {"joint_damping_ratio", T::quantity, M::plain},
    {"joint_solver", T::choice, M::plain, "who holds joints: automatic, iterative or direct", nullptr, joint_solvers},
    {"maximum_linear_speed", T::quantity, M::speed},
    {"sleep_time", T::quantity, M::time, "below the sleep speed before an island sleeps"},
    {"allow_sleep", T::flag},
    {"continuous", T::flag, M::plain, "fast bodies never pass through static geometry"},
    {"material_pairs", T::list, M::plain, "rules for pairs of materials", &material_pair_kind},
};
const ObjectKind world_kind{"world", "Settings of the engine.", world_fields};

constexpr Field earth_fields[] = {
    {"model", T::choice, M::plain, "shape and frame of the Earth", nullptr, earth_models, true},
    {"gravity", T::choice, M::plain, "of a flat Earth", nullptr, gravity_models},
    {"radius", T::quantity, M::length,
     "of a round Earth, at the equator of wgs84, of a flat one with inverse_square gravity"},
    {"gm", T::quantity, M::gravitational_parameter},
    {"uniform_gravity", T::quantity, M::acceleration},
    {"rotation", T::quantity, M::angular_speed, "of wgs84 about the polar axis"},
    {"j2", T::quantity, M::plain, "of wgs84, second zonal harmonic"},
};
const ObjectKind earth_kind{"earth", "What the flight is flown over.", earth_fields};
constexpr Field vehicle_fields[] = {
    {"mass", T::quantity, M::mass, "", nullptr, {}, true},
    {"inertia",
     T::number_list,
     M::inertia,
     "Ixx, Iyy, Izz about the centre of mass; x forward, y to starboard, z down",
     nullptr,
     {},
     true},
    {"drag_coefficient", T::quantity, M::plain, "constant, in the US Standard Atmosphere 1976"},
    {"reference_area", T::quantity, M::area},
};
const ObjectKind vehicle_kind{"vehicle", "The body in flight.", vehicle_fields};
constexpr Field initial_fields[] = {
    {"latitude", T::quantity, M::angle, "geodetic"},
    {"longitude", T::quantity, M::angle},
    {"altitude", T::quantity, M::length, "above the surface"},
    {"velocity", T::number_list, M::speed, "north, east and down, over the ground"},
    {"yaw", T::quantity, M::angle},
    {"pitch", T::quantity, M::angle},
    {"roll", T::quantity, M::angle},
    {"rates", T::number_list, M::angular_speed, "p, q, r in body axes"},
    {"rates_relative_to", T::choice, M::plain, "", nullptr, rate_frames},
};
const ObjectKind initial_kind{"initial", "The state at the start.", initial_fields};
constexpr Field flight_fields[] = {
    {"earth", T::object, M::plain, "", &earth_kind, {}, true},
    {"vehicle", T::object, M::plain, "", &vehicle_kind, {}, true},
    {"initial", T::object, M::plain, "", &initial_kind, {}, true},
    {"method", T::choice, M::plain, "of integration", nullptr, method_choices},
};
const ObjectKind flight_kind{"flight", "A free body with six degrees of freedom, integrated in double precision.",
                             flight_fields};

constexpr Field scene_fields[] = {
    {"$schema", T::text},
    {"name", T::text},
    {"description", T::text},
    {"source", T::text, M::plain, "where numbers of the scene come from"},
    {"kind", T::choice, M::plain, "a world of rigid bodies unless given", nullptr, kind_choices},
    {"dimension", T::integer, M::plain, "2 or 3"},
    {"step", T::quantity, M::time, "of the engine, 1/60 s unless given"},
    {"substeps", T::integer, M::plain, "of the solver, 1 to 64"},
    {"duration", T::quantity, M::time, "of a run, 10 s unless given"},
    {"loop", T::flag, M::plain, "the playground starts it anew after its duration"},
    {"gravity", T::vector, M::acceleration},
    {"world", T::object, M::plain, "", &world_kind},
    {"ground", T::quantity, M::length, "height of a ground plane that pictures draw"},
    {"include", T::list, M::plain,
     "files whose materials, shapes, parameters, bodies, joints, effectors, ropes and so on come first"},
    {"parameters", T::map, M::plain, "", &parameter_kind},
    {"materials", T::map, M::plain, "", &material_kind},
    {"shapes", T::map, M::plain, "", &shape_kind},
    {"bodies", T::list, M::plain, "bodies and groups", &body_kind},
    {"joints", T::list, M::plain, "joints and groups", &joint_kind},
    {"effectors", T::list, M::plain, "effectors and groups", &effector_kind},
    {"ropes", T::list, M::plain, "ropes and groups", &rope_kind, {}, false, 3},
    {"cloths", T::list, M::plain, "cloths and groups", &cloth_kind, {}, false, 3},
    {"soft_bodies", T::list, M::plain, "soft bodies and groups", &soft_body_kind, {}, false, 3},
    {"liquids", T::list, M::plain, "liquids and groups", &liquid_kind},
    {"grains", T::list, M::plain, "sand, gravel, beads and groups", &grains_kind},
    {"particles", T::list, M::plain, "systems of particles and groups", &particles_kind},
    {"structures", T::list, M::plain, "solids that break, and groups", &structure_kind},
    {"explosions", T::list, M::plain, "charges and groups", &explosion_kind},
    {"guns", T::list, M::plain, "guns and groups", &gun_kind},
    {"rockets", T::list, M::plain, "rockets and groups", &rocket_kind, {}, false, 3},
    {"shells", T::list, M::plain, "spinning shells and groups", &fired_shell_kind, {}, false, 3},
    {"penetration", T::list, M::plain, "what projectiles go through; all else stops them", &penetration_kind},
    {"characters", T::list, M::plain, "characters and groups", &character_kind},
    {"environment", T::object, M::plain, "gravity, air, wind and water around the bodies", &environment_kind},
    {"camera", T::object, M::plain, "", &camera_kind},
    {"plots", T::list, M::plain, "", &plot_kind},
    {"expectations", T::list, M::plain, "", &expectation_kind},
    {"flight", T::object, M::plain, "where kind is flight", &flight_kind},
};
const ObjectKind scene_kind{"scene", "A Carom scene.", scene_fields};
constexpr Field part_fields[] = {
    {"$schema", T::text},
    {"name", T::text},
    {"description", T::text},
    {"source", T::text},
    {"include", T::list},
    {"parameters", T::map, M::plain, "", &parameter_kind},
    {"materials", T::map, M::plain, "", &material_kind},
    {"shapes", T::map, M::plain, "", &shape_kind},
    {"bodies", T::list, M::plain, "", &body_kind},
    {"joints", T::list, M::plain, "", &joint_kind},
    {"effectors", T::list, M::plain, "", &effector_kind},
    {"ropes", T::list, M::plain, "ropes", &rope_kind, {}, false, 3},
    {"cloths", T::list, M::plain, "cloths", &cloth_kind, {}, false, 3},
    {"soft_bodies", T::list, M::plain, "soft bodies", &soft_body_kind, {}, false, 3},
    {"liquids", T::list, M::plain, "liquids", &liquid_kind},
    {"grains", T::list, M::plain, "sand, gravel, beads", &grains_kind},
    {"particles", T::list, M::plain, "systems of particles", &particles_kind},
    {"structures", T::list, M::plain, "solids that break", &structure_kind},
    {"explosions", T::list, M::plain, "charges", &explosion_kind},
    {"guns", T::list, M::plain, "guns", &gun_kind},
    {"rockets", T::list, M::plain, "rockets", &rocket_kind, {}, false, 3},
    {"shells", T::list, M::plain, "spinning shells", &fired_shell_kind, {}, false, 3},
    {"penetration", T::list, M::plain, "what projectiles go through; all else stops them", &penetration_kind},
    {"characters", T::list, M::plain, "", &character_kind},
};
const ObjectKind part_kind{"part", "A file that scenes include.", part_fields};
constexpr Field preset_fields[] = {
    {"$schema", T::text},
    {"description", T::text, M::plain, "", nullptr, {}, true},
    {"source", T::text, M::plain, "where the numbers come from", nullptr, {}, true},
    {"values", T::any, M::plain, "the keys that the preset gives", nullptr, {}, true},
};
const ObjectKind preset_kind{"preset", "Values under a name, for the key preset.", preset_fields};

const ObjectKind* const all_kinds[] = {&scene_kind,
                                       &world_kind,
                                       &material_pair_kind,
                                       &parameter_kind,
                                       &material_kind,
                                       &filter_kind,
                                       &surface_kind,
                                       &shape_kind,
                                       &rotation_kind,
                                       &body_kind,
                                       &character_kind,
                                       &mass_properties_kind,
                                       &group_kind,
                                       &joint_kind,
                                       &frame_kind,
                                       &joint_axis_kind,
                                       &joint_axes_kind,
                                       &spring_kind,
                                       &limit_kind,
                                       &motor_kind,
                                       &effector_kind,
                                       &wave_kind,
                                       &ball_air_kind,
                                       &camera_kind,
                                       &plot_kind,
                                       &axis_kind,
                                       &series_kind,
                                       &expectation_kind,
                                       &flight_kind,
                                       &earth_kind,
                                       &vehicle_kind,
                                       &initial_kind,
                                       &environment_kind,
                                       &gravity_field_kind,
                                       &turning_frame_kind,
                                       &air_kind,
                                       &wind_field_kind,
                                       &wind_layer_kind,
                                       &gust_kind,
                                       &turbulence_kind,
                                       &thermal_kind,
                                       &obstacle_kind,
                                       &wake_kind,
                                       &sea_kind,
                                       &sea_wave_kind,
                                       &rope_kind,
                                       &rope_attachment_kind,
                                       &rope_winch_kind,
                                       &rope_lump_kind,
                                       &cloth_kind,
                                       &pin_kind,
                                       &soft_body_kind,
                                       &liquid_kind,
                                       &fill_kind,
                                       &tap_kind,
                                       &drain_kind,
                                       &grains_kind,
                                       &particles_kind,
                                       &emitter_kind,
                                       &sub_emission_kind,
                                       &attractor_kind,
                                       &touch_kind,
                                       &burst_kind,
                                       &structure_kind,
                                       &bowled_kind,
                                       &pitched_kind,
                                       &golf_shot_kind,
                                       &explosion_kind,
                                       &case_kind,
                                       &gun_kind,
                                       &sway_kind,
                                       &rocket_kind,
                                       &stage_kind,
                                       &rocket_motor_kind,
                                       &fired_shell_kind,
                                       &shell_kind,
                                       &shell_row_kind,
                                       &ammunition_kind,
                                       &sight_kind,
                                       &penetration_kind,
                                       &layer_kind};

}  // namespace

const FieldTables& tables() {
  static const FieldTables t{.scene = &scene_kind,
                             .part = &part_kind,
                             .world = &world_kind,
                             .material_pair = &material_pair_kind,
                             .parameter = &parameter_kind,
                             .material = &material_kind,
                             .filter = &filter_kind,
                             .surface = &surface_kind,
                             .shape = &shape_kind,
                             .body = &body_kind,
                             .character = &character_kind,
                             .mass_properties = &mass_properties_kind,
                             .group = &group_kind,
                             .joint = &joint_kind,
                             .joint_axis = &joint_axis_kind,
                             .joint_axes = &joint_axes_kind,
                             .frame = &frame_kind,
                             .spring = &spring_kind,
                             .limit = &limit_kind,
                             .motor = &motor_kind,
                             .effector = &effector_kind,
                             .wave = &wave_kind,
                             .camera = &camera_kind,
                             .plot = &plot_kind,
                             .axis = &axis_kind,
                             .series = &series_kind,
                             .expectation = &expectation_kind,
                             .rotation = &rotation_kind,
                             .preset = &preset_kind,
                             .flight = &flight_kind,
                             .earth = &earth_kind,
                             .vehicle = &vehicle_kind,
                             .initial = &initial_kind,
                             .rope = &rope_kind,
                             .cloth = &cloth_kind,
                             .soft_body = &soft_body_kind,
                             .liquid = &liquid_kind,
                             .grains = &grains_kind,
                             .particles = &particles_kind,
                             .structure = &structure_kind,
                             .explosion = &explosion_kind,
                             .gun = &gun_kind,
                             .all = all_kinds};
  return t;
}

}  // namespace carom::scene::detail
