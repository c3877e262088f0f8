#include "carom/scene/detail/environment_fields.h"

namespace carom::scene::detail {
namespace {
using T = FieldType;
using M = Measure;

constexpr std::string_view gravity_kinds[] = {"none", "uniform", "spherical", "oblate"};
constexpr std::string_view profiles[] = {"uniform", "power", "logarithmic"};
constexpr std::string_view turbulence_spectra[] = {"dryden", "von_karman"};
constexpr std::string_view sea_spectra[] = {"none", "pierson_moskowitz", "jonswap"};
constexpr std::string_view stretchings[] = {"wheeler", "vertical"};

constexpr Field gravity_fields[] = {
    {"kind", T::choice, M::plain, "", nullptr, gravity_kinds, true},
    {"acceleration", T::vector, M::acceleration, "uniform"},
    {"center", T::vector, M::length, "spherical and oblate"},
    {"axis", T::vector, M::plain, "oblate: of the turning, y unless given"},
    {"gm", T::quantity, M::gravitational_parameter, "the Earth's unless given"},
    {"minimum_radius", T::quantity, M::length, "inside it the pull stays as there"},
    {"equatorial_radius", T::quantity, M::length, "oblate"},
    {"j2", T::quantity, M::plain, "oblate"},
};
constexpr Field turning_frame_fields[] = {
    {"rate", T::vector, M::angular_speed, "of the frame; a number in the plane"},
    {"latitude", T::quantity, M::angle, "the Earth's turning there, instead of a rate"},
    {"bearing", T::quantity, M::angle, "of the x axis, from north over east; 90 deg unless given"},
    {"origin", T::vector, M::length, "on the axis"},
    {"centrifugal", T::flag, M::plain, "felt too; on Earth it is part of gravity"},
};
constexpr Field air_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"temperature_offset", T::quantity, M::temperature, "added at every height"},
    {"sea_level_pressure", T::quantity, M::pressure, "QNH"},
    {"humidity", T::quantity, M::plain, "0 to 1"},
    {"altitude", T::quantity, M::length, "of y = 0 above the sea"},
    {"vacuum", T::flag, M::plain, "no air at all"},
};
constexpr Field layer_fields[] = {
    {"height", T::quantity, M::length, "above the ground", nullptr, {}, true},
    {"velocity", T::vector, M::speed, "", nullptr, {}, true},
};
constexpr Field gust_fields[] = {
    {"velocity", T::vector, M::speed, "the peak", nullptr, {}, true},
    {"direction", T::vector, M::plain, "the way it travels, x unless given"},
    {"front", T::quantity, M::length, "along the direction at time 0"},
    {"gradient_distance", T::quantity, M::length, "from nothing to the peak"},
    {"speed", T::quantity, M::speed, "of its travel"},
    {"lasting", T::flag, M::plain, "it stays at the peak"},
};
constexpr Field turbulence_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"spectrum", T::choice, M::plain, "von_karman unless given", nullptr, turbulence_spectra},
    {"intensity", T::number_list, M::speed, "along, across and up; or by height and wind_at_20_feet"},
    {"length", T::number_list, M::length, "along, across and up"},
    {"height", T::quantity, M::length, "MIL-F-8785C: scales of this height above the ground, below 2000 ft"},
    {"wind_at_20_feet", T::quantity, M::speed, "MIL-F-8785C: 15 kn light, 30 kn moderate, 45 kn severe"},
    {"strength", T::quantity, M::speed, "the same intensity in all directions"},
    {"size", T::quantity, M::length, "the same length in all directions"},
    {"mean_wind", T::vector, M::speed, "that carries it; the wind at its height unless given"},
    {"smallest", T::quantity, M::length, "eddies; a hundredth of the length unless given"},
    {"shells", T::integer, M::plain, "4 to 64 bands of six modes, 16 unless given"},
    {"seed", T::bits},
};
constexpr Field thermal_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"base", T::vector, M::length, "its foot"},
    {"strength", T::quantity, M::speed, "the fastest rise"},
    {"radius", T::quantity, M::length, "where rise turns to sink"},
    {"depth", T::quantity, M::length, "from the ground to the inversion"},
    {"lean", T::vector, M::plain, "downwind for every metre up"},
};
constexpr Field obstacle_fields[] = {
    {"center", T::vector, M::length, "the middle of its front"},
    {"area", T::quantity, M::area, "across the wind"},
    {"drag_coefficient", T::quantity},
    {"growth", T::quantity, M::plain, "of the lee's width per metre"},
};
constexpr Field wake_fields[] = {
    {"point", T::vector, M::length, "midway between the cores at time 0"},
    {"direction", T::vector, M::plain, "of the flight, horizontal"},
    {"circulation", T::quantity, M::circulation, "of each"},
    {"spacing", T::quantity, M::length},
    {"core_radius", T::quantity, M::length},
    {"decay_time", T::quantity, M::time},
};
constexpr Field wind_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"velocity", T::vector, M::speed, "at the reference height"},
    {"profile", T::choice, M::plain, "uniform unless given", nullptr, profiles},
    {"reference_height", T::quantity, M::length, "10 m unless given"},
    {"exponent", T::quantity, M::plain, "power profile, 1/7 unless given"},
    {"roughness_length", T::quantity, M::length, "logarithmic profile"},
    {"layers", T::list, M::plain, "by rising height, instead of a profile", &wind_layer_kind},
    {"turbulence", T::object, M::plain, "", &turbulence_kind},
    {"gusts", T::list, M::plain, "", &gust_kind},
    {"thermals", T::list, M::plain, "", &thermal_kind},
    {"obstacles", T::list, M::plain, "", &obstacle_kind},
    {"wakes", T::list, M::plain, "pairs of vortices behind wings", &wake_kind},
};
constexpr Field sea_wave_fields[] = {
    {"height", T::quantity, M::length, "from trough to crest"},
    {"period", T::quantity, M::time},
    {"direction", T::quantity, M::angle, "where it goes to, from x toward z"},
    {"phase", T::quantity, M::angle},
    {"wave_number", T::quantity, M::wave_number, "instead of the period, with the frequency"},
    {"frequency", T::quantity, M::angular_speed, "instead of the period, with the wave_number"},
    {"heading", T::number_list, M::plain, "unit vector (x, z) instead of the direction"},
};
constexpr Field sea_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"level", T::quantity, M::length, "of the still surface"},
    {"depth", T::quantity, M::length, "deep unless given"},
    {"density", T::quantity, M::density, "1025 kg/m^3 unless given"},
    {"gravity", T::quantity, M::acceleration, "of the waves"},
    {"current", T::vector, M::speed, "horizontal"},
    {"stretching", T::choice, M::plain, "wheeler unless given", nullptr, stretchings},
    {"waves", T::list, M::plain, "regular waves, instead of a spectrum", &sea_wave_kind},
    {"spectrum", T::choice, M::plain, "none unless given", nullptr, sea_spectra},
    {"significant_height", T::quantity, M::length, "of the spectrum"},
    {"peak_period", T::quantity, M::time, "of the spectrum"},
    {"peak_enhancement", T::quantity, M::plain, "jonswap: 3.3 unless given"},
    {"wind_speed", T::quantity, M::speed, "instead of height and period: at 19.5 m, or with a fetch at 10 m"},
    {"fetch", T::quantity, M::length, "jonswap, with the wind_speed"},
    {"sea_state", T::integer, M::plain, "0 to 9, instead of height and period"},
    {"direction", T::quantity, M::angle, "where the waves go to, from x toward z"},
    {"spread", T::quantity, M::plain, "s of cos^2s; 10 unless given, 0: long crests"},
    {"components", T::integer, M::plain, "1 to 256, 48 unless given"},
    {"seed", T::bits},
};
constexpr Field environment_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"gravity", T::object, M::plain, "beside the scene's own gravity", &gravity_field_kind},
    {"frame", T::object, M::plain, "Coriolis and centrifugal forces", &turning_frame_kind},
    {"air", T::object, M::plain, "", &air_kind},
    {"wind", T::object, M::plain, "", &wind_field_kind},
    {"water", T::object, M::plain, "", &sea_kind},
    {"ground", T::quantity, M::length, "height of the ground, for the wind"},
};

}  // namespace

