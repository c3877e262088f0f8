// Calls of the interface in any order with any numbers: valid, invalid, stale, foreign, huge, not finite. A refused
// call leaves the world as it was, nothing ever stops being finite, and snapshots go there and back.
#include <cstring>
#include <limits>

#include "carom/carom.h"
#include "carom/environment/environment.h"
#include "tests/fuzz/require.h"

namespace {
using namespace carom;
using namespace carom::rigid;

class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return size_ == 0; }
  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  bool flag() { return (byte() & 1) != 0; }
  /// Mostly what a game says, sometimes what nobody should.
  float number(float scale = 1) {
    const std::uint8_t kind = byte();
    if (kind < 200) return scale * (float(byte()) - 100) / 32;
    switch (kind % 8) {
      case 0:
        return std::numeric_limits<float>::quiet_NaN();
      case 1:
        return std::numeric_limits<float>::infinity();
      case 2:
        return -1e30f;
      case 3:
        return 1e12f;
      case 4:
        return 1e-30f;
      case 5:
        return -0.0f;
      case 6: {
        std::uint32_t bits = 0;
        for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
        float x;
        std::memcpy(&x, &bits, 4);
        return x;
      }
      default:
        return scale * 1e5f;
    }
  }
  /// Of a size that can be: mostly.
  float size() { return byte() < 240 ? 0.05f + float(byte()) / 128 : number(); }
  std::vector<std::byte> rest(std::size_t most) {
    std::vector<std::byte> bytes;
    while (size_ > 0 && bytes.size() < most) bytes.push_back(std::byte(byte()));
    return bytes;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

template <class D>
struct Player {
  using Vector = typename D::Vector;
  Source in;
  WorldDef<D> definition{};
  World<D> world, foreign;
  std::vector<BodyId> bodies;  ///< alive or not
  std::vector<ShapeId> shapes;
  std::vector<JointId> joints;
  std::vector<EffectorId> effectors;
  Snapshot<D> snapshot;
  std::uint64_t snapshot_hash = 0;
  int steps = 0;

  Player(Source source, const WorldDef<D>& d) : in(source), definition(d), world(d), foreign(d) {
    bodies.push_back(foreign.create_body({}).value());
    shapes.push_back(foreign.add_shape(bodies[0], geometry_of()).value());
    bodies.push_back({});
    shapes.push_back({});
    joints.push_back({});
    effectors.push_back({});
    BodyDef<D> ground;
    ground.type = BodyType::fixed;
    bodies.push_back(world.create_body(ground).value());
    if constexpr (D::dimension == 2)
      shapes.push_back(world.add_shape(bodies.back(), geometry::make_box2({50, 1})).value());
    else
      shapes.push_back(world.add_shape(bodies.back(), geometry::Box{{50, 1, 50}}).value());
  }
  static typename D::Shape geometry_of() {
    if constexpr (D::dimension == 2)
      return geometry::Circle{0.5f};
    else
      return geometry::Sphere{0.5f};
  }

  Vector vector(float scale = 1) {
    Vector v{};
    for (int i = 0; i < D::dimension; ++i) v[i] = in.number(scale);
    return v;
  }
  typename D::Angular angular() {
    if constexpr (D::dimension == 2)
      return in.number();
    else
      return vector();
  }
  typename D::Rotation rotation() {
    typename D::Rotation q{};
    if (in.byte() < 128) return q;
    if constexpr (D::dimension == 2)
      q = {in.number(), in.number()};
    else
      q = {in.number(), in.number(), in.number(), in.number()};
    return in.byte() < 200 ? math::normalize(q) : q;
  }
  typename D::Position position() { return typename D::Position(vector(2)) * (in.byte() > 250 ? 1e9 : 1.0); }
  typename D::Transform transform() { return {vector(0.2f), rotation()}; }
  BodyId body() { return bodies[in.byte() % bodies.size()]; }
  ShapeId shape() { return shapes[in.byte() % shapes.size()]; }

  typename D::Shape any_shape() {
    if constexpr (D::dimension == 2) {
      switch (in.byte() % 5) {
        case 0:
          return geometry::Circle{in.size()};
        case 1:
          return geometry::Capsule2{in.size(), in.size()};
        case 2: {
          const Vector points[5] = {vector(), vector(), vector(), vector(), vector()};
          const auto polygon = geometry::make_polygon(points, in.flag() ? in.size() : 0);
          return polygon.ok() ? geometry::Shape2(*polygon) : geometry::Shape2(geometry::Circle{1});
        }
        case 3: {
          auto chain = geometry::make_chain({vector(5), vector(5), vector(5), vector(5)}, in.flag());
          return chain.ok() ? geometry::Shape2(*chain) : geometry::Shape2(geometry::Segment{vector(), vector()});
        }
        default:
          return in.byte() < 200 ? geometry::make_box2({0.1f + math::abs(float(in.byte())) / 128, 0.3f})
                                 : geometry::make_box2({in.size(), in.size()});
      }
    } else {
      switch (in.byte() % 12) {
        case 0:
          return geometry::Sphere{in.size()};
        case 1:
          return geometry::Capsule3{in.size(), in.size()};
        case 2:
          return geometry::Cylinder{in.size(), in.size(), in.flag() ? in.size() : 0.0f};
        case 3:
          return geometry::Cone{in.size(), in.size(), in.flag() ? in.size() : 0.0f};
        case 4: {
          const Vector points[6] = {vector(), vector(), vector(), vector(), vector(), vector()};
          const auto hull = geometry::make_hull(points);
          return hull.ok() ? geometry::Shape3(*hull) : geometry::Shape3(geometry::Sphere{1});
        }
        case 5: {
          auto mesh = geometry::make_triangle_mesh({vector(5), vector(5), vector(5), vector(5)}, {0, 1, 2, 0, 2, 3});
          return mesh.ok() ? geometry::Shape3(*mesh) : geometry::Shape3(geometry::Plane{});
        }
        case 6: {
          auto field = geometry::make_height_field(3, 3, {in.size(), in.size()},
                                                   {0, in.number(), 0, in.number(), 0, in.number(), 0, 0.1f, 0});
          return field.ok() ? geometry::Shape3(*field) : geometry::Shape3(geometry::Plane{vector()});
        }
        case 8:
          return geometry::Ellipsoid{{in.size(), in.size(), in.size()}};
        case 9: {
          std::vector<std::uint8_t> cells;
          for (int i = 0; i < 27; ++i) cells.push_back(std::uint8_t(in.byte() % 3));
          auto grid = geometry::make_voxel_grid(3, 3, 3, in.size(), cells);
          return grid.ok() ? geometry::Shape3(*grid) : geometry::Shape3(geometry::Box{});
        }
        case 10: {  // closed, where its corners are no plane: a body of its own
          auto mesh = geometry::make_triangle_mesh({vector(), vector(), vector(), vector()},
                                                   {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, {0, 1, 0, in.byte()});
          return mesh.ok() ? geometry::Shape3(*mesh) : geometry::Shape3(geometry::Sphere{});
        }
        case 7: {
          auto compound = geometry::make_compound({{geometry::Box{{in.size(), in.size(), in.size()}}, transform()},
                                                   {geometry::Sphere{in.size()}, transform()}});
          return compound.ok() ? geometry::Shape3(*compound) : geometry::Shape3(geometry::Box{});
        }
        default:
          return geometry::Box{{in.size(), in.size(), in.size()}, in.flag() ? in.size() : 0};
      }
    }
  }

  bool add_body() {
    BodyDef<D> d;
    d.type = BodyType(in.byte() % (in.byte() < 250 ? 3 : 200));
    d.position = position();
    d.rotation = rotation();
    d.linear_velocity = vector(4);
    d.angular_velocity = angular();
    const std::uint8_t options = in.byte();
    d.bullet = (options & 1) != 0;
    d.awake = (options & 2) == 0;
    d.enabled = (options & 12) != 12;
    d.allow_sleep = (options & 16) == 0;
    d.locks.x = (options & 96) == 96;
    d.locks.rotation_z = (options & 192) == 192;
    if (options == 77) d.name = "named";
    if (in.byte() > 200) d.linear_damping = in.number(), d.gravity_scale = in.number(), d.time_scale = in.number();
    const auto made = world.create_body(d);
    if (made.ok()) bodies.push_back(*made);
    return made.ok();
  }
  bool add_shape() {
    ShapeDef<D> d;
    const std::uint8_t options = in.byte();
    d.sensor = (options & 7) == 7;
    d.hit_events = (options & 8) != 0;
    d.modify_contacts = (options & 48) == 48;
    if ((options & 192) == 192) d.local = transform();
    if (in.byte() > 180) {
      d.density = in.number(1000);
      d.material = {in.number(), in.number(), in.number(), in.number(), in.byte() % 4u};
      d.filter = {in.byte(), in.byte(), std::int32_t(in.byte()) - 128};
    }
    if (in.byte() > 230) d.surface_velocity = vector();
    while (in.byte() > 200) d.surfaces.push_back({{in.number(), in.number()}, vector()});
    if (in.byte() > 230) d.one_way = vector();
    const auto made = world.add_shape(body(), any_shape(), d);
    if (made.ok()) shapes.push_back(*made);
    return made.ok();
  }
  template <class Def>
  bool make_joint(Def d) {
    d.body_a = body();
    d.body_b = body();
    d.frame_a = transform();
    d.frame_b = transform();
    d.collide_connected = in.flag();
    if constexpr (requires { d.spring; }) d.spring = {in.number(4), in.number()};
    if constexpr (requires { d.limit; }) d.limit = {in.flag(), in.number(), in.number()};
    if constexpr (requires { d.motor; }) d.motor = {in.flag(), in.number(), in.number(100)};
    if constexpr (requires { d.target; }) d.target = position();
    if constexpr (requires { d.length; }) d.length = in.number();
    if constexpr (requires { d.ratio; }) d.ratio = in.number();
    if constexpr (requires { d.radius; }) d.radius = in.number();
    if constexpr (requires { d.pitch; }) d.pitch = in.number();
    if constexpr (requires { d.ground_a; }) d.ground_a = position(), d.ground_b = position();
    if constexpr (requires { d.points; }) {
      const Vector points[] = {vector(), vector(), vector(4), vector(4)};
      d.points = std::span(points).first(in.byte() % 5u);
      d.closed = in.flag(), d.straight = in.flag(), d.follow = in.flag();
      const auto made = world.create_joint(d);
      if (made.ok()) joints.push_back(*made);
      return made.ok();
    }
    if constexpr (requires { d.angular[0]; }) {
      for (JointAxis& axis : d.linear) axis = any_axis();
      for (JointAxis& axis : d.angular) axis = any_axis();
    }
    const auto made = world.create_joint(d);
    if (made.ok()) joints.push_back(*made);
    return made.ok();
  }
  JointAxis any_axis() {
    if (in.flag()) return {};
    JointAxis a;
    a.free = true;
    a.limit = {in.flag(), in.number(), in.number()};
    a.spring = {in.number(4), in.number()};
    a.target = in.number(), a.friction = in.number();
    return a;
  }
  bool add_joint() {
    const std::uint8_t kind = in.byte();
    if (kind >= 200) {
      switch (kind % 6) {
        case 0:
          return make_joint(GenericJointDef<D>{});
        case 1:
          return make_joint(GearJointDef<D>{});
        case 2:
          return make_joint(RackJointDef<D>{});
        case 3:
          return make_joint(PulleyJointDef<D>{});
        case 4:
          return make_joint(PathJointDef<D>{});
        default:
          if constexpr (D::dimension == 3) return make_joint(ScrewJointDef<D>{});
      }
    }
    switch (kind % 7) {
      case 0:
        return make_joint(DistanceJointDef<D>{});
      case 1:
        return make_joint(BallJointDef<D>{});
      case 2:
        return make_joint(HingeJointDef<D>{});
      case 3:
        return make_joint(SliderJointDef<D>{});
      case 4:
        return make_joint(WeldJointDef<D>{});
      case 5:
        return make_joint(MotorJointDef<D>{});
      default:
        return make_joint(MouseJointDef<D>{});
    }
  }
  EffectorDef<D> any_effector() {
    switch (in.byte() % 12) {
      case 0: {
        LinearDrag<D> e;
        e.body = in.flag() ? body() : BodyId{};
        e.coefficient = double(in.number(10));
        return e;
      }
      case 1:
        return Wind<D>{vector()};
      case 2: {
        SpringDamper<D> e;
        e.body_a = body();
        e.body_b = in.flag() ? body() : BodyId{};
        e.point_b = position();
        e.stiffness = double(in.number(1000));
        e.damping = double(in.number(10));
        return e;
      }
      case 3: {
        Buoyancy<D> e;
        e.level = double(in.number());
        e.linear_drag = double(in.number());
        e.added_mass = vector();
        return e;
      }
      case 7: {
        Surroundings<D> e;
        environment::Environment::Definition d;
        d.wind.mean.velocity = {double(in.number(50)), double(in.number(50)), 0};
        d.frame.rate = {0, 0, double(in.number(3))};
        d.gravity.kind = in.flag() ? environment::GravityField::Kind::spherical : environment::GravityField::Kind::none;
        const environment::WaveComponent wave{double(in.number(2)), 0.1 + double(in.byte()), double(in.number(3))};
        auto sea = environment::Sea::make({.level = double(in.number(5))}, {&wave, 1});
        if (sea.ok()) d.water = std::move(sea).value();
        auto made = environment::Environment::make(std::move(d));
        if (made.ok()) e.environment = std::make_shared<const environment::Environment>(std::move(made).value());
        return e;  // null where the numbers were bad: refused
      }
      case 8: {
        BodyDrag<D> e;
        e.body = in.flag() ? body() : BodyId{};
        e.law.kind = forces::DragLaw::Kind(in.byte() % 8);
        e.law.coefficient = double(in.number(3));
        e.diameter = double(in.number(5));
        e.area = double(in.number(5));
        e.point = vector();
        return e;
      }
      case 9: {
        MagnusLift<D> e;
        e.radius = double(in.number(2));
        return e;
      }
      case 10: {
        TurningFrame<D> e;
        e.center = position();
        if constexpr (D::dimension == 2)
          e.rate = in.number(20);
        else
          e.rate = vector();
        e.centrifugal = in.flag();
        return e;
      }
      case 11: {
        ElectromagneticField<D> e;
        e.body = in.flag() ? body() : BodyId{};
        e.charge = double(in.number(100));
        e.electric = vector();
        e.magnetic = {in.number(9), in.number(9), in.number(9)};
        return e;
      }
      case 4: {
        RadialField<D> e;
        e.center = position();
        e.strength = double(in.number());
        e.exponent = double(in.number());
        return e;
      }
      case 5: {
        CustomEffector<D> e;
        e.body = in.flag() ? body() : BodyId{};
        const float x = in.number(100);  // not finite, too
        e.model = [x](const EffectorInput<D>&) {
          Wrench<D> w;
          w.force.x = x;
          return w;
        };
        return e;
      }
      default: {
        QuadraticDrag<D> e;
        e.area = double(in.number());
        return e;
      }
    }
  }

  bool snapshots() {
    switch (in.byte() % 4) {
      case 0:
        world.snapshot(snapshot);
        snapshot_hash = world.state_hash();
        return true;
      case 1: {
        const bool there = !snapshot.empty();
        const Status restored = world.restore(snapshot);
        require(restored.ok() == there, "a snapshot that was taken restores, an empty one does not");
        if (restored.ok()) require(world.state_hash() == snapshot_hash, "the restored state is the saved one");
        return restored.ok();
      }
      case 2: {
        const Snapshot<D> now = world.snapshot();
        const auto back = Snapshot<D>::decode(now.encode(snapshot), snapshot);
        require(back.ok(), "what was encoded decodes");
        require(back->digest() == now.digest(), "there and back gives the same state");
        const std::uint64_t hash = world.state_hash();
        require(world.restore(*back).ok(), "what was decoded restores");
        require(world.state_hash() == hash, "and is the same");
        return true;
      }
      default: {
        std::vector<std::byte> bytes = world.snapshot().encode();
        const std::size_t place = (std::size_t(in.byte()) << 8 | in.byte()) % bytes.size();
        if (in.flag())
          bytes.resize(place);
        else
          bytes[place] ^= std::byte(1 + in.byte() % 255);
        require(!Snapshot<D>::decode(bytes).ok(), "a broken snapshot is refused");
        return !Snapshot<D>::decode(in.rest(200)).ok();
      }
    }
  }

  bool query() {
    std::vector<RayHit<D>> hits;
    std::vector<ShapeId> found;
    switch (in.byte() % 5) {
      case 0:
        return world.ray_cast(position(), vector(8)).ok();
      case 1:
        return world.ray_cast_all(position(), vector(8), hits).ok();
      case 2:
        return world.shape_cast(any_shape(), {position(), rotation()}, vector(8)).ok();
      case 3:
        return world.overlap(any_shape(), {position(), rotation()}, found).ok();
      default:
        return world.overlap_bounds({position(), position()}, found).ok();
    }
  }

  bool change_ground() {
    const SurfaceMaterial<D> surface{{in.number(), in.number(), in.number()}, vector()};
    if (in.byte() < 60) return world.set_surface(shape(), int(in.byte()) - 2, surface).ok();
    if constexpr (D::dimension == 3) {
      const int at[3] = {in.byte() % 5 - 1, in.byte() % 5 - 1, in.byte() % 5 - 1};
      const int size[3] = {in.byte() % 4, in.byte() % 4, in.byte() % 4};
      std::vector<float> heights;
      std::vector<std::uint8_t> cells;
      for (int i = 0; i < size[0] * size[1]; ++i) heights.push_back(in.number());
      const int count = size[0] * size[1] * (in.flag() ? size[2] : 1);
      for (int i = 0; i < count; ++i) cells.push_back(std::uint8_t(in.byte() % 3));
      const geometry::GridRectangle rectangle{at[0], at[1], size[0], size[1]};
      switch (in.byte() % 4) {
        case 0:
          return world.set_heights(shape(), rectangle, heights).ok();
        case 1:
          return world.set_holes(shape(), rectangle, cells).ok();
        case 2:
          return world.set_cell_materials(shape(), rectangle, cells).ok();
        default:
          return world.set_cells(shape(), {at[0], at[1], at[2], size[0], size[1], size[2]}, cells).ok();
      }
    }
    return false;
  }

  /// What stands on the world's public face alone: figures with muscles, and characters.
  bool mechanism() {
    auto figure = Articulation<D>::create(world, body());
    if (!figure.ok()) return false;
    (void)figure->set_muscles({double(in.number()), double(in.number()), double(in.number(100))});
    for (int j = 0; j < int(figure->joints().size()) && j < 4; ++j) {
      (void)figure->set_target(j, double(in.number()), double(in.number()), double(in.number()));
      (void)figure->set_target(j, Quatf{in.number(), in.number(), in.number(), in.number()});
      if (in.flag()) (void)figure->set_muscle(j, {double(in.number()), double(in.number()), 0});
    }
    std::vector<double> accelerations(std::size_t(figure->degrees()), double(in.number())),
        torques(accelerations.size());
    (void)figure->inverse_dynamics(accelerations, torques);
    return figure->drive(world, in.byte() < 245 ? 1.0f / 60 : in.number()).ok();
  }
  template <class Walker, class Definition>
  bool walk() {
    Definition d;
    d.radius = in.size(), d.half_length = in.size(), d.mass = in.size() * 100;
    d.max_slope = in.number(), d.step_height = in.size();
    if (in.byte() > 200) d.up = vector();
    auto made = Walker::create(world, d, position());
    if (!made.ok()) return false;
    for (int i = in.byte() % 4; i >= 0; --i) {
      (void)made->move(world, vector(4), in.byte() < 245 ? 1.0f / 60 : in.number());
      if (steps < 40) ++steps, (void)world.step(1.0f / 60);
    }
    if (in.flag()) (void)made->teleport(world, position());
    if (in.flag()) require(made->destroy(world).ok(), "a character goes as it came");
    return true;
  }

  /// False where the call was refused.
  bool act() {
    const std::uint8_t call = in.byte();
    if (call >= 250) return walk<Character<D>, CharacterDef<D>>();
    if (call >= 246) return walk<DynamicCharacter<D>, DynamicCharacterDef<D>>();
    if (call >= 238) return mechanism();
    switch (call % 34) {
      case 0:
      case 1:
        return bodies.size() < 40 && add_body();
      case 2:
      case 3:
      case 4:
        return shapes.size() < 60 && add_shape();
      case 5:
        return joints.size() < 40 && add_joint();
      case 6:
        return world.destroy_body(body()).ok();
      case 7:
        return world.destroy_shape(shape()).ok();
      case 8:
        return world.destroy_joint(joints[in.byte() % joints.size()]).ok();
      case 9: {
        if (effectors.size() >= 12) return false;
        const auto made = world.add_effector(any_effector());
        if (made.ok()) effectors.push_back(*made);
        return made.ok();
      }
      case 10:
        return world.destroy_effector(effectors[in.byte() % effectors.size()]).ok();
      case 11:
        return world.set_pose(body(), position(), rotation()).ok();
      case 12:
        return world.set_velocity(body(), vector(10), angular()).ok();
      case 13:
        return world.set_type(body(), BodyType(in.byte() % 4)).ok();
      case 14:
        return world.set_awake(body(), in.flag()).ok();
      case 15:
        return world.set_enabled(body(), in.flag()).ok();
      case 16:
        return world.set_locks(body(), {in.flag(), in.flag(), in.flag(), in.flag(), in.flag(), in.flag()}).ok();
      case 17:
        return world.add_force_at(body(), vector(1e4f), position()).ok();
      case 18:
        return world.add_impulse_at(body(), vector(1e3f), position()).ok();
      case 19:
        return world.add_angular_impulse(body(), angular()).ok();
      case 20: {
        Material m{in.number(), in.number(), in.number(), in.number(), in.byte() % 4u};
        return world.set_material(shape(), m).ok();
      }
      case 21:
        return world.set_filter(shape(), {in.byte(), in.byte(), std::int32_t(in.byte()) - 128}).ok();
      case 22:
        switch (in.byte() % 4) {
          case 0:
            return world.set_surface_velocity(shape(), vector()).ok();
          case 1:
            return world.set_one_way(shape(), vector()).ok();
          case 2:
            return world.set_modify_contacts(shape(), in.flag()).ok();
          default:
            return world.set_density(shape(), in.number(1000)).ok();
        }
      case 23: {
        const PairRule rule{in.number(), in.number(), in.number()};
        return world.set_pair_rule(in.byte() % 4, in.byte() % 4, in.flag() ? &rule : nullptr).ok();
      }
      case 24:
        return world.explode({position(), in.number(), in.number(), in.number(100), in.number()}).ok();
      case 25:
        return world.set_target_pose(body(), position(), rotation(), in.number()).ok();
      case 26:
        return world.set_gravity(vector(5)).ok();
      case 27:
        return query();
      case 32:
      case 33:
        return change_ground();
      case 28:
      case 29:
        return snapshots();
      default: {
        if (steps > 40) return false;
        const int count = 1 + in.byte() % 8;
        for (int i = 0; i < count; ++i, ++steps)
          if (!world.step(in.byte() < 245 ? 1.0f / 60 : in.number()).ok()) return i > 0;
        return true;
      }
    }
  }

  void play() {
    world.set_contact_filter([](ShapeId a, ShapeId b) { return (a.index + b.index) % 13 != 5; });
    world.set_contact_modifier([](ContactModification<D>& c) {
      if ((c.shape_a.index + c.shape_b.index) % 3 == 0) c.enabled = false;
      c.friction = c.count == 1 ? std::numeric_limits<float>::quiet_NaN() : 0.1f;
      c.restitution = 0.5f;
    });
    for (int calls = 0; calls < 300 && !in.empty(); ++calls) {
      const std::uint64_t before = world.state_hash();
      if (!act()) require(world.state_hash() == before, "a refused call leaves the world as it was");
    }
    for (int i = 0; i < 5; ++i) require(world.step(1.0f / 60).ok(), "the world goes on");
    for (const BodyId b : bodies) {
      const auto s = world.state(b);
      if (s.ok())
        require(math::is_finite(s->pose.position) && math::is_finite(s->linear_velocity), "bodies stay finite");
    }
    (void)world.totals();
    (void)world.counters();
    (void)world.worst_penetration();
    (void)world.worst_joint_error();
    std::vector<ContactView<D>> contacts;
    world.contacts(contacts);
    const Snapshot<D> end = world.snapshot();
    require(world.restore(end).ok(), "the end restores");
  }
};

template <class D>
void play(Source in) {
  WorldDef<D> d;
  const std::uint8_t options = in.byte();
  d.threads = (options & 15) == 15 ? 2 : 1;
  d.continuous = (options & 16) == 0;
  d.allow_sleep = (options & 32) == 0;
  d.move_events = (options & 64) != 0;
  d.sleep_time = 0.05f;
  d.substeps = (options & 128) != 0 ? 2 : 4;
  Player<D>(in, d).play();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4 || size > 4096) return 0;
  Source in(data, size);
  if (in.flag())
    play<Dim2>(in);
  else
    play<Dim3>(in);
  return 0;
}
