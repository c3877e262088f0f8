#include "carom/scene/detail/environment.h"

#include "carom/math/elementary.h"
#include "carom/scene/detail/environment_fields.h"
#include "carom/scene/detail/text.h"

namespace carom::scene::detail {
namespace {
using namespace environment;
using math::Vec3d;

/// Calls make(object) for every entry of a list.
template <class Make>
void each(Reader& reader, const Object& o, const char* key, const ObjectKind& kind, std::size_t most,
          const Make& make) {
  const Node* list = o.find(key);
  if (list == nullptr || reader.failed()) return;
  const std::string path = o.path_of(key);
  if (!list->is_array() || list->children.size() > most)
    return reader.expected(*list, path, "a list of at most " + std::to_string(most));
  for (std::size_t i = 0; i < list->children.size() && !reader.failed(); ++i) {
    Object entry;
    if (reader.open(list->children[i], index_path(path, i), kind, entry)) make(entry);
  }
}
bool part(Reader& reader, const Object& o, const char* key, const ObjectKind& kind, Object& out) {
  return o.has(key) && !reader.failed() && reader.open(*o.find(key), o.path_of(key), kind, out);
}

/// To unit length, unless it is that already: what was written comes back to the bit.
void make_unit(Vec3d& v) {
  const double length = math::length(v);
  if (length > 0 && math::abs(length - 1) > 1e-9) v /= length;
}

GravityField read_gravity(Reader& reader, const Object& o) {
  GravityField g;
  g.kind = GravityField::Kind(reader.choice(o, "kind", 0));
  g.acceleration = reader.vector(o, "acceleration", g.acceleration);
  g.center = reader.vector(o, "center");
  g.axis = reader.vector(o, "axis", g.axis);
  make_unit(g.axis);
  g.gm = reader.number(o, "gm", g.gm);
  g.minimum_radius = reader.number(o, "minimum_radius", g.minimum_radius);
  g.equatorial_radius = reader.number(o, "equatorial_radius", g.equatorial_radius);
  g.j2 = reader.number(o, "j2", g.j2);
  return g;
}

RotatingFrame read_frame(Reader& reader, const Object& o) {
  RotatingFrame frame;
  frame.rate = reader.angular(o, "rate");
  if (o.has("latitude")) {
    if (o.has("rate")) reader.fail(*o.node, o.path, "found both rate and latitude, expected one of them");
    frame.rate = earth_rate(reader.number(o, "latitude", 0), reader.number(o, "bearing", 0.5 * math::pi));
  } else if (o.has("bearing")) {
    reader.fail(*o.node, o.path, "found a bearing without a latitude");
  }
  frame.origin = reader.vector(o, "origin");
  frame.centrifugal = reader.flag(o, "centrifugal", false);
  return frame;
}

Turbulence read_turbulence(Reader& reader, const Object& o, const WindField& wind) {
  TurbulenceDef def;
  def.spectrum = TurbulenceSpectrum(reader.choice(o, "spectrum", int(def.spectrum)));
  const double height = reader.number(o, "height", 10);
  if (o.has("wind_at_20_feet")) def.scales = low_altitude_turbulence(height, reader.number(o, "wind_at_20_feet", 0));
  if (o.has("strength")) {
    const double sigma = reader.number(o, "strength", 0);
    def.scales.intensity = {sigma, sigma, sigma};
  }
  if (o.has("size")) {
    const double length = reader.number(o, "size", 0);
    def.scales.length = {length, length, length};
  }
  const auto three = [&](const char* key, Vec3d& out) {
    if (!o.has(key)) return;
    const std::vector<double> v = reader.numbers(o, key, 3);
    if (v.size() == 3) out = {v[0], v[1], v[2]};
  };
  three("intensity", def.scales.intensity);
  three("length", def.scales.length);
  def.mean_wind = reader.vector(o, "mean_wind", wind.mean_at(height));
  def.smallest = reader.number(o, "smallest", 0);
  def.shells = reader.integer(o, "shells", def.shells, 4, 64);
  def.seed = reader.bits(o, "seed", def.seed);
  if (reader.failed()) return {};
  core::Result<Turbulence> made = Turbulence::make(def);
  if (!made.ok()) return reader.fail(*o.node, o.path, made.error().message), Turbulence{};
  return std::move(made).value();
}

WindField read_wind(Reader& reader, const Object& o) {
  WindField wind;
  wind.mean.velocity = reader.vector(o, "velocity");
  wind.mean.profile = WindProfile(reader.choice(o, "profile", 0));
  wind.mean.reference_height = reader.number(o, "reference_height", wind.mean.reference_height);
  wind.mean.exponent = reader.number(o, "exponent", wind.mean.exponent);
  wind.mean.roughness_length = reader.number(o, "roughness_length", wind.mean.roughness_length);
  each(reader, o, "layers", wind_layer_kind, 1000,
       [&](const Object& e) { wind.layers.push_back({reader.number(e, "height", 0), reader.vector(e, "velocity")}); });
  each(reader, o, "gusts", gust_kind, 1000, [&](const Object& e) {
    Gust g;
    g.velocity = reader.vector(e, "velocity");
    g.direction = reader.vector(e, "direction", g.direction);
    make_unit(g.direction);
    g.front = reader.number(e, "front", 0);
    g.gradient_distance = reader.number(e, "gradient_distance", g.gradient_distance);
    g.speed = reader.number(e, "speed", 0);
    g.lasting = reader.flag(e, "lasting", false);
    wind.gusts.push_back(g);
  });
  each(reader, o, "thermals", thermal_kind, 1000, [&](const Object& e) {
    Thermal t;
    t.base = reader.vector(e, "base");
    t.strength = reader.number(e, "strength", t.strength);
    t.radius = reader.number(e, "radius", t.radius);
    t.depth = reader.number(e, "depth", t.depth);
    t.lean = reader.vector(e, "lean");
    wind.thermals.push_back(t);
  });
  each(reader, o, "obstacles", obstacle_kind, 1000, [&](const Object& e) {
    Obstacle b;
    b.center = reader.vector(e, "center");
    b.area = reader.number(e, "area", b.area);
    b.drag_coefficient = reader.number(e, "drag_coefficient", b.drag_coefficient);
    b.growth = reader.number(e, "growth", b.growth);
    wind.obstacles.push_back(b);
  });
  each(reader, o, "wakes", wake_kind, 1000, [&](const Object& e) {
    WakeVortexPair w;
    w.point = reader.vector(e, "point");
    w.direction = reader.vector(e, "direction", w.direction);
    make_unit(w.direction);
    w.circulation = reader.number(e, "circulation", w.circulation);
    w.spacing = reader.number(e, "spacing", w.spacing);
    w.core_radius = reader.number(e, "core_radius", w.core_radius);
    w.decay_time = reader.number(e, "decay_time", w.decay_time);
    wind.wakes.push_back(w);
  });
  if (Object e; part(reader, o, "turbulence", turbulence_kind, e)) wind.turbulence = read_turbulence(reader, e, wind);
  if (!reader.failed()) reader.accept(validate(wind), *o.node, o.path);
  return wind;
}

WaveComponent read_wave(Reader& reader, const Object& o, const WaterBody& water) {
  const double height = reader.number(o, "height", 0), phase = reader.number(o, "phase", 0);
  const bool by_number = o.has("wave_number") && o.has("frequency");
  if (!o.has("height")) reader.fail(*o.node, o.path, "the key \"height\" is missing in a wave");
  if (o.has("period") == by_number || o.has("wave_number") != o.has("frequency"))
    reader.fail(*o.node, o.path, "expected a period, or a wave_number with a frequency");
  const double period = reader.number(o, "period", 1);
  if (!reader.failed() && !(period > 0)) reader.expected(*o.find("period"), o.path_of("period"), "more than 0 s");
  WaveComponent wave = regular_wave(height, reader.failed() ? 1 : period, reader.number(o, "direction", 0), water.depth,
                                    water.gravity, phase);
  if (by_number) {
    wave.wave_number = reader.number(o, "wave_number", 0);
    wave.frequency = reader.number(o, "frequency", 0);
  }
  if (o.has("heading")) {
    const std::vector<double> heading = reader.numbers(o, "heading", 2);
    if (heading.size() == 2) wave.direction_x = heading[0], wave.direction_z = heading[1];
  }
  return wave;
}

std::optional<Sea> read_sea(Reader& reader, const Object& o) {
  WaterBody water;
  water.level = reader.number(o, "level", water.level);
  water.depth = reader.number(o, "depth", water.depth);
  water.density = reader.number(o, "density", water.density);
  water.gravity = reader.number(o, "gravity", water.gravity);
  water.current = reader.vector(o, "current");
  water.stretching = Stretching(reader.choice(o, "stretching", 0));
  std::vector<WaveComponent> waves;
  each(reader, o, "waves", sea_wave_kind, 256, [&](const Object& e) { waves.push_back(read_wave(reader, e, water)); });
  const int spectrum = reader.choice(o, "spectrum", 0);
  const bool by_height = o.has("significant_height") || o.has("peak_period"), by_wind = o.has("wind_speed"),
             by_state = o.has("sea_state");
  if (!reader.failed() && spectrum != 0 && !waves.empty())
    reader.fail(*o.node, o.path, "found both waves and a spectrum, expected one of them");
  if (!reader.failed() && int(by_height) + int(by_wind) + int(by_state) != (spectrum != 0 ? 1 : 0))
    reader.fail(*o.node, o.path,
                "expected a spectrum with either significant_height and peak_period, wind_speed, or sea_state");
  if (!reader.failed() && by_height && !(o.has("significant_height") && o.has("peak_period")))
    reader.fail(*o.node, o.path, "expected significant_height and peak_period together");
  if (!reader.failed() && o.has("fetch") && !(by_wind && spectrum == 2))
    reader.fail(*o.node, o.path, "found a fetch, expected it with a wind_speed and the spectrum jonswap");
  SeaDef def;
  const double gamma = reader.number(o, "peak_enhancement", spectrum == 2 ? 3.3 : 1);
  const double wind = reader.number(o, "wind_speed", 10), fetch = reader.number(o, "fetch", 100e3);
  if (!reader.failed() && (!(wind > 0) || !(fetch > 0)))
    reader.fail(*o.node, o.path, "found a wind_speed or fetch of 0 or less, expected more");
  if (by_wind && !reader.failed())
    def.spectrum =
        o.has("fetch") ? fetch_limited_sea(wind, fetch, gamma, water.gravity) : fully_grown_sea(wind, water.gravity);
  if (by_state) def.spectrum = sea_state(reader.integer(o, "sea_state", 4, 0, 9));
  def.spectrum.significant_height = reader.number(o, "significant_height", def.spectrum.significant_height);
  def.spectrum.peak_period = reader.number(o, "peak_period", def.spectrum.peak_period);
  def.spectrum.peak_enhancement = gamma;
  def.direction = reader.number(o, "direction", def.direction);
  def.spread = reader.number(o, "spread", def.spread);
  def.components = reader.integer(o, "components", def.components, 1, 256);
  def.seed = reader.bits(o, "seed", def.seed);
  if (reader.failed()) return std::nullopt;
  core::Result<Sea> made = spectrum != 0 ? Sea::make(water, def) : Sea::make(water, waves);
  if (!made.ok()) return reader.fail(*o.node, o.path, made.error().message), std::nullopt;
  return std::move(made).value();
}

std::string text_of(Vec3d v, int dimension) {
  return "[" + digits(v.x) + ", " + digits(v.y) + (dimension == 3 ? ", " + digits(v.z) : "") + "]";
}
/// "[a, b]" of the objects that make(entry) gives.
template <class List, class Make>
std::string list_of(const List& list, const Make& make) {
  std::string out;
  for (const auto& entry : list) out += (out.empty() ? "" : ", ") + make(entry).object();
  return "[" + out + "]";
}

std::string wind_text(const WindField& wind, int dimension) {
  constexpr const char* profiles[] = {"uniform", "power", "logarithmic"};
  const auto vector = [dimension](Vec3d v) { return text_of(v, dimension); };
  Fields f;
  f.put("velocity", vector(wind.mean.velocity)).put("profile", quote(profiles[int(wind.mean.profile)]));
  f.put("reference_height", wind.mean.reference_height).put("exponent", wind.mean.exponent);
  f.put("roughness_length", wind.mean.roughness_length);
  if (!wind.layers.empty())
    f.put("layers", list_of(wind.layers, [&](const WindColumn::Level& l) {
            return Fields().put("height", l.height).put("velocity", vector(l.velocity));
          }));
  if (!wind.turbulence.calm()) {
    const TurbulenceDef& t = wind.turbulence.definition();
    f.put("turbulence", Fields()
                            .put("spectrum", quote(t.spectrum == TurbulenceSpectrum::dryden ? "dryden" : "von_karman"))
                            .put("intensity", text_of(t.scales.intensity, 3))
                            .put("length", text_of(t.scales.length, 3))
                            .put("mean_wind", vector(t.mean_wind))
                            .put("smallest", t.smallest)
                            .put("shells", std::to_string(t.shells))
                            .put("seed", bits_text(t.seed))
                            .object());
  }
  if (!wind.gusts.empty())
    f.put("gusts", list_of(wind.gusts, [&](const Gust& g) {
            Fields e;
            e.put("velocity", vector(g.velocity)).put("direction", vector(g.direction)).put("front", g.front);
            e.put("gradient_distance", g.gradient_distance).put("speed", g.speed);
            return e.flag("lasting", g.lasting, false);
          }));
  if (!wind.thermals.empty())
    f.put("thermals", list_of(wind.thermals, [&](const Thermal& t) {
            Fields e;
            e.put("base", vector(t.base)).put("strength", t.strength).put("radius", t.radius);
            return e.put("depth", t.depth).put("lean", vector(t.lean));
          }));
  if (!wind.obstacles.empty())
    f.put("obstacles", list_of(wind.obstacles, [&](const Obstacle& b) {
            Fields e;
            e.put("center", vector(b.center)).put("area", b.area);
            return e.put("drag_coefficient", b.drag_coefficient).put("growth", b.growth);
          }));
  if (!wind.wakes.empty())
    f.put("wakes", list_of(wind.wakes, [&](const WakeVortexPair& w) {
            Fields e;
            e.put("point", vector(w.point)).put("direction", vector(w.direction)).put("circulation", w.circulation);
            return e.put("spacing", w.spacing).put("core_radius", w.core_radius).put("decay_time", w.decay_time);
          }));
  return f.object();
}

std::string sea_text(const Sea& sea, int dimension) {
  const WaterBody& water = sea.water();
  Fields f;
  f.put("level", water.level).put("depth", water.depth).put("density", water.density).put("gravity", water.gravity);
  f.put("current", text_of(water.current, dimension));
  f.put("stretching", quote(water.stretching == Stretching::wheeler ? "wheeler" : "vertical"));
  if (!sea.components().empty())
    f.put("waves", list_of(sea.components(), [](const WaveComponent& w) {
            Fields e;
            e.put("height", 2 * w.amplitude).put("wave_number", w.wave_number).put("frequency", w.frequency);
            return e.put("heading", "[" + digits(w.direction_x) + ", " + digits(w.direction_z) + "]")
                .put("phase", w.phase);
          }));
  return f.object();
}

}  // namespace

std::shared_ptr<const Environment> read_environment(Reader& reader, const Object& scene) {
  Object o, e;
  if (!part(reader, scene, "environment", environment_kind, o)) return nullptr;
  Environment::Definition d;
  if (part(reader, o, "gravity", gravity_field_kind, e)) d.gravity = read_gravity(reader, e);
  if (part(reader, o, "frame", turning_frame_kind, e)) d.frame = read_frame(reader, e);
  if (part(reader, o, "air", air_kind, e)) {
    d.air.temperature = reader.number(e, "temperature_offset", 0);
    d.air.sea_level_pressure = reader.number(e, "sea_level_pressure", d.air.sea_level_pressure);
    d.air.relative_humidity = reader.number(e, "humidity", 0);
    d.altitude = reader.number(e, "altitude", 0);
    d.vacuum = reader.flag(e, "vacuum", false);
  }
  if (part(reader, o, "wind", wind_field_kind, e)) d.wind = read_wind(reader, e);
  if (part(reader, o, "water", sea_kind, e)) d.water = read_sea(reader, e);
  d.ground = reader.number(o, "ground", 0);
  if (reader.failed()) return nullptr;
  core::Result<Environment> made = Environment::make(std::move(d));
  if (!made.ok()) return reader.fail(*o.node, o.path, made.error().message), nullptr;
  return std::make_shared<const Environment>(std::move(made).value());
}

std::string environment_text(const Environment& environment, int dimension) {
  constexpr const char* kinds[] = {"none", "uniform", "spherical", "oblate"};
  const Environment::Definition& d = environment.definition();
  const auto vector = [dimension](Vec3d v) { return text_of(v, dimension); };
  Fields f;
  if (environment.has_gravity()) {
    Fields g;
    g.put("kind", quote(kinds[int(d.gravity.kind)])).put("acceleration", vector(d.gravity.acceleration));
    g.put("center", vector(d.gravity.center)).put("axis", vector(d.gravity.axis)).put("gm", d.gravity.gm);
    g.put("minimum_radius", d.gravity.minimum_radius).put("equatorial_radius", d.gravity.equatorial_radius);
    f.put("gravity", g.put("j2", d.gravity.j2).object());
  }
  if (environment.turns())
    f.put("frame", Fields()
                       .put("rate", dimension == 2 ? digits(d.frame.rate.z) : text_of(d.frame.rate, 3))
                       .put("origin", vector(d.frame.origin))
                       .flag("centrifugal", d.frame.centrifugal, false)
                       .object());
  f.put("air", Fields()
                   .put("temperature_offset", d.air.temperature)
                   .put("sea_level_pressure", d.air.sea_level_pressure)
                   .put("humidity", d.air.relative_humidity)
                   .put("altitude", d.altitude)
                   .flag("vacuum", d.vacuum, false)
                   .object());
  f.put("wind", wind_text(d.wind, dimension));
  if (d.water) f.put("water", sea_text(*d.water, dimension));
  return f.put("ground", d.ground).object();
}

}  // namespace carom::scene::detail
