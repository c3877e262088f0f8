// World queries against a search through all shapes.
#include "carom/math/elementary.h"
#include "mechanics_world.h"

namespace carom::rigid::test {
namespace query_test {

/// A small linear congruential generator: the same scene everywhere.
struct Draw {
  std::uint32_t state = 7;
  float operator()(float low, float high) {
    state = 1664525u * state + 1013904223u;
    return low + (high - low) * float(state >> 8) / 16777216.0f;
  }
};

geometry::Shape2 any_shape(Dim2, int kind, Draw& draw) {
  if (kind == 0) return geometry::Circle{draw(0.1f, 0.5f)};
  if (kind == 1) return geometry::Capsule2{draw(0.1f, 0.5f), draw(0.1f, 0.3f)};
  const float w = draw(0.1f, 0.6f), h = draw(0.1f, 0.6f);
  return geometry::make_box2({w, h});
}
geometry::Shape3 any_shape(Dim3, int kind, Draw& draw) {
  if (kind == 0) return geometry::Sphere{draw(0.1f, 0.5f)};
  if (kind == 1) {
    const float l = draw(0.1f, 0.5f), r = draw(0.1f, 0.3f);
    return geometry::Capsule3{l, r};
  }
  const float x = draw(0.1f, 0.5f), y = draw(0.1f, 0.5f), z = draw(0.1f, 0.5f);
  return geometry::Box{{x, y, z}};
}
Vec2d any_position(Dim2, Draw& draw) {
  const double x = double(draw(-8, 8)), y = double(draw(-8, 8));
  return {x, y};
}
Vec3d any_position(Dim3, Draw& draw) {
  const double x = double(draw(-5, 5)), y = double(draw(-5, 5)), z = double(draw(-5, 5));
  return {x, y, z};
}
Rot2f any_rotation(Dim2, Draw& draw) {
  const float a = draw(-3, 3);
  return {math::cos(a), math::sin(a)};
}
Quatf any_rotation(Dim3, Draw& draw) {
  const float w = draw(-1, 1), x = draw(-1, 1), y = draw(-1, 1), z = draw(-1, 1);
  return normalize(Quatf{w, x, y, z});
}

template <class D>
class Queries : public testing::Test {
 public:
  struct Placed {
    ShapeId id;
    typename D::Shape shape;
    typename D::Pose pose;
    std::uint64_t category;
  };
  typename D::Position origin{};
  WorldDef<D> definition = weightless<D>();
  World<D> world{definition};
  std::vector<Placed> all;
  Draw draw;

