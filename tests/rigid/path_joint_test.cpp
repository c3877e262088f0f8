// Path joints against the mechanics of a bead on a wire: the tautochrone, loop and helix, motors, stops and what they
// say.
#include <cmath>

#include "mechanics_world.h"

namespace carom::rigid::test {
namespace path_joint_test {

template <class D>
class PathJoints : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(PathJoints, Dimensions);

constexpr double g = 9.80665;

template <class D>
WorldDef<D> heavy() {
  WorldDef<D> d;
  d.allow_sleep = false;
  return d;
}
template <class D>
void run(World<D>& world, int steps) {
  for (int i = 0; i < steps; ++i) world.step(frame).value();
}
double magnitude_of(float w) { return std::abs(double(w)); }
double magnitude_of(const Vec3f& w) { return double(math::length(w)); }
template <class D>
double energy(const World<D>& world, BodyId body, double mass, double inertia) {
  const auto s = world.state(body).value();
  const double spin = double(math::length(s.linear_velocity)), turn = double(magnitude_of(s.angular_velocity));
  return 0.5 * mass * spin * spin + 0.5 * inertia * turn * turn + mass * g * s.pose.position.y;
}
/// A cycloid with its cusps up: x = r(θ + sin θ), y = −r cos θ, measured along from its lowest point s = 4r sin(θ/2).
template <class D>
struct Cycloid {
  std::vector<typename D::Vector> points, tangents;
  explicit Cycloid(double r) {
    constexpr int n = 49;
    const double end = 2.9, step = 2 * end / (n - 1);
    for (int i = 0; i < n; ++i) {
      const double a = -end + i * step;
      points.push_back(vec<D>(float(r * (a + std::sin(a))), float(-r * std::cos(a))));
      tangents.push_back(vec<D>(float(r * (1 + std::cos(a)) * step), float(r * std::sin(a) * step)));
    }
  }
};
template <class D>
std::vector<typename D::Vector> circle(double r, int n) {
  std::vector<typename D::Vector> points;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n;
    points.push_back(vec<D>(float(r * std::sin(a)), float(-r * std::cos(a))));
  }
  return points;
}
/// With the tangents of the circle itself.
template <class D>
std::vector<typename D::Vector> circle_tangents(double r, int n) {
  std::vector<typename D::Vector> tangents;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n, way = 2 * M_PI / n * r;
    tangents.push_back(vec<D>(float(way * std::cos(a)), float(way * std::sin(a))));
  }
  return tangents;
}

// Huygens 1673: on a cycloid every swing takes 4π√(r/g), however wide.
TYPED_TEST(PathJoints, CycloidIsATautochrone) {
  using D = TypeParam;
  const double r = 0.5, period = 4 * M_PI * std::sqrt(r / g);
  const Cycloid<D> wire(r);
  for (const double a : {0.4, 1.2, 2.2}) {
    World<D> world(heavy<D>());
    PathJointDef<D> def;
    def.body_b = add_mass(world, r * (a + std::sin(a)), -r * std::cos(a), 2, 0.3);
    def.points = wire.points;
    def.tangents = wire.tangents;
    const JointId joint = world.create_joint(def).value();
    const double middle = double(world.joint_state(joint).value().coordinate) - 4 * r * std::sin(a / 2);
    double before = 1, t = 0, first = 0, last = 0;
    int rises = 0;
    const double begin = energy(world, def.body_b, 2, 0.3);
    for (int i = 0; i < 1200; ++i) {
      world.step(frame).value();
      t += double(frame);
      const double s = double(world.joint_state(joint).value().coordinate) - middle;
      if (before < 0 && s >= 0) {
        last = t - double(frame) * s / (s - before);
        if (rises++ == 0) first = last;
      }
      before = s;
      ASSERT_LT(world.joint_state(joint).value().linear_error, 1e-3f);
    }
    EXPECT_NEAR((last - first) / (rises - 1), period, 2e-3 * period) << "from θ " << a;
    const double depth = 2 * g * r * (1 - std::cos(a));
    EXPECT_NEAR(energy(world, def.body_b, 2, 0.3), begin, 0.01 * depth) << "from θ " << a;
  }
}

