// Contacts of grains, lanes at a time. With u = r ω, the speed of its rim, a grain's radius drops out of friction:
//   u ← u − k/m n×f,  slip = Δv − (u_a + u_b)×n,  a unit of friction changes the slip by (1 + k)(1/m_a + 1/m_b)
// where 1/k = ½ for discs and ⅖ for balls is the inertia over m r².

namespace carom::particles::detail::CAROM_GRAIN_NAMESPACE {

constexpr int width = CAROM_GRAIN_WIDTH;
using F = math::WideFloat<width>;
using M = math::WideMask<width>;

CAROM_SIMD_INLINE F splat(float x) { return F::splat(x); }
/// Components over lanes: vectors, and what turns (one number in the plane).
template <int K>
struct Lanes {
  F k[K];
};
template <int K>
CAROM_SIMD_INLINE Lanes<K> load(const float (&from)[K][grain_lanes], int lane) {
  Lanes<K> r;
  for (int i = 0; i < K; ++i) r.k[i] = F::load(from[i] + lane);
  return r;
}
template <int K>
CAROM_SIMD_INLINE void store(const Lanes<K>& v, float (&to)[K][grain_lanes], int lane) {
  for (int i = 0; i < K; ++i) v.k[i].store(to[i] + lane);
}
template <int K>
CAROM_SIMD_INLINE Lanes<K> operator+(const Lanes<K>& a, const Lanes<K>& b) {
  Lanes<K> r;
  for (int i = 0; i < K; ++i) r.k[i] = a.k[i] + b.k[i];
  return r;
}
template <int K>
CAROM_SIMD_INLINE Lanes<K> operator-(const Lanes<K>& a, const Lanes<K>& b) {
  Lanes<K> r;
  for (int i = 0; i < K; ++i) r.k[i] = a.k[i] - b.k[i];
  return r;
}
template <int K>
CAROM_SIMD_INLINE Lanes<K> operator*(F s, const Lanes<K>& a) {
  Lanes<K> r;
  for (int i = 0; i < K; ++i) r.k[i] = s * a.k[i];
  return r;
}
template <int K>
CAROM_SIMD_INLINE F dot(const Lanes<K>& a, const Lanes<K>& b) {
  F r = a.k[0] * b.k[0];
  for (int i = 1; i < K; ++i) r = r + a.k[i] * b.k[i];
  return r;
}
CAROM_SIMD_INLINE Lanes<3> cross(const Lanes<3>& a, const Lanes<3>& b) {
  return {{a.k[1] * b.k[2] - a.k[2] * b.k[1], a.k[2] * b.k[0] - a.k[0] * b.k[2], a.k[0] * b.k[1] - a.k[1] * b.k[0]}};
}
/// The slip across n of grains whose rims run with u and which part with `along` n.
CAROM_SIMD_INLINE Lanes<3> slip_of(const Lanes<3>& across, F along, const Lanes<3>& u, const Lanes<3>& n) {
  return across - along * n - cross(u, n);
}
CAROM_SIMD_INLINE Lanes<1> slip_of(const Lanes<2>& across, F /*along*/, const Lanes<1>& u, const Lanes<2>& n) {
  return {{n.k[0] * across.k[1] - n.k[1] * across.k[0] - u.k[0]}};
}
/// A friction as a vector, and its moment about a grain's middle over the radius.
CAROM_SIMD_INLINE Lanes<3> vector_of(const Lanes<3>& grip, const Lanes<3>& /*n*/) { return grip; }
CAROM_SIMD_INLINE Lanes<2> vector_of(const Lanes<1>& grip, const Lanes<2>& n) {
  return {{-n.k[1] * grip.k[0], n.k[0] * grip.k[0]}};
}
CAROM_SIMD_INLINE Lanes<3> twist_of(const Lanes<3>& grip, const Lanes<3>& n) { return cross(n, grip); }
CAROM_SIMD_INLINE Lanes<1> twist_of(const Lanes<1>& grip, const Lanes<2>& /*n*/) { return grip; }
/// Cut off at a size; nought at none, even where squares vanish: whether such a lane is looked at hangs on those
/// beside.
template <int K>
CAROM_SIMD_INLINE Lanes<K> limited(const Lanes<K>& v, F limit) {
  const F square = dot(v, v);
  const M over = square > limit * limit, held = limit > F::zero();
  Lanes<K> r;
  for (int i = 0; i < K; ++i) r.k[i] = math::select(held, v.k[i], F::zero());
  if (math::none(over)) return r;
  return math::select(over, limit / math::sqrt(math::select(over, square, splat(1))), splat(1)) * r;
}

CAROM_SIMD_INLINE Lanes<1> limited(const Lanes<1>& v, F limit) {
  return {{math::max(math::min(v.k[0], limit), splat(0) - limit)}};
}

/// Where the grains' records begin, of Size floats each. To be made again where they are written: so many addresses do
/// not stay in registers, and to put them aside costs more than to read the numbers twice (the compiler must not know).
template <int Size>
struct Records {
  float* row[width];
  CAROM_SIMD_INLINE Records(float* base, const volatile std::uint32_t* at) {
    math::simd_detail::unrolled<width>([&](auto lane) __attribute__((always_inline)) {
      constexpr int i = decltype(lane)::value;
      row[i] = base + std::size_t(at[i]) * (Size / grain_place);
    });
  }
};

/// One side of a contact.
template <int N>
struct Side {
  static constexpr int turns = GrainBlock<N>::turns;
  Lanes<N> v;
  Lanes<turns> u;
  F inverse_mass, curve;