  /// 200 shapes with local placements about `origin`, some fixed, in two categories.
  void fill() {
    for (int i = 0; i < 200; ++i) {
      BodyDef<D> body;
      body.type = i % 3 == 0 ? BodyType::fixed : (i % 3 == 1 ? BodyType::kinematic : BodyType::dynamic);
      body.position = origin + any_position(D{}, draw);
      body.rotation = any_rotation(D{}, draw);
      const BodyId id = world.create_body(body).value();
      ShapeDef<D> def;
      def.filter.category = i % 2 == 0 ? 1 : 2;
      def.filter.mask = 4;  // nothing collides, queries of category 4 see all
      def.local.p = typename D::Vector(any_position(D{}, draw)) * 0.1f;
      const typename D::Shape shape = any_shape(D{}, i % 3, draw);
      const ShapeId shape_id = world.add_shape(id, shape, def).value();
      all.push_back({shape_id, shape, typename D::Pose{body.position, body.rotation} * def.local, def.filter.category});
    }
  }
};
template <class D>
bool same(const RayHit<D>& a, const RayHit<D>& b) {
  return a.shape == b.shape && a.fraction == b.fraction && a.point == b.point && a.normal == b.normal &&
         a.child == b.child;
}
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Queries, Dimensions);

template <class D, class Self>
void check_rays(Self& self) {
  for (int k = 0; k < 300; ++k) {
    const auto from = self.origin + any_position(D{}, self.draw) * 2.0;
    const auto way = typename D::Vector(self.origin + any_position(D{}, self.draw) - from) * 1.5f;
    const QueryFilter filter{.category = 4, .mask = k % 2 == 0 ? ~std::uint64_t{0} : 1};
    int hits = 0;
    float first = 1;
    ShapeId shape{};
    for (const auto& s : self.all) {
      if ((s.category & filter.mask) == 0) continue;
      const auto hit = geometry::ray_cast(s.shape, local_point(s.pose, from), inverse_rotate(s.pose.rotation, way));
      if (!hit.hit) continue;
      ++hits;
      if (hit.fraction < first) {
        first = hit.fraction;
        shape = s.id;
      }
    }
    const RayHit<D> found = self.world.ray_cast(from, way, filter).value();
    EXPECT_EQ(found.shape, shape);
    EXPECT_EQ(found.fraction, first);
    if (found.shape) {
      const auto expected = from + typename D::Position(way) * double(found.fraction);
      EXPECT_LT(math::length(found.point - expected), 1e-4);
      EXPECT_LE(dot(found.normal, way), 1e-3f * math::length(way));
    }
    std::vector<RayHit<D>> list;
    self.world.ray_cast_all(from, way, list, filter).value();
    EXPECT_EQ(int(list.size()), hits);
    for (std::size_t i = 1; i < list.size(); ++i) EXPECT_LE(list[i - 1].fraction, list[i].fraction);
  }
}

TYPED_TEST(Queries, RaysAgreeWithBruteForce) {
  this->fill();
  check_rays<TypeParam>(*this);
}
TYPED_TEST(Queries, RaysAgreeWithBruteForceFarFromTheOrigin) {
  this->origin.x = 1e8;
  this->origin.y = -3e7;
  this->fill();
  check_rays<TypeParam>(*this);
}

TYPED_TEST(Queries, OverlapsAgreeWithBruteForce) {
  using D = TypeParam;
  this->fill();
  for (int k = 0; k < 200; ++k) {
    const typename D::Shape probe = any_shape(D{}, k % 3, this->draw);
    typename D::Pose pose;
    pose.position = any_position(D{}, this->draw);
    pose.rotation = any_rotation(D{}, this->draw);
    std::vector<ShapeId> expected, found;
    for (const auto& s : this->all)
      if (geometry::overlap(s.shape, probe, relative(s.pose, pose))) expected.push_back(s.id);
    this->world.overlap(probe, pose, found).value();
    EXPECT_EQ(found, expected);
  }
}

TYPED_TEST(Queries, BoundsAgreeWithBruteForce) {
  using D = TypeParam;
  this->fill();
  for (int k = 0; k < 200; ++k) {
    const auto a = any_position(D{}, this->draw), b = a + any_position(D{}, this->draw) * 0.2;
    const typename D::Bounds box{min(a, b), max(a, b)};
    std::vector<ShapeId> expected, found;
    for (const auto& s : this->all) {
      const auto local = geometry::bounds(s.shape, typename D::Transform{{}, s.pose.rotation});
      const typename D::Bounds tight{s.pose.position + typename D::Position(local.low),
                                     s.pose.position + typename D::Position(local.high)};
      if (overlaps(tight, box)) expected.push_back(s.id);
    }
    this->world.overlap_bounds(box, found).value();
    EXPECT_EQ(found, expected);
  }
}

TYPED_TEST(Queries, CastsAgreeWithBruteForce) {
  using D = TypeParam;
  this->fill();
  for (int k = 0; k < 150; ++k) {
    const typename D::Shape probe = any_shape(D{}, k % 3, this->draw);
    typename D::Pose pose;
    pose.position = any_position(D{}, this->draw) * 2.0;
    pose.rotation = any_rotation(D{}, this->draw);
    const auto way = typename D::Vector(any_position(D{}, this->draw) - pose.position);
    float first = 1;
    for (const auto& s : this->all) {
      const auto hit =
          geometry::shape_cast(s.shape, probe, relative(s.pose, pose), inverse_rotate(s.pose.rotation, way));
      if (hit.hit) first = math::min(first, hit.fraction);
    }
    EXPECT_EQ(this->world.shape_cast(probe, pose, way).value().fraction, first);
  }
}

/// Two places in the way at the same fraction, and starts inside several shapes, must not make answers depend on the
/// tree that is walked: the first queries walk the world's own trees, later ones the wide copies.
TYPED_TEST(Queries, AnswersStayTheSameHoweverOftenOneAsks) {
  using D = TypeParam;
  this->fill();
  for (int i = 0; i < 4; ++i) {  // twins: the same shape at the same place
    BodyDef<D> body;
    body.type = BodyType::fixed;
    body.position = pos<D>(i / 2, 0);
    const BodyId id = this->world.create_body(body).value();
    this->world.add_shape(id, any_shape(D{}, 2, this->draw), {.filter = {.category = 1, .mask = 4}}).value();
  }
  std::vector<RayQuery<D>> rays;
  for (int k = 0; k < 40; ++k) {
    const auto from = k % 2 == 0 ? pos<D>(0, 0) : any_position(D{}, this->draw);
    rays.push_back({from, typename D::Vector(any_position(D{}, this->draw)), {.category = 4}});
  }
  std::vector<RayHit<D>> first;
  for (int round = 0; round < 20; ++round)
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const auto hit = this->world.ray_cast(rays[k].origin, rays[k].translation, rays[k].filter).value();
      if (round == 0)
        first.push_back(hit);
      else
        ASSERT_TRUE(same(hit, first[k])) << round << " " << k;
    }
  // A plane among many: its box has no end.
  if constexpr (D::dimension == 3) {
    const BodyId ground = this->world.create_body({.type = BodyType::fixed, .position = {0, -40, 0}}).value();
    const ShapeId plane = this->world.add_shape(ground, geometry::Plane{}).value();
    std::vector<ShapeId> found;
    for (int k = 0; k < 400; ++k) {
      ASSERT_EQ(this->world.ray_cast({3, -30, 2}, {1, -20, 0}).value().shape, plane) << k;
      this->world.overlap_bounds({{-1, -42, -1}, {1, -39, 1}}, found).value();
      ASSERT_EQ(found, std::vector<ShapeId>{plane}) << k;
    }
  }
  // Whatever moves is found where it is, by the next query.
  const BodyId mover = this->world.create_body({.type = BodyType::fixed, .position = pos<D>(500, 0)}).value();
  this->world.add_shape(mover, any_shape(D{}, 0, this->draw)).value();
  EXPECT_TRUE(this->world.ray_cast(pos<D>(500, 5), vec<D>(0, -10)).value().shape);
}

