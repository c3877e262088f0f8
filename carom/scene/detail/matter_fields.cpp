#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view rope_touches[] = {"none", "others", "itself"};  // as RopeTouch
constexpr std::string_view edges[] = {"first_column", "last_column", "first_row", "last_row"};
constexpr std::string_view particle_drag_laws[] = {"none", "linear", "stokes", "schiller_naumann", "quadratic"};
constexpr std::string_view answers[] = {"bounce", "stick", "kill"};
constexpr std::string_view forms[] = {"point", "segment", "disc", "box", "sphere", "mesh"};
constexpr std::string_view occasions[] = {"death", "hit"};

constexpr Field attachment_fields[] = {
    {"node", T::integer, M::plain, "which particle of the rope, from 0; -1: the last; the nearest unless given"},
    {"body", T::name, M::plain, "name of a body; the world where absent"},
    {"anchor", T::vector, M::length, "where it is held, in the world; where the particle lies unless given"},
    {"clamped", T::flag, M::plain, "of an end: holds its direction and its turn too"},
    {"collide", T::flag, M::plain, "the rope touches this body's shapes too (a drum)"},
};
constexpr Field winch_fields[] = {
    {"end", T::integer, M::plain, "0: the first particle, 1: the last", nullptr, {}, true},
    {"speed", T::quantity, M::speed, "reeled in; negative: paid out", nullptr, {}, true},
};
constexpr Field lump_fields[] = {
    {"node", T::integer, M::plain, "-1: the last", nullptr, {}, true},
    {"mass", T::quantity, M::mass, "", nullptr, {}, true},
};
constexpr Field rope_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this rope out"},
    {"points", T::point_list, M::length, "the rope lies along these", nullptr, {}, true},
    {"segments", T::integer, M::plain, "1 to 10000, 20 unless given"},
    {"length", T::quantity, M::length, "at rest; as long as it lies unless given"},
    {"mass_per_length", T::quantity, M::mass_per_length},
    {"radius", T::quantity, M::length},
    {"diameter", T::quantity, M::length, "instead of radius"},
    {"axial_stiffness", T::quantity, M::force, "EA: force at a strain of one"},
    {"axial_damping", T::quantity, M::rope_damping, "of the strain's rate"},
    {"bending_stiffness", T::quantity, M::rope_bending, "EI"},
    {"bending_damping", T::quantity, M::time, "in proportion to EI"},
    {"torsional_stiffness", T::quantity, M::rope_bending, "GJ"},
    {"friction", T::quantity, M::plain, "mixed with a shape's"},
    {"drag_coefficient", T::quantity, M::plain, "across, on the diameter"},
    {"skin_coefficient", T::quantity, M::plain, "along, on the surface"},
    {"break_tension", T::quantity, M::force, "0: never breaks"},
    {"attachments", T::list, M::plain, "what holds it", &rope_attachment_kind},
    {"winches", T::list, M::plain, "that reel it in", &rope_winch_kind},
    {"masses", T::list, M::plain, "lumps on the rope", &rope_lump_kind},
    {"twist", T::quantity, M::angle, "of the clamped last end against the first"},
    {"substeps", T::integer, M::plain, "1 to 256; of all ropes the most"},
    {"collide", T::flag, M::plain, "with shapes of the world and other ropes"},
    {"touch", T::choice, M::plain, "which ropes: others unless given; itself: others and itself", nullptr,
     rope_touches},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb"},
};

