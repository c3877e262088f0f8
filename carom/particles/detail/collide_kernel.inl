// Where the paths of one block of particles meet a surface, and what becomes of them there.

namespace carom::particles::detail::CAROM_PARTICLE_NAMESPACE {

struct Closest {
  F gap;
  V normal;
};

/// Signed distance and outward normal, in the shape's frame, of points (not yet less the particle's radius). Outside a
/// hull it is that of the farthest face's plane: never more than the distance.
template <Form form>
CAROM_SIMD_INLINE Closest closest(const SurfaceData& s, const V& q) {
  const V zero = {F::zero(), F::zero(), F::zero()};
  if constexpr (form == Form::plane) return {q.y, {F::zero(), splat(1), F::zero()}};
  if constexpr (form == Form::sphere || form == Form::capsule) {
    V r = q;
    if constexpr (form == Form::capsule) r.y = q.y - math::clamp(q.y, splat(-s.half[1]), splat(s.half[1]));
    const F length = math::sqrt(dot(r, r));
    const M out = length > F::zero();
    const F inverse = splat(1) / math::select(out, length, splat(1));
    return {length - splat(s.radius), select(out, inverse * r, {F::zero(), splat(1), F::zero()})};
  }
  if constexpr (form == Form::box || form == Form::cylinder) {
    F ax = math::abs(q.x), az = math::abs(q.z);
    const F ay = math::abs(q.y) - splat(s.half[1]);
    F nx = math::copysign(splat(1), q.x), nz = math::copysign(splat(1), q.z);
    const F ny = math::copysign(splat(1), q.y);
    if constexpr (form == Form::box) {
      ax = ax - splat(s.half[0]);
      az = az - splat(s.half[2]);
    } else {  // across and along: as a box of two dimensions
      const F across = math::sqrt(q.x * q.x + q.z * q.z);
      const M off = across > F::zero();
      const F inverse = splat(1) / math::select(off, across, splat(1));
      nx = math::select(off, q.x * inverse, splat(1));
      nz = math::keep(off, q.z * inverse);
      ax = across - splat(s.half[0]);
      az = splat(-far_gap);
    }
    const F ox = math::max(ax, F::zero()), oy = math::max(ay, F::zero()), oz = math::max(az, F::zero());
    const F length = math::sqrt(ox * ox + oy * oy + oz * oz);
    const F inside = math::max(math::max(ax, ay), az);
    const M out = length > F::zero();
    const F inverse = splat(1) / math::select(out, length, splat(1));
    const M x = ax == inside, y = ay == inside;
    V n;
    if constexpr (form == Form::box) {
      const V corner = {ox * inverse * nx, oy * inverse * ny, oz * inverse * nz};
      const V face =
          select(x, V{nx, F::zero(), F::zero()}, select(y, V{F::zero(), ny, F::zero()}, V{F::zero(), F::zero(), nz}));
      n = select(out, corner, face);
    } else {
      const V corner = {ox * inverse * nx, oy * inverse * ny, ox * inverse * nz};
      n = select(out, corner, select(x, V{nx, F::zero(), nz}, V{F::zero(), ny, F::zero()}));
    }
    return {math::select(out, length, inside) - splat(s.radius), n};
  }
  if constexpr (form == Form::hull) {
    Closest best = {splat(-far_gap), zero};
    for (int k = 0; k < s.plane_count; ++k) {
      const float* plane = s.planes + 4 * k;
      const V n = splat(plane);
      const F gap = dot(n, q) - splat(plane[3]);
      const M more = gap > best.gap;
      best = {math::select(more, gap, best.gap), select(more, n, best.normal)};
    }
    return {best.gap - splat(s.radius), best.normal};
  }
  if constexpr (form == Form::height_field) {
    const F u = q.x / splat(s.cell[0]), w = q.z / splat(s.cell[1]);
    const F last_u = splat(float(s.columns - 1)), last_w = splat(float(s.rows - 1));
    M on = (u >= F::zero()) & (w >= F::zero()) & (u <= last_u) & (w <= last_w);
    // A lane that is not a number must not reach the conversion.
    const F cu = math::select(on, u, F::zero()), cw = math::select(on, w, F::zero());
    const I ci = math::to_int(math::min(cu, splat(float(s.columns) - 1.001f)));
    const I cj = math::to_int(math::min(cw, splat(float(s.rows) - 1.001f)));
    const F fu = cu - math::to_float(ci), fw = cw - math::to_float(cj);
    F h00 = F::zero(), h10 = F::zero(), h01 = F::zero(), h11 = F::zero();
    for (int k = 0; k < width; ++k) {
      const float* h = s.heights + cj[k] * s.columns + ci[k];
      h00.set(k, h[0]);
      h10.set(k, h[1]);
      h01.set(k, h[s.columns]);
      h11.set(k, h[s.columns + 1]);
      if (s.holes != nullptr && s.holes[cj[k] * (s.columns - 1) + ci[k]] != 0) on.v[k] = 0;
    }
    const M lower = fu >= fw;  // the triangle with the corner (i + 1, j)
    const F slope_x = math::select(lower, h10 - h00, h11 - h01), slope_z = math::select(lower, h11 - h10, h01 - h00);
    const F height = h00 + slope_x * fu + slope_z * fw;
    const F gx = slope_x / splat(s.cell[0]), gz = slope_z / splat(s.cell[1]);
    const F inverse = splat(1) / math::sqrt(gx * gx + gz * gz + splat(1));
    return {math::select(on, (q.y - height) * inverse, splat(far_gap)), {-(gx * inverse), inverse, -(gz * inverse)}};
  }
  return {splat(far_gap), zero};
}

/// The gap to the tangent plane of the place of impact at the start of the way, and that plane's normal.
struct Meeting {
  M hit;
  F gap;
  V normal;
};

template <Form form>
CAROM_SIMD_INLINE Meeting meet(const SurfaceData& s, const V& q0, const V& q1, F radius, M near, const Path& path,
                               int k) {
  const V way = q1 - q0;
  if constexpr (form == Form::given) {
    const F gap = F::load(path.gap + k);
    return {near & (gap < splat(far_gap)), gap, load(path.normal, k)};
  }
  Closest end = closest<form>(s, q1);
  end.gap = end.gap - radius;
  Meeting m = {near & (end.gap < F::zero()), end.gap - dot(end.normal, way), end.normal};
  if constexpr (form == Form::plane || form == Form::height_field) return m;
  // From the start on, each time to where the way crosses the tangent plane of the nearest point: for a convex shape
  // that is never beyond the surface, and most often on it.
  F t = F::zero();
  M going = near;
  const F tolerance = splat(1e-4f) * radius + splat(1e-6f);
  for (int round = 0; round < 8 && math::any(going); ++round) {
    const V q = q0 + t * way;
    Closest c = closest<form>(s, q);
    c.gap = c.gap - radius;
    const F along = dot(c.normal, way);
    const M touches = going & (c.gap <= tolerance) & ((along < F::zero()) | (c.gap < -tolerance));
    m.hit = m.hit | touches;
    m.gap = math::select(touches, c.gap - t * along, m.gap);
    m.normal = select(touches, c.normal, m.normal);
    going = going & !touches & (along < F::zero());
    t = math::select(going, t - c.gap / math::select(going, along, splat(-1)), t);
    going = going & (t <= splat(1));
  }
  return m;
}

template <Form form>
CAROM_SIMD_INLINE int collide_form(const CollideData& d, const SurfaceData& s, const Arrays& arrays, int from, int to,
                                   int count, Path& path, HitList& hits) {
  int touched = 0;
  const V center0 = splat(s.place0), center1 = splat(s.place1);
  for (int i = from; i < to; i += width) {
    const int k = i - from;
    // Most are nowhere near: that is found out with as little as possible.
    const V p1 = load(arrays.position, i);
    const F left = F::load(path.left + k);
    M near = left > F::zero();
    if (s.reach < far_gap) {
      const V off = p1 - center1;
      const F reach = splat(s.reach) + F::load(path.reach + k);
      near = near & (dot(off, off) < reach * reach);
    }
    if (!math::any(near)) continue;
    if (arrays.held != nullptr) near = near & (F::load(arrays.held + i) == F::zero());
    const V p0 = load(path.start, k);
    const F scale = arrays.scale != nullptr ? F::load(arrays.scale + i) : splat(1);
    const F radius = splat(d.radius) * scale;

    const V q0 = turn_back(s.turn0, p0 - center0), q1 = turn_back(s.turn1, p1 - center1);
    Meeting m = meet<form>(s, q0, q1, radius, near, path, k);
    if (!math::any(m.hit)) continue;

    // Velocities relative to the surface, in its frame; the acceleration is what they changed by.
    const V v0 = load(path.speed, k), v1 = load(arrays.velocity, i);
    V u = {F::zero(), F::zero(), F::zero()};
    if (s.moves) u = splat(s.velocity) + cross(splat(s.spin), p1 - splat(s.center));
    const V w0 = turn_back(s.turn1, v0 - u), w1 = turn_back(s.turn1, v1 - u);
    const V g = turn_back(s.turn1, splat(d.gravity));
    const V n = m.normal;
    const F time = math::max(left, splat(1e-9f));
    const V a = (splat(1) / time) * (w1 - w0);
    // n·(w0 s + a s²/2) = −gap: the moment of impact on the path as it curves.
    const F fall0 = dot(n, w0), pull = dot(n, a), gap = math::max(m.gap, F::zero());
    const F root = math::sqrt(math::max(fall0 * fall0 - splat(2) * pull * gap, F::zero()));
    const F below = fall0 - root;
    F moment =
        math::select(below < F::zero(), splat(-2) * gap / math::select(below < F::zero(), below, splat(-1)), F::zero());
    moment = math::clamp(moment, F::zero(), left);
    const F rest = left - moment;
    const V wh = w0 + moment * a;
    const F speed = math::max(-dot(n, wh), F::zero());
    // To the surface, also out of it where it came to be inside.
    V qh = q0 + moment * (w0 + (splat(0.5f) * moment) * a);
    const F sunk = m.gap + dot(n, qh - q0);
    qh = qh - sunk * n;

    F share = splat(1);
    const F mass = splat(d.mass) * scale * scale * scale;
    if (s.inverse_mass > 0) {
      const V arm = p1 - splat(s.center), about = cross(arm, turn(s.turn1, n));
      const F give = splat(s.inverse_mass) + dot(about, turn(s.inverse_inertia, about));
      share = splat(1) / (splat(1) + mass * give);
    }
    // What gravity gives in a step is no impact: it rests.
    const F weight = math::max(-dot(n, g), F::zero());
    const M bounces = (speed > splat(d.dt) * weight) & (speed > splat(1e-4f)) & (splat(s.restitution) > F::zero());
    const F push = math::select(bounces, (splat(1) + splat(s.restitution)) * speed, speed) * share;
    const V slide = wh + speed * n;  // along the surface, where it approaches
    const V tangent = slide - dot(n, slide) * n;
    const F slip = math::sqrt(dot(tangent, tangent));
    const F grip = math::min(slip * share, splat(s.friction) * push);
    const V after = wh + push * n - (grip / math::max(slip, splat(1e-12f))) * tangent;
    // Free flight for the rest of the step …
    V end_w = after + rest * g;
    V end_q = qh + rest * (after + (splat(0.5f) * rest) * g);
    // … unless that leads back into the surface: then along it, held by friction.
    const F out = dot(n, after);
    const M lies = !bounces | (dot(n, end_q - qh) < F::zero());
    const V flat = after - out * n;
    const V free = flat + rest * (g - dot(n, g) * n);
    const F slip1 = math::sqrt(dot(free, free));
    const F grip1 = math::min(slip1, splat(s.friction) * rest * weight);
    // A light body is still being caught up with after the blow.
    const F lift = math::max(out + rest * dot(n, g), math::min(out, F::zero()));
    const V along = free - (grip1 / math::max(slip1, splat(1e-12f))) * free;
    end_w = select(lies, along + lift * n, end_w);
    end_q = select(lies, qh + (splat(0.5f) * rest) * (flat + along + lift * n), end_q);
    if (s.answer != Answer::bounce) {
      end_w = {F::zero(), F::zero(), F::zero()};
      end_q = qh;
    }

    const V new_v = select(m.hit, turn(s.turn1, end_w) + u, v1);
    const V new_p = select(m.hit, turn(s.turn1, end_q) + center1, p1);
    store(new_p, arrays.position, i);
    store(new_v, arrays.velocity, i);
    const V new_start = select(m.hit, turn(s.turn1, qh) + center1, p0), new_way = new_p - new_start;
    store(new_start, path.start, k);
    (radius + math::sqrt(dot(new_way, new_way))).store(path.reach + k);
    store(select(m.hit, turn(s.turn1, after) + u, v0), path.speed, k);
    math::select(m.hit, rest, left).store(path.left + k);
    if (s.answer == Answer::kill) math::select(m.hit, splat(d.now), F::load(arrays.death + i)).store(arrays.death + i);
    if (s.answer == Answer::stick && arrays.held != nullptr && !s.moves)
      math::select(m.hit, splat(1), F::load(arrays.held + i)).store(arrays.held + i);

    std::uint32_t bits = math::bitmask(m.hit);
    if (i + width > count) bits &= (1u << (count > i ? count - i : 0)) - 1u;  // behind the last there is none
    touched += __builtin_popcount(bits);
    if (hits.room == 0 && hits.exchanged == nullptr) continue;
    const V toward = turn(s.turn1, n);
    for (; bits != 0; bits &= bits - 1) {
      const int lane = __builtin_ctz(bits);
      if (hits.count < hits.room && speed[lane] > hits.slowest)
        hits.hits[hits.count++] = {i + lane, {toward.x[lane], toward.y[lane], toward.z[lane]}, speed[lane]};
      if (hits.exchanged == nullptr) continue;
      const double m_i = mass[lane];
      const double jx = m_i * (double(new_v.x[lane]) - double(v1.x[lane]));
      const double jy = m_i * (double(new_v.y[lane]) - double(v1.y[lane]));
      const double jz = m_i * (double(new_v.z[lane]) - double(v1.z[lane]));
      const double rx = double(p1.x[lane]) - s.center[0], ry = double(p1.y[lane]) - s.center[1],
                   rz = double(p1.z[lane]) - s.center[2];
      hits.exchanged[0] += jx;
      hits.exchanged[1] += jy;
      hits.exchanged[2] += jz;
      hits.exchanged[3] += ry * jz - rz * jy;
      hits.exchanged[4] += rz * jx - rx * jz;
      hits.exchanged[5] += rx * jy - ry * jx;
    }
  }
  return touched;
}

template <Form form>
CAROM_SIMD_INLINE void near_form(const CollideData& d, const SurfaceData& s, const Arrays& arrays, float margin,
                                 int from, int to, Path& path) {
  const V center = splat(s.place0);
  for (int i = from; i < to; i += width) {
    const int k = i - from;
    const F scale = arrays.scale != nullptr ? F::load(arrays.scale + i) : splat(1);
    const F radius = splat(d.radius) * scale;
    const V off = load(arrays.position, i) - center;
    M near = M::all();
    if (s.reach < far_gap) {
      const F reach = splat(s.reach + margin) + radius;
      near = dot(off, off) < reach * reach;
    }
    if (!math::any(near)) {
      splat(far_gap).store(path.gap + k);
      continue;
    }
    const Closest c = closest<form>(s, turn_back(s.turn0, off));
    math::select(near, c.gap - radius, splat(far_gap)).store(path.gap + k);
    store(turn(s.turn0, c.normal), path.normal, k);
  }
}

void find_near(const CollideData& d, const SurfaceData& s, const Arrays& arrays, float margin, int from, int to,
               Path& path) {
  switch (s.form) {
    case Form::plane:
      return near_form<Form::plane>(d, s, arrays, margin, from, to, path);
    case Form::sphere:
      return near_form<Form::sphere>(d, s, arrays, margin, from, to, path);
    case Form::capsule:
      return near_form<Form::capsule>(d, s, arrays, margin, from, to, path);
    case Form::box:
      return near_form<Form::box>(d, s, arrays, margin, from, to, path);
    case Form::cylinder:
      return near_form<Form::cylinder>(d, s, arrays, margin, from, to, path);
    case Form::hull:
      return near_form<Form::hull>(d, s, arrays, margin, from, to, path);
    case Form::height_field:
      return near_form<Form::height_field>(d, s, arrays, margin, from, to, path);
    case Form::given:
      break;  // cast one by one, by the caller
  }
}

int collide(const CollideData& d, const SurfaceData& s, const Arrays& arrays, int from, int to, int count, Path& path,
            HitList& hits) {
  switch (s.form) {
    case Form::plane:
      return collide_form<Form::plane>(d, s, arrays, from, to, count, path, hits);
    case Form::sphere:
      return collide_form<Form::sphere>(d, s, arrays, from, to, count, path, hits);
    case Form::capsule:
      return collide_form<Form::capsule>(d, s, arrays, from, to, count, path, hits);
    case Form::box:
      return collide_form<Form::box>(d, s, arrays, from, to, count, path, hits);
    case Form::cylinder:
      return collide_form<Form::cylinder>(d, s, arrays, from, to, count, path, hits);
    case Form::hull:
      return collide_form<Form::hull>(d, s, arrays, from, to, count, path, hits);
    case Form::height_field:
      return collide_form<Form::height_field>(d, s, arrays, from, to, count, path, hits);
    case Form::given:
      return collide_form<Form::given>(d, s, arrays, from, to, count, path, hits);
  }
  return 0;
}

}  // namespace carom::particles::detail::CAROM_PARTICLE_NAMESPACE