// Thrown from below at √(5gr) a bead passes the top at √(gr) without a force; below it is held with 6mg.
TYPED_TEST(PathJoints, LoopTheLoop) {
  using D = TypeParam;
  const double r = 1;
  World<D> world(heavy<D>());
  const auto points = circle<D>(r, 24), tangents = circle_tangents<D>(r, 24);
  PathJointDef<D> def;
  def.body_b = add_mass(world, 0, -r, 1, 0.1);
  def.points = points;
  def.tangents = tangents;
  def.closed = true;
  const JointId joint = world.create_joint(def).value();
  EXPECT_NEAR(double(world.joint_state(joint).value().coordinate), 0, 1e-3);
  world.set_velocity(def.body_b, vec<D>(float(std::sqrt(5 * g * r)), 0), {}).value();
  run(world, 1);
  EXPECT_NEAR(double(world.joint_state(joint).value().force.y), 6 * g, 0.02 * 6 * g);
  double highest = -1, speed = 0, force = 0;
  for (int i = 0; i < 40; ++i) {
    run(world, 1);
    const auto s = world.state(def.body_b).value();
    if (s.pose.position.y <= highest) break;
    highest = s.pose.position.y;
    speed = double(math::length(s.linear_velocity));
    force = double(math::length(world.joint_state(joint).value().force));
  }
  EXPECT_GT(highest, 0.98 * r);
  EXPECT_NEAR(speed, std::sqrt(g * r + 2 * g * (r - highest)), 0.01 * speed);
  EXPECT_NEAR(force, 3 * g * (r - highest) / r, 0.15 * g);
  // Round and round: nothing is lost in a minute.
  run(world, 3600);
  EXPECT_NEAR(energy(world, def.body_b, 1, 0.1), 1.5 * g * r, 0.01 * 2.5 * g * r);
}

// On a helix of slope α a bead slides at g sin α.
TEST(PathJoints3, HelixIsAnIncline) {
  World3 world(heavy<Dim3>());
  const double r = 2, rise = 1, turns = 4;  // m a turn
  std::vector<Vec3f> points, tangents;
  const int n = 97;
  for (int i = 0; i < n; ++i) {
    const double u = turns * (n - 1 - i) / (n - 1), a = 2 * M_PI * u, way = -turns / (n - 1);
    points.push_back({float(r * std::cos(a)), float(rise * u), float(r * std::sin(a))});
    tangents.push_back(
        {float(-2 * M_PI * r * std::sin(a) * way), float(rise * way), float(2 * M_PI * r * std::cos(a) * way)});
  }
  PathJointDef<Dim3> def;
  BodyDef<Dim3> body;
  body.position = Vec3d(points[0]);
  def.body_b = add_mass<Dim3>(world, body, 1, 0.1);
  def.points = points;
  def.tangents = tangents;
  const JointId joint = world.create_joint(def).value();
  run(world, 300);
  const double slope = rise / std::sqrt(rise * rise + 4 * M_PI * M_PI * r * r), t = 300 * double(frame);
  const JointState<Dim3> s = world.joint_state(joint).value();
  EXPECT_NEAR(double(s.coordinate), 0.5 * g * slope * t * t, 0.005 * 0.5 * g * slope * t * t);
  EXPECT_NEAR(double(s.speed), g * slope * t, 0.005 * g * slope * t);
  EXPECT_LT(s.linear_error, 1e-3f);
}

TYPED_TEST(PathJoints, EndsAreStops) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  const std::vector<typename D::Vector> points = {vec<D>(0, 0), vec<D>(3, -4), vec<D>(6, -4)};
  PathJointDef<D> def;
  def.body_b = add_mass(world, 0, 0, 2, 0.3);
  def.points = points;
  def.straight = true;
  const JointId joint = world.create_joint(def).value();
  run(world, 40);  // along the first line: g · .8
  const double t = 40 * double(frame);
  EXPECT_NEAR(double(world.joint_state(joint).value().coordinate), 0.5 * 0.8 * g * t * t, 0.02);
  run(world, 600);
  EXPECT_NEAR(world.joint_state(joint).value().coordinate, 8, 0.02f) << "around the corner and to the end";
  EXPECT_NEAR(world.joint_state(joint).value().speed, 0, 1e-3f);
  EXPECT_NEAR(double(world.joint_state(joint).value().force.y), 2 * g, 0.05);
}