  CAROM_SIMD_INLINE void read(const Records<grain_motion<N>>& records, const GrainPass& pass) {
    F row[grain_motion<N>];
    math::gather_records<width>(records.row, row);
    if constexpr (N == 2) {
      v = {{row[0], row[1]}};
      u = {{row[2]}};
      curve = row[3];
      inverse_mass = splat(pass.lightness) * (curve * curve);
    } else {
      v = {{row[0], row[1], row[2]}};
      u = {{row[4], row[5], row[6]}};
      inverse_mass = row[3];
      curve = row[7];
    }
  }
  CAROM_SIMD_INLINE void write(const Records<grain_motion<N>>& records) const {
    if constexpr (N == 2) {
      const F row[4] = {v.k[0], v.k[1], u.k[0], curve};
      math::scatter_records<width>(records.row, row);
    } else {
      const F row[8] = {v.k[0], v.k[1], v.k[2], inverse_mass, u.k[0], u.k[1], u.k[2], curve};
      math::scatter_records<width>(records.row, row);
    }
  }
};

/// Of pushes: they then go through a heap in fewer sweeps. A pair alone is as good as solved after the usual four.
constexpr float over_relaxation = 1.2f;
/// Of what the last sweep changed of a push the next one changes so much again, also in the next substep: loads that
/// go up through many layers gather pace (B. T. Polyak, "Some methods of speeding up the convergence of iteration
/// methods", USSR Comput. Math. Math. Phys. 4 (1964) 1). Twice as much would shake them.
constexpr float heavy_ball = 0.35f;

template <int N>
constexpr float turning = N == 2 ? 2.0f : 2.5f;  ///< k

/// Gives both sides an impulse, b's; `grip` and `roll` as in a block.
template <int N, bool pair>
CAROM_SIMD_INLINE void give(Side<N>& a, Side<N>& b, const Lanes<N>& n, const Lanes<N>& impulse,
                            const Lanes<GrainBlock<N>::turns>& grip, const Lanes<GrainBlock<N>::turns>& roll) {
  const auto twist = twist_of(grip, n);
  a.v = a.v - a.inverse_mass * impulse;
  a.u = a.u - (splat(turning<N>) * a.inverse_mass) * (twist + a.curve * roll);
  if constexpr (pair) {
    b.v = b.v + b.inverse_mass * impulse;
    b.u = b.u - (splat(turning<N>) * b.inverse_mass) * (twist - b.curve * roll);
  }
}

/// What lanes have that `chosen` has bits for, to the numbers and columns behind the first `at`, where a block of lanes
/// may be written; returns where it ends.
template <int K>
CAROM_SIMD_INLINE int pack(std::uint32_t chosen, math::WideInt<width> number, const F* column, int* numbers,
                           float* const* columns, int at) {
#if defined(__AVX512F__)
  if constexpr (width == 16) {
    _mm512_storeu_si512(numbers + at, _mm512_maskz_compress_epi32(__mmask16(chosen), __m512i(number.v)));
    for (int k = 0; k < K; ++k)
      _mm512_storeu_ps(columns[k] + at, _mm512_maskz_compress_ps(__mmask16(chosen), __m512(column[k].v)));
    return at + __builtin_popcount(chosen);
  }
#endif
  if (chosen == 0) return at;
  std::int32_t lanes[width];
  number.store(lanes);
  float rows[K > 0 ? K : 1][width];
  for (int k = 0; k < K; ++k) column[k].store(rows[k]);
  for (; chosen != 0; chosen &= chosen - 1, ++at) {
    const int lane = __builtin_ctz(chosen);
    numbers[at] = lanes[lane];
    for (int k = 0; k < K; ++k) columns[k][at] = rows[k][lane];
  }
  return at;
}

/// Bits of as many lanes.
CAROM_SIMD_INLINE std::uint32_t first_lanes(int count) { return count < width ? (1u << count) - 1 : (1u << width) - 1; }

CAROM_SIMD_INLINE math::WideInt<width> lane_numbers(int first) {
  return math::WideInt<width>::lanes() + math::WideInt<width>::splat(first);
}

/// Those of the runs that are near, side by side; returns how many.
template <int N>
CAROM_SIMD_INLINE int draw_near(const GrainColumns<N>& grains, const GrainRuns<N>& runs, const GrainRoom<N>& room) {
  int count = 0;
  for (int run = 0; run < runs.count; ++run)
    for (int j = runs.from[run]; j < runs.to[run]; j += width) {
      F x[N + 1];
      for (int k = 0; k <= N; ++k) x[k] = F::load(grains.column[k] + j);
      M inside = (x[0] >= splat(runs.low[0])) & (x[0] <= splat(runs.high[0]));
      for (int k = 1; k < N; ++k) inside = inside & (x[k] >= splat(runs.low[k])) & (x[k] <= splat(runs.high[k]));
      count = pack<N + 1>(math::bitmask(inside) & first_lanes(runs.to[run] - j), lane_numbers(j), x, room.number,
                          room.column, count);
    }
  return count;
}

template <int N>
int find(const GrainColumns<N>& grains, const GrainRuns<N>& runs, const GrainReach<N>& reach, const GrainRoom<N>& room,
         int* first, int* found, int at) {
  const int count = draw_near(grains, runs, room), own_count = runs.end - runs.begin;
  int waits = 0;
  for (int i = 0; i < own_count; ++i) {
    first[runs.begin + i] = at;
    F x[N], ways[N];
    for (int k = 0; k < N; ++k) {
      x[k] = splat(room.column[k][i]);
      ways[k] = splat(reach.way[k]);
    }
    const F own = splat(room.column[N][i] + reach.slack), more = splat(reach.most - reach.slack);
    for (int j = i + 1; j < count; j += width) {
      // They close by no more than s = Σ |d| way / |d| and may touch where |d| < u + s, with u the sum of radii and
      // slack: where |d|² − |d| s is below u |d|, which asks for no root.
      F square, way;
      for (int k = 0; k < N; ++k) {
        const F d = F::load(room.column[k] + j) - x[k], far = math::abs(d) * ways[k];
        square = k == 0 ? d * d : square + d * d;
        way = k == 0 ? far : way + far;
      }
      const F touch = own + F::load(room.column[N] + j), farthest = touch + more, most = touch * touch * square;
      const F late = math::max(square - way, F::zero()),
              early = math::max(square - splat(1.0f / grain_stages) * way, F::zero());
      const std::uint32_t hits =
          math::bitmask(late * late <= most) & math::bitmask(square < farthest * farthest) & first_lanes(count - j);
      const std::uint32_t soon = math::bitmask(early * early <= most) & hits;
      const auto others = math::WideInt<width>::load(room.number + j);
      at = pack<0>(soon, others, nullptr, found, nullptr, at);
      const F wait[3] = {square, way, touch};
      math::WideInt<width>::splat(runs.begin + i).store(room.own + waits);
      waits = pack<3>(hits ^ soon, others, wait, room.other, room.wait, waits);
    }
  }
  for (int k = 0; k < waits; k += width) {
    const F square = F::load(room.wait[0] + k), open = square - F::load(room.wait[2] + k) * math::sqrt(square);
    const F stage = splat(grain_stages) * open / math::max(F::load(room.wait[1] + k), splat(1e-30f));
    std::int32_t stages[width];
    math::to_int(math::max(math::min(stage, splat(grain_stages - 1)), splat(1))).store(stages);
    for (int lane = 0; lane < width && k + lane < waits; ++lane)
      room.later[stages[lane]][room.waiting[stages[lane]]++] = {std::uint32_t(room.own[k + lane]) * grain_place,
                                                                std::uint32_t(room.other[k + lane]) * grain_place};
  }
  return at;
}

template <int N>
void move(float* place, float* motion, int first, int last, const float* time, const float* gained) {
  constexpr int rows = N == 2 ? width / 4 : 1;  // at a time: in space rows of motion have eight floats
  using Rows = math::WideFloat<4 * rows>;
  float times[4 * rows], gains[4 * rows];
  for (int i = 0; i < 4 * rows; ++i) {
    times[i] = time[i % 4];
    gains[i] = gained[i % 4];
  }
  const auto one = [&]<class R>(int i, R) __attribute__((always_inline)) {
    float *const p = place + std::size_t(i) * grain_place, *const m = motion + std::size_t(i) * grain_motion<N>;
    const R v = R::load(m);
    (R::load(p) + R::load(times) * v).store(p);
    (v + R::load(gains)).store(m);
  };
  int i = first;
  for (; i + rows <= last; i += rows) one(i, Rows{});
  for (; i < last; ++i) one(i, math::WideFloat<4>{});
}

/// One of both grains' rows of every lane.
template <std::uint32_t GrainWait::* which>
CAROM_SIMD_INLINE void rows_of(const GrainWait* waiting, float* base, F (&columns)[grain_place]) {
  float* row[width];
  math::simd_detail::unrolled<width>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    row[i] = base + waiting[i].*which;
  });
  math::gather_records<width>(row, columns);
}

