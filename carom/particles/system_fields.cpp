// Air, attractors and drag, as the kernels want them.
#include <string>

#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/system.h"

namespace carom::particles {
using math::Vec3d;

namespace {

constexpr int wind_nodes = 256;
constexpr double wind_top = 500;  // m above the ground; constant beyond
constexpr int max_fields = 256;
constexpr int patch_nodes = 8192, fewest_nodes = 512;

/// The part of a number of turns beyond the nearest whole one.
float part_turn(double turns) { return float(turns - math::floor(turns + 0.5)); }

}  // namespace

core::Status check(const Air& air) {
  const environment::Wind& w = air.wind;
  if (!detail::finite_vector(w.velocity)) return core::Error{"wind: velocity is not finite"};
  if (!math::is_finite(air.ground)) return core::Error{"air: ground is not finite"};
  if (!(w.reference_height > 0 && math::is_finite(w.reference_height)))
    return detail::bad("wind", "reference_height", w.reference_height, "above 0 m");
  if (!math::is_finite(w.exponent)) return detail::bad("wind", "exponent", w.exponent, "a finite number");
  if (!(w.roughness_length > 0 && w.roughness_length < w.reference_height))
    return detail::bad("wind", "roughness_length", w.roughness_length, "above 0 m and below the reference height");
  for (std::size_t i = 0; i < air.layers.size(); ++i) {
    if (!detail::finite_vector(air.layers[i].velocity))
      return core::Error{"air: the velocity of a layer is not finite"};
    const double height = air.layers[i].height;
    if (!(math::abs(height) <= 1e6) || (i > 0 && !(height > air.layers[i - 1].height)))
      return detail::bad("air", "height of a layer", height, "more than that of the layer before, within 10^6 m");
  }
  if (air.field)
    if (const core::Status status = environment::validate(*air.field); !status) return status;
  const Turbulence& t = air.turbulence;
  if (!(t.speed >= 0 && t.speed <= 1e4f)) return detail::bad("turbulence", "speed", t.speed, "0 to 10^4 m/s");
  if (!(t.length > 0 && t.length <= 1e6f)) return detail::bad("turbulence", "length", t.length, "above 0 to 10^6 m");
  if (t.waves < 1 || t.waves > 64) return detail::bad("turbulence", "waves", t.waves, "1 to 64");
  if (air.whirls.size() > max_fields)
    return detail::bad("air", "number of whirls", double(air.whirls.size()), "at most 256");
  for (const Whirl& whirl : air.whirls) {
    if (!detail::finite_vector(whirl.center)) return core::Error{"whirl: center is not finite"};
    if (!(math::abs(math::length(whirl.axis) - 1) < 1e-6)) return core::Error{"whirl: axis is not a unit vector"};
    if (!math::is_finite(whirl.vortex.circulation)) return core::Error{"whirl: circulation is not finite"};
    if (!(whirl.vortex.core_radius > 0 && math::is_finite(whirl.vortex.core_radius)))
      return detail::bad("whirl", "core_radius", whirl.vortex.core_radius, "above 0 m");
  }
  return {};
}

core::Status check(const Attractor& a) {
  const forces::Radial& r = a.radial;
  if (!detail::finite_vector(a.center)) return core::Error{"attractor: center is not finite"};
  if (!math::is_finite(r.strength)) return core::Error{"attractor: strength is not finite"};
  if (!(r.reference > 0 && math::is_finite(r.reference)))
    return detail::bad("attractor", "reference", r.reference, "above 0 m");
  if (!(math::abs(r.exponent) <= 8)) return detail::bad("attractor", "exponent", r.exponent, "-8 to 8");
  if (!(r.range > 0)) return detail::bad("attractor", "range", r.range, "above 0 m");
  if (!(r.core > 0 && math::is_finite(r.core))) return detail::bad("attractor", "core", r.core, "above 0 m");
  return {};
}

core::Status ParticleSystem::set_air(const Air& air) {
  if (const core::Status status = particles::check(air); !status) return status;
  air_ = air;
  if (air_.field) {
    air_.wind = air_.field->mean;
    air_.layers = air_.field->layers;
  }
  if (definition_.planar) air_.wind.velocity.z = 0;
  wind_table_.clear();
  wind_base_ = air_.ground;
  wind_height_ = wind_top;
  if (!air_.layers.empty()) {
    const environment::WindColumn column(air_.layers);
    const double low = air_.layers.front().height;
    wind_base_ += low;
    wind_height_ = math::max(1.0, air_.layers.back().height - low);
    // What drifts with the wind does so with that of the height at which profiles have theirs.
    air_.wind = {.velocity = column.at(air_.wind.reference_height)};
    if (definition_.planar) air_.wind.velocity.z = 0;
    for (int k = 0; air_.layers.size() > 1 && k < 3; ++k)
      for (int i = 0; i < wind_nodes; ++i) {
        const auto at = [&](int node) {
          const double v = column.at(low + wind_height_ * math::square(double(node) / wind_nodes))[k];
          return k == 2 && definition_.planar ? 0.0f : float(v);
        };
        wind_table_.push_back(at(i));
        wind_table_.push_back(at(i + 1) - at(i));
      }
  }
  const environment::Wind& wind = air_.wind;
  if (air_.layers.empty() && wind.profile != environment::WindProfile::uniform && math::length(wind.velocity) > 0) {
    // By the root of the height: fine at the ground, where the wind changes most.
    environment::Wind unit = wind;
    unit.velocity = {1, 0, 0};
    const auto factor = [&](int i) {
      return environment::wind_at(unit, wind_top * math::square(double(i) / wind_nodes)).x;
    };
    for (int i = 0; i < wind_nodes; ++i) {
      wind_table_.push_back(float(factor(i)));
      wind_table_.push_back(float(factor(i + 1)) - float(factor(i)));
    }
  }

  const Turbulence& t = air_.turbulence;
  wave_shapes_.clear();
  wave_rates_.clear();
  if (t.speed > 0) {
    math::Random random(t.seed);
    double squares = 0;
    for (int i = 0; i < t.waves; ++i) {
      // In turns a metre, from 1/length to 8/length evenly in its logarithm; E(k) ~ k^(−5/3) gives |a|² ~ k^(−2/3).
      const double part = t.waves > 1 ? double(i) / (t.waves - 1) : 0;
      const double number = math::exp2(3 * part) / double(t.length);
      Vec3d direction = random.on_sphere(), across = random.on_sphere();
      if (definition_.planar) {
        const math::Vec2d c = random.on_circle();
        direction = {c.x, c.y, 0};
        across = {0, 0, 1};
      }
      const Vec3d a = math::normalize(math::cross(direction, across)) * math::exp2(-part);
      squares += 0.5 * math::dot(a, a);
      detail::Wave wave{};
      for (int k = 0; k < 3; ++k) {
        wave.k[k] = float(direction[k] * number);
        wave.a[k] = float(a[k]);
      }
      wave.phase = random.uniform_float();
      wave_shapes_.push_back(wave);
      // Turns a second: an eddy turns over in its size by its speed; half of them one way round.
      wave_rates_.push_back((i % 2 == 0 ? 0.5 : -0.5) * number * double(t.speed) * math::exp2(-part));
    }
    const float factor = float(double(t.speed) / math::sqrt(squares));
    for (detail::Wave& wave : wave_shapes_)
      for (float& a : wave.a) a *= factor;
  }
  waves_ = wave_shapes_;
  whirl_data_.resize(air_.whirls.size());
  return {};
}

core::Status ParticleSystem::set_attractors(std::span<const Attractor> attractors) {
  if (attractors.size() > max_fields)
    return detail::bad("particle system", "number of attractors", double(attractors.size()), "at most 256");
  for (const Attractor& attractor : attractors)
    if (const core::Status status = particles::check(attractor); !status) return status;
  attractors_.assign(attractors.begin(), attractors.end());
  attractor_data_.resize(attractors_.size());
  return {};
}

/// The box of a sample of the particles, but no more than three deviations about their mean: some that flew off do not
/// make the grid coarse for all.
void ParticleSystem::prepare_wind(double time) {
  if (!air_.field || air_.field->steady() || count_ == 0) return;
  const std::size_t stride = std::size_t(count_) / 16384 + 1;
  Vec3d low, high;
  for (int k = 0; k < 3; ++k) {
    double sum = 0, squares = 0, least = 1e30, most = -1e30;
    int sampled = 0;
    for (std::size_t i = 0; i < std::size_t(count_); i += stride, ++sampled) {
      const double x = double(arrays_[k][i]);
      sum += x;
      squares += x * x;
      least = math::min(least, x);
      most = math::max(most, x);
    }
    const double mean = sum / sampled, reach = 3 * math::sqrt(math::max(squares / sampled - mean * mean, 0.0));
    low[k] = math::max(least, mean - reach) + definition_.anchor[k];
    high[k] = math::min(most, mean + reach) + definition_.anchor[k];
  }
  patch_.set(*air_.field, low, high, time, air_.ground, math::clamp(16 * count_, fewest_nodes, patch_nodes));
  const environment::WindGrid& grid = patch_.grid();
  if (wind_nodes_.size() == 0) wind_nodes_ = detail::AlignedFloats(4 * patch_nodes);
  const std::span<const math::Vec3f> nodes = patch_.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int k = 0; k < (definition_.planar ? 2 : 3); ++k) wind_nodes_[4 * i + std::size_t(k)] = nodes[i][k];
  detail::WindNodes& to = move_.nodes;
  const int counts[3] = {grid.columns, grid.layers, grid.rows};
  to.node = wind_nodes_.data();
  to.inverse_spacing = float(1 / grid.spacing);
  to.layer = 4 * grid.columns;
  to.row = to.layer * grid.layers;
  for (int k = 0; k < 3; ++k) {
    to.corner[k] = float(grid.corner[k] - definition_.anchor[k]);
    to.last[k] = float(counts[k]) - 1.001f;
  }
}

