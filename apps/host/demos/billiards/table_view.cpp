#include "apps/host/demos/billiards/table_view.h"

#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::host::demo {

using rigid::Dim3;
using sports::BilliardTable;
using sports::TableCorner;

namespace {

struct TableMesh {
  std::vector<Vec3f> corners;
  std::vector<std::uint32_t> indices;

  /// A triangle by its outer side: counterclockwise where it is looked at.
  void triangle(Vec3d a, Vec3d b, Vec3d c) {
    for (const Vec3d p : {a, b, c}) {
      indices.push_back(std::uint32_t(corners.size()));
      corners.emplace_back(p);
    }
  }
  void quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  /// A simple polygon, its area in (x, z) positive, as a level face that looks up: by cutting off ears.
  void level(std::vector<Vec2d> p, double y) {
    const auto up = [&](Vec2d q) { return Vec3d{q.x, y, q.y}; };
    while (p.size() >= 3) {
      const std::size_t n = p.size();
      std::size_t ear = n;
      for (std::size_t i = 0; i < n && ear == n; ++i) {
        const Vec2d a = p[(i + n - 1) % n], b = p[i], c = p[(i + 1) % n];
        if (cross(b - a, c - b) <= 1e-14) continue;
        bool free = true;
        for (std::size_t k = 0; k < n && free; ++k) {
          const Vec2d q = p[k];
          if (q == a || q == b || q == c) continue;
          free = !(cross(b - a, q - a) >= 0 && cross(c - b, q - b) >= 0 && cross(a - c, q - c) >= 0);
        }
        if (free) ear = i;
      }
      if (ear == n) ear = 1 % n;  // only slivers are left
      triangle(up(p[(ear + n - 1) % n]), up(p[(ear + 1) % n]), up(p[ear]));
      p.erase(p.begin() + std::ptrdiff_t(ear));
    }
  }
};

void add_mesh(Stage3& stage, const char* name, const TableMesh& mesh, std::uint32_t color) {
  rigid::BodyDef<Dim3> body;
  // A fixed body would be shown in the grey of what sleeps.
  body.type = rigid::BodyType::kinematic;
  body.allow_sleep = false;
  body.name = name;
  rigid::ShapeDef<Dim3> shape;
  shape.filter.mask = 0;
  stage.add(body, stage.keep(geometry::make_triangle_mesh(mesh.corners, mesh.indices)), shape, color);
}

void add_box(Stage3& stage, const char* name, Vec3d middle, Vec3d half, std::uint32_t color) {
  rigid::BodyDef<Dim3> body;
  body.type = rigid::BodyType::kinematic;
  body.allow_sleep = false;
  body.name = name;
  body.position = middle;
  rigid::ShapeDef<Dim3> shape;
  shape.filter.mask = 0;
  stage.add(body, geometry::Box{Vec3f(half)}, shape, color);
}

/// The points of a pocket's far side, from a to b round its centre, the way round that leads away from `inner`.
std::vector<Vec2d> far_side(Vec2d a, Vec2d b, Vec2d center, double radius, Vec2d inner) {
  const double from = atan2(a.y - center.y, a.x - center.x);
  double turn = atan2(b.y - center.y, b.x - center.x) - from;
  const Vec2d out = normalize(center - inner);
  while (turn < 0) turn += 2 * pi;
  const SinCos<double> middle = sincos(from + turn / 2);
  if (middle.cos * out.x + middle.sin * out.y < 0) turn -= 2 * pi;
  std::vector<Vec2d> points;
  for (int i = 1; i < 14; ++i) {
    const SinCos<double> s = sincos(from + turn * i / 14);
    points.push_back(center + radius * Vec2d{s.cos, s.sin});
  }
  return points;
}

}  // namespace

