// The presets' own shots in a world of rigid bodies: several balls, cushions, pockets, to the last ball at rest.
#include "carom/sports/billiards_world.h"

#include <algorithm>
#include <map>
#include <string>

#include "carom/core/string.h"
#include "carom/rigid/world.h"
#include "tests/sports/billiards_support.h"

namespace billiards_world_test {
using namespace billiards_test;
using rigid::Dim3;

/// Who met whom, in order: "0-1" two balls, "1c" a ball and a cushion or jaw, "3p2" ball 3 in pocket 2. Contacts of the
/// same two in quick succession count once.
class Record {
 public:
  void meet(double time, int a, int b) {
    const std::pair<int, int> pair{math::min(a, b), math::max(a, b)};
    const auto [last, first] = last_.insert({pair, time});
    const bool counts = first || time - last->second > (b == cushion ? .25 : .05);
    last->second = time;
    if (!counts) return;
    if (b == cushion)
      all_ += core::text(" ", a, "c");
    else
      add(core::text(" ", pair.first, "-", pair.second));
  }
  void fall(int ball, int pocket) { add(core::text(" ", ball, "p", pocket)); }
  const std::string& all() const { return all_; }
  const std::string& without_cushions() const { return balls_; }
  static constexpr int cushion = 1000;

 private:
  void add(const std::string& what) {
    all_ += what;
    balls_ += what;
  }
  std::map<std::pair<int, int>, double> last_;
  std::string all_, balls_;
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

enum class Cushions { by_law, by_contact };

/// A table in the rigid-body world as a game would make it: spheres on a box, the cloth's effector, friction between
/// balls by a contact modifier, pockets after every step. Cushions by their law after every step, or as plates at the
/// height of the nose.
class RigidTable {
 public:
  RigidTable(const BilliardTable& table, const BilliardPhysics& physics, std::span<const Vec2d> balls, double rate,
             Cushions cushions = Cushions::by_law)
      : table_(table), physics_(physics), cushions_(cushions), rate_(rate), world_(definition(physics)) {
    const double r = physics.ball.radius;
    const auto rule = [&](std::uint32_t a, std::uint32_t b, double friction, double restitution, double spinning) {
      const rigid::PairRule pair{
          .friction = float(friction), .restitution = float(restitution), .spinning_resistance = float(spinning)};
      world_.set_pair_rule(a, b, &pair).value();
    };
    rule(ball, ball, physics.balls.friction_floor, physics.balls.restitution, 0);
    rule(ball, bed, physics.cloth.sliding_friction, 0, physics.cloth.spinning_friction);
    add(rigid::BodyType::fixed, geometry::Box{{10, 1, 10}}, {0, -1, 0}, bed);
    if (cushions == Cushions::by_contact) add_plates(rule);
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
  enum Kind : std::uint32_t { ball = 1, bed, nose };

  /// The lower edge of each plate is the nose. On the bed the impulse (1 + e) v cos θ of the law leaves a ball with
  /// (1 + e) cos²θ − 1 of its speed; what the world gives back along the contact counts with cos²θ.
  void add_plates(const auto& rule) {
    const double sine = table_.nose_height() / physics_.ball.radius - 1, half = .05;
    rule(ball, nose, physics_.cushion.friction, 1 + physics_.cushion.restitution - 1 / (1 - sine * sine), 0);
    for (const BilliardTable::Edge& e : table_.edges()) {
      const Vec2d middle = e.from + .5 * e.length * e.along - half * e.inward;
      add(rigid::BodyType::fixed, geometry::Box{{float(.5 * e.length), float(half), float(half)}},
          {middle.x, table_.nose_height() + half, middle.y}, nose, math::atan2(-e.along.y, e.along.x));
    }
  }

  static rigid::WorldDef<Dim3> definition(const BilliardPhysics& physics) {
    rigid::WorldDef<Dim3> def;
    def.gravity = {0, -float(physics.gravity), 0};
    def.restitution_threshold = .02f;
    def.contact_hertz = 144;
    return def;
  }

  rigid::BodyId add(rigid::BodyType type, const Dim3::Shape& shape, Vec3d position, Kind kind, double turn = 0) {
    const double r = physics_.ball.radius;
    rigid::BodyDef<Dim3> body;
    body.type = type;
    body.position = position;
    body.rotation = {0, float(math::sin(turn / 2)), 0, float(math::cos(turn / 2))};
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
      if (cushions_ == Cushions::by_law && meet_cushions(s, table_, physics_) > 0) {
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
  Cushions cushions_;
  double rate_, time_ = 0;
  rigid::World<Dim3> world_;
  std::vector<rigid::BodyId> balls_;
  std::vector<int> pocket_;
  Record record_;
};

/// A stroke, and how far (m) any ball may lie at the end from where it should, at the steps of a game and at fine ones.
struct Shot {
  const char* name;
  std::vector<Vec2d> balls;
  Stroke stroke;
  double game, fine;
};
constexpr double game_rate = 240, fine_rate = 1000;  ///< steps a second, of four substeps each

void agree(const RectangularTable& shape, const BilliardPhysics& physics, const Shot& shot, double rate) {
  const bool fine = rate == fine_rate;
  SCOPED_TRACE(core::text(shot.name, fine ? ", fine steps" : ", a game's steps"));
  Billiards game = make_game(shape, physics);
  ASSERT_TRUE(game.place(shot.balls).ok());
  ASSERT_TRUE(game.strike(0, shot.stroke).ok());
  RigidTable table(game.table(), game.physics(), shot.balls, rate);
  table.set_velocity(0, game.state(0));
  ASSERT_TRUE(game.run().ok());
  table.run(game.rest_time() + 1);
  const Record computed = record_of(game);
  if (fine)
    EXPECT_EQ(table.record().all(), computed.all());
  else
    EXPECT_EQ(table.record().without_cushions(), computed.without_cushions());
  for (int i = 0; i < game.balls(); ++i) {
    ASSERT_EQ(table.pocket_of(i), game.pocket_of(i)) << "ball " << i;
    if (game.pocket_of(i) >= 0) continue;
    const Vec3d d = table.state(i).position - game.state(i).position;
    EXPECT_LT(math::hypot(d.x, d.z), fine ? shot.fine : shot.game) << "ball " << i;
    EXPECT_LT(length(table.state(i).velocity), 1e-3) << "ball " << i;
  }
}

// The bounds stand in docs/billiards.md.
TEST(BilliardsWorld, PoolShotsAgreeToRest) {
  const Shot shots[] = {
      {"three cushions with english", {{-.6, -.2}}, {.direction = .5, .speed = 1.2, .side = .3}, .005, .003},
      {"two balls one after the other",
       {{-.6, -.2}, {-.3, -.23}, {-.16, -.03}, {.05, -.26}},
       {.direction = 0, .speed = 1.2},
       .065,
       .06},
      {"three balls in a row, the last in a pocket",
       {{-.6, .1}, {-.2, .1}, {0, .11}, {.2, .1}},
       {.direction = 0, .speed = 1.5},
       .055,
       .035},
      {"follow", {{-.6, .1}, {-.3, .1}, {.1, .115}, {.3, .3}}, {.direction = 0, .speed = 1.6, .height = .4}, .065, .06},
      {"draw", {{-.4, .2}, {-.1, .205}, {-.75, .215}}, {.direction = 0, .speed = 1.6, .height = -.45}, .025, .01},
      {"a cut with english", {{-.6, .3}, {-.2, .27}, {.2, -.3}}, {.direction = 0, .speed = 1.5, .side = .3}, .06, .17},
      {"a cushion first", {{-.6, -.2}, {.3, -.18}, {.5, .1}}, {.direction = .85, .speed = 1.4}, .09, .05},
  };
  for (const Shot& shot : shots)
    for (const double rate : {game_rate, fine_rate}) agree(nine_foot_pool(), pool_physics(), shot, rate);
}

TEST(BilliardsWorld, SnookerShotsAgreeToRest) {
  const Shot shots[] = {
      {"three cushions with english", {{-.78, -.26}}, {.direction = .5, .speed = 1.2, .side = .3}, .005, .003},
      {"a ball, and the cue ball in a pocket",
       {{-.78, -.26}, {-.39, -.299}, {-.208, -.039}},
       {.direction = 0, .speed = 1.2},
       .02,
       .01},
      {"three balls one after the other",
       {{-.78, .13}, {-.26, .13}, {0, .143}, {.26, .13}},
       {.direction = 0, .speed = 1.5},
       .08,
       .02},
      {"follow",
       {{-.78, .13}, {-.39, .13}, {.13, .1495}, {.39, .39}},
       {.direction = 0, .speed = 1.6, .height = .4},
       .09,
       .04},
      {"draw", {{-.52, .26}, {-.13, .2665}, {-.975, .2795}}, {.direction = 0, .speed = 1.6, .height = -.45}, .06, .03},
  };
  for (const Shot& shot : shots)
    for (const double rate : {game_rate, fine_rate}) agree(snooker_table(), snooker_physics(), shot, rate);
}

// A plate at the height of the nose presses the ball on the bed, which rubs meanwhile, and what the world gives back
// comes after that: the laws have no such order of things. The bounds stand in docs/billiards.md.
TEST(BilliardsWorld, NosesAsContactsReboundOtherwise) {
  const BilliardPhysics p = pool_physics();
  const double r = p.ball.radius;
  double slower = 0;
  for (const double speed : {1., 3.})
    for (const double degrees : {0., 40.})
      for (const double roll : {0., 1.}) {
        const math::SinCos<double> way = math::sincos(math::radians(degrees));
        const Vec3d v{speed * way.sin, 0, -speed * way.cos};
        const BilliardState start{{.5, r, -.535}, v, roll * rolling_spin(v, r), BallPhase::sliding};
        Billiards game = make_game(nine_foot_pool(), p);
        const Vec2d place{start.position.x, start.position.z};
        ASSERT_TRUE(game.place(std::span(&place, 1)).ok());
        ASSERT_TRUE(game.set_state(0, start).ok());
        RigidTable table(game.table(), game.physics(), std::span(&place, 1), fine_rate, Cushions::by_contact);
        table.set_velocity(0, start);
        ASSERT_TRUE(game.run(.35).ok());
        table.run(.35);
        ASSERT_EQ(record_of(game).all(), " 0c");
        const Vec3d law = game.state(0).velocity, contact = table.state(0).velocity;
        EXPECT_GT(contact.z, 0);
        const double less = 1 - length(contact) / length(law);
        EXPECT_LT(math::abs(less), .25) << speed << " " << degrees << " " << roll;
        slower = math::max(slower, less);
        const double turned = math::atan2(contact.x, contact.z) - math::atan2(law.x, law.z);
        EXPECT_LT(math::abs(turned), math::radians(12.0)) << speed << " " << degrees << " " << roll;
      }
  EXPECT_GT(slower, .1) << "agrees better than the document says";
}

// How far ahead any other method could foretell a break: what differs grows by four orders until all is at rest.
TEST(BilliardsWorld, BreaksThatBeginApartEndApart) {
  for (const double gap : {0., 2e-4}) {
    const RackOptions rack{.gap = gap, .jitter = gap > 0 ? .5 : 0};
    std::vector<Vec2d> balls = eight_ball_rack(nine_foot_pool(), pool_physics().ball.radius, rack);
    const Stroke stroke{.direction = .01, .speed = 6.5, .height = .1};
    Billiards one = make_game(nine_foot_pool(), pool_physics()), other = one;
    ASSERT_TRUE(one.place(balls).ok());
    balls[0].y += 1e-9;
    ASSERT_TRUE(other.place(balls).ok());
    double apart = 0;
    for (Billiards* game : {&one, &other}) {
      ASSERT_TRUE(game->strike(0, stroke).ok());
      ASSERT_TRUE(game->run().ok());
    }
    for (int i = 0; i < one.balls(); ++i)
      apart = math::max(apart, distance(one.state(i).position, other.state(i).position));
    EXPECT_GT(apart, 2e-6);
    EXPECT_LT(apart, 1e-4);
  }
}

TEST(BilliardsWorld, ClothHoldsBackWhatRolls) {
  const BilliardPhysics p = pool_physics();
  const double r = p.ball.radius, m = p.ball.mass, bed = .8, brake = p.cloth.rolling_friction * p.gravity;
  const auto effector = cloth_effector(p, {}, 1. / 240, bed);
  const auto load = [&](double height, Vec3d velocity, double rolling) {
    rigid::EffectorInput<Dim3> input;
    input.state.center_of_mass = {0, bed + height, 0};
    input.state.linear_velocity = math::Vec3f(velocity);
    input.state.angular_velocity = math::Vec3f(rolling * rolling_spin(velocity, r) + Vec3d{0, 7, 0});
    return effector.model(input);
  };
  const auto rolls = load(r, {0, 0, 2}, 1);
  EXPECT_LT(length(Vec3d(rolls.force) - Vec3d{0, 0, -m * brake}), 1e-7);
  EXPECT_LT(length(Vec3d(rolls.torque) - Vec3d{-.4 * m * r * brake, 0, 0}), 1e-9);
  const auto stops = load(r, {1e-4, 0, 0}, 1);
  EXPECT_NEAR(stops.force.x, -m * 1e-4 * 240, 1e-9) << "it stops within the step";
  for (const auto& none :
       {load(r, {0, 0, 2}, 0), load(r, {0, 0, 2}, 1.2), load(1.1 * r, {0, 0, 2}, 1), load(r, {}, 1)}) {
    EXPECT_EQ(length(none.force), 0);
    EXPECT_EQ(length(none.torque), 0);
  }
}

TEST(BilliardsWorld, CushionsMeetWhatGoesIntoThem) {
  const BilliardPhysics p = pool_physics();
  const BilliardTable table = plain_table(.5, p.ball.radius);
  const double r = p.ball.radius, reach = r * math::sqrt(1 - .28 * .28), late = .002;
  BilliardState struck{{0, r, -.5 + reach}, {1, 0, -2}, {3, 4, 5}, BallPhase::sliding};
  BilliardState s = struck;
  s.position += late * s.velocity;
  EXPECT_NEAR(strike_cushion(struck, {0, .28, -reach / r}, true, p), 2 * reach / r, 1e-12);
  EXPECT_NEAR(meet_cushions(s, table, p), 2 * reach / r, 1e-12);
  EXPECT_LT(length(s.velocity - struck.velocity), 1e-12);
  EXPECT_LT(length(s.angular_velocity - struck.angular_velocity), 1e-12);
  EXPECT_LT(length(s.position - (struck.position + late * struck.velocity)), 1e-12);
  EXPECT_EQ(meet_cushions(s, table, p), 0) << "it leaves";
  s = {{0, r, -.5 + reach + 1e-6}, {1, 0, -2}, {}, BallPhase::sliding};
  EXPECT_EQ(meet_cushions(s, table, p), 0) << "not there yet";
  s.position = {0, 2 * r, -.5};
  EXPECT_EQ(meet_cushions(s, table, p), 0) << "it flies";
  s = {{0, r, -.5}, {1, 0, -2}, {}, BallPhase::pocketed};
  EXPECT_EQ(meet_cushions(s, table, p), 0);
}

}  // namespace billiards_world_test
