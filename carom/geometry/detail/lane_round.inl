// A polygon with at most four corners and a circle or a capsule in each lane, or two capsules: part of lane_pairs.inl,
// the same as manifold2_round.cpp.

namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE {

/// As of rounded2.h.
CAROM_SIMD_INLINE Wide2 closest_on_line(const Wide2& a, const Wide2& b, const Wide2& p) {
  const Wide2 d = b - a;
  const F length_squared = dot(d, d);
  const F t = clamp(dot(p - a, d) / length_squared, F::zero(), F::splat(1));
  return select(length_squared > F::zero(), a + d * t, a);
}
CAROM_SIMD_INLINE Point single_contact(const Wide2& a, F ra, const Wide2& b, F rb, const Wide2& n, F d, int feature) {
  return {(a + n * ra + b - n * rb) * F::splat(0.5f), d - ra - rb, Int::splat(feature)};
}
/// Of contacts at one point, in the lanes of `asked`.
CAROM_SIMD_INLINE void over_border(Mask asked, const Wide2& edge_normal, F above, F radius, Answers& out) {
  const Mask over =
      asked & (out.count > Int::zero()) & !(above - radius <= -min(F::splat(0.005f) * radius, F::splat(0.001f)));
  const Mask along = over & (dot(out.normal, edge_normal) > F::splat(0.85f));
  const Mask beside = over & !along & (out.point[0].separation > F::zero());
  out.normal = select(along, edge_normal, Wide2{keep(!beside, out.normal.x), keep(!beside, out.normal.y)});
  out.count = keep(!beside, out.count);
}

/// A polygon and something round in the frame of the polygon, whichever of them is A.
struct RoundLanes : Lanes {
  const Shape2 *quad[width], *round[width];
  Mask of_b;    ///< the polygon is A
  Wide2 place;  ///< of the other
  F turn_c, turn_s;

  CAROM_SIMD_INLINE RoundLanes(const LanePairs& pairs, int first, int count) : Lanes(pairs, first, count) {
    std::int32_t round_b[width];
    for (int i = 0; i < width; ++i) {
      const bool first_is = a[i]->type == ShapeType2::polygon;
      quad[i] = first_is ? a[i] : b[i], round[i] = first_is ? b[i] : a[i];
      round_b[i] = first_is ? 1 : 0;
    }
    of_b = Int::load(round_b) > Int::zero();
    place = select(of_b, p, -rotate_back(c, s, p));
    turn_c = c, turn_s = select(of_b, s, -s);
  }
  /// From the frame of the polygon to that of A; the normal, as it is there.
  CAROM_SIMD_INLINE void seen_from_a(Answers& out) const {
    out.normal = select(of_b, out.normal, rotate(c, s, out.normal));
    for (Point& point : out.point) point.at = select(of_b, point.at, rotate(c, s, point.at) + p);
  }
};

std::uint32_t collide_quad_circles(LanePairs& pairs, int first, int count) {
  const RoundLanes lanes(pairs, first, count);
  const Quads a(lanes.quad);
  float radii[width];
  for (int i = 0; i < width; ++i) radii[i] = lanes.round[i]->circle.radius;
  const F radius = F::load(radii), zero = F::zero();
  const Wide2 p = lanes.place;
  F s[4];
  for (int k = 0; k < 4; ++k) s[k] = (p.x * a.n[k].x + p.y * a.n[k].y) - dot(a.n[k], a.v[k]);
  const F best = max(max(s[0], s[1]), max(s[2], s[3]));
  const Int edge = place_of(s, best);
  const Wide2 normal = pick(a.n, edge);
  const Mask apart = best > a.radius + radius + lanes.margin;

  const Wide2 q = closest_on_line(pick(a.v, edge), pick(a.v, a.next(edge)), p), d = p - q;
  const F d2 = dot(d, d), length = sqrt(d2);
  const Mask at_corner =
      (best > zero) & (d2 > F::splat(1e-12f) * best) & (d2 > best * best * F::splat(1.000001f)) & !apart;
  const F inverse = F::splat(1) / length;
  const Mask has_way = length > F::splat(1e-12f);
  const Wide2 direct = {keep(has_way, d.x * inverse), select(has_way, d.y * inverse, F::splat(1))};
  const Mask far = apart | (at_corner & !(length <= a.radius + radius + lanes.margin));

  Answers out;
  out.kind = lanes.kind, out.edge = lanes.edge;
  out.normal = select(at_corner, direct, normal);
  out.count = keep(!far, Int::splat(1));
  out.point[0] = single_contact(select(at_corner, q, p - normal * best), a.radius, p, radius, out.normal,
                                select(at_corner, length, best), 0);
  out.point[1] = out.point[0];
  over_border(at_corner & (a.radius == zero), normal, best, a.radius + radius, out);
  lanes.seen_from_a(out);
  out.normal = select(lanes.of_b, out.normal, -out.normal);
  store(out, Mask::none(), pairs, first, count);
  return 0;
}

/// The closest points of polygons and lines that lie apart; s[j]: how far the ends of the line are from the edges.
CAROM_SIMD_INLINE F closest(const Quads& a, const Wide2 (&end)[2], const F (&s)[2][4], Wide2& on_a, Wide2& on_line) {
  const F zero = F::zero();
  F least = F::splat(3.4e38f);
  on_a = on_line = {zero, zero};
  for (int j = 0; j < 2; ++j) {
    const F best = max(max(s[j][0], s[j][1]), max(s[j][2], s[j][3]));
    const Int edge = place_of(s[j], best);
    const Wide2 q = closest_on_line(pick(a.v, edge), pick(a.v, a.next(edge)), end[j]), between = q - end[j];
    const F d = dot(between, between);
    const Mask nearer = (best > zero) & (best * best < least) & (d < least);
    least = select(nearer, d, least);
    on_a = select(nearer, q, on_a), on_line = select(nearer, end[j], on_line);
  }
  const Wide2 along = end[1] - end[0];
  const F inverse = F::splat(1) / dot(along, along);
  F t[4], d[4];
  for (int k = 0; k < 4; ++k) {
    const Wide2 w = a.v[k] - end[0];
    t[k] = min(max((w.x * along.x + w.y * along.y) * inverse, zero), F::splat(1));
    const F rx = w.x - t[k] * along.x, ry = w.y - t[k] * along.y;
    d[k] = rx * rx + ry * ry;
  }
  const F corner_distance = least_of(d);
  const Int corner = place_of(d, corner_distance);
  const Mask nearer = corner_distance < least;
  on_a = select(nearer, pick(a.v, corner), on_a);
  on_line = select(nearer, end[0] + along * pick(t, corner), on_line);
  return sqrt(select(nearer, corner_distance, least));
}

std::uint32_t collide_quad_capsules(LanePairs& pairs, int first, int count) {
  const RoundLanes lanes(pairs, first, count);
  const Quads a(lanes.quad);
  float radii[width], halves[width];
  for (int i = 0; i < width; ++i) {
    const Capsule2& capsule = lanes.round[i]->capsule;
    radii[i] = capsule.radius, halves[i] = capsule.half_length;
  }
  const F round = F::load(radii), half_length = F::load(halves), radius = a.radius + round, margin = lanes.margin;
  const F zero = F::zero(), one = F::splat(1);
  const Int first_of_two = Int::splat(1), second_of_two = Int::splat(2);
  const Wide2 half = {(-lanes.turn_s) * half_length, lanes.turn_c * half_length};
  const Wide2 end[2] = {lanes.place - half, lanes.place + half}, line_normal = {lanes.turn_c, lanes.turn_s};

  F s[2][4], both[4], across_of[4];
  for (int k = 0; k < 4; ++k) {
    const F at = dot(a.n[k], a.v[k]);
    across_of[k] = line_normal.x * a.v[k].x + line_normal.y * a.v[k].y;
    for (int j = 0; j < 2; ++j) s[j][k] = (end[j].x * a.n[k].x + end[j].y * a.n[k].y) - at;
    both[k] = min(s[0][k], s[1][k]);
  }
  const F best = max(max(both[0], both[1]), max(both[2], both[3])), level = dot(line_normal, end[0]);
  const Int edge = place_of(both, best);
  const F right = least_of(across_of) - level;
  const F left = level - max(max(across_of[0], across_of[1]), max(across_of[2], across_of[3]));
  const Mask is_left = left > right;
  const F across = select(is_left, left, right);
  const Wide2 outward = select(is_left, -line_normal, line_normal);  // of the capsule
  const Wide2 edge_normal = pick(a.n, edge);

  // `by_line`: the capsule's side is the reference edge; it stays so while nothing else is clearly better.
  const F slack = F::splat(1e-3f) * max(a.size(), zero);
  const F of_second = select(lanes.of_b, across, best), of_first = select(lanes.of_b, best, across);
  const Mask second = of_second > of_first + select(lanes.kind == second_of_two, -slack, slack);
  const Mask by_line = !(second ^ lanes.of_b);
  Answers out;
  out.kind = math::select(second, second_of_two, first_of_two);
  out.edge = math::select(by_line, keep(is_left, first_of_two), edge);
  const Mask apart_best = best - radius > margin, apart_across = across - radius > margin;
  const Wide2 normal = select(by_line, -outward, edge_normal);  // from the polygon
  const F separation = select(by_line, across, best);

  // The part of the one edge beside the other.
  const Wide2 n = select(by_line, outward, edge_normal), t = {-n.y, n.x};
  const Wide2 line_start = select(is_left, end[1], end[0]), line_stop = select(is_left, end[0], end[1]);
  const Wide2 start = select(by_line, line_start, pick(a.v, edge));
  const Wide2 stop = select(by_line, line_stop, pick(a.v, a.next(edge)));
  const Int facing = lowest_along(a.n, outward), lowest = lowest_along(a.v, outward);
  const Mask side_facing = !(dot(edge_normal, line_normal) <= zero);
  const Mask end_lowest = dot(edge_normal, end[1]) < dot(edge_normal, end[0]);
  const IncidentEdges incident = {select(by_line, pick(a.v, a.next(facing)), select(side_facing, end[0], end[1])),
                                  select(by_line, pick(a.v, facing), select(side_facing, end[1], end[0])),
                                  math::select(by_line, facing, keep(side_facing, first_of_two)),
                                  select(by_line, a.radius, round)};
  const DeepestCorners deepest = {select(by_line, pick(a.v, lowest), select(end_lowest, end[1], end[0])),
                                  math::select(by_line, lowest, keep(end_lowest, first_of_two)), separation,
                                  separation - radius};
  clip_edges({n, start, dot(t, stop - start), out.edge, select(by_line, round, a.radius)}, incident, deepest, slack,
             second, margin, out);
  // As if the polygon were A.
  out.normal = normal;

  const Mask asks = separation > F::splat(1e-4f) * slack;
  if (any(asks)) {
    Wide2 on_a, on_line;
    const F d = closest(a, end, s, on_a, on_line);
    const Mask has_way = d > F::splat(1e-6f);
    const Wide2 direct = select(has_way, (on_line - on_a) * (one / d), normal);
    const Mask apart = asks & (d - radius > margin);
    const Mask at_corner = asks & !apart & has_way & (dot(direct, normal) < F::splat(0.9999f));
    const Point point = single_contact(on_a, a.radius, on_line, round, direct, d, 1 << 25);
    out.normal = select(apart | at_corner, direct, out.normal);
    out.count = math::select(at_corner, first_of_two, out.count);
    out.point[0] = select(at_corner, point, out.point[0]);
    over_border(at_corner & !by_line & (a.radius == zero), normal, separation, radius, out);
    out.count = keep(!apart, out.count);
    out.point[0].separation = select(apart, d - radius, out.point[0].separation);
  }
  const Mask apart = apart_best | apart_across;
  out.normal = select(apart, select(apart_best, edge_normal, -outward), out.normal);
  out.count = keep(!apart, out.count);
  out.point[0].separation = select(apart, select(apart_best, best - radius, across - radius), out.point[0].separation);
  out.normal = select(lanes.of_b, out.normal, -out.normal);
  lanes.seen_from_a(out);
  store(out, Mask::none(), pairs, first, count);
  return 0;
}

/// What polygons() of manifold2.cpp finds of two lines of which capsules() does not tell: they cross, or lie along each
/// other. Mask: it is more than that.
CAROM_SIMD_INLINE Mask contacts_of_lines(const Wide2 (&va)[2], const Wide2 (&vb)[2], const Wide2 (&na)[2],
                                         const Wide2 (&nb)[2], F radius_a, F radius_b, F margin, Answers& out) {
  const F radius = radius_a + radius_b;
  const Int one = Int::splat(1), two = Int::splat(2);
  const auto along = [](const Wide2& n, const Wide2& from, const Wide2(&v)[2])
                         __attribute__((always_inline)) { return min(dot(n, v[0]), dot(n, v[1])) - dot(n, from); };
  const F a0 = along(na[0], va[0], vb), a1 = along(na[1], va[1], vb);
  const F b0 = along(nb[0], vb[0], va), b1 = along(nb[1], vb[1], va);
  const F of_a = max(a0, a1), of_b = max(b0, b1);
  const Mask by_b = of_b > of_a, back = select(by_b, b1, a1) > select(by_b, b0, a0);
  const F separation = select(by_b, of_b, of_a);
  const auto side = [&](const Wide2(&v)[2], Mask last)
                        __attribute__((always_inline)) { return select(last, v[1], v[0]); };
  const Wide2 n = select(by_b, side(nb, back), side(na, back)), t = {-n.y, n.x};
  const Wide2 start = select(by_b, side(vb, back), side(va, back));
  const Wide2 stop = select(by_b, side(vb, !back), side(va, !back));
  const Wide2 other[2] = {select(by_b, va[0], vb[0]), select(by_b, va[1], vb[1])};
  const Mask facing = select(by_b, dot(n, na[1]), dot(n, nb[1])) < select(by_b, dot(n, na[0]), dot(n, nb[0]));
  const Mask lowest = dot(n, other[1]) < dot(n, other[0]);
  const F radius_r = select(by_b, radius_b, radius_a), radius_s = select(by_b, radius_a, radius_b);
  out.kind = math::select(by_b, two, one);
  out.edge = keep(back, one);
  clip_edges({n, start, dot(t, stop - start), out.edge, radius_r},
             {side(other, !facing), side(other, facing), keep(facing, one), radius_s},
             {side(other, lowest), keep(lowest, one), separation, separation - radius}, F::zero(), by_b, margin, out);
  return (of_a - radius > margin) | (of_b - radius > margin) | (out.count == Int::zero());
}

std::uint32_t collide_capsules(LanePairs& pairs, int first, int count) {
  const Lanes lanes(pairs, first, count);
  float radii[2][width], halves[2][width];
  for (int i = 0; i < width; ++i) {
    const Capsule2 &a = lanes.a[i]->capsule, &b = lanes.b[i]->capsule;
    radii[0][i] = a.radius, halves[0][i] = a.half_length;
    radii[1][i] = b.radius, halves[1][i] = b.half_length;
  }
  const F zero = F::zero(), one = F::splat(1), margin = lanes.margin;
  const F radius_a = F::load(radii[0]), radius_b = F::load(radii[1]), radius = radius_a + radius_b;
  const F half_a = F::load(halves[0]), half_b = F::load(halves[1]), c = lanes.c, s = lanes.s;
  const Wide2 p = lanes.p, half = {(-s) * half_b, c * half_b}, normal_b = {c, s}, u = {-s, c};
  const Wide2 e[2] = {p - half, p + half};

  // As capsules() of manifold2_round.cpp.
  const F right = min(e[0].x, e[1].x), left = -max(e[0].x, e[1].x), level = dot(normal_b, p);
  const F from = (-half_a) * normal_b.y - level, to = half_a * normal_b.y - level;
  const F above = min(from, to), below = -max(from, to);
  const Mask is_left = left > right, is_below = below > above;
  const F of_a = max(right, left), of_b = max(above, below);
  const Mask second = of_b > of_a;
  const F separation = select(second, of_b, of_a);
  const F length_a = clamp(e[0].y, -half_a, half_a), length_b = clamp(e[1].y, -half_a, half_a);
  const F from_b = clamp(dot(Wide2{zero, -half_a} - p, u), -half_b, half_b);
  const F to_b = clamp(dot(Wide2{zero, half_a} - p, u), -half_b, half_b);
  const Wide2 on[4][2] = {{{zero, -half_a}, p + u * from_b},
                          {{zero, half_a}, p + u * to_b},
                          {{zero, length_a}, e[0]},
                          {{zero, length_b}, e[1]}};
  Wide2 on_a = on[0][0], on_b = on[0][1];
  F least = dot(on_a - on_b, on_a - on_b);
  for (int i = 1; i < 4; ++i) {
    const F d = dot(on[i][0] - on[i][1], on[i][0] - on[i][1]);
    const Mask nearer = d < least;
    least = select(nearer, d, least);
    on_a = select(nearer, on[i][0], on_a), on_b = select(nearer, on[i][1], on_b);
  }
  const F d = sqrt(least);
  const Wide2 direct = (on_b - on_a) * (one / d);
  const F sign = select(is_below, one, -one);
  const Wide2 normal = select(second, normal_b * sign, Wide2{select(is_left, -one, one), zero});
  const Mask uncrossed = separation > F::splat(-1e-5f), has_way = d > F::splat(1e-6f), apart = d - radius > margin;
  const F turned = dot(direct, normal);
  const Mask told = uncrossed & has_way & (apart | !(turned >= F::splat(0.9999f)));

  Answers out;
  out.kind = math::select(second, Int::splat(2), Int::splat(1));
  out.edge = keep((second & is_below) | ((!second) & is_left), Int::splat(1));
  out.normal = direct;
  out.count = keep(!apart, Int::splat(1));
  out.point[0] = single_contact(on_a, radius_a, on_b, radius_b, direct, d, 1 << 25);
  out.point[0].separation = select(apart, d - radius, out.point[0].separation);
  out.point[1] = out.point[0];
  Mask left_alone = Mask::none();
  if (!all(told)) {
    const Wide2 va[2] = {{zero, -half_a}, {zero, half_a}}, na[2] = {{one, zero}, {-one, zero}};
    const Wide2 vb[2] = {rotate(c, s, {zero, -half_b}) + p, rotate(c, s, {zero, half_b}) + p};
    const Wide2 nb[2] = {rotate(c, s, na[0]), rotate(c, s, na[1])};
    Answers beside;
    const Mask more = contacts_of_lines(va, vb, na, nb, radius_a, radius_b, margin, beside);
    // Where rounding might decide between the two, scalars do.
    const Mask narrow = uncrossed & ((turned < F::splat(0.99995f)) | (d < F::splat(0.01f) * radius));
    const Mask hardly = (!uncrossed) & (separation > F::splat(-2e-5f));
    left_alone = (!told) & (more | narrow | hardly);
    out.kind = math::select(told, out.kind, beside.kind), out.edge = math::select(told, out.edge, beside.edge);
    out.normal = select(told, out.normal, beside.normal), out.count = math::select(told, out.count, beside.count);
    for (int k = 0; k < 2; ++k) out.point[k] = select(told, out.point[k], beside.point[k]);
  }
  store(out, left_alone, pairs, first, count);
  return bitmask(left_alone);
}

}  // namespace carom::geometry::detail::CAROM_PAIRS_NAMESPACE