TYPED_TEST(PathJoints, MotorSpringLimitAndFriction) {
  using D = TypeParam;
  const auto points = circle<D>(1, 12);
  PathJointDef<D> def;
  def.points = points;
  def.closed = true;
  {  // 2 m/s with 3 N: 2 kg take 4/3 s
    World<D> world(weightless<D>());
    def.body_b = add_mass(world, 0, -1, 2, 0.3);
    def.motor = {true, 2, 3};
    const JointId joint = world.create_joint(def).value();
    run(world, 40);
    EXPECT_NEAR(world.joint_state(joint).value().speed, 1.0f, 0.01f);
    run(world, 60);
    EXPECT_NEAR(world.joint_state(joint).value().speed, 2.0f, 0.01f);
    def.motor = {};
  }
  {  // a position: the shorter way round
    World<D> world(weightless<D>());
    def.body_b = add_mass(world, 0, -1, 2, 0.3);
    def.spring = {2, 1};
    def.target_distance = 5;  // of 2π
    const JointId joint = world.create_joint(def).value();
    run(world, 5);
    EXPECT_LT(world.joint_state(joint).value().speed, 0.0f);
    run(world, 300);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 5, 2e-3f);
    def.spring = {};
  }
  {  // friction of 3 N stops 2 kg at 1 m/s within m v²/2F
    World<D> world(weightless<D>());
    BodyDef<D> body;
    body.position = pos<D>(0, -1);
    body.linear_velocity = vec<D>(1, 0);
    def.body_b = add_mass<D>(world, body, 2, 0.3);
    def.friction = 3;
    const JointId joint = world.create_joint(def).value();
    run(world, 120);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 1.0f / 3, 0.01f);
    EXPECT_NEAR(world.joint_state(joint).value().speed, 0, 1e-4f);
    def.friction = 0;
  }
  {  // limits of an open path, changed later
    World<D> world(heavy<D>());
    const std::vector<typename D::Vector> line = {vec<D>(0, 0), vec<D>(0, -5)};
    PathJointDef<D> lift;
    lift.body_b = add_mass(world, 0, 0, 2, 0.3);
    lift.points = line;
    lift.limit = {true, 0, 1};
    const JointId joint = world.create_joint(lift).value();
    run(world, 120);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 1, 0.01f);
    world.set_limit(joint, {true, 0, 2}).value();
    run(world, 120);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 2, 0.01f);
    world.set_motor(joint, {true, -0.5f, 100}).value();
    run(world, 120);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 1, 0.02f);
  }
}

// A body that follows turns with the wire: at v on a circle of radius r by v/r, and its energy holds that turning too.
TYPED_TEST(PathJoints, FollowsTheTangent) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  const auto points = circle<D>(1, 24), tangents = circle_tangents<D>(1, 24);
  PathJointDef<D> def;
  def.body_b = add_mass(world, 0, -1, 1, 0.5);
  def.points = points;
  def.tangents = tangents;
  def.closed = true;
  def.follow = true;
  const JointId joint = world.create_joint(def).value();
  const double v = 8;
  world.set_velocity(def.body_b, vec<D>(float(v), 0), about_z<D>(float(v))).value();
  const double begin = energy(world, def.body_b, 1, 0.5);
  for (int i = 0; i < 600; ++i) {
    run(world, 1);
    ASSERT_LT(world.joint_state(joint).value().angular_error, 0.01f);
    ASSERT_LT(world.joint_state(joint).value().linear_error, 2e-3f);
  }
  EXPECT_NEAR(energy(world, def.body_b, 1, 0.5), begin, 0.01 * begin);
  const auto s = world.state(def.body_b).value();
  EXPECT_NEAR(double(z_of(s.angular_velocity)), double(math::length(s.linear_velocity)), 0.02 * v);
}

// The wire on a free body: what one gains the other loses.
TYPED_TEST(PathJoints, WireOnABodyKeepsMomentum) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const auto points = circle<D>(1, 16);
  PathJointDef<D> def;
  def.body_a = add_mass(world, 0, 0, 3, 2);
  BodyDef<D> bead;
  bead.position = pos<D>(0, -1);
  bead.linear_velocity = vec<D>(4, 0);
  def.body_b = add_mass<D>(world, bead, 1, 0.1);
  def.points = points;
  def.closed = true;
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 300; ++i) {
    run(world, 1);
    const auto a = state_of(world, def.body_a), b = state_of(world, def.body_b);
    ASSERT_NEAR(3 * a.linear_velocity.x + b.linear_velocity.x, 4, 1e-3f);
    ASSERT_NEAR(3 * a.linear_velocity.y + b.linear_velocity.y, 0, 1e-3f);
    ASSERT_LT(world.joint_state(joint).value().linear_error, 2e-3f);
  }
  const auto a = state_of(world, def.body_a), b = state_of(world, def.body_b);
  const double kinetic =
      1.5 * double(math::length_squared(a.linear_velocity)) + 0.5 * double(math::length_squared(b.linear_velocity)) +
      std::pow(magnitude_of(a.angular_velocity), 2) + 0.05 * std::pow(magnitude_of(b.angular_velocity), 2);
  EXPECT_NEAR(kinetic, 8, 0.08);
}