template <int N>
void wait(const GrainWait* waiting, int count, float* place, float* pace, float slack, int* stages) {
  for (int i = 0; i < count; i += width) {
    const GrainWait* pairs = waiting + i;
    GrainWait last[width];
    if (count - i < width) {
      for (int lane = 0; lane < width; ++lane) last[lane] = pairs[lane < count - i ? lane : 0];
      pairs = last;
    }
    F a[grain_place], b[grain_place], most[grain_place];
    rows_of<&GrainWait::a>(pairs, place, a);
    rows_of<&GrainWait::b>(pairs, place, b);
    rows_of<&GrainWait::a>(pairs, pace, most);
    F square = F::zero(), way = F::zero();
    for (int k = 0; k < N; ++k) {
      const F apart = math::abs(b[k] - a[k]);
      square = square + apart * apart;
      way = way + apart * most[k];
    }
    // As find() has it, from here on.
    const F touch = a[3] + b[3] + splat(slack), open = square - touch * math::sqrt(square);
    const F all = splat(grain_stages), later = all * open;
    const F stage = math::select(later < all * way, later / math::max(way, splat(1e-30f)), all);
    math::to_int(math::select(later < way, F::zero(), stage)).store(stages + i);
  }
}

template <int N>
void recall(GrainBlock<N>* blocks, int first, int last, const int* was, const float* held, float scale, float* motion,
            const GrainPass& pass) {
  constexpr int K = GrainBlock<N>::turns;
  static const float nothing[grain_held<N>] = {};
  for (int i = first; i < last; ++i)
    for (int lane = 0; lane < grain_lanes; lane += width) {
      const math::WideInt<width> from = math::WideInt<width>::load(was + i * grain_lanes + lane);
      std::int32_t index[width];
      (from >> 1).store(index);
      F row[grain_held<N>];
      math::gather_rows<grain_held<N>, width>(held, index, nothing, row);
      const auto one = math::WideInt<width>::splat(1);
      const F side = math::select((from & one) == one, splat(-scale), splat(scale));
      (splat(scale) * row[0]).store(blocks[i].push + lane);
      for (int k = 0; k < K; ++k) {
        // In the plane friction goes along a tangent that turns with the normal.
        ((N == 2 ? splat(scale) : side) * row[1 + k]).store(blocks[i].grip[k] + lane);
        (side * row[1 + K + k]).store(blocks[i].roll[k] + lane);
      }
      Side<N> a, b;
      a.read({motion, blocks[i].a + lane}, pass);
      b.read({motion, blocks[i].b + lane}, pass);
      const F curves = a.curve + b.curve;
      const F lightness = a.inverse_mass * (a.curve * a.curve) + b.inverse_mass * (b.curve * b.curve);
      (splat(1) / (a.inverse_mass + b.inverse_mass)).store(blocks[i].ease + lane);
      (splat(1 / turning<N>) / lightness).store(blocks[i].give_way + lane);
      (splat(1) / curves).store(blocks[i].lever + lane);
    }
}

