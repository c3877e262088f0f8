#include "carom/scene/detail/fields.h"

#include "carom/scene/detail/destruction_fields.h"
#include "carom/scene/detail/environment_fields.h"
#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view kind_choices[] = {"rigid", "flight"};
constexpr std::string_view body_types[] = {"fixed", "kinematic", "dynamic"};
constexpr std::string_view shape_types[] = {"sphere", "capsule", "box",     "cylinder",     "cone",   "ellipsoid",
                                            "hull",   "plane",   "mesh",    "height_field", "voxels", "compound",
                                            "circle", "polygon", "segment", "chain",        "tiles"};
constexpr std::string_view character_types[] = {"kinematic", "dynamic"};
constexpr std::string_view joint_types[] = {"distance",    "ball",    "hinge",     "slider", "weld",  "motor",
                                            "mouse",       "generic", "gear",      "rack",   "screw", "pulley",
                                            "cylindrical", "planar",  "universal", "wheel",  "path"};
constexpr std::string_view joint_solvers[] = {"automatic", "iterative", "direct"};
constexpr std::string_view effector_types[] = {
    "spherical_gravity", "linear_drag",   "quadratic_drag",        "wind",         "spring",
    "buoyancy",          "thrust",        "radial_field",          "vortex_field", "body_drag",
    "magnus_lift",       "turning_frame", "electromagnetic_field", "projectile"};
constexpr std::string_view drag_laws[] = {"constant", "sphere", "cylinder", "disc", "by_reynolds", "by_mach"};
constexpr std::string_view lift_balls[] = {"rough_ball", "baseball", "tennis_ball"};
constexpr std::string_view drag_functions[] = {"g1", "g2", "g5", "g6", "g7", "g8", "gi", "gs", "ra4"};
constexpr std::string_view series_styles[] = {"line", "points"};
constexpr std::string_view earth_models[] = {"flat", "round", "wgs84"};
constexpr std::string_view gravity_models[] = {"uniform", "inverse_square"};
constexpr std::string_view method_choices[] = {"rk4", "heun", "midpoint", "euler", "dormand_prince"};
constexpr std::string_view rate_frames[] = {"inertial", "ground"};

constexpr Field rotation_fields[] = {
    {"axis", T::vector, M::plain, "axis to turn about; need not be of unit length", nullptr, {}, false, 3},
    {"angle", T::quantity, M::angle, "angle about the axis"},
    {"yaw", T::quantity, M::angle, "turn about y, applied last", nullptr, {}, false, 3},
    {"pitch", T::quantity, M::angle, "turn about z, applied second", nullptr, {}, false, 3},
    {"roll", T::quantity, M::angle, "turn about x, applied first", nullptr, {}, false, 3},
    {"quaternion", T::number_list, M::plain, "w, x, y, z", nullptr, {}, false, 3},
};
}  // namespace
const ObjectKind rotation_kind{"rotation", "A rotation: axis and angle, yaw, pitch and roll, or a quaternion.",
                               rotation_fields};
