#include "carom/scene/detail/destruction_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view bursts[] = {"ground", "free_air", "air"};
constexpr std::string_view arcs[] = {"low", "high"};
constexpr std::string_view patterns[] = {"voronoi", "even", "clustered", "radial", "slabs", "bricks"};
constexpr std::string_view substances[] = {"glass", "brick_and_mortar", "concrete", "ceramic", "wood", "ice"};

constexpr Field explosion_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this charge out"},
    {"position", T::vector, M::length},
    {"mass", T::quantity, M::mass, "of TNT, or of what is equivalent to it", nullptr, {}, true},
    {"time", T::quantity, M::time, "when it goes off"},
    {"burst", T::choice, M::plain, "on the ground (unless given), in free air, or in the air over ground", nullptr,
     bursts},
    {"ground", T::quantity, M::length, "height of the ground under a burst in the air; 0 unless given"},
    {"reach", T::quantity, M::length, "at most 40 m/kg^(1/3), which 0 stands for"},
    {"clearing", T::flag, M::plain, "edges relieve the reflected pressure; true unless given"},
    {"shelter", T::quantity, M::plain, "0 to 1: share of the pressure that arrives behind an obstacle"},
    {"case", T::object, M::plain, "that flies apart as it goes off, in space", &case_kind},
    {"casing", T::name, M::plain, "name of a body that is neither pushed nor in the way"},
    {"mask", T::bits, M::plain, "categories of shapes that feel it"},
    {"obstacles", T::bits, M::plain, "categories of shapes that shelter"},
};

constexpr std::string_view case_shapes[] = {"cylinder", "sphere"}, explosives[] = {"tnt", "composition_b"};
constexpr Field case_fields[] = {
    {"description", T::text},
    {"mass", T::quantity, M::mass, "", nullptr, {}, true},
    {"shape", T::choice, M::plain, "sphere unless given", nullptr, case_shapes},
    {"explosive", T::choice, M::plain, "for the speed by Gurney; tnt unless given", nullptr, explosives},
    {"fragments", T::integer, M::plain, "how many, 500 unless given"},
    {"density", T::quantity, M::density, "of its material, steel unless given"},
    {"drag_coefficient", T::quantity, M::plain, "of tumbling fragments, 1.1 unless given"},
    {"lifetime", T::quantity, M::time, "that they fly at most, 10 s unless given"},
    {"seed", T::integer, M::plain, "of masses and directions"},
};