template <int N>
void keep(const GrainBlock<N>* blocks, int first, int last, const int* pair, float* held) {
  constexpr int K = GrainBlock<N>::turns;
  for (int i = first; i < last; ++i)
    for (int lane = 0; lane < grain_lanes; lane += width) {
      F row[grain_held<N>];
      row[0] = F::load(blocks[i].push + lane);
      for (int k = 0; k < K; ++k) {
        row[1 + k] = F::load(blocks[i].grip[k] + lane);
        row[1 + K + k] = F::load(blocks[i].roll[k] + lane);
      }
      row[grain_held<N> - 1] = F::zero();
      math::scatter_rows<grain_held<N>, grain_held<N>, width>(held, pair + i * grain_lanes + lane, row);
    }
}

template <int N>
CAROM_SIMD_INLINE void measure_lanes(GrainBlock<N>& c, int lane, float* place, const GrainPass& pass) {
  F a[grain_place], b[grain_place];
  using Places = Records<grain_place>;
  math::gather_records<width>(Places(place, c.a + lane).row, a);
  math::gather_records<width>(Places(place, c.b + lane).row, b);
  Lanes<N> d;
  for (int i = 0; i < N; ++i) d.k[i] = b[i] - a[i];
  const F square = dot(d, d);
  const M apart = square > F::zero();
  const F distance = math::sqrt(square), far = math::select(apart, distance, splat(1));
  for (int i = 0; i < N; ++i) d.k[i] = math::select(apart, d.k[i], splat(i == 1 ? 1 : 0));
  F gap = distance - a[3] - b[3];
  const F deep = splat(-pass.slop) - gap;
  const auto n = (splat(1) / far) * d;
  store(n, c.normal, lane);
  if (math::any(deep > F::zero())) {
    const F out = splat(pass.part) * math::max(deep, F::zero());
    // Masses of one density go with r² and r³; a grain that is none has no radius.
    F ma = N == 2 ? a[3] * a[3] : a[3] * a[3] * a[3], mb = N == 2 ? b[3] * b[3] : b[3] * b[3] * b[3];
    F upward = F::zero();  // of b above a, times their distance
    for (int k = 0; k < N; ++k) upward = upward + splat(pass.up[k]) * d.k[k];
    ma = ma * (far + math::max(upward, F::zero()));
    mb = mb * (far - math::min(upward, F::zero()));
    const F masses = ma + mb, each = out / math::select(masses > F::zero(), masses, splat(1));
    for (int k = 0; k < N; ++k) {
      a[k] = a[k] - (mb * each) * n.k[k];
      b[k] = b[k] + (ma * each) * n.k[k];
    }
    gap = gap + out;
    math::scatter_records<width>(Places(place, c.a + lane).row, a);
    math::scatter_records<width>(Places(place, c.b + lane).row, b);
  }
  gap.store(c.gap + lane);
}

