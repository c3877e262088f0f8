#include "carom/sports/table.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::sports {

using math::Vec2d;

namespace {

double table_turn(Vec2d a, Vec2d b, Vec2d c) { return cross(b - a, c - b); }

bool chords_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d) {
  const double c1 = cross(b - a, c - a), d1 = cross(b - a, d - a), a1 = cross(d - c, a - c), b1 = cross(d - c, b - c);
  return ((c1 > 0) != (d1 > 0)) && ((a1 > 0) != (b1 > 0));
}

/// Both directions at a corner, and how much of each edge the rounding takes.
struct Rounded {
  Vec2d in{}, out{}, center{};
  double tangent = 0;
  bool reflex = false;
};

Rounded rounded_corner(const std::vector<TableCorner>& outline, std::size_t i) {
  const std::size_t n = outline.size();
  const TableCorner& at = outline[i];
  const TableCorner& before = outline[(i + n - 1) % n];
  Rounded r;
  r.in = normalize(at.point - before.point);
  r.out = normalize(outline[(i + 1) % n].point - at.point);
  const double sine = cross(r.in, r.out), cosine = dot(r.in, r.out);
  r.reflex = sine < 0 && !at.open && !before.open;
  if (!r.reflex || !(at.rounding > 0)) {
    r.center = at.point;
    return r;
  }
  // tan(δ/2) of the turn δ.
  r.tangent = at.rounding * (-sine / (1 + cosine));
  const Vec2d outward{r.in.y, -r.in.x};
  r.center = at.point - r.tangent * r.in + at.rounding * outward;
  return r;
}

double distance_to_edge(const BilliardTable::Edge& e, Vec2d p) {
  const double t = math::clamp(dot(p - e.from, e.along), 0.0, e.length);
  return distance(p, e.from + t * e.along);
}

core::Error table_error(const std::string& what) { return core::Error{"table: " + what}; }

}  // namespace

core::Result<TableDef> make_table(const RectangularTable& t) {
  const struct {
    const char* name;
    double value;
  } fields[] = {{"length", t.length},
                {"width", t.width},
                {"nose_height", t.nose_height},
                {"rail_width", t.rail_width},
                {"corner_mouth", t.corner_mouth},
                {"corner_angle", t.corner_angle},
                {"corner_radius", t.corner_radius},
                {"side_mouth", t.side_mouth},
                {"side_angle", t.side_angle},
                {"side_radius", t.side_radius}};
  for (const auto& field : fields)
    if (!math::is_finite(field.value) || !(field.value > 0))
      return table_error(core::refused(field.name, field.value, "a finite number > 0"));
  for (const double depth : {t.corner_depth, t.side_depth, t.corner_rounding, t.side_rounding})
    if (!math::is_finite(depth)) return table_error("a depth or rounding is not finite");
  if (!(t.corner_angle > math::pi / 2 && t.corner_angle < math::pi) ||
      !(t.side_angle > math::pi / 2 && t.side_angle < math::pi))
    return table_error("the angle between nose and facing must lie between 90 and 180 degrees");
  TableDef d{.nose_height = t.nose_height, .rail_width = t.rail_width};
  const double x = t.length / 2, z = t.width / 2;
  if (!t.pockets) {
    for (const Vec2d p : {Vec2d{-x, -z}, Vec2d{x, -z}, Vec2d{x, z}, Vec2d{-x, z}}) d.outline.push_back({p});
    return d;
  }
  // Round the table: each pocket has its axis outward and the directions of the noses that lead to it.
  const auto add = [&](Vec2d middle, Vec2d outward, Vec2d arriving, Vec2d leaving, double reach, double angle,
                       double depth, double radius, double rounding) -> bool {
    const Vec2d center = middle + depth * outward;
    const math::SinCos<double> turn = math::sincos(math::pi - angle);
    const Vec2d first = middle - reach * arriving, last = middle + reach * leaving;
    const auto facing = [&](Vec2d nose, Vec2d along, double side) {
      const Vec2d way = turn.cos * along + side * turn.sin * perpendicular(along);
      return nose + math::max(0.0, dot(center - nose, way)) * way;
    };
    const Vec2d a = facing(first, arriving, -1), b = facing(last, -leaving, 1);
    d.outline.push_back({first, rounding});
    d.outline.push_back({a, 0, true});
    d.outline.push_back({b});
    d.outline.push_back({last, rounding});
    d.pockets.push_back({center, radius});
    return distance(a, center) < radius && distance(b, center) < radius;
  };
  const double diagonal = math::sqrt(0.5), corner = t.corner_mouth * diagonal, side = t.side_mouth / 2;
  const auto corner_at = [&](Vec2d sign, Vec2d arriving, Vec2d leaving) {
    return add({sign.x * x, sign.y * z}, diagonal * sign, arriving, leaving, corner, t.corner_angle, t.corner_depth,
               t.corner_radius, t.corner_rounding);
  };
  const auto side_at = [&](double sign, Vec2d way) {
    return add({0, sign * z}, {0, sign}, way, way, side, t.side_angle, t.side_depth, t.side_radius, t.side_rounding);
  };
  const Vec2d right{1, 0}, left{-1, 0}, up{0, 1}, down{0, -1};
  const bool covered[] = {corner_at({-1, -1}, down, right), side_at(-1, right), corner_at({1, -1}, right, up),
                          corner_at({1, 1}, up, left),      side_at(1, left),   corner_at({-1, 1}, left, down)};
  for (const bool is : covered)
    if (!is) return table_error("the facings of a pocket do not end within its circle: widen it or make it deeper");
  return d;
}