void add_table(Stage3& stage, const BilliardTable& table, const TableColors& colors) {
  const std::vector<TableCorner> outline = table.drawn_outline(5);
  const std::size_t n = outline.size();
  const double nose = table.nose_height(), rubber = 0.045;
  const auto at = [&](std::size_t i) { return outline[i % n].point; };
  const auto place = [](Vec2d p, double y) { return Vec3d{p.x, y, p.y}; };
  Vec2d low = at(0), high = at(0);
  for (std::size_t i = 0; i < n; ++i) low = min(low, at(i)), high = max(high, at(i));
  // Pockets may lie farther out than any cushion.
  for (const sports::TablePocket& p : table.pockets())
    low = min(low, p.center - Vec2d{p.radius, p.radius}), high = max(high, p.center + Vec2d{p.radius, p.radius});
  const double wood = table.pockets().empty() ? table.definition().rail_width : 0.045;
  low -= Vec2d{wood, wood}, high += Vec2d{wood, wood};
  const Vec2d middle = 0.5 * (low + high);

  TableMesh bed, cushions, frame, holes;
  std::vector<Vec2d> floor, hole;  // hole: of the rail, behind the rubber
  for (std::size_t i = 0; i < n; ++i) {
    floor.push_back(at(i));
    if (outline[i].open) continue;
    const Vec2d way = normalize(at(i + 1) - at(i)), out{way.y, -way.x};
    // The face under the nose recedes.
    const Vec2d back = 0.3 * nose * out;
    cushions.quad(place(at(i + 1), nose), place(at(i), nose), place(at(i) + back, 0), place(at(i + 1) + back, 0));
  }
  bed.level(floor, 0);
  add_mesh(stage, "bed", bed, colors.cloth);

  std::size_t first = n;
  for (std::size_t i = 0; i < n && first == n; ++i)
    if (outline[i].open) first = (i + 1) % n;
  if (first == n) {
    // All the way round.
    for (std::size_t i = 0; i < n; ++i) {
      const auto corner = [&](std::size_t k) {
        const Vec2d in = normalize(at(k) - at(k + n - 1)), out = normalize(at(k + 1) - at(k));
        const Vec2d side = Vec2d{in.y, -in.x} + Vec2d{out.y, -out.x};
        return at(k) + (2 * rubber / dot(side, side)) * side;
      };
      hole.push_back(corner(i));
      cushions.quad(place(at(i), nose), place(at(i + 1), nose), place(corner(i + 1), nose), place(corner(i), nose));
    }
  }
  // From jaw to jaw, as deep as the rubber.
  for (std::size_t k = 0; k < n && first < n;) {
    std::vector<Vec2d> chain;
    std::size_t i = first + k;
    for (; k < n; ++k, ++i) {
      chain.push_back(at(i));
      if (outline[i % n].open) break;
    }
    ++k;
    const Vec2d a = chain.back(), b = at(i + 1);
    const int pocket = table.pocket_at(a);
    if (chain.size() >= 4) {
      const Vec2d way = normalize(chain[chain.size() - 2] - chain[1]), out{way.y, -way.x};
      const auto cut = [&](Vec2d jaw, Vec2d end) {
        const double deep = dot(end - jaw, out);
        return deep > rubber ? jaw + (rubber / deep) * (end - jaw) : end;
      };
      hole.push_back(chain.front());
      chain.front() = cut(chain[1], chain.front());
      chain.back() = cut(chain[chain.size() - 2], chain.back());
      for (const Vec2d end : {chain.front(), chain.back()})
        if (!(hole.back() == end)) hole.push_back(end);
      // The rubber lies on the other side of the nose than the bed.
      cushions.level({chain.rbegin(), chain.rend()}, nose);
    }
    if (!(hole.back() == a)) hole.push_back(a);
    if (pocket < 0) continue;
    const sports::TablePocket& p = table.pockets()[std::size_t(pocket)];
    Vec2d last = a;
    std::vector<Vec2d> round = far_side(a, b, p.center, p.radius, middle);
    for (const Vec2d q : round) hole.push_back(q);
    round.push_back(b);
    for (const Vec2d q : round) {
      holes.quad(place(q, nose), place(last, nose), place(last, -0.07), place(q, -0.07));
      last = q;
    }
  }
  add_mesh(stage, "cushions", cushions, colors.cushion);

  // The rail: the outer rectangle with that hole, joined by one cut.
  std::vector<Vec2d> ring = {low, {high.x, low.y}, high, {low.x, high.y}, low};
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < hole.size(); ++i)
    if (distance(hole[i], low) < distance(hole[nearest], low)) nearest = i;
  for (std::size_t i = 0; i <= hole.size(); ++i) ring.push_back(hole[(nearest + hole.size() - i) % hole.size()]);
  frame.level(ring, nose);
  const Vec2d outer[4] = {low, {high.x, low.y}, high, {low.x, high.y}};
  for (int i = 0; i < 4; ++i) {
    const Vec2d a = outer[i], b = outer[(i + 1) % 4];
    frame.quad(place(a, nose), place(b, nose), place(b, -0.16), place(a, -0.16));
  }
  add_mesh(stage, "rails", frame, colors.wood);
  if (!table.pockets().empty()) {
    for (const sports::TablePocket& p : table.pockets()) {
      std::vector<Vec2d> disc;
      for (int i = 0; i < 28; ++i) {
        const SinCos<double> s = sincos(2 * pi * i / 28);
        disc.push_back(p.center + p.radius * Vec2d{s.cos, s.sin});
      }
      holes.level(disc, 0.0008);
    }
    add_mesh(stage, "pockets", holes, 0x0c0c0e);
  }
  const double x = (high.x - low.x) / 2, z = (high.y - low.y) / 2;
  add_box(stage, "slate", {middle.x, -0.09, middle.y}, {x - 0.004, 0.07, z - 0.004}, colors.wood);
  for (int i = 0; i < 4; ++i)
    add_box(stage, "leg",
            {middle.x + (i % 2 == 0 ? -1 : 1) * (x - 0.2), -0.48, middle.y + (i < 2 ? -1 : 1) * (z - 0.2)},
            {0.07, 0.32, 0.07}, 0x3a2415);
  // Sights: eight parts along the length, four along the width.
  double length = 0, width = 0;
  for (const BilliardTable::Edge& e : table.edges()) {
    if (e.along.x != 0 && e.along.y == 0) width = max(width, 2 * abs(e.offset));
    if (e.along.y != 0 && e.along.x == 0) length = max(length, 2 * abs(e.offset));
  }
  TableMesh sights;
  const auto sight = [&](Vec2d p) {
    if (table.pocket_at(p) >= 0) return;
    for (const sports::TablePocket& pocket : table.pockets())
      if (distance(p, pocket.center) < pocket.radius + 0.02) return;
    std::vector<Vec2d> disc;
    for (int i = 0; i < 10; ++i) {
      const SinCos<double> s = sincos(2 * pi * i / 10);
      disc.push_back(p + 0.007 * Vec2d{s.cos, s.sin});
    }
    sights.level(disc, nose + 0.001);
  };
  for (const double side : {-1.0, 1.0}) {
    for (int i = -3; i <= 3; ++i) sight({length * i / 8, side * (width / 2 + rubber + 0.02)});
    for (int i = -1; i <= 1; ++i) sight({side * (length / 2 + rubber + 0.02), width * i / 4});
  }
  if (!sights.corners.empty()) add_mesh(stage, "sights", sights, 0xe8e2d0);
}

