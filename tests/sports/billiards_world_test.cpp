// The presets' own shots in a world of rigid bodies: several balls, cushions, pockets, to the last ball at rest.
#include "carom/sports/billiards_world.h"

#include <map>
#include <string>

#include "carom/core/string.h"
#include "carom/rigid/world.h"
#include "tests/sports/billiards_support.h"

namespace billiards_world_test {
using namespace billiards_test;
using rigid::Dim3;

/// Who met whom, in order: "0-1" two balls, "1c" a cushion or jaw, "3p2" ball 3 in pocket 2. Contacts of the same two
/// within a twentieth of a second count once.
class Record {
 public:
  void meet(double time, int a, int b) {
    const std::pair<int, int> pair{math::min(a, b), math::max(a, b)};
    const auto [last, first] = last_.insert({pair, time});
    if (first || time - last->second > .05)
      text_ += b == cushion ? core::text(" ", a, "c") : core::text(" ", pair.first, "-", pair.second);
    last->second = time;
  }
  void fall(int ball, int pocket) { text_ += core::text(" ", ball, "p", pocket); }
  const std::string& text() const { return text_; }
  static constexpr int cushion = 1000;

 private:
  std::map<std::pair<int, int>, double> last_;
  std::string text_;
};

Record record_of(const Billiards& game) {
  using Kind = BilliardEvent::Kind;
  Record record;
  for (const BilliardEvent& e : game.events()) {
    if (e.kind == Kind::ball) record.meet(e.time, e.ball, e.other);
    if (e.kind == Kind::cushion || e.kind == Kind::jaw) record.meet(e.time, e.ball, Record::cushion);
    if (e.kind == Kind::pocket) record.fall(e.ball, e.other);
  }
  return record;
}

/// A table in the rigid-body world as a game would make it: spheres on a box, the cloth's effector, friction between
/// balls by a contact modifier, cushions and pockets after every step.
class RigidTable {
 public:
  RigidTable(const BilliardTable& table, const BilliardPhysics& physics, std::span<const Vec2d> balls, double rate)
      : table_(table), physics_(physics), rate_(rate), world_(definition(physics)) {
    const double r = physics.ball.radius;
    const auto rule = [&](std::uint32_t a, std::uint32_t b, double friction, double restitution, double spinning) {
      const rigid::PairRule pair{.friction = float(friction),
                                 .restitution = float(restitution),
                                 .spinning_resistance = float(spinning)};
      world_.set_pair_rule(a, b, &pair).value();
    };
    rule(ball, ball, physics.balls.friction_floor, physics.balls.restitution, 0);
    rule(ball, bed, physics.cloth.sliding_friction, 0, physics.cloth.spinning_friction);
    add(rigid::BodyType::fixed, geometry::Box{{10, 1, 10}}, {0, -1, 0}, bed);
    for (const Vec2d place : balls) {
      balls_.push_back(add(rigid::BodyType::dynamic, geometry::Sphere{float(r)}, {place.x, r, place.y}, ball));
      world_.add_effector(cloth_effector(physics, balls_.back(), 1 / rate)).value();
      pocket_.push_back(-1);
    }
    world_.set_contact_modifier([c = physics.balls](rigid::ContactModification<Dim3>& contact) {
      if (contact.material_a != ball || contact.material_b != ball) return;
      const math::Vec3f n = contact.normal, v = contact.relative_velocity;
      contact.friction = float(ball_friction(c, length(v - dot(v, n) * n)));
    });
    for (int i = 0; i < int(rate); ++i) world_.step(float(1 / rate)).value();  // they settle into the soft contact
  }

  void set_velocity(int i, const BilliardState& s) {
    world_.set_velocity(balls_[std::size_t(i)], math::Vec3f(s.velocity), math::Vec3f(s.angular_velocity)).value();
  }

  void run(double span) {
    for (int i = 0; i < int(span * rate_ + .5); ++i) step();
  }

  BilliardState state(int i) const {
    const auto s = world_.state(balls_[std::size_t(i)]).value();
    return {s.pose.position, Vec3d(s.linear_velocity), Vec3d(s.angular_velocity), BallPhase::sliding};
  }
  int pocket_of(int i) const { return pocket_[std::size_t(i)]; }
  const Record& record() const { return record_; }

 private:
  enum Kind : std::uint32_t { ball = 1, bed };

  static rigid::WorldDef<Dim3> definition(const BilliardPhysics& physics) {
    rigid::WorldDef<Dim3> def;
    def.gravity = {0, -float(physics.gravity), 0};
    def.restitution_threshold = .02f;
    def.contact_hertz = 144;
    return def;
  }

  rigid::BodyId add(rigid::BodyType type, const Dim3::Shape& shape, Vec3d position, Kind kind) {
    const double r = physics_.ball.radius;
    rigid::BodyDef<Dim3> body;
    body.type = type;
    body.position = position;
    body.bullet = type == rigid::BodyType::dynamic;
    body.sleep_speed = .005f;
    const rigid::BodyId id = world_.create_body(body).value();
    rigid::ShapeDef<Dim3> def;
    def.density = float(physics_.ball.mass / (4. / 3 * math::pi * r * r * r));
    def.material.user_id = kind;
    def.modify_contacts = kind == ball;
    world_.add_shape(id, shape, def).value();
    return id;
  }

