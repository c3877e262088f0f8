#include "carom/scene/detail/body_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view body_types[] = {"fixed", "kinematic", "dynamic"};
constexpr std::string_view shape_types[] = {
    "sphere",       "capsule", "box",      "cylinder", "cone",    "ellipsoid", "hull",  "plane", "mesh",
    "height_field", "voxels",  "compound", "circle",   "polygon", "segment",   "chain", "tiles", "concave_polygon"};
constexpr std::string_view character_types[] = {"kinematic", "dynamic"};
}  // namespace

constexpr Field rotation_fields[] = {
    {"axis", T::vector, M::plain, "axis to turn about; need not be of unit length", nullptr, {}, false, 3},
    {"angle", T::quantity, M::angle, "angle about the axis"},
    {"yaw", T::quantity, M::angle, "turn about y, applied last", nullptr, {}, false, 3},
    {"pitch", T::quantity, M::angle, "turn about z, applied second", nullptr, {}, false, 3},
    {"roll", T::quantity, M::angle, "turn about x, applied first", nullptr, {}, false, 3},
    {"quaternion", T::number_list, M::plain, "w, x, y, z", nullptr, {}, false, 3},
};
const ObjectKind rotation_kind{"rotation", "A rotation: axis and angle, yaw, pitch and roll, or a quaternion.",
                               rotation_fields};

constexpr Field material_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"friction", T::quantity, M::plain, "Coulomb's coefficient, at least 0"},
    {"restitution", T::quantity, M::plain, "0 to 1"},
    {"rolling_resistance", T::quantity, M::plain, "lever arm over radius, at least 0"},
    {"spinning_resistance", T::quantity, M::plain, "likewise, of what spins about the normal (3D)"},
    {"tangent_speed", T::quantity, M::speed, "speed of a conveyor along the surface"},
    {"density", T::quantity, M::density, "used by shapes that give neither density nor mass"},
    {"user_id", T::integer},
};
const ObjectKind material_kind{"material", "How a surface behaves.", material_fields};

constexpr Field filter_fields[] = {
    {"category", T::bits, M::plain, "what the shape is: a number, a hexadecimal text, or a list of bit numbers"},
    {"mask", T::bits, M::plain, "what it collides with"},
    {"group", T::integer, M::plain, "negative: never collide within the group; positive: always"},
};
const ObjectKind filter_kind{"filter", "Which shapes collide.", filter_fields};

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
    {"points", T::point_list, M::length,
     "of a hull, polygon, segment or chain; of a concave polygon round its outline"},
    {"openings",
     T::point_lists,
     M::length,
     "of a concave polygon: outlines of its holes, each in either direction",
     nullptr,
     {},
     false,
     2},
    {"loop", T::flag, M::plain, "a chain that closes", nullptr, {}, false, 2},
    {"simplify", T::flag, M::plain, "drop the least important corners of a hull with too many", nullptr, {}, false, 3},
    {"max_corners",
     T::integer,
     M::plain,
     "that a hull may have, from 8 to 255; 128 where absent",
     nullptr,
     {},
     false,
     3},
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
const ObjectKind shape_kind{"shape", "A collision shape.", shape_fields};

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

}  // namespace carom::scene::detail