const ObjectKind gravity_field_kind{"gravity", "Gravity that differs from place to place.", gravity_fields};
const ObjectKind turning_frame_kind{"turning_frame", "A frame that turns.", turning_frame_fields};
const ObjectKind air_kind{"air", "The day: how the air differs from the standard atmosphere.", air_fields};
const ObjectKind wind_layer_kind{"wind_layer", "Wind at a height.", layer_fields};
const ObjectKind gust_kind{"gust", "A single gust of the shape 1 - cos.", gust_fields};
const ObjectKind turbulence_kind{"turbulence", "Eddies that the wind carries along.", turbulence_fields};
const ObjectKind thermal_kind{"thermal", "Warm air that rises.", thermal_fields};
const ObjectKind obstacle_kind{"obstacle", "Something that shelters what is behind it.", obstacle_fields};
const ObjectKind wake_kind{"wake", "The vortices behind a wing.", wake_fields};
const ObjectKind wind_field_kind{"wind_field", "The wind of the place.", wind_fields};
const ObjectKind sea_wave_kind{"sea_wave", "One regular wave.", sea_wave_fields};
const ObjectKind sea_kind{"sea", "Water with waves and current.", sea_fields};
const ObjectKind environment_kind{"environment", "All that is around the bodies.", environment_fields};

}  // namespace carom::scene::detail