constexpr Field pin_fields[] = {
    {"vertex", T::integer, M::plain, "one vertex, from 0"},
    {"near", T::vector, M::length, "the vertex nearest to this place"},
    {"edge", T::choice, M::plain, "a whole side of a sheet", nullptr, edges},
    {"lower", T::vector, M::length, "all vertices within a box"},
    {"upper", T::vector, M::length, "all vertices within a box"},
    {"body", T::name, M::plain, "that holds them; the world where absent"},
};
constexpr Field cloth_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this cloth out"},
    {"corner", T::vector, M::length, "of a sheet: where its first vertex lies"},
    {"along", T::vector, M::length, "of a sheet: its side from the first column to the last, along the warp"},
    {"across", T::vector, M::length, "of a sheet: its side from the first row to the last"},
    {"columns", T::integer, M::plain, "vertices of a row, 2 or more"},
    {"rows", T::integer, M::plain, "2 or more"},
    {"points", T::point_list, M::length, "instead of a sheet"},
    {"triangles", T::number_list, M::plain, "three indices each"},
    {"warp", T::vector, M::plain, "direction of the warp"},
    {"velocity", T::vector, M::speed},
    {"mass_per_area", T::quantity, M::mass_per_area},
    {"warp_stiffness", T::quantity, M::stiffness, "E t along the warp"},
    {"weft_stiffness", T::quantity, M::stiffness, "E t across it"},
    {"poisson_ratio", T::quantity, M::plain, "0 to .49"},
    {"shear_stiffness", T::quantity, M::stiffness, "a radian"},
    {"bending_stiffness", T::quantity, M::cloth_bending},
    {"damping", T::quantity, M::time, "stress of the strain's rate, as a share of the stiffness"},
    {"thickness", T::quantity, M::length, "folds and bodies keep this apart"},
    {"friction", T::quantity, M::plain},
    {"normal_coefficient", T::quantity, M::plain, "of the pressure of a wind that meets it squarely"},
    {"tangential_coefficient", T::quantity, M::plain, "of the air along it"},
    {"tear_tension", T::quantity, M::stiffness, "force per metre; 0: never tears"},
    {"pins", T::list, M::plain, "what is held", &pin_kind},
    {"substeps", T::integer, M::plain, "1 to 64"},
    {"collide", T::flag, M::plain, "with shapes of the world"},
    {"self_collide", T::flag},
    {"self_collide_edges", T::flag},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb"},
};
constexpr Field soft_body_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this body out"},
    {"corner", T::vector, M::length, "of a box"},
    {"size", T::vector, M::length, "of a box"},
    {"center", T::vector, M::length, "of a ball"},
    {"radius", T::quantity, M::length, "of a ball"},
    {"cells", T::any, M::plain, "of a box along x, y and z: three numbers; of a ball across: one"},
    {"points", T::point_list, M::length, "instead of a box or ball"},
    {"tetrahedra", T::number_list, M::plain, "four indices each"},
    {"velocity", T::vector, M::speed},
    {"density", T::quantity, M::density},
    {"youngs_modulus", T::quantity, M::pressure},
    {"poisson_ratio", T::quantity, M::plain, "0 to .48"},
    {"damping", T::quantity, M::time, "stress of the strain's rate, as a share of the stiffness"},
    {"friction", T::quantity, M::plain},
    {"skin", T::quantity, M::length, "vertices keep so far from shapes"},
    {"pressure", T::quantity, M::pressure, "from within on the surface"},
    {"pins", T::list, M::plain, "what is held", &pin_kind},
    {"substeps", T::integer, M::plain, "1 to 64"},
    {"collide", T::flag, M::plain, "with shapes of the world"},
    {"filter", T::object, M::plain, "", &filter_kind},
    {"color", T::color, M::plain, "as #rrggbb"},
};

constexpr Field fill_fields[] = {
    {"lower", T::vector, M::length, "of a box"},
    {"upper", T::vector, M::length, "of a box"},
    {"center", T::vector, M::length, "of a ball (liquids)"},
    {"radius", T::quantity, M::length, "of a ball (liquids)"},
    {"velocity", T::vector, M::speed},
    {"tag", T::integer, M::plain, "0 to 1000000; pictures tint what is not 0"},
};
constexpr Field tap_fields[] = {
    {"center", T::vector, M::length, "", nullptr, {}, true},
    {"velocity", T::vector, M::speed, "", nullptr, {}, true},
    {"radius", T::quantity, M::length},
    {"tag", T::integer, M::plain, "0 to 1000000"},
};
constexpr Field drain_fields[] = {
    {"lower", T::vector, M::length, "", nullptr, {}, true},
    {"upper", T::vector, M::length, "", nullptr, {}, true},
};
constexpr Field liquid_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this liquid out"},
    {"lower", T::vector, M::length, "corner of the domain", nullptr, {}, true},
    {"upper", T::vector, M::length, "opposite corner", nullptr, {}, true},
    {"spacing", T::quantity, M::length, "between particles; a cell is two of them wide"},
    {"density", T::quantity, M::density},
    {"viscosity", T::quantity, M::kinematic_viscosity},
    {"surface_tension", T::quantity, M::stiffness, "matters for drops of a centimetre or two"},
    {"walls", T::list, M::plain, "which sides are walls: \"lower_x\", \"upper_x\", \"lower_y\" …; all unless given"},
    {"fill", T::list, M::plain, "boxes and balls of liquid at the start", &fill_kind},
    {"taps", T::list, M::plain, "from which liquid comes", &tap_kind},
    {"drains", T::list, M::plain, "that swallow it", &drain_kind},
    {"maximum_particles", T::integer, M::plain, "room for so many; what it is filled with and half more unless given"},
    {"courant", T::quantity, M::plain, "cells a particle may cross in a substep"},
    {"maximum_substeps", T::integer, M::plain, "1 to 64"},
    {"color", T::color, M::plain, "as #rrggbb"},
};
constexpr Field grains_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave these grains out"},
    {"lower", T::vector, M::length, "corner of the domain", nullptr, {}, true},
    {"upper", T::vector, M::length, "opposite corner", nullptr, {}, true},
    {"radius", T::quantity, M::length, "of the largest"},
    {"diameter", T::quantity, M::length, "instead of radius"},
    {"radius_spread", T::quantity, M::plain, "0 to .5"},
    {"density", T::quantity, M::density, "of the grains themselves"},
    {"friction", T::quantity, M::plain, "between grains"},
    {"rolling_friction", T::quantity, M::plain, "lever arm over radius"},
    {"wall_friction", T::quantity, M::plain, "at walls and bodies"},
    {"walls", T::list, M::plain, "which sides are walls: \"lower_x\", \"upper_x\", \"lower_y\" …; all unless given"},
    {"fill", T::list, M::plain, "boxes of grains at the start", &fill_kind},
    {"maximum_grains", T::integer, M::plain, "room for so many; what it is filled with unless given"},
    {"substeps", T::integer, M::plain, "1 to 64"},
    {"iterations", T::integer, M::plain, "1 to 100"},
    {"seed", T::integer, M::plain, "of the radii"},
    {"color", T::color, M::plain, "as #rrggbb"},
};