TYPED_TEST(Queries, ManyAtOnceAnswerAsOneByOne) {
  using D = TypeParam;
  this->definition.threads = 3;
  this->world = World<D>(this->definition);
  this->fill();
  std::vector<RayQuery<D>> rays;
  std::vector<ShapeCastQuery<D>> casts;
  std::vector<OverlapQuery<D>> places;
  for (int k = 0; k < 333; ++k) {
    const QueryFilter filter{.category = 4, .mask = k % 2 == 0 ? ~std::uint64_t{0} : 1};
    typename D::Pose pose;
    pose.position = any_position(D{}, this->draw);
    pose.rotation = any_rotation(D{}, this->draw);
    const auto way = typename D::Vector(any_position(D{}, this->draw));
    rays.push_back({pose.position, way, filter});
    casts.push_back({pose, way, filter});
    places.push_back({pose, filter});
  }
  const typename D::Shape probe = any_shape(D{}, 2, this->draw);
  std::vector<RayHit<D>> hits(rays.size()), met(casts.size());
  std::vector<ShapeId> found, one;
  std::vector<std::uint32_t> ends(places.size());
  this->world.cast_rays(rays, hits).value();
  this->world.cast_shapes(probe, casts, met).value();
  this->world.overlap_shapes(probe, places, found, ends).value();
  std::size_t begin = 0, touched = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    EXPECT_TRUE(same(hits[k], this->world.ray_cast(rays[k].origin, rays[k].translation, rays[k].filter).value()));
    EXPECT_TRUE(
        same(met[k], this->world.shape_cast(probe, casts[k].pose, casts[k].translation, casts[k].filter).value()));
    this->world.overlap(probe, places[k].pose, one, places[k].filter).value();
    EXPECT_EQ(std::vector<ShapeId>(found.begin() + std::ptrdiff_t(begin), found.begin() + std::ptrdiff_t(ends[k])),
              one);
    begin = ends[k];
    touched += one.size();
  }
  EXPECT_EQ(begin, found.size());
  EXPECT_GT(touched, 50u);
  // What is wrong is named by its number.
  rays[7].translation = vec<D>(__builtin_nanf(""), 0);
  const Status bad = this->world.cast_rays(rays, hits);
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().message.find("ray 7: translation.x"), std::string::npos) << bad.error().message;
  EXPECT_FALSE(this->world.cast_shapes(probe, casts, std::span(met).first(3)).ok());
}