template <int N, bool pair>
void press(GrainBlock<N>* blocks, int first, int last, float* place, float* motion, const GrainPass& pass) {
  for (int i = first; i < last; ++i) {
    GrainBlock<N>& c = blocks[i];
    for (int lane = 0; lane < grain_lanes; lane += width) {
      if constexpr (pair) measure_lanes(c, lane, place, pass);
      const F push = F::load(c.push + lane);
      if (math::none(push > F::zero())) continue;
      const auto n = load(c.normal, lane);
      auto grip = load(c.grip, lane);
      if constexpr (N == 3) {
        grip = grip - dot(grip, n) * n;
        store(grip, c.grip, lane);
      }
      Side<N> a, b;
      a.read({motion, c.a + lane}, pass);
      if constexpr (pair) b.read({motion, c.b + lane}, pass);
      give<N, pair>(a, b, n, push * n + vector_of(grip, n), grip, load(c.roll, lane));
      a.write({motion, c.a + lane});
      if constexpr (pair) b.write({motion, c.b + lane});
    }
  }
  static_cast<void>(place);
  static_cast<void>(pass);
}

template <int N, bool pair>
CAROM_SIMD_INLINE void sweep_lanes(GrainBlock<N>& c, int lane, float* motion, const GrainPass& pass) {
  Side<N> a, b;
  a.read({motion, c.a + lane}, pass);
  if constexpr (pair) b.read({motion, c.b + lane}, pass);
  const auto n = load(c.normal, lane);
  const F easy = pair ? F::load(c.ease + lane) : splat(1) / a.inverse_mass;
  const F before = F::load(c.push + lane), last = F::load(c.gain + lane);
  const F bias = math::max(F::load(c.gap + lane), F::zero()) * splat(pass.inverse_h);
  const F over = splat(over_relaxation) * easy, start = before + splat(heavy_ball) * last - bias * over;
  auto across = splat(-1) * a.v;
  auto u = a.u;
  if constexpr (pair) {
    across = b.v - a.v;
    u = a.u + b.u;
  }
  const F along = dot(across, n), push = math::max(start - along * over, F::zero());
  if (math::none(math::max(math::max(push, before), F::zero() - last) > F::zero())) return;
  push.store(c.push + lane);
  const F gain = push - before;
  gain.store(c.gain + lane);
  // What the push changes is along n: the slip does not ask for it.
  const auto grip = load(c.grip, lane), roll = load(c.roll, lane);
  const auto gripped =
      limited(grip - (easy * splat(1 / (1 + turning<N>))) * slip_of(across, along, u, n), splat(pass.friction) * push);
  store(gripped, c.grip, lane);
  const auto more_grip = gripped - grip;
  Lanes<GrainBlock<N>::turns> more_roll{};
  if (pass.rolling > 0) {
    auto rolling = a.curve * a.u;
    if constexpr (pair) rolling = rolling - b.curve * b.u;
    const F lever = pair ? F::load(c.lever + lane) : splat(0.5f) / a.curve;
    const F inertia =
        pair ? F::load(c.give_way + lane) : splat(1 / turning<N>) / (a.inverse_mass * (a.curve * a.curve));
    const auto rolled = limited(roll + inertia * rolling, push * (splat(2 * pass.rolling) * lever));
    store(rolled, c.roll, lane);
    more_roll = rolled - roll;
  }
  give<N, pair>(a, b, n, gain * n + vector_of(more_grip, n), more_grip, more_roll);
  a.write({motion, c.a + lane});
  if constexpr (pair) b.write({motion, c.b + lane});
}