constexpr Field emitter_fields[] = {
    {"form", T::choice, M::plain, "point unless given", nullptr, forms},
    {"size", T::vector, M::length, "half extents of a box"},
    {"radius", T::quantity, M::length, "of a disc or sphere; half the length of a segment"},
    {"surface_only", T::flag, M::plain, "of a disc, box or sphere: the rim or surface"},
    {"file", T::text, M::plain, "an OBJ, STL or glTF file of a mesh, beside the scene", nullptr, {}, false, 3},
    {"vertices", T::point_list, M::length, "of a mesh", nullptr, {}, false, 3},
    {"indices", T::number_list, M::plain, "of a mesh, three a triangle", nullptr, {}, false, 3},
    {"position", T::vector, M::length},
    {"rotation", T::rotation, M::angle, "", &rotation_kind},
    {"velocity", T::vector, M::speed, "of the emitter"},
    {"inherited", T::quantity, M::plain, "the part of its velocity that particles start with"},
    {"rate", T::quantity, M::rate},
    {"start", T::quantity, M::time},
    {"duration", T::quantity, M::time, "without end unless given"},
    {"burst", T::integer, M::plain, "so many at once at its start"},
    {"direction", T::vector, M::plain, "up unless given"},
    {"along_normal", T::flag, M::plain, "outward from the form instead"},
    {"spread", T::quantity, M::angle, "half angle of the cone of directions"},
    {"speed", T::any, M::speed, "one number, or the lowest and highest"},
    {"lifetime", T::any, M::time, "one number, or the lowest and highest"},
    {"scale", T::any, M::plain, "of the radius: one number, or the lowest and highest"},
    {"seed", T::integer},
};
constexpr Field sub_emission_fields[] = {
    {"on", T::choice, M::plain, "what bears them", nullptr, occasions, true},
    {"into", T::name, M::plain, "name of the system that they belong to; this one where absent"},
    {"emitter", T::object, M::plain, "how they come; its place, rate and times do not count", &emitter_kind},
    {"count", T::integer, M::plain, "for each event"},
    {"chance", T::quantity, M::plain, "that an event counts"},
    {"inherited", T::quantity, M::plain, "the part of the event's velocity that they start with"},
    {"along_normal", T::flag, M::plain, "up of the emitter is turned to the surface's normal"},
};
constexpr Field attractor_fields[] = {
    {"center", T::vector, M::length, "", nullptr, {}, true},
    {"strength", T::quantity, M::acceleration, "where the reference is; negative: it pulls", nullptr, {}, true},
    {"reference", T::quantity, M::length, "distance at which the strength holds"},
    {"exponent", T::quantity, M::plain, "of the distance"},
    {"range", T::quantity, M::length},
};
constexpr Field burst_fields[] = {
    {"time", T::quantity, M::time, "0 unless given"},
    {"count", T::integer, M::plain, "1000 unless given; what finds no room is not born"},
    {"center", T::vector, M::length},
    {"velocity", T::vector, M::speed, "of the centre"},
    {"energy", T::quantity, M::energy, "of all in the centre's frame, instead of a speed"},
    {"speed", T::quantity, M::speed, "root of the mean square"},
    {"equal_speeds", T::flag, M::plain, "true unless given; false: uniform in velocity space"},
    {"lifetime", T::quantity, M::time},
    {"seed", T::integer, M::plain},
};
constexpr Field touch_fields[] = {
    {"restitution", T::quantity, M::plain, "0 to 1, between particles"},
    {"friction", T::quantity, M::plain, "between particles"},
    {"rolling", T::quantity, M::plain, "lever arm over radius"},
    {"substeps", T::integer, M::plain, "1 to 64"},
    {"iterations", T::integer, M::plain, "1 to 64"},
};
constexpr Field particles_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"name", T::text, M::plain, name_text},
    {"description", T::text},
    {"if", T::quantity, M::plain, "0: leave this system out"},
    {"capacity", T::integer, M::plain, "what finds no room is not born; 10000 unless given"},
    {"radius", T::quantity, M::length},
    {"diameter", T::quantity, M::length, "instead of radius"},
    {"mass", T::quantity, M::mass, "of one"},
    {"density", T::quantity, M::density, "of its ball, instead of mass"},
    {"gravity_scale", T::quantity, M::plain, "hot smoke rises: negative"},
    {"drag", T::choice, M::plain, "quadratic unless given", nullptr, particle_drag_laws},
    {"drag_coefficient", T::quantity, M::plain, "of a quadratic drag"},
    {"linear_coefficient", T::quantity, M::damping, "of a linear drag"},
    {"drag_over_age", T::any, M::plain, "a factor: a number, or pairs of age (0 to 1) and value"},
    {"size_over_age", T::any, M::plain, "of pictures: a number, or pairs of age and value"},
    {"opacity_over_age", T::any, M::plain, "of pictures: a number, or pairs of age and value"},
    {"color_over_age", T::any, M::plain, "of pictures: a color, or pairs of age and color"},
    {"turbulence_speed", T::quantity, M::speed, "root of the mean square, beside the environment's wind"},
    {"turbulence_length", T::quantity, M::length, "of the largest eddies"},
    {"restitution", T::quantity, M::plain, "at bodies"},
    {"friction", T::quantity, M::plain, "at bodies"},
    {"answer", T::choice, M::plain, "to a collision; bounce unless given", nullptr, answers},
    {"two_way", T::flag, M::plain, "bodies feel the particles"},
    {"touch", T::object, M::plain, "particles touch each other", &touch_kind},
    {"emitters", T::list, M::plain, "where they come from", &emitter_kind},
    {"bursts", T::list, M::plain, "that fly apart with no momentum between them", &burst_kind},
    {"sub_emissions", T::list, M::plain, "particles born where others die or strike", &sub_emission_kind},
    {"attractors", T::list, M::plain, "that pull all alike", &attractor_kind},
};

}  // namespace