TYPED_TEST(Queries, MovedBodiesAreFoundWhereTheyAre) {
  using D = TypeParam;
  World<D> world(this->definition);
  BodyDef<D> def;
  def.linear_velocity = vec<D>(6, 0);
  const BodyId body = world.create_body(def).value();
  world.add_shape(body, any_shape(D{}, 0, this->draw)).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_TRUE(world.ray_cast(pos<D>(6, 5), vec<D>(0, -10)).value().shape);
  EXPECT_FALSE(world.ray_cast(pos<D>(0, 5), vec<D>(0, -10)).value().shape);
  world.set_pose(body, pos<D>(-20, 0), {}).value();
  EXPECT_TRUE(world.ray_cast(pos<D>(-20, 5), vec<D>(0, -10)).value().shape);
}

TYPED_TEST(Queries, SensorsAreNotSeenAndBadNumbersAreRefused) {
  using D = TypeParam;
  World<D> world;
  const BodyId body = world.create_body({}).value();
  ShapeDef<D> def;
  def.sensor = true;
  world.add_shape(body, any_shape(D{}, 0, this->draw), def).value();
  EXPECT_FALSE(world.ray_cast(pos<D>(-5, 0), vec<D>(10, 0)).value().shape);
  const float nan = __builtin_nanf("");
  EXPECT_FALSE(world.ray_cast(pos<D>(double(nan), 0), vec<D>(1, 0)).ok());
  EXPECT_FALSE(world.ray_cast(pos<D>(0, 0), vec<D>(nan, 0)).ok());
  std::vector<ShapeId> found;
  EXPECT_FALSE(world.overlap_bounds({pos<D>(1, 1), pos<D>(0, 0)}, found).ok());
  typename D::Shape bad;
  if constexpr (D::dimension == 2)
    bad = geometry::Circle{-1};
  else
    bad = geometry::Sphere{-1};
  EXPECT_FALSE(world.overlap(bad, {}, found).ok());
  EXPECT_FALSE(world.shape_cast(bad, {}, vec<D>(1, 0)).ok());
}

// Whose centre or farthest point is faster; who sleeps and who is fixed is not.
TYPED_TEST(Queries, FastBodiesAreThoseWhosePointsAre) {
  using D = TypeParam;
  World<D>& world = this->world;
  std::vector<BodyId> found, expected;
  const auto ball = [&](double x) {
    BodyDef<D> def;
    def.type = BodyType::dynamic;
    def.position = pos<D>(x, 0);
    const BodyId body = world.create_body(def).value();
    if constexpr (D::dimension == 2)
      world.add_shape(body, geometry::Circle{0.5f}, {}).value();
    else
      world.add_shape(body, geometry::Sphere{0.5f}, {}).value();
    return body;
  };
  for (const float speed : {0.f, 19.f, 21.f, 300.f}) {
    const BodyId body = ball(3 * double(speed));
    world.set_velocity(body, vec<D>(0, -speed), {}).value();
    if (speed > 20) expected.push_back(body);
  }
  const BodyId turning = ball(-40);
  if constexpr (D::dimension == 2)
    world.set_velocity(turning, {}, -41).value();
  else
    world.set_velocity(turning, {}, {0, 0, 41}).value();
  expected.push_back(turning);
  world.fast_bodies(20, found);
  EXPECT_EQ(found, expected);
  world.set_awake(turning, false).value();
  expected.pop_back();
  world.fast_bodies(20, found);
  EXPECT_EQ(found, expected);
}

}  // namespace query_test
}  // namespace carom::rigid::test