  int ball_of(rigid::ShapeId shape) const {
    const rigid::BodyId body = world_.body_of(shape).value();
    return int(std::find(balls_.begin(), balls_.end(), body) - balls_.begin());
  }

  void step() {
    world_.step(float(1 / rate_)).value();
    time_ += 1 / rate_;
    for (const rigid::ContactBeginEvent& e : world_.events().contact_begin)
      if (e.material_a == ball && e.material_b == ball) record_.meet(time_, ball_of(e.shape_a), ball_of(e.shape_b));
    for (int i = 0; i < int(balls_.size()); ++i) {
      if (pocket_of(i) >= 0) continue;
      const rigid::BodyId body = balls_[std::size_t(i)];
      BilliardState s = state(i);
      if (meet_cushions(s, table_, physics_) > 0) {
        world_.set_pose(body, s.position, world_.state(body).value().pose.rotation).value();
        set_velocity(i, s);
        record_.meet(time_, i, Record::cushion);
      }
      if (const int pocket = table_.pocket_at({s.position.x, s.position.z}); pocket >= 0) {
        pocket_[std::size_t(i)] = pocket;
        record_.fall(i, pocket);
        world_.set_enabled(body, false).value();
      }
    }
  }

  const BilliardTable& table_;
  const BilliardPhysics& physics_;
  double rate_, time_ = 0;
  rigid::World<Dim3> world_;
  std::vector<rigid::BodyId> balls_;
  std::vector<int> pocket_;
  Record record_;
};

struct Shot {
  std::vector<Vec2d> balls;
  Stroke stroke;
  double until = 20;  ///< s, after the stroke
};

struct Comparison {
  double apart = 0;  ///< m, of the ball that is farthest from where it should be
  std::string computed, stepped;
};

Comparison compare(const RectangularTable& shape, const BilliardPhysics& physics, const Shot& shot, double rate) {
  Billiards game = make_game(shape, physics);
  EXPECT_TRUE(game.place(shot.balls).ok());
  EXPECT_TRUE(game.strike(0, shot.stroke).ok());
  const BilliardState struck = game.state(0);
  EXPECT_TRUE(game.run(shot.until).ok());
  RigidTable table(game.table(), game.physics(), shot.balls, rate);
  table.set_velocity(0, struck);
  table.run(math::min(shot.until, game.rest_time() + 1));
  Comparison result{0, record_of(game).text(), table.record().text()};
  for (int i = 0; i < game.balls(); ++i) {
    EXPECT_EQ(game.pocket_of(i), table.pocket_of(i)) << "ball " << i;
    if (game.pocket_of(i) >= 0) continue;
    const Vec3d d = table.state(i).position - game.state(i).position;
    result.apart = math::max(result.apart, math::hypot(d.x, d.z));
    if (getenv("SHOW")) std::printf(" %.4f", math::hypot(d.x, d.z));
  }
  if (getenv("SHOW")) std::printf(" | %.4f @%g rest %.2f\n   E%s\n   R%s\n", result.apart, rate, game.rest_time(), result.computed.c_str(), result.stepped.c_str());
  return result;
}

TEST(BilliardsWorld, Explore) {
  for (int snooker : {0, 1}) {
    const auto shape = snooker ? snooker_table() : nine_foot_pool();
    const auto p = snooker ? snooker_physics() : pool_physics();
    const double s = snooker ? 1.3 : 1;
  struct S{ const char* n; std::vector<Vec2d> at; Stroke st; };
  std::vector<S> shots={
   {"alone",{{-.6,-.2}},{.direction=.5,.speed=1.2,.side=.3}},
   {"row",{{-.6,-.2},{-.3,-.23},{-.16,-.03},{.05,-.26}},{.direction=0,.speed=1.2}},
   {"line",{{-.6,.1},{-.2,.1},{0.,.11},{.2,.1}},{.direction=0,.speed=1.5}},
   {"follow",{{-.6,.1},{-.3,.1},{.1,.115},{.3,.3}},{.direction=0,.speed=1.6,.height=.4}},
   {"draw",{{-.4,.2},{-.1,.205},{-.75,.215}},{.direction=0,.speed=1.6,.height=-.45}},
   {"cushion first",{{-.6,-.2},{.3,-.18},{.5,.1}},{.direction=.85,.speed=1.4}},
   {"english",{{-.6,.3},{-.2,.27},{.2,-.3}},{.direction=.0,.speed=1.5,.side=.3}},
   {"pot",{{.5,.2},{.9,.4},{.2,-.3}},{.direction=-.3,.speed=1.5}},
  };
  for(auto& x:shots){ for(auto& q:x.at) q=s*q; for(double rate:{240.,1000.,4000.}) { std::printf("%s %s",snooker?"snk":"pool",x.n); compare(shape,p,{x.at,x.st},rate); } }
  }
}

}  // namespace billiards_world_test
