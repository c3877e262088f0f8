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

/// Lobatto's points of (0, 1), at both ends, where there is no defect, and within: the first half of those and the
/// middle, with their weights.
struct ManyPoints {
  static constexpr int pairs = 2;
  static constexpr double place[] = {0.08488805186071657, 0.2655756032646429, 0.5};
  static constexpr double weight[] = {0.13841302368078295, 0.21587269060493133, 0.2438095238095238};
  static constexpr double end_weight = 1.0 / 42;
};
struct FewPoints {
  static constexpr int pairs = 1;
  static constexpr double place[] = {0.17267316464601146, 0.5};
  static constexpr double weight[] = {49.0 / 180, 16.0 / 45};
  static constexpr double end_weight = 1.0 / 20;
};
/// What a defect with such values at the pairs (their sums, or by how much the later is more) and in the middle of
/// ManyPoints adds to the bulge, by h².
struct Bulge {
  static constexpr double even[] = {0.016050917709345004, 0.004250421576369281, -0.01660714285714286},
                          odd[] = {0.024574971804006942, -0.017331692522059194},
                          sharp[] = {0.022200311187888205, -0.027724864759316778, 0.029464285714285714};
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

/// A function of t from −1 to 1 over an element: even(t²) + t odd(t²).
template <int Even, int Odd>
struct AboutMiddle {
  D even[Even], odd[Odd];
  template <class S>
  CAROM_SIMD_INLINE D at(S t, S t2) const {
    return polynomial(even, t2) + t * polynomial(odd, t2);
  }
  /// At ∓t.
  CAROM_SIMD_INLINE void pair(double t, double t2, D& before, D& after) const {
    const D sum = polynomial(even, t2), more = t * polynomial(odd, t2);
    before = sum - more;
    after = sum + more;
  }
};

/// The interpolant over elements as FlightElement has it. `Plain`: of the places the heights alone; not `Bulged`:
/// Hermite's quintic alone.
template <bool Plain, bool Bulged>
struct Interpolant {
  static constexpr int more = Bulged ? 1 : 0;
  D h;
  AboutMiddle<3 + 2 * more, 3 + more> place[3];
  AboutMiddle<3 + more, 2 + 2 * more> velocity[3];
  AboutMiddle<2 + 2 * more, 2 + more> acceleration[3];
  /// `from` and `to` give the values of an array at the nodes.
  template <class From, class To>
  CAROM_SIMD_INLINE Interpolant(const FlightPath& path, From&& from, To&& to) : h(to(path.t) - from(path.t)) {
    const D half = 0.5 * h, by_half = D::splat(1) / half, quarter = 0.5 * half, eighth = quarter * half;
    for (int i = 0; i < 3; ++i) {
      const D x = 0.5 * from(path.x[i]), to_x = 0.5 * to(path.x[i]), v = quarter * from(path.v[i]),
              to_v = quarter * to(path.v[i]), k = eighth * from(path.k[i]), to_k = eighth * to(path.k[i]);
      const D opens = to_v - v, e2 = 0.125 * ((k + to_k) - opens), e1 = 0.5 * opens - 2 * e2;
      const D way = to_x - x, turn = (v + to_v) - way, o2 = 0.125 * ((to_k - k) - 3 * turn), o1 = 0.5 * turn - 2 * o2;
      D even[3 + 2 * more] = {(x + to_x) - e1 - e2, e1, e2}, odd[3 + more] = {way - o1 - o2, o1, o2};
      if constexpr (Bulged) {
        const auto& bulge = path.elements.bulge;
        const D b0 = from(bulge[0][i]), b1 = from(bulge[1][i]), b2 = from(bulge[2][i]);
        even[0] = even[0] + b0;
        even[1] = even[1] + (b2 - 3 * b0);
        even[2] = even[2] + 3 * (b0 - b2);
        even[3] = 3 * b2 - b0;
        even[4] = D::splat(0) - b2;
        odd[0] = odd[0] + b1;
        odd[1] = odd[1] - 3 * b1;
        odd[2] = odd[2] + 3 * b1;
        odd[3] = D::splat(0) - b1;
      }
      if (!Plain || i == 1) {
        for (int j = 0; j < 3 + 2 * more; ++j) place[i].even[j] = even[j];
        for (int j = 0; j < 3 + more; ++j) place[i].odd[j] = odd[j];
      }
      for (int j = 0; j < 3 + more; ++j) velocity[i].even[j] = double(2 * j + 1) * by_half * odd[j];
      for (int j = 0; j < 2 + 2 * more; ++j) velocity[i].odd[j] = double(2 * j + 2) * by_half * even[j + 1];
      for (int j = 0; j < 2 + 2 * more; ++j) acceleration[i].even[j] = double(2 * j + 1) * by_half * velocity[i].odd[j];
      for (int j = 0; j < 2 + more; ++j) acceleration[i].odd[j] = double(2 * j + 2) * by_half * velocity[i].even[j + 1];
    }
  }
};

template <class Points, bool Plain>
void feel_elements(const AimMedium& medium, FlightPath& path) {
  constexpr int pairs = Points::pairs, points = 2 * pairs + 1;
  constexpr bool finely = pairs == 2;
  FlightPath::Elements& out = path.elements;
  for (int n = 0; n < path.count; n += lanes) {
    const Interpolant<Plain, finely> flown(
        path, [&](const double* a) __attribute__((always_inline)) { return load(a + n); },
        [&](const double* a) __attribute__((always_inline)) { return load(a + n + 1); });
    const D h = flown.h;
    Vector w, defects[points];
    for (int j = 0; j < 3; ++j) w[j] = Points::end_weight * (load(path.w[j] + n) + load(path.w[j] + n + 1));
    D drag = Points::end_weight * (load(path.drag + n) + load(path.drag + n + 1));
    D along = Points::end_weight * (load(path.along + n) + load(path.along + n + 1));
    const auto feel_at = [&](int q, double share, const Vector& x, const Vector& v) __attribute__((always_inline)) {
      const Felt f = feel<Plain, true>(medium, x, v);
      drag = drag + share * f.drag;
      along = along + share * f.along;
      for (int j = 0; j < 3; ++j) {
        w[j] = w[j] + share * f.w[j];
        defects[q][j] = f.a[j] - defects[q][j];
      }
    };
    for (int q = 0; q < pairs; ++q) {
      const double t = 1 - 2 * Points::place[q], t2 = t * t;
      const int last = points - 1 - q;
      Vector x{}, to_x{}, v, to_v;
      for (int j = 0; j < 3; ++j) {
        if (!Plain || j == 1) flown.place[j].pair(t, t2, x[j], to_x[j]);
        flown.velocity[j].pair(t, t2, v[j], to_v[j]);
        flown.acceleration[j].pair(t, t2, defects[q][j], defects[last][j]);
      }
      feel_at(q, Points::weight[q], x, v);
      feel_at(last, Points::weight[q], to_x, to_v);
    }
    Vector x{}, v;
    for (int j = 0; j < 3; ++j) {
      if (!Plain || j == 1) x[j] = flown.place[j].even[0];
      v[j] = flown.velocity[j].even[0];
      defects[pairs][j] = flown.acceleration[j].even[0];
    }
    feel_at(pairs, Points::weight[pairs], x, v);
    // ∫ H d of the defect d over it, H Hermite's cubics: what is weighted by a cubic in s takes its values (0, 1) and
    // slopes at both ends of them. Halves of their sums and differences are even and odd about the middle.
    Vector start, start_slope, end, end_slope;
    D defect{}, rest{};
    for (int j = 0; j < 3; ++j) {
      const D middle = defects[pairs][j];
      D whole = 0.5 * Points::weight[pairs] * middle, later{}, hump = 0.25 * whole, tilt{};
      defect = defect + Points::weight[pairs] * absolute(middle);
      D bulge[3] = {Bulge::even[2] * middle, {}, Bulge::sharp[2] * middle};
      for (int q = 0; q < pairs; ++q) {
        const double s = Points::place[q], share = 0.5 * Points::weight[q], t = 1 - 2 * s;
        const D before = defects[q][j], after = defects[points - 1 - q][j], sum = before + after, more = after - before;
        defect = defect + Points::weight[q] * (absolute(before) + absolute(after));
        whole = whole + share * sum;
        later = later + share * (t * (1 + 2 * s * (1 - s))) * more;
        hump = hump + share * s * (1 - s) * sum;
        tilt = tilt - share * (s * (1 - s) * t) * more;
        if constexpr (finely) {
          bulge[0] = bulge[0] + Bulge::even[q] * sum;
          bulge[1] = bulge[1] + Bulge::odd[q] * more;
          bulge[2] = bulge[2] + Bulge::sharp[q] * sum;
        }
      }
      start[j] = whole - later;
      start_slope[j] = hump + tilt;
      end[j] = whole + later;
      end_slope[j] = tilt - hump;
      if constexpr (finely) {
        for (int k = 0; k < 3; ++k) {
          bulge[k] = load(out.bulge[k][j] + n) + h * h * bulge[k];
          store(bulge[k], out.bulge[k][j] + n);
        }
        // Of the sixth and the fifth Legendre coefficient of what they bend the acceleration by.
        rest = rest + 2.56 * absolute(bulge[2]) + 2.1 * absolute(bulge[1]) + 0.4 * absolute(bulge[0]);
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
    for (int j = 0; j < 3; ++j) q[j] = c * rise[j] + turned * e[j];
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
    store_floats(rest / h, out.rest + n);
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

/// What a change of the start, and what the elements owe, do to every node, forward along the path.
void spread_out(FlightPath& path) {
  const FlightPath::Elements& of = path.elements;
  Four x[3]{}, v[3]{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  float carried = 0, defect = 0, leaps = 0, leap = 0;  // m, m/s
  for (int n = 0;; ++n) {
    FlightPath::Spread& out = path.spread[n];
    __builtin_memcpy(out.x, x, sizeof x);
    __builtin_memcpy(out.v, v, sizeof v);
    out.carried = carried;
    out.leaps = leaps;
    if (n == path.count) return;
    const float half = 0.5f * of.h[n], a = of.a[n], c = of.c[n];
    const Four ahead = of.e[0][n] * v[0] + of.e[1][n] * v[1] + of.e[2][n] * v[2];
    const Four height = x[1] + half * v[1], sunk = half * (x[1] + (2.0f / 3 * half) * v[1]);
    const Four d = of.d[n] * ahead, b = of.b[n] * ahead;
    defect += of.defect[n];
    carried += c * defect;
    defect *= a;
    leaps += c * leap;
    leap *= a;
    for (int i = 0; i < 3; ++i) {
      const float e = of.e[i][n], q = of.q[i][n], more_x = of.x[i][n], more_v = of.v[i][n];
      x[i] = x[i] + c * v[i] + e * d + q * sunk + Four{0, 0, 0, more_x};
      v[i] = a * v[i] + e * b + q * height + Four{0, 0, 0, more_v};
      leaps += __builtin_fabsf(more_x);
      leap += __builtin_fabsf(more_v);
    }
  }
}

/// By six of Gauss's points in parts of elements: their fifth and third Legendre coefficients say what they
/// mistake.
struct Gauss {
  static constexpr int points = 6;
  static constexpr double place[] = {0.033765242898423975, 0.1693953067668677, 0.3806904069584015,
                                     0.6193095930415985,   0.8306046932331324, 0.966234757101576};
  static constexpr double weight[] = {0.08566224618958525, 0.1803807865240693, 0.23395696728634552,
                                      0.23395696728634552, 0.1803807865240693, 0.08566224618958525};
  static constexpr double fifth[] = {-0.2057123110596229, 0.2943957149254376,  -0.33461902074104083,
                                     0.33461902074104083, -0.2943957149254376, 0.2057123110596229};
  static constexpr double third[] = {-0.6282499246436889, 0.269115769744599,  0.3239618653539353,
                                     -0.3239618653539353, -0.269115769744599, 0.6282499246436889};
};

template <bool Plain>
void measure_parts(const AimMedium& medium, const FlightPath& path, AimPart* parts, int count) {
  for (int first = 0; first < count; first += lanes) {
    const auto part = [&](int i) -> AimPart& { return parts[first + i < count ? first + i : count - 1]; };
    const Interpolant<Plain, true> flown(
        path,
        [&](const double* a)
            __attribute__((always_inline)) { return gather([&](int i) { return a[part(i).element]; }); },
        [&](const double* a)
            __attribute__((always_inline)) { return gather([&](int i) { return a[part(i).element + 1]; }); });
    const D from = gather([&](int i) { return part(i).from; }),
            width = gather([&](int i) { return part(i).to; }) - from;
    Vector moments[4]{}, high{}, low{};
    for (int q = 0; q < Gauss::points; ++q) {
      const D s = from + Gauss::place[q] * width, share = Gauss::weight[q] * width, s2 = s * s, s3 = s2 * s;
      const D end = 3.0 * s2 - 2.0 * s3, weights[4] = {D::splat(1) - end, s3 - 2.0 * s2 + s, end, s3 - s2};
      const D t = s + s - D::splat(1), t2 = t * t;
      Vector x{}, v;
      for (int j = 0; j < 3; ++j) {
        if (!Plain || j == 1) x[j] = flown.place[j].at(t, t2);
        v[j] = flown.velocity[j].at(t, t2);
      }
      const Felt f = feel<Plain, true>(medium, x, v);
      for (int j = 0; j < 3; ++j) {
        const D d = share * (f.a[j] - flown.acceleration[j].at(t, t2));
        for (int k = 0; k < 4; ++k) moments[k][j] = moments[k][j] + weights[k] * d;
        high[j] = high[j] + Gauss::fifth[q] * d;
        low[j] = low[j] + Gauss::third[q] * d;
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

void pad(FlightPath& path) {
  const int last = path.count;
  for (int i = 1; i <= lanes; ++i) {  // what lanes read beyond the end
    path.t[last + i] = path.t[last] + i;
    for (int j = 0; j < 3; ++j) {
      path.x[j][last + i] = path.x[j][last];
      path.v[j][last + i] = path.v[j][last];
      path.k[j][last + i] = path.w[j][last + i] = path.rise[j][last + i] = 0;
    }
    path.drag[last + i] = path.along[last + i] = 0;
    path.flatten(last + i - 1);
  }
}

void linearize(const AimMedium& medium, FlightPath& path, bool finely) {
  pad(path);
  const bool plain = medium.beside == nullptr;
  plain ? feel_nodes<true>(medium, path) : feel_nodes<false>(medium, path);
  if (finely)
    plain ? feel_elements<ManyPoints, true>(medium, path) : feel_elements<ManyPoints, false>(medium, path);
  else
    plain ? feel_elements<FewPoints, true>(medium, path) : feel_elements<FewPoints, false>(medium, path);
  owe<false>(path);
}

void spread(const AimMedium& medium, FlightPath& path) {
  pad(path);
  const bool plain = medium.beside == nullptr;
  plain ? feel_nodes<true>(medium, path) : feel_nodes<false>(medium, path);
  plain ? feel_elements<FewPoints, true>(medium, path) : feel_elements<FewPoints, false>(medium, path);
  spread_out(path);
}

void measure(const AimMedium& medium, const FlightPath& path, AimPart* parts, int count) {
  if (medium.beside == nullptr)
    measure_parts<true>(medium, path, parts, count);
  else
    measure_parts<false>(medium, path, parts, count);
}

}  // namespace

const AimKernel kernel{linearize, spread, measure, owe<true>};

}  // namespace carom::ballistics::detail::CAROM_AIM_NAMESPACE