namespace {

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

constexpr Field material_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"friction", T::quantity, M::plain, "Coulomb's coefficient, at least 0"},
    {"restitution", T::quantity, M::plain, "0 to 1"},
    {"rolling_resistance", T::quantity, M::plain, "lever arm over radius, at least 0"},
    {"tangent_speed", T::quantity, M::speed, "speed of a conveyor along the surface"},
    {"density", T::quantity, M::density, "used by shapes that give neither density nor mass"},
    {"user_id", T::integer},
};
}  // namespace
const ObjectKind material_kind{"material", "How a surface behaves.", material_fields};
namespace {

constexpr Field filter_fields[] = {
    {"category", T::bits, M::plain, "what the shape is: a number, a hexadecimal text, or a list of bit numbers"},
    {"mask", T::bits, M::plain, "what it collides with"},
    {"group", T::integer, M::plain, "negative: never collide within the group; positive: always"},
};
}  // namespace
const ObjectKind filter_kind{"filter", "Which shapes collide.", filter_fields};
namespace {

constexpr Field surface_fields[] = {
    {"material", T::reference, M::plain, "name of a material, or one written here", &material_kind, {}, true},
    {"surface_velocity", T::vector, M::speed, "the part runs like a belt; in the shape's frame"},
};
const ObjectKind surface_kind{"surface", "What parts of a mesh, height field or chain are made of.", surface_fields};

constexpr Field shape_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text},
    {"description", T::text},
    {"type", T::choice, M::plain, "kind of shape", nullptr, shape_types},
    {"use", T::name, M::plain, "name of a shape of the scene's shapes to start from"},
    {"radius", T::quantity, M::length,
     "of spheres, circles, capsules, cylinders and cones; rounding of boxes, polygons and hulls"},
    {"diameter", T::quantity, M::length, "instead of radius"},
    {"size", T::vector, M::length, "of a box, edge to edge"},
    {"half_extents", T::vector, M::length, "of a box, instead of size; without the rounding radius"},
    {"length", T::quantity, M::length, "of a capsule's axis"},
    {"half_length", T::quantity, M::length, "instead of length"},
    {"rounding",
     T::quantity,
     M::length,
     "of a cylinder or cone: it is swept by a sphere of this radius",
     nullptr,
     {},
     false,
     3},
    {"height", T::quantity, M::length, "of a cylinder or cone"},
    {"half_height", T::quantity, M::length, "instead of height"},
    {"radii", T::vector, M::length, "of an ellipsoid: its half axes", nullptr, {}, false, 3},
    {"normal", T::vector, M::plain, "of a plane", nullptr, {}, false, 3},
    {"points", T::point_list, M::length, "of a hull, polygon, segment or chain"},
    {"loop", T::flag, M::plain, "a chain that closes", nullptr, {}, false, 2},
    {"simplify", T::flag, M::plain, "drop the least important corners of a hull with too many", nullptr, {}, false, 3},
    {"vertices", T::point_list, M::length, "of a mesh", nullptr, {}, false, 3},
    {"indices", T::number_list, M::plain, "of a mesh, three a triangle", nullptr, {}, false, 3},
    {"file",
     T::text,
     M::plain,
     "mesh file beside the scene (OBJ, STL, glTF, GLB), for meshes and hulls",
     nullptr,
     {},
     false,
     3},
    {"scale",
     T::quantity,
     M::plain,
     "of vertices or points: 0.001 for a mesh file in millimetres",
     nullptr,
     {},
     false,
     3},
    {"columns", T::integer, M::plain, "of a height field, vertices along x; of voxels and tiles, cells along x"},
    {"layers", T::integer, M::plain, "of voxels, cells along y", nullptr, {}, false, 3},
    {"cell_size", T::quantity, M::length, "of voxels, edge of a cube; of tiles, edge of a square"},
    {"runs", T::number_list, M::plain,
     "of voxels and tiles, along x, then y, then z: how many cells, and 0 (empty) or 1 and the place in surfaces, one "
     "after another"},
    {"rows", T::integer, M::plain, "of a height field, vertices along z; of voxels, cells along z; of tiles, along y"},
    {"cell", T::number_list, M::length, "of a height field, spacing along x and z", nullptr, {}, false, 3},
    {"heights", T::number_list, M::length, "of a height field, row by row", nullptr, {}, false, 3},
    {"holes", T::number_list, M::plain, "of a height field, 1 a cell without surface", nullptr, {}, false, 3},
    {"materials", T::number_list, M::plain,
     "of a mesh, height field or chain: for each triangle, cell or segment its place in surfaces, from 0"},
    {"children", T::list, M::plain, "of a compound: convex shapes in their places", &shape_kind, {}, false, 3},
    {"position", T::vector, M::length, "of the shape in its body"},
    {"rotation", T::rotation, M::angle, "of the shape in its body", &rotation_kind},
    {"density", T::quantity, M::density, "mass per volume (plane: per area)"},
    {"mass", T::quantity, M::mass, "instead of density"},
    {"material", T::reference, M::plain, "name of a material, or one written here", &material_kind},
    {"surfaces", T::list, M::plain, "what the numbers in materials stand for: names of materials, or surfaces",
     &surface_kind},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"sensor", T::flag, M::plain, "reports overlaps, pushes nothing"},
    {"contact_events", T::flag},
    {"hit_events", T::flag},
    {"modify_contacts", T::flag, M::plain, "a program that runs the scene is asked about its contacts"},
    {"surface_velocity", T::vector, M::speed, "the surface runs like a belt; in the shape's frame"},
    {"one_way", T::vector, M::plain, "holds what comes against this direction, lets through the rest; shape's frame"},
    {"user_data", T::bits},
};
}  // namespace
const ObjectKind shape_kind{"shape", "A collision shape.", shape_fields};
namespace {

constexpr Field mass_properties_fields[] = {
    {"mass", T::quantity, M::mass, "", nullptr, {}, true},
    {"center", T::vector, M::length, "centre of mass in the body's frame"},
    {"inertia",
     T::any,
     M::inertia,
     "about the centre of mass: a number (plane); Ixx, Iyy, Izz or these and Ixy, Ixz, Iyz as tensor components "
     "(space)",
     nullptr,
     {},
     true},
};
const ObjectKind mass_properties_kind{"mass_properties", "Mass, centre and inertia in place of those of the shapes.",
                                      mass_properties_fields};

constexpr Field body_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, "unique; {expressions} in braces are replaced"},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this body out"},
    {"type", T::choice, M::plain, "dynamic unless given", nullptr, body_types},
    {"position", T::vector, M::length},
    {"rotation", T::rotation, M::angle, "", &rotation_kind},
    {"velocity", T::vector, M::speed, "of the centre of mass"},
    {"angular_velocity", T::vector, M::angular_speed, "world axes; a number in the plane"},
    {"linear_damping", T::quantity, M::rate},
    {"angular_damping", T::quantity, M::rate},
    {"gravity_scale", T::quantity, M::plain},
    {"time_scale", T::quantity, M::plain, "seconds that the body lives in a second of the world"},
    {"sleep_speed", T::quantity, M::speed, "0: never sleeps"},
    {"substeps", T::integer, M::plain, "that all have at least which touches it or is jointed to it; 0: the world's"},
    {"locks", T::list, M::plain, "motions that are locked: x, y, z, rotation_x, rotation_y, rotation_z"},
    {"awake", T::flag},
    {"allow_sleep", T::flag},
    {"bullet", T::flag, M::plain, "continuous collision against moving bodies too"},
    {"enabled", T::flag},
    {"user_data", T::bits},
    {"color", T::color, M::plain, "as #rrggbb, or #rrggbbaa with an opacity"},
    {"trail", T::flag, M::plain, "pictures draw its path"},
    {"shape", T::reference, M::plain, "one shape, or the name of one", &shape_kind},
    {"shapes", T::list, M::plain, "several shapes", &shape_kind},
    {"material", T::reference, M::plain, "of shapes that name none", &material_kind},
    {"filter", T::object, M::plain, "of shapes that give none", &filter_kind},
    {"density", T::quantity, M::density, "of shapes that give neither density nor mass"},
    {"mass", T::quantity, M::mass, "of the whole body: the densities are scaled to it"},
    {"mass_properties", T::object, M::plain, "", &mass_properties_kind},
};
const ObjectKind body_kind{"body", "A rigid body.", body_fields};