template <int N, bool pair>
void sweep(GrainBlock<N>* blocks, int first, int last, bool back, float* motion, const GrainPass& pass) {
  for (int i = 0; i < last - first; ++i)
    for (int lane = 0; lane < grain_lanes; lane += width)
      sweep_lanes<N, pair>(blocks[back ? last - 1 - i : first + i], lane, motion, pass);
}

template <int N>
float deepest(const GrainBlock<N>* blocks, int first, int last, float* place) {
  F most = F::zero();
  for (int i = first; i < last; ++i)
    for (int lane = 0; lane < grain_lanes; lane += width) {
      F a[grain_place], b[grain_place];
      math::gather_records<width>(Records<grain_place>(place, blocks[i].a + lane).row, a);
      math::gather_records<width>(Records<grain_place>(place, blocks[i].b + lane).row, b);
      Lanes<N> d;
      for (int k = 0; k < N; ++k) d.k[k] = b[k] - a[k];
      most = math::max(most, a[3] + b[3] - math::sqrt(dot(d, d)));
    }
  float result = 0;
  for (int i = 0; i < width; ++i) result = most[i] > result ? most[i] : result;
  return result;
}

const GrainKernels<2> kernels2 = {find<2>,        wait<2>,        move<2>,         recall<2>,       keep<2>,
                                  press<2, true>, sweep<2, true>, press<2, false>, sweep<2, false>, deepest<2>};
const GrainKernels<3> kernels3 = {find<3>,        wait<3>,        move<3>,         recall<3>,       keep<3>,
                                  press<3, true>, sweep<3, true>, press<3, false>, sweep<3, false>, deepest<3>};

}  // namespace carom::particles::detail::CAROM_GRAIN_NAMESPACE
