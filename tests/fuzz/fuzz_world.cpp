// Calls of the interface in any order with any numbers: valid, invalid, stale, foreign, huge, not finite. A refused
// call leaves the world as it was, nothing ever stops being finite, and snapshots go there and back.
#include "tests/fuzz/require.h"
#include "tests/fuzz/target.h"
#include "tests/fuzz/world_maker.h"

namespace {
using namespace carom;
using namespace carom::rigid;
using fuzz::Source;

// Under the thread sanitizer all worlds have threads, and an eighth of them enough bodies to keep those busy.
#if defined(__has_feature) && __has_feature(thread_sanitizer)
constexpr bool watches_threads = true;
#else
constexpr bool watches_threads = false;
#endif

template <class D>
struct Player : fuzz::Maker<D> {
  using Base = fuzz::Maker<D>;
  using Base::add_body, Base::add_joint, Base::add_shape, Base::any_effector, Base::any_shape;
  using Base::angular, Base::body, Base::position, Base::rotation, Base::shape, Base::vector;
  using Base::bodies, Base::effectors, Base::in, Base::joints, Base::shapes, Base::world;
  Snapshot<D> snapshot;
  std::uint64_t snapshot_hash = 0;
  int steps = 0;

  Player(Source source, const WorldDef<D>& d) : Base(source, d) {}

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

  JointId joint() { return joints[in.byte() % joints.size()]; }
  bool change_joint() {
    switch (in.byte() % 16) {
      case 0:
        return world.set_motor(joint(), {in.flag(), in.number(), in.number(100)}).ok();
      case 1:
        return world.set_limit(joint(), {in.flag(), in.number(), in.number()}).ok();
      case 2:
        return world.set_spring(joint(), {in.number(4), in.number()}).ok();
      case 3:
        return world.set_spring_target(joint(), in.number()).ok();
      case 4:
        return world.set_max_spring_force(joint(), in.number(100)).ok();
      case 5:
        return world.set_target_rotation(joint(), rotation()).ok();
      case 6:
        return world.set_target_pose(joint(), vector(), rotation()).ok();
      case 7:
        return world.set_target_velocity(joint(), vector(4), angular()).ok();
      case 8:
        return world.set_hold(joint(), in.flag(), in.flag()).ok();
      case 9:
        return world.set_max_force(joint(), in.number(100), in.number(100)).ok();
      case 10:
        return world.set_length(joint(), in.number()).ok();
      case 11:
        return world.set_cone_angle(joint(), in.number()).ok();
      case 12:
        return world.set_friction(joint(), in.number()).ok();
      case 13:
        return world.set_break_force(joint(), in.number(100), in.number(100)).ok();
      case 14:
        return world.set_axis(joint(), int(in.byte() % 8) - 1, this->any_axis()).ok();
      default:
        return world.set_mouse_target(joint(), position()).ok();
    }
  }
  bool change_body() {
    switch (in.byte() % 9) {
      case 0:
        return world.set_damping(body(), in.number(), in.number()).ok();
      case 1:
        return world.set_gravity_scale(body(), in.number()).ok();
      case 2:
        return world.set_substeps(body(), int(in.byte() % 70) - 2).ok();
      case 3: {
        typename D::MassProperties m;
        m.mass = double(in.number(10));
        if constexpr (D::dimension == 2)
          m.inertia = double(in.number());
        else
          m.inertia = Mat3d::diagonal({double(in.number()), double(in.number()), double(in.number())});
        m.center = typename D::Position(vector(0.1f));
        return world.set_mass_properties(body(), m).ok();
      }
      case 4:
        return world.add_force(body(), vector(1e4f)).ok();
      case 5:
        return world.add_impulse(body(), vector(1e3f)).ok();
      case 6:
        return world.add_torque(body(), angular()).ok();
      case 7:
        return world.set_effector(effectors[in.byte() % effectors.size()], any_effector()).ok();
      default:
        return world.set_user_data(body(), in.byte()).ok();
    }
  }
  /// Says what might help, does some of it, and makes room.
  bool look_after() {
    if (in.flag()) {
      const int most = 200;
      const Capacity capacity{in.byte() % most, in.byte() % most, in.byte() % most, in.byte() % most,
                              int(in.byte() % 20) - 1};
      return world.reserve(capacity).ok();
    }
    const std::vector<Advice> advice = advise(world, 1.0f / 60);
    return apply_advice<D>(world, advice) > 0;
  }