constexpr Field character_fields[] = {
    {"name", T::text, M::plain, "unique among bodies and characters; {expressions} in braces are replaced"},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this character out"},
    {"type", T::choice, M::plain, "dynamic (a body that legs drive) unless given; kinematic moves by its own rule",
     nullptr, character_types},
    {"position", T::vector, M::length, "of the feet"},
    {"velocity", T::vector, M::speed, "with which it walks, against the ground it stands on; the part along up jumps"},
    {"up", T::vector, M::plain, "unit vector"},
    {"radius", T::quantity, M::length, "of the capsule"},
    {"half_length", T::quantity, M::length, "of the capsule's straight part"},
    {"max_slope", T::quantity, M::angle, "what is steeper does not carry"},
    {"step_height", T::quantity, M::length, "stairs up to this are climbed"},
    {"mass", T::quantity, M::mass},
    {"leg_force", T::quantity, M::force, "of a dynamic one: the most that its legs push with"},
    {"air_force", T::quantity, M::force, "of a dynamic one: with which it steers in the air"},
    {"push_force", T::quantity, M::force, "of a kinematic one: with which it pushes bodies in its way"},
    {"filter", T::object, M::plain, "what it meets", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb, or #rrggbbaa with an opacity"},
    {"trail", T::flag, M::plain, "pictures draw its path"},
};
const ObjectKind character_kind{"character", "A character that walks.", character_fields};

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
    {"max_spring_force", T::quantity, M::force, "path, of the spring; 0: as much as it takes"},
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
    {"density", T::quantity, M::density, "of the medium; projectile: the standard atmosphere where absent"},
    {"drag_coefficient", T::quantity, M::plain, "quadratic drag, projectile; body drag whose law is constant"},
    {"area", T::quantity, M::area, "quadratic drag; body drag, that of a disc of its diameter unless given"},
    {"point", T::vector, M::length, "quadratic and body drag and thrust, in the body"},
    {"law", T::choice, M::plain, "body drag, sphere unless given", nullptr, drag_laws},
    {"table", T::number_list, M::plain, "body drag by Reynolds or Mach number: x, C_d, x, C_d …"},
    {"logarithmic", T::flag, M::plain, "the table is linear over the logarithm of x"},
    {"diameter", T::quantity, M::length, "body drag, of the Reynolds number; projectile, of its frontal area"},
    {"viscosity", T::quantity, M::viscosity, "body drag, where the scene has no environment"},
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
    {"velocity", T::vector, M::speed, "wind; projectile: of the air"},
    {"body_a", T::name, M::plain, "spring"},
    {"body_b", T::name, M::plain, "spring; the world where absent"},
    {"point_a", T::vector, M::length, "spring, in body A"},
    {"point_b", T::vector, M::length, "spring, in body B or the world"},
    {"rest_length", T::quantity, M::length, "spring"},
    {"stiffness", T::quantity, M::stiffness, "spring"},
    {"damping", T::quantity, M::damping, "spring"},
    {"level", T::quantity, M::length, "buoyancy: height of the still surface"},
    {"linear_drag", T::quantity, M::rate, "buoyancy"},
    {"angular_drag", T::quantity, M::rate, "buoyancy"},
    {"waves", T::list, M::plain, "buoyancy, at most four", &wave_kind},
    {"current", T::vector, M::speed, "buoyancy"},
    {"force", T::vector, M::force, "thrust, in the body's axes"},
    {"strength", T::quantity, M::acceleration, "radial field"},
    {"reference", T::quantity, M::length, "radial field: where the strength holds"},
    {"exponent", T::quantity, M::plain, "radial field"},
    {"range", T::quantity, M::length, "radial field"},
    {"axis", T::vector, M::plain, "vortex field", nullptr, {}, false, 3},
    {"circulation", T::quantity, M::circulation, "vortex field"},
    {"core_radius", T::quantity, M::length, "vortex field"},
    {"rate", T::quantity, M::rate, "vortex field"},
    {"drag_function", T::choice, M::plain, "projectile", nullptr, drag_functions},
    {"ballistic_coefficient", T::quantity, M::plain, "projectile, lb/in^2; or its diameter and mass"},
    {"mass", T::quantity, M::mass, "projectile"},
    {"form_factor", T::quantity, M::plain, "projectile: multiplies the drag"},
};
const ObjectKind effector_kind{"effector", "A force that acts on its own every step.", effector_fields};

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
    {"friction", T::quantity, M::plain, "Coulomb's coefficient, at least 0"},
    {"restitution", T::quantity, M::plain, "0 to 1"},
    {"rolling_resistance", T::quantity, M::plain, "lever arm over radius, at least 0"},
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

