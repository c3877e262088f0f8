// What a projectile of the aim solver feels, in lanes. Compiled once for each instruction set: CAROM_AIM_NAMESPACE,
// CAROM_AIM_WIDTH.

namespace carom::ballistics::detail::CAROM_AIM_NAMESPACE {
namespace {

constexpr int lanes = CAROM_AIM_WIDTH;
using D = math::WideDouble<lanes>;
using Mask = typename D::Mask;

CAROM_SIMD_INLINE D load(const double* p) {
  D r;
  __builtin_memcpy(&r.v, p, sizeof r.v);
  return r;
}
CAROM_SIMD_INLINE void store(D a, double* p) { __builtin_memcpy(p, &a.v, sizeof a.v); }
CAROM_SIMD_INLINE void store_floats(D a, float* p) {
  typedef float Floats __attribute__((vector_size(4 * lanes)));  // NOLINT(modernize-use-using)
  const Floats floats = __builtin_convertvector(a.v, Floats);
  __builtin_memcpy(p, &floats, sizeof floats);
}
CAROM_SIMD_INLINE D operator*(double a, D b) { return D::splat(a) * b; }
CAROM_SIMD_INLINE D absolute(D a) { return {typename D::Vector(Mask(a.v) & 0x7fffffffffffffff)}; }
CAROM_SIMD_INLINE D larger(D a, double least) { return math::select(a > D::splat(least), a, D::splat(least)); }
CAROM_SIMD_INLINE D smaller(D a, double most) { return math::select(D::splat(most) > a, a, D::splat(most)); }

/// f(lane) of every lane.
template <class F>
CAROM_SIMD_INLINE D gather(F&& f) {
  if constexpr (lanes == 2)
    return D{typename D::Vector{f(0), f(1)}};
  else if constexpr (lanes == 4)
    return D{typename D::Vector{f(0), f(1), f(2), f(3)}};
  else
    return D{typename D::Vector{f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)}};
}

/// Four numbers that lie side by side in memory, of every lane: the first of all, the second, and so on.
template <int N>
struct Columns {
  using Wide = math::WideDouble<N>;
  Wide x[4];
  template <class F>
  CAROM_SIMD_INLINE explicit Columns(const F& of_lane) {
    const auto row = [&](int lane, int at) __attribute__((always_inline)) {
      typename Wide::Vector r;
      __builtin_memcpy(&r, of_lane(lane) + at, sizeof r);
      return r;
    };
    if constexpr (N == 2) {
      for (int at = 0; at < 4; at += 2) {
        const auto a = row(0, at), b = row(1, at);
        x[at].v = __builtin_shufflevector(a, b, 0, 2);
        x[at + 1].v = __builtin_shufflevector(a, b, 1, 3);
      }
    } else if constexpr (N == 8) {
      // Two lanes in a register: 0 and 4, 1 and 5, 2 and 6, 3 and 7.
      const auto both = [&](int lane) __attribute__((always_inline)) {
        typedef double Row __attribute__((vector_size(32)));  // NOLINT(modernize-use-using)
        Row low, high;
        __builtin_memcpy(&low, of_lane(lane), sizeof low);
        __builtin_memcpy(&high, of_lane(lane + 4), sizeof high);
        return typename Wide::Vector(__builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7));
      };
      const auto a = both(0), b = both(1), c = both(2), d = both(3);
      const auto ab = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
                 to_ab = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15),
                 cd = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
                 to_cd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
      x[0].v = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13);
      x[1].v = __builtin_shufflevector(to_ab, to_cd, 0, 1, 8, 9, 4, 5, 12, 13);
      x[2].v = __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15);
      x[3].v = __builtin_shufflevector(to_ab, to_cd, 2, 3, 10, 11, 6, 7, 14, 15);
    } else {
      const auto a = row(0, 0), b = row(1, 0), c = row(2, 0), d = row(3, 0);
      const auto ac = __builtin_shufflevector(a, c, 0, 1, 4, 5), bd = __builtin_shufflevector(b, d, 0, 1, 4, 5),
                 to_ac = __builtin_shufflevector(a, c, 2, 3, 6, 7), to_bd = __builtin_shufflevector(b, d, 2, 3, 6, 7);
      x[0].v = __builtin_shufflevector(ac, bd, 0, 4, 2, 6);
      x[1].v = __builtin_shufflevector(ac, bd, 1, 5, 3, 7);
      x[2].v = __builtin_shufflevector(to_ac, to_bd, 0, 4, 2, 6);
      x[3].v = __builtin_shufflevector(to_ac, to_bd, 1, 5, 3, 7);
    }
  }
};

struct Vector {
  D x[3];
  CAROM_SIMD_INLINE D& operator[](int i) { return x[i]; }
  CAROM_SIMD_INLINE const D& operator[](int i) const { return x[i]; }
};
CAROM_SIMD_INLINE D dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The whole part of numbers from 0 to 2^31; of whole numbers themselves it may be one less.
struct Cell {
  Mask bits;
  D part;  // of one, what is left
  CAROM_SIMD_INLINE explicit Cell(D place) {
    constexpr double shift = 6755399441055744.0;  // 1.5·2^52: the last bits of the sum are the number, rounded
    const D moved = (place - D::splat(0.5)) + D::splat(shift);
    bits = Mask(moved.v);
    part = place - (moved - D::splat(shift));
  }
  CAROM_SIMD_INLINE std::uint32_t operator[](int lane) const { return std::uint32_t(bits[lane]); }
};

/// The acceleration, the velocity through the air, and how drag grows across it and along it.
struct Felt {
  Vector a, w;
  D drag, along;
};