constexpr Field ammunition_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"drag_function", T::choice, M::plain, "a standard projectile", nullptr, drag_functions},
    {"drag_coefficient", T::quantity, M::plain, "at every speed, instead of a function"},
    {"drag_table", T::any, M::plain,
     "Mach number, C_D, Mach number, C_D … instead, smooth between; or a file of such: of presets/drag, or beside the "
     "scene"},
    {"ballistic_coefficient", T::quantity, M::plain, "lb/in^2; or mass and diameter alone"},
    {"ballistic_coefficients", T::number_list, M::plain,
     "Mach number, lb/in^2, Mach number …: each from its Mach number up"},
    {"form_factor", T::quantity, M::plain, "multiplies the drag"},
    {"mass", T::quantity, M::mass, "of the projectile"},
    {"diameter", T::quantity, M::length},
    {"length", T::quantity, M::length},
    {"muzzle_speed", T::quantity, M::speed},
    {"speed_deviation", T::quantity, M::speed, "standard deviation from shot to shot"},
    {"powder_mass", T::quantity, M::mass, "for the recoil"},
    {"gas_speed", T::quantity, M::speed, "at which the powder's gas leaves"},
    {"shell", T::reference, M::plain,
     "its rounds fly as spinning shells, in space: name of a preset of presets/shell, or written here; the drag counts "
     "after a hit, and for aiming",
     &shell_kind},
};
constexpr Field sight_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"height", T::quantity, M::length, "from the bore up to the line of sight"},
    {"offset", T::quantity, M::length, "from the bore to the right to the line of sight", nullptr, {}, false, 3},
    {"click", T::quantity, M::angle, "of a turret"},
    {"spacing", T::quantity, M::angle, "between marks of the reticle"},
    {"magnification", T::quantity, M::plain},
    {"parallax_free", T::quantity, M::length,
     "distance at which an eye off its axis makes no error; unless given at all"},
};
constexpr std::string_view stances[] = {"offhand", "kneeling", "sitting", "prone", "supported"};
constexpr Field sway_fields[] = {
    {"description", T::text},
    {"stance", T::choice, M::plain, "offhand unless given", nullptr, stances},
    {"skill", T::quantity, M::plain, "0 (beginner) to 1 (expert), 0.5 unless given"},
    {"fatigue", T::quantity, M::plain, "0 to 1"},
    {"breath_held", T::quantity, M::plain, "0 to 1: without breath, and with half as much tremor again"},
    {"breath", T::quantity, M::angle, "root mean square of an axis, instead of that of the stance"},
    {"breath_frequency", T::quantity, M::frequency},
    {"heartbeat", T::quantity, M::angle, "likewise"},
    {"heartbeat_frequency", T::quantity, M::frequency},
    {"tremor", T::quantity, M::angle, "likewise"},
    {"tremor_low", T::quantity, M::frequency, "of its band"},
    {"tremor_high", T::quantity, M::frequency},
    {"drift", T::quantity, M::angle, "of the body, likewise"},
    {"drift_low", T::quantity, M::frequency, "of its band"},
    {"drift_high", T::quantity, M::frequency},
};
constexpr Field gun_fields[] = {
    {"preset", T::text, M::plain, "name of a preset file, such as gun/rifle_308"},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this gun out"},
    {"body", T::name, M::plain, "that carries it, and takes the recoil; it stands in the world where absent"},
    {"position", T::vector, M::length, "of the muzzle; in the body's frame where it has one"},
    {"direction", T::vector, M::plain, "of the bore, x unless given; in the body's frame where it has one"},
    {"target", T::name, M::plain, "a body aimed at before each shot, with lead; out of reach it does not shoot"},
    {"arc", T::choice, M::plain, "at a target: low unless given", nullptr, arcs},
    {"ammunition", T::reference, M::plain, "name of a preset of presets/ammunition, or written here", &ammunition_kind},
    {"sight", T::reference, M::plain, "name of a preset of presets/sight, or written here", &sight_kind},
    {"sighted", T::flag, M::plain, "direction is the line of sight: the bore is raised for the zero"},
    {"zero", T::quantity, M::length, "distance at which a sighted gun meets the line of sight"},
    {"dial", T::quantity, M::length, "sighted: the sight is raised from its zero by whole clicks for this distance"},
    {"clicks_up", T::integer, M::plain, "sighted: turns of the sight, which move the strike; dial comes on top"},
    {"clicks_right", T::integer, M::plain, "", nullptr, {}, false, 3},
    {"hold_up", T::quantity, M::angle, "sighted: how much higher than direction it is held"},
    {"hold_right", T::quantity, M::angle, "likewise, to the right", nullptr, {}, false, 3},
    {"eye_up", T::quantity, M::length,
     "sighted: the eye above the sight's axis, which the parallax shows; the mark is as far as dial or zero"},
    {"eye_right", T::quantity, M::length, "likewise, to the right", nullptr, {}, false, 3},
    {"cant", T::quantity, M::angle, "sighted: it leans to the right", nullptr, {}, false, 3},
    {"sway", T::object, M::plain, "of the hands that hold it; none unless given", &sway_kind},
    {"mass", T::quantity, M::mass, "of the gun"},
    {"muzzle_speed", T::quantity, M::speed, "from this barrel instead of that of the ammunition"},
    {"twist", T::quantity, M::length, "of a turn"},
    {"dispersion", T::quantity, M::angle, "standard deviation of each axis"},
    {"rounds_per_minute", T::quantity, M::plain},
    {"rounds", T::integer, M::plain, "how many it has, 1 unless given"},
    {"start", T::quantity, M::time, "of the first shot"},
    {"lifetime", T::quantity, M::time, "a projectile flies no longer; 60 s unless given"},
    {"recoil", T::flag, M::plain, "its body takes the recoil; true unless given"},
    {"climb", T::flag, M::plain, "the mount's motion turns the bore from shot to shot"},
    {"pattern", T::number_list, M::angle,
     "instead of climb: how far each shot points beside the aim, to the right and up by turns; the last stays"},
    {"mount_mass", T::quantity, M::mass, "what moves back"},
    {"mount_inertia", T::quantity, M::inertia, "about the shoulder"},
    {"mount_bore_above_shoulder", T::quantity, M::length, "lever that lifts the muzzle"},
    {"mount_bore_beside_shoulder", T::quantity, M::length, "lever that swings it"},
    {"mount_push_frequency", T::quantity, M::frequency},
    {"mount_push_damping", T::quantity, M::plain},
    {"mount_rise_frequency", T::quantity, M::frequency},
    {"mount_rise_damping", T::quantity, M::plain},
    {"mount_roll_inertia", T::quantity, M::inertia, "about the line through the shoulder along the bore"},
    {"mount_swing_frequency", T::quantity, M::frequency, "that of the rise unless given"},
    {"mount_swing_damping", T::quantity, M::plain, "that of the rise unless given"},
    {"mount_centre_ahead", T::quantity, M::length,
     "of mass, from the shoulder; 0 unless given: nothing couples the ways it moves"},
    {"mount_centre_above", T::quantity, M::length, "likewise"},
    {"mount_centre_beside", T::quantity, M::length, "likewise, to the right"},
    {"mount_lift_frequency", T::quantity, M::frequency, "up and down"},
    {"mount_lift_damping", T::quantity, M::plain},
    {"mount_slide_frequency", T::quantity, M::frequency, "from side to side"},
    {"mount_slide_damping", T::quantity, M::plain},
    {"mount_roll_frequency", T::quantity, M::frequency},
    {"mount_roll_damping", T::quantity, M::plain},
    {"seed", T::integer, M::plain, "of dispersion, muzzle speeds and sway"},
    {"color", T::color, M::plain, "of its projectiles, as #rrggbb"},
};

