#include <algorithm>

#include "apps/host/demos/billiards/table_view.h"
#include "carom/geometry/hull.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {

using rigid::Dim3;
using sports::BallPhase;
using sports::Billiards;
using sports::BilliardState;

namespace {

constexpr std::uint32_t ivory = 0xf6f1e3;

/// A belt or a cap of a ball, a hair above it: between two latitudes (rad).
geometry::Shape3 ball_patch(Stage3& stage, double radius, double from, double to) {
  std::vector<Vec3f> points;
  constexpr int around = 32, rings = 7;
  for (int ring = 0; ring < rings; ++ring) {
    const double latitude = from + (to - from) * ring / (rings - 1);
    if (latitude > 1.57) {
      points.push_back({0, float(radius), 0});
      break;
    }
    const SinCos<double> l = sincos(latitude);
    for (int i = 0; i < around; ++i) {
      const SinCos<double> s = sincos(2 * pi * i / around);
      points.emplace_back(float(radius * l.cos * s.cos), float(radius * l.sin), float(radius * l.cos * s.sin));
    }
  }
  return stage.keep(geometry::make_hull(points, {.max_vertices = 255}));
}

}  // namespace

std::vector<BallBodies::Look> BallBodies::pool() {
  constexpr std::uint32_t colors[8] = {0xf2c21b, 0x1f4fa8, 0xd0342c, 0x5b2d86, 0xee7a1c, 0x1c7d45, 0x8a1f2d, 0x161616};
  std::vector<Look> looks = {{ivory, Kind::plain}};
  for (int i = 0; i < 15; ++i) looks.push_back({colors[i < 8 ? i : i - 8], i < 8 ? Kind::solid : Kind::stripe});
  return looks;
}
std::vector<BallBodies::Look> BallBodies::snooker() {
  std::vector<Look> looks;
  for (const std::uint32_t c : {ivory, 0xf2c21bu, 0x1c7d45u, 0x6b3f22u, 0x1f4fa8u, 0xf08aa8u, 0x161616u})
    looks.push_back({c, Kind::plain});
  looks.resize(22, {0xb0202a, Kind::plain});
  return looks;
}
std::vector<BallBodies::Look> BallBodies::carom() {
  return {{ivory, Kind::solid}, {0xf2c21b, Kind::solid}, {0xc02a2a, Kind::solid}};
}
std::vector<BallBodies::Look> BallBodies::russian() {
  std::vector<Look> looks(16, {ivory, Kind::solid});
  looks[0] = {0x9a5a1e, Kind::solid};
  return looks;
}

void BallBodies::reset() {
  for (Quatd& q : turned_) q = {};
}

void BallBodies::add(Stage3& stage, const Billiards& game, const std::vector<Look>& looks) {
  stage.looks_in_materials = true;
  const float r = float(game.physics().ball.radius);
  const geometry::Shape3 belt = ball_patch(stage, 1.012 * r, -0.5, 0.5), cap = ball_patch(stage, 1.006 * r, 1.2, 1.6);
  bodies_.clear();
  for (int i = 0; i < game.balls(); ++i) {
    const Look look = looks[std::min(std::size_t(i), looks.size() - 1)];
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::kinematic;
    const std::string name = i == 0 ? "cue ball" : "ball " + std::to_string(i);
    body.name = name;
    body.position = game.state(i).position;
    const auto id = stage.keep(stage.world().create_body(body));
    const auto shape = [&](const geometry::Shape3& form, std::uint32_t color, bool flipped = false) {
      rigid::ShapeDef<Dim3> d;
      d.filter.mask = 0;
      d.material.user_id = 0xff000000u | color;
      if (flipped) d.local.q = {0, 1, 0, 0};
      if (const auto made = stage.world().add_shape(id, form, d); !made.ok()) stage.fail(made.error());
    };
    shape(geometry::Sphere{r}, look.kind == Kind::stripe ? ivory : look.color);
    if (look.kind == Kind::stripe) shape(belt, look.color);
    if (look.kind == Kind::solid) {
      const std::uint32_t spot = look.color == ivory ? 0x2a5aa0 : ivory;
      shape(cap, spot);
      shape(cap, spot, true);
    }
    stage.adopt(id, look.color);
    bodies_.push_back(id);
  }
  turned_.assign(bodies_.size(), {});
  // Nobody places balls with their spots upward.
  for (std::size_t i = 0; i < turned_.size(); ++i)
    turned_[i] =
        from_axis_angle(normalize(Vec3d{sin(2.0 * double(i)), 0.3, cos(3.0 * double(i))}), 0.9 + 0.4 * double(i));
  shown_.assign(bodies_.size(), {});
  // What has fallen lies on the floor in front of the table.
  for (const sports::TableCorner& c : game.table().definition().outline) tray_ = max(tray_, c.point.y + 0.45);
  show(stage, game, game.time(), 0);
}

