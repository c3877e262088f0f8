// Forces and motion of one block of particles.

namespace carom::particles::detail::CAROM_PARTICLE_NAMESPACE {

CAROM_SIMD_INLINE V between_nodes(const WindNodes& d, const V& p) {
  const F scale = splat(d.inverse_spacing);
  // In this order a place that is no number gives a node of the grid.
  const auto place = [&](F x, int axis) __attribute__((always_inline)) {
    return math::min(splat(d.last[axis]), math::max(F::zero(), (x - splat(d.corner[axis])) * scale));
  };
  const V at{place(p.x, 0), place(p.y, 1), place(p.z, 2)};
  const I column = math::to_int(at.x), layer = math::to_int(at.y), row = math::to_int(at.z);
  const V part{at.x - math::to_float(column), at.y - math::to_float(layer), at.z - math::to_float(row)};
  const float* from[width];
  for (int i = 0; i < width; ++i) from[i] = d.node + (4 * column[i] + d.layer * layer[i] + d.row * row[i]);
  const auto along = [&](int more) __attribute__((always_inline)) {
    const float *low[width], *high[width];
    for (int i = 0; i < width; ++i) {
      low[i] = from[i] + more;
      high[i] = low[i] + 4;
    }
    F a[4], b[4];
    math::gather_rows<4, width>(low, a);
    math::gather_rows<4, width>(high, b);
    return V{a[0] + part.x * (b[0] - a[0]), a[1] + part.x * (b[1] - a[1]), a[2] + part.x * (b[2] - a[2])};
  };
  const auto above = [&](int more) __attribute__((always_inline)) {
    const V low = along(more), high = along(more + d.layer);
    return low + part.y * (high - low);
  };
  const V near = above(0), far = above(d.row);
  return near + part.z * (far - near);
}

CAROM_SIMD_INLINE V air_at(const MoveData& d, const V& p) {
  V u = splat(d.wind);
  if (d.wind_table != nullptr) {
    // In this order a place that is no number gives the table's end, not an index out of it.
    const F root = math::sqrt(math::max(F::zero(), p.y - splat(d.wind_floor)) * splat(d.wind_scale));
    const F place = math::min(splat(d.wind_last), root);
    if (d.wind_layers > 0)
      u = {look_up(d.wind_table, place), look_up(d.wind_table + d.wind_layers, place),
           look_up(d.wind_table + 2 * d.wind_layers, place)};
    else
      u = look_up(d.wind_table, place) * u;
  }
  if (d.nodes.node != nullptr) u = u + between_nodes(d.nodes, p);
  for (int w = 0; w < d.waves; ++w) {
    const Wave& wave = d.wave[w];
    const F c = cos_turns(dot(splat(wave.k), p) + splat(wave.phase));
    u = u + c * splat(wave.a);
  }
  for (int w = 0; w < d.whirls; ++w) {
    const WhirlData& whirl = d.whirl[w];
    const V around = cross(splat(whirl.axis), p - splat(whirl.center));
    const F r2 = dot(around, around);
    const F rate =
        select(r2 < splat(whirl.core2), splat(whirl.inside), splat(whirl.outside) / math::max(r2, splat(whirl.core2)));
    u = u + rate * around;
  }
  return u;
}

CAROM_SIMD_INLINE V pull_at(const MoveData& d, const V& p) {
  V a = splat(d.gravity);
  for (int k = 0; k < d.attractors; ++k) {
    const AttractorData& attractor = d.attractor[k];
    const V r = p - splat(attractor.center);
    const F r2 = dot(r, r), distance = math::max(math::sqrt(r2), splat(attractor.core));
    const F power = exp2_lanes(splat(attractor.exponent) * log2_lanes(distance * splat(attractor.inverse_reference)));
    const F strength = math::keep(r2 < splat(attractor.range2), splat(attractor.strength) * power / distance);
    a = a + strength * r;
  }
  return a;
}

/// Rate (1/s) at which the speed w through the air is lost.
template <Rate rate>
CAROM_SIMD_INLINE F rate_of(const MoveData& d, F coefficient, F reynolds, F speed) {
  if constexpr (rate == Rate::own) return coefficient;
  if constexpr (rate == Rate::quadratic) return coefficient * speed;
  // 1 + .15 Re^.687, and Newton's .44 Re/24 where that is more: from Re = 993 on.
  const F re = math::max(reynolds * speed, splat(1e-6f));
  const F schiller = splat(1) + splat(0.15f) * exp2_lanes(splat(0.687f) * log2_lanes(re));
  (void)d;
  return coefficient * math::max(schiller, splat(0.44f / 24) * re);
}

template <Rate rate, bool fields>
CAROM_SIMD_INLINE void move_all(const MoveData& d, const Arrays& arrays, int from, int to, Path& path) {
  const F dt = splat(d.dt), half_step = splat(0.5f * d.dt);
  V u = splat(d.wind), a = splat(d.gravity);
  for (int i = from; i < to; i += width) {
    const V p = load(arrays.position, i), v = load(arrays.velocity, i);
    if constexpr (fields) {
      // Half a step on: with the motion below that is the leapfrog, which keeps orbits.
      const V middle = p + half_step * v;
      u = air_at(d, middle);
      a = pull_at(d, middle);
    }
    const V w = v - u;
    Decay decay{splat(d.decay), splat(d.mean), splat(d.half)};
    if constexpr (rate != Rate::uniform) {
      F coefficient = splat(d.rate_coefficient), reynolds = splat(d.reynolds);
      if (arrays.scale != nullptr) {
        const F scale = F::load(arrays.scale + i);
        for (int k = 0; k < d.scale_power; ++k) coefficient = coefficient / scale;
        reynolds = reynolds * scale;
      }
      if (d.drag_table != nullptr) {
        const F birth = F::load(arrays.birth + i), death = F::load(arrays.death + i);
        const F age = (splat(d.now) - birth) / math::max(death - birth, splat(1e-6f));
        coefficient =
            coefficient * look_up(d.drag_table, math::min(splat(63.999f), math::max(F::zero(), age * splat(64))));
      }
      F speed = F::zero();
      if constexpr (rate != Rate::own) {
        // The rate of half a step later, by an implicit half step: exact at the terminal speed, second order else.
        const F now = rate_of<rate>(d, coefficient, reynolds, math::sqrt(dot(w, w)));
        const F shrink = splat(1) / (splat(1) + half_step * now);
        const V middle = w + half_step * a;
        speed = math::sqrt(dot(middle, middle)) * shrink;
      }
      decay = decay_of(rate_of<rate>(d, coefficient, reynolds, speed) * dt);
    }
    // v̇ = a − λ(v − u) solved exactly over the step (exponential integrator): stable for any λ dt.
    const F mean = decay.mean * dt, half = decay.half * dt * dt;
    V v1 = u + decay.decay * w + mean * a;
    V p1 = p + dt * u + mean * w + half * a;
    if (arrays.held != nullptr) {
      const M free = F::load(arrays.held + i) == F::zero();
      p1 = select(free, p1, p);
      v1 = select(free, v1, {F::zero(), F::zero(), F::zero()});
    }
    if (d.keep_path) {
      store(p, path.start, i - from);
      store(v, path.speed, i - from);
      dt.store(path.left + (i - from));
      const V way = p1 - p;
      const F radius = splat(d.radius) * (arrays.scale != nullptr ? F::load(arrays.scale + i) : splat(1));
      (radius + math::sqrt(dot(way, way))).store(path.reach + (i - from));
    }
    if (!d.velocity_only) store(p1, arrays.position, i);
    store(v1, arrays.velocity, i);
  }
}

template <bool fields>
CAROM_SIMD_INLINE void move_by_rate(const MoveData& d, const Arrays& arrays, int from, int to, Path& path) {
  switch (d.rate) {
    case Rate::uniform:
      return move_all<Rate::uniform, fields>(d, arrays, from, to, path);
    case Rate::own:
      return move_all<Rate::own, fields>(d, arrays, from, to, path);
    case Rate::quadratic:
      return move_all<Rate::quadratic, fields>(d, arrays, from, to, path);
    case Rate::schiller_naumann:
      return move_all<Rate::schiller_naumann, fields>(d, arrays, from, to, path);
  }
}

void move(const MoveData& d, const Arrays& arrays, int from, int to, Path& path) {
  if (d.wind_table != nullptr || d.nodes.node != nullptr || d.waves > 0 || d.whirls > 0 || d.attractors > 0)
    move_by_rate<true>(d, arrays, from, to, path);
  else
    move_by_rate<false>(d, arrays, from, to, path);
}

int find_dead(const Arrays& arrays, float now, float limit, int from, int to, int count, std::int32_t* dead) {
  int found = 0;
  for (int i = from; i < to; i += width) {
    const V p = load(arrays.position, i), v = load(arrays.velocity, i);
    const F most = math::abs(p.x) + math::abs(p.y) + math::abs(p.z) + math::abs(v.x) + math::abs(v.y) + math::abs(v.z);
    // A sum that is not a number is not within the limit either.
    const M lives = (F::load(arrays.death + i) > splat(now)) & (most < splat(limit));
    const M over = !lives;
    for (std::uint32_t bits = math::bitmask(over); bits != 0; bits &= bits - 1) {
      const int k = i + __builtin_ctz(bits);
      if (k < count) dead[found++] = k;
    }
  }
  return found;
}

}  // namespace carom::particles::detail::CAROM_PARTICLE_NAMESPACE