constexpr Field layer_of_material_fields[] = {
    {"name", T::text},
    {"thickness", T::quantity, M::length, "of the last layer as thick as the shape unless given"},
    {"strength", T::quantity, M::pressure, "a of the resistance A (a + b v^2)"},
    {"inertia", T::quantity, M::density, "b"},
    {"limit_speed", T::quantity, M::speed, "of a thin plate, by Recht and Ipson, instead of a medium"},
    {"density", T::quantity, M::density, "of a plate"},
    {"ricochet_angle", T::quantity, M::angle, "flatter than this it skips off"},
    {"ricochet_restitution", T::quantity, M::plain, "share of the speed that is left then"},
};
constexpr Field penetration_fields[] = {
    {"description", T::text},
    {"user_id", T::integer, M::plain, "of the material; all others where absent"},
    {"wall",
     T::any,
     M::plain,
     "name of a preset of presets/wall, or a list of layers from the outside",
     nullptr,
     {},
     true},
};

constexpr Field structure_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, "unique among bodies; {expressions} in braces are replaced"},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this structure out"},
    {"shape", T::reference, M::plain, "a solid: box, hull, polygon, closed mesh, sphere, cylinder …", &shape_kind},
    {"outline",
     T::point_list,
     M::length,
     "any simple polygon, counterclockwise, instead of a shape",
     nullptr,
     {},
     false,
     2},
    {"position", T::vector, M::length},
    {"rotation", T::rotation, M::angle, "", &rotation_kind},
    {"velocity", T::vector, M::speed, "of the centre of mass"},
    {"angular_velocity", T::vector, M::angular_speed, "world axes; a number in the plane"},
    {"pattern", T::choice, M::plain, "where it cracks; voronoi unless given", nullptr, patterns},
    {"pieces", T::integer, M::plain, "of voronoi, even and clustered patterns; slabs"},
    {"seed", T::integer, M::plain, "of the pattern"},
    {"rounds", T::integer, M::plain, "even: of Lloyd's smoothing, 0 to 10"},
    {"impact", T::vector, M::length, "clustered, radial: centre of the cracks, in its frame"},
    {"impact_radius", T::quantity, M::length, "clustered: mean distance of half the sites"},
    {"axis", T::vector, M::plain, "slabs: square to them; radial: through the pane, in space"},
    {"first_radius", T::quantity, M::length, "radial: of the first ring"},
    {"growth", T::quantity, M::plain, "radial: from ring to ring"},
    {"sectors", T::integer, M::plain, "radial: pieces of a ring"},
    {"jitter", T::quantity, M::plain, "radial, slabs: 0 to 1"},
    {"brick", T::vector, M::length, "bricks: size"},
    {"skin", T::quantity, M::length, "by which hulls of pieces stand back, 1 mm unless given"},
    {"substance", T::choice, M::plain, "density, strengths and stiffness; concrete unless given", nullptr, substances},
    {"density", T::quantity, M::density, "instead of the substance's"},
    {"tensile_strength", T::quantity, M::pressure, "instead of the substance's"},
    {"compressive_strength", T::quantity, M::pressure, "instead of the substance's"},
    {"shear_strength", T::quantity, M::pressure, "instead of the substance's"},
    {"youngs_modulus", T::quantity, M::pressure, "instead of the substance's"},
    {"contact_time", T::quantity, M::time, "of a blow, instead of the substance's"},
    {"anchored_below", T::quantity, M::length, "parts that reach below this y of its frame hold to the ground"},
    {"bullet", T::flag, M::plain, "pieces are continuous against moving bodies too"},
    {"material", T::reference, M::plain, "of its surface", &material_kind},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb, or #rrggbbaa with an opacity"},
};