void ParticleSystem::prepare_move(double dt) {
  detail::MoveData& m = move_;
  const SystemDef& d = definition_;
  m = {};
  m.dt = float(dt);
  m.now = float(time_ - epoch_);
  m.radius = d.radius;
  const Vec3d gravity = d.gravity * double(d.gravity_scale);
  for (int k = 0; k < 3; ++k) {
    m.gravity[k] = float(gravity[k]);
    m.wind[k] = float(air_.wind.velocity[k]);
  }
  if (!wind_table_.empty()) {
    m.wind_table = wind_table_.data();
    m.wind_layers = air_.layers.empty() ? 0 : 2 * wind_nodes;
    m.wind_floor = float(wind_base_ - d.anchor.y);
    m.wind_scale = float(wind_nodes * wind_nodes / wind_height_);
    m.wind_last = float(wind_nodes) - 0.001f;
  }
  prepare_wind(time_ - 0.5 * dt);
  // The waves are carried along by the wind at its reference height (Taylor's frozen turbulence) and turn over.
  for (std::size_t i = 0; i < waves_.size(); ++i) {
    const detail::Wave& shape = wave_shapes_[i];
    const Vec3d k{shape.k[0], shape.k[1], shape.k[2]};
    const double drift = math::dot(k, d.anchor) - math::dot(k, air_.wind.velocity) * time_ + wave_rates_[i] * time_;
    waves_[i].phase = part_turn(double(shape.phase) + drift);
  }
  m.waves = int(waves_.size());
  m.wave = waves_.data();
  for (std::size_t i = 0; i < air_.whirls.size(); ++i) {
    const Whirl& whirl = air_.whirls[i];
    const Vec3d c = whirl.center - d.anchor;
    const double core2 = math::square(whirl.vortex.core_radius), outside = whirl.vortex.circulation / (2 * math::pi);
    whirl_data_[i] = {{float(c.x), float(c.y), float(c.z)},
                      {float(whirl.axis.x), float(whirl.axis.y), float(whirl.axis.z)},
                      float(outside / core2),
                      float(outside),
                      float(core2)};
  }
  m.whirls = int(whirl_data_.size());
  m.whirl = whirl_data_.data();
  for (std::size_t i = 0; i < attractors_.size(); ++i) {
    const Attractor& a = attractors_[i];
    const Vec3d c = a.center - d.anchor;
    attractor_data_[i] = {{float(c.x), float(c.y), float(c.z)},
                          float(a.radial.strength),
                          float(1 / a.radial.reference),
                          float(a.radial.exponent),
                          float(math::min(math::square(a.radial.range), 1e30)),
                          float(a.radial.core)};
  }
  m.attractors = int(attractor_data_.size());
  m.attractor = attractor_data_.data();

  // Drag. The rate of the linear laws is the same for all unless scale or age change it.
  const double r = double(d.radius), mass = double(d.mass);
  double rate = 0;
  switch (d.drag.law) {
    case DragLaw::none:
      break;
    case DragLaw::linear:
      rate = double(d.drag.coefficient) / mass;
      m.scale_power = 3;
      break;
    case DragLaw::stokes:
    case DragLaw::schiller_naumann:
      rate = 6 * math::pi * double(d.drag.viscosity) * r / mass;
      m.scale_power = 2;
      m.reynolds = float(double(d.drag.density) * 2 * r / double(d.drag.viscosity));
      break;
    case DragLaw::quadratic:
      rate = 0.5 * double(d.drag.density) * double(d.drag.coefficient) * math::pi * r * r / mass;
      m.scale_power = 1;
      break;
  }
  m.rate_coefficient = float(rate);
  const bool own = scaled_ || !d.drag_over_age.is_constant() || d.drag_over_age(0) != 1;
  m.rate = detail::Rate::uniform;
  if (rate > 0) {
    if (d.drag.law == DragLaw::quadratic)
      m.rate = detail::Rate::quadratic;
    else if (d.drag.law == DragLaw::schiller_naumann)
      m.rate = detail::Rate::schiller_naumann;
    else if (own)
      m.rate = detail::Rate::own;
  }
  const double x = rate * dt;
  // Near zero by their series: e^{−x}, (1 − e^{−x})/x, (x − 1 + e^{−x})/x².
  const double decay = math::exp(-x);
  const double mean = x > 1e-3 ? -math::expm1(-x) / x : 1 - x / 2 + x * x / 6;
  const double half = x > 1e-3 ? (1 - mean) / x : 0.5 - x / 6 + x * x / 24;
  m.decay = float(decay);
  m.mean = float(mean);
  m.half = float(half);
  if (own && !(d.drag_over_age.is_constant() && d.drag_over_age(0) == 1)) {
    if (drag_table_.empty())
      for (int i = 0; i < Curve::pieces; ++i) {
        const auto& values = d.drag_over_age.values();
        drag_table_.push_back(values[std::size_t(i)]);
        drag_table_.push_back(values[std::size_t(i) + 1] - values[std::size_t(i)]);
      }
    m.drag_table = drag_table_.data();
  }
  m.keep_path = !colliders_.empty();

  collide_.dt = m.dt;
  collide_.now = m.now;
  for (int k = 0; k < 3; ++k) collide_.gravity[k] = m.gravity[k];
  collide_.radius = d.radius;
  collide_.mass = d.mass;
}

}  // namespace carom::particles