/// `rise`: by how much the acceleration grows with the height.
template <bool Plain, bool Slopes>
CAROM_SIMD_INLINE Felt feel(const AimMedium& m, const Vector& x, const Vector& v, Vector* rise = nullptr) {
  Felt f;
  const D height = smaller(x[1], 1e9);
  D density = D::splat(m.air.nodes[0].density), sound = D::splat(m.air.nodes[0].speed_of_sound), denser{}, faster{};
  if (m.air.per_metre != 0) {
    const Cell cell(
        smaller(larger((height - D::splat(m.air.lowest)) * D::splat(m.air.per_metre), 0), m.air.last * (1 - 1e-15)));
    static_assert(sizeof(environment::AirColumn::Air) == 2 * sizeof(double));
    const Columns<lanes> air([&](int i) { return &m.air.nodes[cell[i]].density; });
    denser = air.x[2] - air.x[0];
    faster = air.x[3] - air.x[1];
    density = air.x[0] + cell.part * denser;
    sound = air.x[1] + cell.part * faster;
  }

  Vector shear{};
  if (!math::any_of<lanes>(D::splat(m.sheared_up_to) > height)) {
    for (int j = 0; j < 3; ++j) f.w[j] = v[j] - D::splat(m.wind_above[j]);
  } else {
    const D above = height - D::splat(m.wind.legs[0].height);
    const Mask cells = Mask(smaller(larger(above, m.lowest_cell), m.highest_cell).v) >> 48;
    const environment::WindColumn::Leg* leg[lanes];
#pragma GCC unroll 8
    for (int i = 0; i < lanes; ++i) {
      const double here = height.v[i];
      leg[i] = m.wind.legs + m.wind.first[std::uint64_t(cells[i]) - m.wind.first_cell];
      while (leg[i][1].height <= here) ++leg[i];
    }
    if (math::any_of<lanes>(~(above > D::splat(0))))
      for (int i = 0; i < lanes; ++i)
        if (!(above.v[i] > 0)) leg[i] = &m.below;
    const Columns<lanes> at([&](int i) { return &leg[i]->height; }), by([&](int i) { return &leg[i]->shear.x; });
    const D up = height - at.x[0];
    for (int j = 0; j < 3; ++j) {
      shear[j] = by.x[j];
      f.w[j] = v[j] - (at.x[j + 1] + up * shear[j]);
    }
  }

  const D weight = D::splat(m.half_area) * density, slowness = D::splat(1) / sound;
  const D speed = math::sqrt(dot(f.w, f.w)), mach = smaller(speed * slowness, 1e9);
  D coefficient = D::splat(m.drag.pieces[0].constant), past{}, c1{}, c2{}, c3{};
  if (m.drag.rows != nullptr) {
    const Cell cell(smaller(mach * D::splat(m.drag.rows_per_mach), m.drag.last_row + 0.5));
    const Columns<lanes> row([&](int i) { return &m.drag.rows[cell[i]].constant; });
    past = D::splat(1 / m.drag.rows_per_mach) * cell.part;
    c1 = row.x[1];
    c2 = row.x[2];
    c3 = row.x[3];
    coefficient = larger(row.x[0] + past * (c1 + past * (c2 + past * c3)), 0);
  } else if (m.drag.varies) {
    const Cell cell(smaller(mach * D::splat(m.drag.cells_per_mach), double(DragCurve::cells) - 1));
    const DragCurve::Piece* piece[lanes];
#pragma GCC unroll 8
    for (int i = 0; i < lanes; ++i) {
      const double here = mach.v[i];
      piece[i] = m.drag.pieces + m.drag.first[cell[i]];
      piece[i] += piece[i][1].start < here;  // nobody foresees that one
      while (piece[i][1].start < here) ++piece[i];
    }
    const Columns<lanes> curve([&](int i) { return &piece[i]->start; });
    past = mach - curve.x[0];
    c1 = curve.x[2];
    c2 = curve.x[3];
    c3 = gather([&](int i) { return piece[i]->cube; });
    coefficient = larger(curve.x[1] + past * (c1 + past * (c2 + past * c3)), 0);
  }
  const D by_speed = weight * speed;
  f.drag = by_speed * coefficient;
  for (int j = 0; j < 3; ++j) f.a[j] = D::splat(0) - f.drag * f.w[j];
  if constexpr (Plain) {
    f.a[1] = f.a[1] - D::splat(m.gravity);
  } else {
    for (int i = 0; i < lanes; ++i) {
      const double place[3] = {x[0].v[i], x[1].v[i], x[2].v[i]}, velocity[3] = {v[0].v[i], v[1].v[i], v[2].v[i]};
      double a[3] = {f.a[0].v[i], f.a[1].v[i], f.a[2].v[i]};
      m.beside(*m.conditions, place, velocity, a);
      for (int j = 0; j < 3; ++j) f.a[j].v[i] = a[j];
    }
  }
  if constexpr (Slopes) {
    const D slope = c1 + past * (2.0 * c2 + past * (3.0 * c3));
    const D steep = by_speed * mach * slope;
    f.along = f.drag + f.drag + steep;
    if (rise != nullptr) {
      const D by_metre = D::splat(m.air.per_metre);
      const D bend = (f.along - f.drag) / larger(speed * speed, 1e-18);
      const D more = bend * dot(f.w, shear) + steep * slowness * (by_metre * faster) -
                     D::splat(m.half_area) * (by_metre * denser) * coefficient * speed;
      for (int j = 0; j < 3; ++j) (*rise)[j] = f.drag * shear[j] + more * f.w[j];
    }
  }
  return f;
}

}  // namespace
}  // namespace carom::ballistics::detail::CAROM_AIM_NAMESPACE