constexpr Field rocket_motor_fields[] = {
    {"description", T::text},
    {"name", T::text},
    {"propellant_mass", T::quantity, M::mass},
    {"mass", T::quantity, M::mass, "with the propellant", nullptr, {}, true},
    {"thrust", T::number_list, M::plain, "s, N, s, N …, from 0 s on, linear between", nullptr, {}, true},
};
constexpr Field stage_fields[] = {
    {"description", T::text},
    {"name", T::text},
    {"motor",
     T::reference,
     M::plain,
     "name of a file of presets/motor or of one beside the scene (my.eng), or written here",
     &rocket_motor_kind,
     {},
     true},
    {"designation", T::text, M::plain, "which motor of the file; its first unless given"},
    {"dry_mass", T::quantity, M::mass, "without the motor", nullptr, {}, true},
    {"dry_centre", T::quantity, M::length, "of the dry mass, from the nose of the whole rocket"},
    {"motor_centre", T::quantity, M::length, "likewise"},
    {"ignition_delay", T::quantity, M::time, "after the stage below is gone; of the first: after the launch"},
    {"separation_delay", T::quantity, M::time, "after its burnout; the last stage stays"},
};
constexpr Field rocket_fields[] = {
    {"preset", T::text, M::plain, "name of a preset file, such as rocket/two_stage_c6"},
    {"name", T::text, M::plain, "unique among bodies; {expressions} in braces are replaced"},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this rocket out"},
    {"position", T::vector, M::length, "of its tail on the rail"},
    {"direction", T::vector, M::plain, "of the rail; straight up unless given"},
    {"rail_length", T::quantity, M::length, "1 m unless given"},
    {"start", T::quantity, M::time, "of the launch"},
    {"diameter", T::quantity, M::length},
    {"length", T::quantity, M::length, "of the whole rocket"},
    {"nose_length", T::quantity, M::length, "of an ogive"},
    {"drag_coefficient", T::quantity, M::plain, "on the frontal area, while a motor burns"},
    {"coasting_drag_coefficient", T::quantity, M::plain, "without; the same unless given"},
    {"drag_table", T::any, M::plain,
     "Mach number, C_D, Mach number, C_D … instead, smooth between; or a file of such: of presets/drag, or beside the "
     "scene"},
    {"coasting_drag_table", T::any, M::plain, "likewise, without a motor that burns"},
    {"fin_count", T::integer, M::plain, "0 to 16"},
    {"fin_root_chord", T::quantity, M::length},
    {"fin_tip_chord", T::quantity, M::length},
    {"fin_span", T::quantity, M::length},
    {"fin_sweep", T::quantity, M::length, "of the leading edge"},
    {"fin_position", T::quantity, M::length, "of the root's leading edge, from the nose"},
    {"parachute_drag_area", T::quantity, M::area, "C_D A; none unless given"},
    {"parachute_height", T::quantity, M::length, "it opens below, on the way down; at the apex unless given"},
    {"parachute_delay", T::quantity, M::time, "after that"},
    {"stages", T::list, M::plain, "1 to 10, the first to burn first", &stage_kind},
    {"material", T::reference, M::plain, "of its surface", &material_kind},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb, or #rrggbbaa with an opacity"},
    {"trail", T::flag, M::plain, "pictures draw its path"},
};