  bool many_queries() {
    std::vector<RayHit<D>> hits(in.byte() % 4);
    const QueryFilter filter{in.byte(), in.byte(), body()};
    switch (in.byte() % 3) {
      case 0: {
        std::vector<RayQuery<D>> rays;
        for (int i = in.byte() % 4; i > 0; --i) rays.push_back({position(), vector(8), filter});
        return world.cast_rays(rays, hits).ok();
      }
      case 1: {
        std::vector<ShapeCastQuery<D>> casts;
        for (int i = in.byte() % 4; i > 0; --i) casts.push_back({{position(), rotation()}, vector(8), filter});
        return world.cast_shapes(any_shape(), casts, hits).ok();
      }
      default: {
        std::vector<OverlapQuery<D>> places;
        for (int i = in.byte() % 4; i > 0; --i) places.push_back({{position(), rotation()}, filter});
        std::vector<ShapeId> found;
        std::vector<std::uint32_t> ends(in.byte() % 4);
        return world.overlap_shapes(any_shape(), places, found, ends).ok();
      }
    }
  }
  bool query() {
    std::vector<RayHit<D>> hits;
    std::vector<ShapeId> found;
    if (in.byte() > 170) return many_queries();
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
      if constexpr (requires { made->drop_through(); })
        if (in.byte() > 200) made->drop_through();
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
    switch (call % 39) {
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
        return in.byte() < 200 ? world.set_awake(body(), in.flag()).ok()
                               : world.set_time_scale(body(), in.number()).ok();
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
        const Material m{in.number(), in.number(), in.number(), in.number(), in.number(), in.byte() % 4u};
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
        PairRule rule{in.number(), in.number(), in.number(), in.number()};
        if (in.flag()) rule.static_friction = in.number();
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
      case 34:
      case 35:
      case 36:
        return change_joint();
      case 37:
        return change_body();
      case 38:
        return in.byte() < 128 ? change_body() : look_after();
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

  /// So many bodies, some tied to the next, that the loops of a step are shared out among threads.
  void crowd() {
    constexpr int across = D::dimension == 2 ? 24 : 8;
    BodyId last;
    for (int i = 0; i < 576; ++i) {
      BodyDef<D> d;
      d.position[0] = 1.02 * (i % across) - 5;
      d.position[1] = 1.5 + 1.02 * (i / (D::dimension == 2 ? across : across * across));
      if constexpr (D::dimension == 3) d.position[2] = 1.02 * (i / across % across) - 5;
      const BodyId next = world.create_body(d).value();
      if constexpr (D::dimension == 2)
        (void)world.add_shape(next,
                              i % 3 != 0 ? geometry::Shape2(geometry::make_box2({0.5f, 0.5f})) : Base::geometry_of());
      else
        (void)world.add_shape(next, i % 3 != 0 ? geometry::Shape3(geometry::Box{}) : Base::geometry_of());
      if (i % 4 == 1) {
        BallJointDef<D> tie;
        tie.body_a = last, tie.body_b = next;
        tie.frame_a.p[0] = 1.02f;
        (void)world.create_joint(tie);
      }
      if (i % 64 == 0) bodies.push_back(next);
      last = next;
    }
  }

  void play() {
    world.set_contact_filter([](ShapeId a, ShapeId b) { return (a.index + b.index) % 13 != 5; });
    world.set_contact_modifier([](ContactModification<D>& c) {
      if ((c.shape_a.index + c.shape_b.index) % 3 == 0) c.enabled = false;
      c.friction = c.count == 1 ? std::numeric_limits<float>::quiet_NaN() : 0.1f;
      c.restitution = 0.5f;
    });
    Snapshot<D> before, after;
    for (int calls = 0; calls < 300 && !in.empty(); ++calls) {
      world.snapshot(before);
      if (act()) continue;
      world.snapshot(after);
      require(after.digest() == before.digest(), "a refused call leaves the world as it was");
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
  d.threads = watches_threads || (options & 15) == 15 ? 2 : 1;
  d.continuous = (options & 16) == 0;
  d.allow_sleep = (options & 32) == 0;
  d.move_events = (options & 64) != 0;
  d.sleep_time = 0.05f;
  d.substeps = (options & 128) != 0 ? 2 : 4;
  Player<D> player(in, d);
  if (watches_threads && (options & 7) == 5) player.crowd();
  player.play();
}

}  // namespace

FUZZ_TARGET(world) {
  if (size < 4 || size > 4096) return;
  Source in(data, size);
  if (in.flag())
    play<Dim2>(in);
  else
    play<Dim3>(in);
}