const ObjectKind* const all_kinds[] = {&scene_kind,         &world_kind,
                                       &material_pair_kind, &parameter_kind,
                                       &material_kind,      &filter_kind,
                                       &surface_kind,       &shape_kind,
                                       &rotation_kind,      &body_kind,
                                       &character_kind,     &mass_properties_kind,
                                       &group_kind,         &joint_kind,
                                       &frame_kind,         &joint_axis_kind,
                                       &joint_axes_kind,    &spring_kind,
                                       &limit_kind,         &motor_kind,
                                       &effector_kind,      &wave_kind,
                                       &camera_kind,        &plot_kind,
                                       &axis_kind,          &series_kind,
                                       &expectation_kind,   &flight_kind,
                                       &earth_kind,         &vehicle_kind,
                                       &initial_kind,       &environment_kind,
                                       &gravity_field_kind, &turning_frame_kind,
                                       &air_kind,           &wind_field_kind,
                                       &wind_layer_kind,    &gust_kind,
                                       &turbulence_kind,    &thermal_kind,
                                       &obstacle_kind,      &wake_kind,
                                       &sea_kind,           &sea_wave_kind,
                                       &rope_kind,          &rope_attachment_kind,
                                       &rope_winch_kind,    &rope_lump_kind,
                                       &cloth_kind,         &pin_kind,
                                       &soft_body_kind,     &liquid_kind,
                                       &fill_kind,          &tap_kind,
                                       &drain_kind,         &grains_kind,
                                       &particles_kind,     &emitter_kind,
                                       &sub_emission_kind,  &attractor_kind,
                                       &touch_kind,         &structure_kind,
                                       &explosion_kind,     &gun_kind,
                                       &ammunition_kind,    &sight_kind,
                                       &penetration_kind,   &layer_kind};

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