void BallBodies::show(Stage3& stage, const Billiards& game, double time, double dt) {
  const double r = game.physics().ball.radius;
  int fallen = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BilliardState s = game.state(int(i), time);
    const double turn = length(s.angular_velocity) * dt;
    if (turn > 1e-9) turned_[i] = normalize(from_axis_angle(normalize(s.angular_velocity), turn) * turned_[i]);
    Vec3d p = s.position;
    if (s.phase == BallPhase::pocketed) {
      // It goes on to the pocket's middle and drops; then it lies in the tray beside the table.
      const double since = time - game.path(int(i)).back().start;
      const sports::TablePocket& pocket = game.table().pockets()[std::size_t(game.pocket_of(int(i)))];
      const double way = min(1.0, since / 0.12);
      p = {p.x + way * (pocket.center.x - p.x), r - 4.9 * since * since, p.z + way * (pocket.center.y - p.z)};
      if (p.y < -0.4) p = {-0.5 + 2.4 * r * fallen, -0.8 + r, tray_};
      ++fallen;
    } else if (s.phase == BallPhase::off_table) {
      p.y = -0.8 + r;
    }
    shown_[i] = p;
    stage.check(stage.world().set_pose(bodies_[i], p, Quatf(turned_[i])));
  }
}

void CueBody::add(Stage3& stage) {
  rigid::BodyDef<Dim3> body;
  body.type = rigid::BodyType::kinematic;
  body.name = "cue";
  body_ = stage.keep(stage.world().create_body(body));
  const auto part = [&](double from, double to, double thin, double thick, std::uint32_t color) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 12; ++i) {
      const SinCos<double> s = sincos(2 * pi * i / 12);
      points.emplace_back(float(thin * s.cos), float(-from), float(thin * s.sin));
      points.emplace_back(float(thick * s.cos), float(-to), float(thick * s.sin));
    }
    rigid::ShapeDef<Dim3> d;
    d.filter.mask = 0;
    d.material.user_id = 0xff000000u | color;
    if (const auto made = stage.world().add_shape(body_, stage.keep(geometry::make_hull(points)), d); !made.ok())
      stage.fail(made.error());
  };
  // The tip is at the origin, the butt down the negative y axis.
  part(0, 0.012, 0.0058, 0.0062, 0x2d6fb5);
  part(0.012, 0.032, 0.0062, 0.0064, 0xf2efe6);
  part(0.032, 0.75, 0.0064, 0.0105, 0xd9b778);
  part(0.75, 1.45, 0.0105, 0.0145, 0x3b2316);
  stage.adopt(body_, sand);
}

void CueBody::aim(Stage3& stage, const Vec3d& ball, double radius, const sports::Stroke& stroke, double back) {
  const SinCos<double> turn = sincos(stroke.direction), rise = sincos(stroke.elevation);
  const Vec3d ahead{turn.cos, 0, -turn.sin}, right{turn.sin, 0, turn.cos};
  const Vec3d along = rise.cos * ahead - Vec3d{0, rise.sin, 0}, up = rise.sin * ahead + Vec3d{0, rise.cos, 0};
  const double deep = sqrt(max(0.0, 1 - stroke.side * stroke.side - stroke.height * stroke.height));
  const Vec3d tip = ball + radius * (stroke.side * right + stroke.height * up - deep * along) - back * along;
  // A little higher at the butt than the stroke says, so as to clear the rail.
  const Vec3d shown = normalize(along - Vec3d{0, stroke.elevation < 0.06 ? 0.06 : 0, 0});
  const Quatd q = shown.y < -0.9999 ? Quatd{0, 1, 0, 0} : normalize(Quatd{1 + shown.y, cross(Vec3d{0, 1, 0}, shown)});
  stage.check(stage.world().set_pose(body_, tip, Quatf(q)));
}

void CueBody::put_away(Stage3& stage, const Vec3d& place) {
  stage.check(stage.world().set_pose(body_, place, from_axis_angle(Vec3f{0, 0, 1}, -float(pi) / 2)));
}

}  // namespace carom::host::demo