TYPED_TEST(PathJoints, BreaksAndIsReadBack) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  const auto points = circle<D>(1, 8);
  PathJointDef<D> def;
  def.points = points;
  def.closed = true;
  def.body_b = add_mass(world, 0, -1, 1, 0.1);
  const JointId first = world.create_joint(def).value();
  def.body_b = add_mass(world, 0, -1, 1, 0.1);
  def.break_force = float(3 * g);
  const JointId weak = world.create_joint(def).value();
  world.set_velocity(def.body_b, vec<D>(float(std::sqrt(5 * g)), 0), {}).value();
  const std::vector<typename D::Vector> line = {vec<D>(0, 5), vec<D>(1, 5), vec<D>(2, 6)};
  PathJointDef<D> other;
  other.points = other.tangents = line;
  other.body_b = add_mass(world, 0, 5, 1, 0.1);
  const JointId last = world.create_joint(other).value();
  run(world, 1);
  EXPECT_FALSE(world.contains(weak)) << "6 mg is more than it bears";
  ASSERT_EQ(world.events().joint_break.size(), 1u);
  EXPECT_GT(math::length(world.events().joint_break[0].force), 3 * float(g));
  run(world, 1);
  for (const auto& [joint, wanted, has_tangents] :
       {std::tuple{first, std::span<const typename D::Vector>(points), false},
        std::tuple{last, std::span<const typename D::Vector>(line), true}}) {
    const AnyJointDef<D> any = world.joint_definition(joint).value();
    const auto& read = std::get<PathJointDef<D>>(any);
    ASSERT_EQ(read.points.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(read.points[i], wanted[i]);
    EXPECT_EQ(read.tangents.size(), has_tangents ? wanted.size() : 0u);
  }
}

TYPED_TEST(PathJoints, GoesThroughASnapshot) {
  using D = TypeParam;
  const auto scene = [](World<D>& world) {
    const auto points = circle<D>(1, 9);
    PathJointDef<D> def;
    def.points = points;
    def.closed = true;
    def.follow = true;
    def.body_b = add_mass(world, 1, 0, 1, 0.1);
    return world.create_joint(def).value();
  };
  World<D> world(heavy<D>());
  scene(world);
  run(world, 30);
  const Snapshot<D> before = world.snapshot();
  run(world, 60);
  const std::uint64_t hash = world.state_hash();
  world.restore(before).value();
  run(world, 60);
  EXPECT_EQ(world.state_hash(), hash);
  World<D> other(heavy<D>());
  other.restore(before).value();
  run(other, 60);
  EXPECT_EQ(other.state_hash(), hash);
}

TYPED_TEST(PathJoints, RefusesWhatIsNoPath) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  const BodyId body = add_mass(world, 0, 0, 1, 0.1);
  const auto message = [&](const auto& change) {
    const std::vector<typename D::Vector> line = {vec<D>(0, 0), vec<D>(1, 0), vec<D>(1, 1)};
    PathJointDef<D> def;
    def.body_b = body;
    def.points = line;
    std::vector<typename D::Vector> room = line;
    change(def, room);
    const auto made = world.create_joint(def);
    return made.ok() ? std::string() : made.error().message;
  };
  using V = std::vector<typename D::Vector>;
  EXPECT_EQ(message([](auto&, V&) {}), "");
  EXPECT_NE(message([](auto& d, V&) { d.points = d.points.first(1); }).find("expected at least 2"), std::string::npos);
  EXPECT_NE(message([](auto& d, V&) { d.closed = true, d.points = d.points.first(2); }).find("at least 3"),
            std::string::npos);
  EXPECT_NE(message([](auto& d, V& v) { v[1] = v[0], d.points = v; }).find("points[0] and points[1] are the same"),
            std::string::npos);
  EXPECT_NE(message([](auto& d, V& v) { v[2].y = NAN, d.points = v; }).find("points[2]"), std::string::npos);
  EXPECT_NE(message([](auto& d, V& v) { v.pop_back(), d.tangents = v; }).find("tangents holds 2"), std::string::npos);
  EXPECT_NE(message([](auto& d, V& v) { d.straight = true, d.tangents = v; }).find("straight"), std::string::npos);
  EXPECT_NE(message([](auto& d, V&) { d.closed = true, d.limit = {true, 0, 1}; }).find("closed"), std::string::npos);
  EXPECT_NE(message([](auto& d, V&) { d.friction = -1; }).find("friction"), std::string::npos);
}

}  // namespace path_joint_test
}  // namespace carom::rigid::test