constexpr Field shell_row_fields[] = {
    {"mach", T::quantity, M::plain, "rising from row to row, linear between"},
    {"axial", T::quantity, M::plain, "C_X0"},
    {"axial_yaw", T::quantity, M::plain, "C_X2, with the square of the yaw"},
    {"normal", T::quantity, M::plain, "C_Na"},
    {"magnus_force", T::quantity, M::plain, "C_Ypa"},
    {"roll_damping", T::quantity, M::plain, "C_lp"},
    {"overturning", T::quantity, M::plain, "C_Ma, not zero"},
    {"pitch_damping", T::quantity, M::plain, "C_mq"},
    {"magnus_moment", T::quantity, M::plain, "C_Mpa"},
};
constexpr Field shell_fields[] = {
    {"preset", T::text, M::plain, "name of a preset file, such as shell/155mm_m107"},
    {"description", T::text},
    {"mass", T::quantity, M::mass},
    {"diameter", T::quantity, M::length},
    {"axial_inertia", T::quantity, M::inertia, "about its axis"},
    {"transverse_inertia", T::quantity, M::inertia, "across it"},
    {"twist", T::quantity, M::plain, "of the barrel, calibres a turn, 20 unless given; negative: left-handed"},
    {"length", T::quantity, M::length, "4.5 calibres unless given"},
    {"centre", T::quantity, M::length, "of mass, from the nose; at .65 of the length unless given"},
    {"aerodynamics", T::list, M::plain, "per radian, rate terms with p d/2V", &shell_row_kind},
};
constexpr std::string_view shell_models[] = {"modified_point_mass", "six_degrees"};
constexpr Field fired_shell_fields[] = {
    {"name", T::text, M::plain, "unique among bodies; {expressions} in braces are replaced"},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this shell out"},
    {"shell", T::reference, M::plain, "name of a preset of presets/shell, or written here", &shell_kind, {}, true},
    {"model", T::choice, M::plain, "modified_point_mass unless given; or the axis nutates and precesses", nullptr,
     shell_models},
    {"position", T::vector, M::length, "of its centre of mass at the muzzle"},
    {"direction", T::vector, M::plain, "of the barrel; x unless given"},
    {"speed", T::quantity, M::speed, "at the muzzle", nullptr, {}, true},
    {"spin", T::quantity, M::angular_speed, "instead of that of the barrel's twist"},
    {"tip", T::vector, M::angular_speed, "its first angular velocity across the axis, in six degrees"},
    {"start", T::quantity, M::time, "when it is fired"},
    {"sticks", T::flag, M::plain, "it stays where it first touches something, as in soft ground"},
    {"material", T::reference, M::plain, "of its surface", &material_kind},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb, or #rrggbbaa with an opacity"},
    {"trail", T::flag, M::plain, "pictures draw its path"},
};

}  // namespace

const ObjectKind shell_row_kind{"shell_row", "Aerodynamic coefficients at a Mach number.", shell_row_fields};
const ObjectKind shell_kind{"shell", "A spinning shell by its numbers.", shell_fields};
const ObjectKind fired_shell_kind{"fired_shell", "A spinning shell that flies as a body.", fired_shell_fields};
const ObjectKind rocket_motor_kind{"rocket_motor", "The motor of a stage.", rocket_motor_fields};
const ObjectKind stage_kind{"stage", "A stage of a rocket.", stage_fields};
const ObjectKind rocket_kind{"rocket", "A rocket that flies as a body.", rocket_fields};
const ObjectKind explosion_kind{"explosion", "A charge that goes off.", explosion_fields};
const ObjectKind case_kind{"case", "What is thrown as fragments.", case_fields};
const ObjectKind ammunition_kind{"ammunition", "What a gun shoots.", ammunition_fields};
const ObjectKind sight_kind{"sight", "What a gun is aimed with.", sight_fields};
const ObjectKind sway_kind{"sway", "How a gun moves in the hands.", sway_fields};
const ObjectKind gun_kind{"gun", "A gun that shoots.", gun_fields};
const ObjectKind layer_kind{"layer", "A layer that projectiles go through.", layer_of_material_fields};
const ObjectKind penetration_kind{"penetration", "What a material is for projectiles.", penetration_fields};
const ObjectKind structure_kind{"structure", "A solid that breaks.", structure_fields};

}  // namespace carom::scene::detail