core::Result<BilliardTable> BilliardTable::create(const RectangularTable& shape) {
  core::Result<TableDef> made = make_table(shape);
  if (!made) return made.error();
  return create(*made);
}

core::Result<BilliardTable> BilliardTable::create(const TableDef& definition) {
  BilliardTable t;
  t.definition_ = definition;
  std::vector<TableCorner>& outline = t.definition_.outline;
  const std::size_t n = outline.size();
  if (n < 3 || n > 256) return table_error(core::refused("outline's number of corners", n, "3 to 256"));
  if (definition.pockets.size() > 64)
    return table_error(core::refused("number of pockets", definition.pockets.size(), "at most 64"));
  for (const double x : {definition.nose_height, definition.rail_width})
    if (!math::is_finite(x) || !(x > 0))
      return table_error(core::refused("nose_height or rail_width", x, "a finite number > 0"));
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_finite(outline[i].point) || !math::is_finite(outline[i].rounding) || outline[i].rounding < 0)
      return table_error(core::text("corner ", i, " is not finite, or its rounding is below 0"));
    if (!(distance(outline[i].point, outline[(i + 1) % n].point) > 1e-6))
      return table_error(core::text("corners ", i, " and ", (i + 1) % n, " are at one point"));
  }
  for (std::size_t i = 0; i < definition.pockets.size(); ++i)
    if (!is_finite(definition.pockets[i].center) || !(definition.pockets[i].radius > 0) ||
        !math::is_finite(definition.pockets[i].radius))
      return table_error(core::text("pocket ", i, " is not finite, or its radius is not above 0"));
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) area += 0.5 * cross(outline[i].point, outline[(i + 1) % n].point);
  if (area < 0) {  // the other way round: edges' flags move with their edges
    std::reverse(outline.begin(), outline.end());
    const bool first = outline[0].open;
    for (std::size_t i = 0; i + 1 < n; ++i) outline[i].open = outline[i + 1].open;
    outline[n - 1].open = first;
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = i + 2; k < n; ++k)
      if ((k + 1) % n != i &&
          chords_cross(outline[i].point, outline[i + 1].point, outline[k].point, outline[(k + 1) % n].point))
        return table_error(core::text("edges ", i, " and ", k, " of the outline cross each other"));

  for (std::size_t i = 0; i < n; ++i) {
    const TableCorner& a = outline[i];
    const TableCorner& b = outline[(i + 1) % n];
    const Rounded from = rounded_corner(outline, i), to = rounded_corner(outline, (i + 1) % n);
    if (a.open) {
      for (const TableCorner* end : {&a, &b})
        if (t.pocket_at(end->point) < 0)
          return table_error(
              core::text("edge ", i, " is open, but no pocket covers its end at corner ", end == &a ? i : (i + 1) % n));
      if (t.pocket_at(a.point) != t.pocket_at(b.point))
        return table_error(core::text("edge ", i, " is open, but its ends lie in different pockets"));
    } else {
      const double whole = distance(a.point, b.point), left = whole - from.tangent - to.tangent;
      if (left < 0) return table_error(core::text("edge ", i, " is too short for the roundings at its ends"));
      Edge e;
      e.along = (b.point - a.point) / whole;
      e.from = a.point + from.tangent * e.along;
      e.length = left;
      e.inward = perpendicular(e.along);
      e.offset = dot(e.inward, a.point);
      t.edges_.push_back(e);
    }
    // A corner that points into the table, or that ends a cushion at a pocket.
    const bool before_open = outline[(i + n - 1) % n].open;
    if (from.reflex)
      t.jaws_.push_back({from.center, a.rounding});
    else if (a.open != before_open || (table_turn(outline[(i + n - 1) % n].point, a.point, b.point) < 0 && !a.open))
      t.jaws_.push_back({a.point, 0});
  }
  const std::vector<TablePocket>& pockets = definition.pockets;
  for (std::size_t i = 0; i < pockets.size(); ++i) {
    Group g;
    g.center = pockets[i].center;
    g.reach = pockets[i].radius;
    g.pocket = int(i);
    t.groups_.push_back(g);
  }
  const auto home = [&](Vec2d a, Vec2d b, double extra) -> Group* {
    for (Group& g : t.groups_) {
      const double far = math::max(distance(a, g.center), distance(b, g.center)) + extra;
      if (far > 3 * pockets[std::size_t(g.pocket)].radius) continue;
      g.reach = math::max(g.reach, far);
      return &g;
    }
    return nullptr;
  };
  for (std::size_t i = 0; i < t.edges_.size(); ++i) {
    const Edge& e = t.edges_[i];
    Group* g = home(e.from, e.from + e.length * e.along, 0);
    (g != nullptr ? g->edges : t.free_edges_).push_back(int(i));
  }
  for (std::size_t i = 0; i < t.jaws_.size(); ++i) {
    Group* g = home(t.jaws_[i].center, t.jaws_[i].center, t.jaws_[i].radius);
    (g != nullptr ? g->jaws : t.free_jaws_).push_back(int(i));
  }
  return t;
}