const ObjectKind rope_attachment_kind{"rope_attachment", "Holds a particle of a rope.", attachment_fields};
const ObjectKind rope_winch_kind{"rope_winch", "Reels a rope in or pays it out.", winch_fields};
const ObjectKind rope_lump_kind{"rope_lump", "A mass on a rope.", lump_fields};
const ObjectKind rope_kind{"rope", "A rope, cable or chain.", rope_fields};
const ObjectKind pin_kind{"pin", "Holds vertices of cloth or of a soft body.", pin_fields};
const ObjectKind cloth_kind{"cloth", "A woven fabric.", cloth_fields};
const ObjectKind soft_body_kind{"soft_body", "An elastic solid.", soft_body_fields};
const ObjectKind fill_kind{"fill", "A box or ball that is full at the start.", fill_fields};
const ObjectKind tap_kind{"tap", "A jet from which liquid comes.", tap_fields};
const ObjectKind drain_kind{"drain", "A box that swallows liquid.", drain_fields};
const ObjectKind liquid_kind{"liquid", "A liquid in a box-shaped domain.", liquid_fields};
const ObjectKind grains_kind{"grains", "Round grains in a box-shaped domain.", grains_fields};
const ObjectKind emitter_kind{"emitter", "Where particles come from.", emitter_fields};
const ObjectKind sub_emission_kind{"sub_emission", "Particles born where others die or strike.", sub_emission_fields};
const ObjectKind attractor_kind{"attractor", "Pulls particles to a point.", attractor_fields};
const ObjectKind burst_kind{"burst", "Particles that fly apart.", burst_fields};
const ObjectKind touch_kind{"touch", "How particles touch each other.", touch_fields};
const ObjectKind particles_kind{"particles", "A system of particles of one kind.", particles_fields};

}  // namespace carom::scene::detail