void draw_circle(Stage3& stage, const Vec3d& middle, double radius, std::uint32_t rgba) {
  constexpr int parts = 20;
  for (int i = 0; i < parts; ++i) {
    const SinCos<double> a = sincos(2 * pi * i / parts), b = sincos(2 * pi * (i + 1) / parts);
    stage.line(middle + radius * Vec3d{a.cos, 0, a.sin}, middle + radius * Vec3d{b.cos, 0, b.sin}, rgba);
  }
}

void draw_path(Stage3& stage, const sports::Billiards& game, int ball, double from, double until, std::uint32_t rgba) {
  std::vector<Vec3d> points;
  game.trace(ball, from, until, 0.02, points);
  for (std::size_t i = 1; i < points.size(); ++i) stage.line(points[i - 1], points[i], rgba);
}

void draw_preview(Stage3& stage, const sports::Billiards& game, int cue_ball, const sports::Stroke& stroke,
                  const sports::Cue& cue, int cushions) {
  sports::Billiards trial = game;
  const double start = trial.time();
  if (!trial.strike(cue_ball, stroke, cue)) return;
  // Until the first ball it meets has gone on for a while, or the cue ball alone has met so many cushions.
  int met = -1, touched = 0;
  double end = start + 12, impact = end;
  std::size_t seen = trial.events().size();
  while (trial.next_event_time() < end) {
    if (!trial.run(trial.next_event_time())) return;
    for (; seen < trial.events().size(); ++seen) {
      const sports::BilliardEvent& e = trial.events()[seen];
      using Kind = sports::BilliardEvent::Kind;
      if (e.kind == Kind::ball && met < 0 && (e.ball == cue_ball || e.other == cue_ball)) {
        met = e.ball == cue_ball ? e.other : e.ball;
        impact = e.time;
        end = min(end, impact + 1.2);
      }
      const bool rubber = e.kind == Kind::cushion || e.kind == Kind::jaw;
      if (rubber && e.ball == cue_ball && met < 0 && ++touched > cushions) end = min(end, e.time);
      if ((rubber || e.kind == Kind::pocket) && e.ball == met) end = min(end, e.time);
    }
  }
  draw_path(stage, trial, cue_ball, start, min(impact, trial.time()), pen(0xffffff, 0xd0));
  if (met < 0) return;
  draw_path(stage, trial, cue_ball, impact, end, pen(0xffffff, 0x60));
  draw_path(stage, trial, met, impact, end, pen(gold, 0xf0));
  draw_circle(stage, trial.state(cue_ball, impact).position, game.physics().ball.radius, pen(0xffffff, 0xd0));
}

}  // namespace carom::host::demo