bool BilliardTable::inside(Vec2d p) const {
  bool in = false;
  const std::vector<TableCorner>& o = definition_.outline;
  for (std::size_t i = 0, k = o.size() - 1; i < o.size(); k = i++) {
    const Vec2d a = o[k].point, b = o[i].point;
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y)) in = !in;
  }
  return in;
}

double BilliardTable::clearance(Vec2d p) const {
  double nearest = 1e300;
  for (const Edge& e : edges_) nearest = math::min(nearest, distance_to_edge(e, p));
  for (const Jaw& j : jaws_) nearest = math::min(nearest, distance(j.center, p) - j.radius);
  return nearest;
}

int BilliardTable::pocket_at(Vec2d p) const {
  for (std::size_t i = 0; i < definition_.pockets.size(); ++i)
    if (distance(p, definition_.pockets[i].center) < definition_.pockets[i].radius) return int(i);
  return -1;
}

std::vector<TableCorner> BilliardTable::drawn_outline(int chords) const {
  std::vector<TableCorner> drawn;
  const std::vector<TableCorner>& o = definition_.outline;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const Rounded r = rounded_corner(o, i);
    if (r.tangent > 0 && chords > 0) {
      const Vec2d start = o[i].point - r.tangent * r.in - r.center;
      const double turn = math::atan2(cross(r.in, r.out), dot(r.in, r.out));
      for (int k = 0; k <= chords; ++k) {
        const math::SinCos<double> s = math::sincos(turn * k / chords);
        drawn.push_back({r.center + Vec2d{s.cos * start.x - s.sin * start.y, s.sin * start.x + s.cos * start.y}, 0,
                         k == chords && o[i].open});
      }
    } else {
      drawn.push_back(o[i]);
    }
  }
  return drawn;
}

RectangularTable seven_foot_pool() { return {}; }
RectangularTable eight_foot_pool() {
  RectangularTable t;
  t.length = 2.2352, t.width = 1.1176;
  return t;
}
RectangularTable nine_foot_pool() {
  RectangularTable t;
  t.length = 2.54, t.width = 1.27;
  return t;
}
RectangularTable snooker_table() {
  RectangularTable t;
  t.length = 3.5445, t.width = 1.7465;
  t.nose_height = 0.64 * 2 * 0.02619375;
  t.corner_mouth = 0.118, t.corner_angle = math::radians(136.0), t.corner_rounding = 0.06;
  t.corner_depth = 0.042, t.corner_radius = 0.058;
  t.side_mouth = 0.128, t.side_angle = math::radians(110.0), t.side_rounding = 0.03;
  t.side_depth = 0.045, t.side_radius = 0.058;
  return t;
}
RectangularTable carom_table() {
  RectangularTable t;
  t.length = 2.84, t.width = 1.42;
  t.nose_height = 0.037;
  t.pockets = false;
  return t;
}
RectangularTable russian_table() {
  RectangularTable t;
  t.length = 3.55, t.width = 1.775;
  t.nose_height = 0.64 * 2 * 0.034;
  t.corner_mouth = 0.0735, t.corner_angle = math::radians(131.0), t.corner_rounding = 0.004;
  t.corner_depth = 0.040, t.corner_radius = 0.045;
  t.side_mouth = 0.083, t.side_angle = math::radians(98.0), t.side_rounding = 0.004;
  t.side_depth = 0.045, t.side_radius = 0.048;
  return t;
}

}  // namespace carom::sports
