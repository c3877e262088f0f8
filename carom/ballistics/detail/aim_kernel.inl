// How a path of the aim solver errs, and what its elements do to a small change, in lanes: one for each node or
// element. Compiled once for each instruction set: CAROM_AIM_NAMESPACE, CAROM_AIM_WIDTH.

#include "carom/ballistics/detail/aim_feel.inl"

namespace carom::ballistics::detail::CAROM_AIM_NAMESPACE {
namespace {

template <bool Plain>
void feel_nodes(const AimMedium& medium, FlightPath& path) {
  for (int n = 0; n <= path.count; n += lanes) {
    Vector x, v, rise;
    for (int j = 0; j < 3; ++j) {
      x[j] = load(path.x[j] + n);
      v[j] = load(path.v[j] + n);
    }
    const Felt f = feel<Plain, true>(medium, x, v, &rise);
    store(f.drag, path.drag + n);
    store(f.along, path.along + n);
    for (int j = 0; j < 3; ++j) {
      store(f.a[j], path.k[j] + n);
      store(f.w[j], path.w[j] + n);
      store(rise[j], path.rise[j] + n);
    }
  }
}

/// Lobatto's points of (0, 1) and their weights: at both ends, where there is no defect, and within. With the values of
/// two Legendre polynomials that say what they may mistake.
struct ManyPoints {
  static constexpr int count = 5;
  static constexpr double place[] = {0.08488805186071657, 0.2655756032646429, 0.5, 0.7344243967353571,
                                     0.9151119481392834};
  static constexpr double weight[] = {0.13841302368078295, 0.21587269060493133, 0.2438095238095238, 0.21587269060493133,
                                      0.13841302368078295};
  static constexpr double end_weight = 1.0 / 42;
  static constexpr double sixth[] = {-0.41475046037812563, 0.332105832278952, -0.3125, 0.332105832278952,
                                     -0.41475046037812563};
  static constexpr double fifth[] = {0.34433574319845717, -0.15570741876857414, 0.0, 0.15570741876857414,
                                     -0.34433574319845717};
};
struct FewPoints {
  static constexpr int count = 3;
  static constexpr double place[] = {0.17267316464601146, 0.5, 0.8273268353539885};
  static constexpr double weight[] = {49.0 / 180, 16.0 / 45, 49.0 / 180};
  static constexpr double end_weight = 1.0 / 20;
};

/// What is left of a velocity at the end of an element, and the way that it makes, as shares, where drag takes it at a
/// rate: rates times the length of the element at its beginning, in the mean and at the end of it.
struct Fade {
  D left, way;
  CAROM_SIMD_INLINE Fade(D from, D mean, D to) {
    const D even = D::splat(1) + (1.0 / 12) * mean * mean, odd = 0.5 * mean;
    left = (even - odd) / (even + odd);
    way = 0.5 * (D::splat(1) + left) + (1.0 / 12) * (to * left - from);
  }
};

template <int N, class S>
CAROM_SIMD_INLINE D polynomial(const D (&c)[N], S s) {
  D r = c[N - 1];
  for (int i = N - 2; i >= 0; --i) r = c[i] + s * r;
  return r;
}

/// Hermite's quintic over elements, by powers of s from 0 to 1. `Plain`: of the places the heights alone.
template <bool Plain>
struct Quintic {
  D h, place[3][6], velocity[3][5], acceleration[3][4];
  /// `from` and `to` give the values of an array at the nodes.
  template <class From, class To>
  CAROM_SIMD_INLINE Quintic(const FlightPath& path, From&& from, To&& to) : h(to(path.t) - from(path.t)) {
    const D by_h = D::splat(1) / h;
    for (int i = 0; i < 3; ++i) {
      const D x = from(path.x[i]), va = from(path.v[i]), v = h * va, k = h * h * from(path.k[i]);
      const D d = to(path.x[i]) - x - v - 0.5 * k, dv = h * to(path.v[i]) - v - k, dk = h * h * to(path.k[i]) - k;
      const D c3 = 10 * d - 4 * dv + 0.5 * dk, c4 = 7 * dv - 15 * d - dk, c5 = 6 * d - 3 * dv + 0.5 * dk;
      const D of_x[6] = {x, v, 0.5 * k, c3, c4, c5};
      const D of_v[5] = {va, by_h * k, 3 * by_h * c3, 4 * by_h * c4, 5 * by_h * c5};
      for (int j = 0; j < 6 && (!Plain || i == 1); ++j) place[i][j] = of_x[j];
      for (int j = 0; j < 5; ++j) velocity[i][j] = of_v[j];
      for (int j = 0; j < 4; ++j) acceleration[i][j] = double(j + 1) * by_h * of_v[j + 1];
    }
  }
  template <class S>
  CAROM_SIMD_INLINE Felt feel_at(const AimMedium& medium, S s) const {
    Vector x{}, v;
    for (int j = 0; j < 3; ++j) {
      if (!Plain || j == 1) x[j] = polynomial(place[j], s);
      v[j] = polynomial(velocity[j], s);
    }
    return feel<Plain, true>(medium, x, v);
  }
};

template <class Points, bool Plain>
void feel_elements(const AimMedium& medium, FlightPath& path) {
  for (int n = 0; n < path.count; n += lanes) {
    const Quintic<Plain> quintic(
        path, [&](const double* a) __attribute__((always_inline)) { return load(a + n); },
        [&](const double* a) __attribute__((always_inline)) { return load(a + n + 1); });
    const D h = quintic.h;
    // ∫ H d of the defect d over it, H Hermite's cubics: what is weighted by a cubic in s takes its values (0, 1) and
    // slopes at both ends of them.
    Vector start{}, start_slope{}, end{}, end_slope{}, high{}, low{}, w;
    D defect{};
    for (int j = 0; j < 3; ++j) w[j] = Points::end_weight * (load(path.w[j] + n) + load(path.w[j] + n + 1));
    D drag = Points::end_weight * (load(path.drag + n) + load(path.drag + n + 1));
    D along = Points::end_weight * (load(path.along + n) + load(path.along + n + 1));
    for (int q = 0; q < Points::count; ++q) {
      const double s = Points::place[q], s2 = s * s, s3 = s2 * s, share = Points::weight[q];
      const Felt f = quintic.feel_at(medium, s);
      drag = drag + share * f.drag;
      along = along + share * f.along;
      for (int j = 0; j < 3; ++j) w[j] = w[j] + share * f.w[j];
      for (int j = 0; j < 3; ++j) {
        const D d = share * (f.a[j] - polynomial(quintic.acceleration[j], s));
        defect = defect + absolute(d);
        start[j] = start[j] + (1 - 3 * s2 + 2 * s3) * d;
        start_slope[j] = start_slope[j] + (s3 - 2 * s2 + s) * d;
        end[j] = end[j] + (3 * s2 - 2 * s3) * d;
        end_slope[j] = end_slope[j] + (s3 - s2) * d;
        if constexpr (Points::count == 5) {
          high[j] = high[j] + Points::sixth[q] * d;
          low[j] = low[j] + Points::fifth[q] * d;
        }
      }
    }
    const D from_drag = h * load(path.drag + n), to_drag = h * load(path.drag + n + 1),
            from_along = h * load(path.along + n), to_along = h * load(path.along + n + 1);
    const Fade across(from_drag, h * drag, to_drag), ahead(from_along, h * along, to_along);
    const D by_length = D::splat(1) / larger(math::sqrt(dot(w, w)), 1e-9);
    Vector e, from_w, to_w;
    for (int j = 0; j < 3; ++j) {
      e[j] = by_length * w[j];
      from_w[j] = load(path.w[j] + n);
      to_w[j] = load(path.w[j] + n + 1);
    }
    // A push within it fades to its end as a matrix that takes its values and slopes at both ends, as H.
    const D from_bend = (from_along - from_drag) * dot(from_w, start_slope) / larger(dot(from_w, from_w), 1e-18),
            to_bend = (to_along - to_drag) * dot(to_w, end_slope) / larger(dot(to_w, to_w), 1e-18);
    Vector u;
    for (int j = 0; j < 3; ++j) u[j] = start[j] + from_drag * start_slope[j] + from_bend * from_w[j];
    const D c = h * across.way, d = h * (ahead.way - across.way), b = ahead.left - across.left, forward = dot(e, u);
    Vector more_x, more_v;
    for (int j = 0; j < 3; ++j) {
      more_v[j] = h * (end[j] + to_drag * end_slope[j] + to_bend * to_w[j] + across.left * u[j] + b * forward * e[j]);
      more_x[j] = h * (c * u[j] + d * forward * e[j] - h * (start_slope[j] + end_slope[j]));
    }
    Vector rise, q;
    for (int j = 0; j < 3; ++j) rise[j] = 0.5 * (load(path.rise[j] + n) + load(path.rise[j] + n + 1));
    const D turned = d * dot(e, rise);
    D rest{};
    for (int j = 0; j < 3; ++j) {
      q[j] = c * rise[j] + turned * e[j];
      rest = rest + absolute(high[j]) + 0.1 * absolute(low[j]);
    }
    FlightPath::Elements& out = path.elements;
    store_floats(across.left, out.a + n);
    store_floats(b, out.b + n);
    store_floats(c, out.c + n);
    store_floats(d, out.d + n);
    store_floats(h, out.h + n);
    for (int j = 0; j < 3; ++j) {
      store_floats(e[j], out.e[j] + n);
      store_floats(q[j], out.q[j] + n);
      store_floats(more_x[j], out.x[j] + n);
      store_floats(more_v[j], out.v[j] + n);
    }
    store_floats(h * defect, out.defect + n);
    store_floats(h * rest, out.rest + n);
  }
}

typedef float Four __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
CAROM_SIMD_INLINE Four four(float x) { return Four{x, x, x, x}; }

/// What the arrival owes, backward along the path, and where it is by what the elements owe. `Again`: what is owed is
/// known.
template <bool Again>
void owe(FlightPath& path) {
  const FlightPath::Elements& of = path.elements;
  Four x{}, y{}, z{}, up{}, off{}, leaps{};
  for (int n = path.count;; --n) {
    FlightPath::Debt& debt = path.debt[n];
    if constexpr (Again) {
      __builtin_memcpy(&x, debt.v[0], 16);
      __builtin_memcpy(&y, debt.v[1], 16);
      __builtin_memcpy(&z, debt.v[2], 16);
      __builtin_memcpy(&up, debt.y, 16);
    } else {
      __builtin_memcpy(debt.v[0], &x, 16);
      __builtin_memcpy(debt.v[1], &y, 16);
      __builtin_memcpy(debt.v[2], &z, 16);
      __builtin_memcpy(debt.y, &up, 16);
    }
    if (n == 0) break;
    const int i = n - 1;
    const Four moved = Four{of.x[0][i], of.x[1][i], of.x[2][i], 0} + of.x[1][i] * up + of.v[0][i] * x + of.v[1][i] * y +
                       of.v[2][i] * z;
    off += moved;
    leaps += moved > Four{} ? moved : -moved;
    if constexpr (Again) continue;
    const Four e{of.e[0][i], of.e[1][i], of.e[2][i], 0}, q{of.q[0][i], of.q[1][i], of.q[2][i], 0};
    const float a = of.a[i], c = of.c[i], half = 0.5f * of.h[i];
    const Four ahead = of.d[i] * (e + of.e[1][i] * up) + of.b[i] * (of.e[0][i] * x + of.e[1][i] * y + of.e[2][i] * z);
    const Four pushed = of.q[0][i] * x + of.q[1][i] * y + of.q[2][i] * z;
    x = a * x + of.e[0][i] * ahead + Four{c, 0, 0, 0};
    y = a * y + of.e[1][i] * ahead + Four{0, c, 0, 0} + c * up + half * (pushed + (2.0f / 3 * half) * q);
    z = a * z + of.e[2][i] * ahead + Four{0, 0, c, 0};
    up = up + pushed + half * q;
  }
  double* const rows[] = {&path.by_velocity[0].x, &path.by_velocity[1].x, &path.by_velocity[2].x};
  double *place = &path.arrival.position.x, *velocity = &path.arrival.velocity.x;
  path.leaps = double(leaps[0]) + double(leaps[1]) + double(leaps[2]);
  for (int i = 0; i < 3; ++i) {
    rows[i][0] = double(x[i]);
    rows[i][1] = double(y[i]);
    rows[i][2] = double(z[i]);
    place[i] = path.x[i][path.count] + double(off[i]);
    velocity[i] = path.v[i][path.count];
  }
}

/// By eight of Gauss's points in parts of elements: their seventh and fifth Legendre coefficients say what they
/// mistake.
struct Gauss {
  static constexpr double place[] = {0.019855071751231856, 0.10166676129318658, 0.2372337950418355, 0.4082826787521751,
                                     0.591717321247825,    0.7627662049581645,  0.8983332387068135, 0.9801449282487682};
  static constexpr double weight[] = {0.05061426814518809, 0.11119051722668723, 0.1568533229389437,
                                      0.181341891689181,   0.181341891689181,   0.1568533229389437,
                                      0.11119051722668723, 0.05061426814518809};
  static constexpr double seventh[] = {-0.15501881289035005, 0.2265762383999968,   -0.2685203140877153,
                                       0.28855496859568763,  -0.28855496859568763, 0.2685203140877153,
                                       -0.2265762383999968,  0.15501881289035005};
  static constexpr double fifth[] = {-0.4828486810505167,  0.4033170755970801,  -0.031045687085550933,
                                     -0.29156822258958437, 0.29156822258958437, 0.031045687085550933,
                                     -0.4033170755970801,  0.4828486810505167};
};

template <bool Plain>
void measure_parts(const AimMedium& medium, const FlightPath& path, AimPart* parts, int count) {
  for (int first = 0; first < count; first += lanes) {
    const auto part = [&](int i) -> AimPart& { return parts[first + i < count ? first + i : count - 1]; };
    const Quintic<Plain> quintic(
        path,
        [&](const double* a)
            __attribute__((always_inline)) { return gather([&](int i) { return a[part(i).element]; }); },
        [&](const double* a)
            __attribute__((always_inline)) { return gather([&](int i) { return a[part(i).element + 1]; }); });
    const D from = gather([&](int i) { return part(i).from; }),
            width = gather([&](int i) { return part(i).to; }) - from;
    Vector moments[4]{}, high{}, low{};
    for (int q = 0; q < 8; ++q) {
      const D s = from + Gauss::place[q] * width, share = Gauss::weight[q] * width, s2 = s * s, s3 = s2 * s;
      const D end = 3.0 * s2 - 2.0 * s3, weights[4] = {D::splat(1) - end, s3 - 2.0 * s2 + s, end, s3 - s2};
      const Felt f = quintic.feel_at(medium, s);
      for (int j = 0; j < 3; ++j) {
        const D d = share * (f.a[j] - polynomial(quintic.acceleration[j], s));
        for (int k = 0; k < 4; ++k) moments[k][j] = moments[k][j] + weights[k] * d;
        high[j] = high[j] + Gauss::seventh[q] * d;
        low[j] = low[j] + Gauss::fifth[q] * d;
      }
    }
    D rest{};
    for (int j = 0; j < 3; ++j) rest = rest + absolute(high[j]) + 0.1 * absolute(low[j]);
    for (int i = 0; i < lanes && first + i < count; ++i) {
      part(i).rest = rest.v[i];
      for (int k = 0; k < 4; ++k)
        for (int j = 0; j < 3; ++j) part(i).moments.of[k][j] = moments[k][j].v[i];
    }
  }
}

}  // namespace

void linearize(const AimMedium& medium, FlightPath& path, bool finely) {
  const int last = path.count;
  for (int i = 1; i <= lanes; ++i) {  // what lanes read beyond the end
    path.t[last + i] = path.t[last] + i;
    for (int j = 0; j < 3; ++j) {
      path.x[j][last + i] = path.x[j][last];
      path.v[j][last + i] = path.v[j][last];
      path.k[j][last + i] = path.w[j][last + i] = path.rise[j][last + i] = 0;
    }
    path.drag[last + i] = path.along[last + i] = 0;
  }
  const bool plain = medium.beside == nullptr;
  plain ? feel_nodes<true>(medium, path) : feel_nodes<false>(medium, path);
  if (finely)
    plain ? feel_elements<ManyPoints, true>(medium, path) : feel_elements<ManyPoints, false>(medium, path);
  else
    plain ? feel_elements<FewPoints, true>(medium, path) : feel_elements<FewPoints, false>(medium, path);
  owe<false>(path);
}

void settle(FlightPath& path) { owe<true>(path); }

void measure(const AimMedium& medium, const FlightPath& path, AimPart* parts, int count) {
  if (medium.beside == nullptr)
    measure_parts<true>(medium, path, parts, count);
  else
    measure_parts<false>(medium, path, parts, count);
}

}  // namespace carom::ballistics::detail::CAROM_AIM_NAMESPACE
