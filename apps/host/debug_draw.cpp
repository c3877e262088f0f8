#include "apps/host/debug_draw.h"

#include <algorithm>
#include <numeric>

#include "apps/host/debug_pen.h"
#include "apps/host/debug_water.h"

namespace carom::host {

namespace {

using math::Vec3d;

constexpr std::uint32_t palette[] = {0xe4572eff, 0x4a8fe7ff, 0x2a9d8fff, 0xd99a1cff, 0x9b6dd6ff, 0xe07a9bff,
                                     0x6bbf59ff, 0x00a6c7ff, 0xb5651dff, 0x7d6bd0ff, 0xc2b800ff, 0xd1495bff};
constexpr std::uint32_t asleep = 0x8a8f98ff, velocity_pen = 0x2a9d8fff, spin_pen = 0x9b6dd6ff, weight_pen = 0x4a8fe7ff,
                        normal_pen = 0xe4572eff, friction_pen = 0xf4b942ff, joint_pen = 0x9b6dd6ff;

template <class D>
class Drawing {
 public:
  Drawing(const rigid::World<D>& world, double size, ArrowScale scale, std::vector<Line>& out)
      : world_(world), pen_(0.012 * size, D::dimension == 2, out), mark_(0.012 * size), size_(size), scale_(scale) {}

  void bodies(std::uint32_t layers) {
    std::vector<rigid::BodyId> all;
    world_.bodies(all);
    if (layers & layer_islands) find_islands(all);
    std::vector<rigid::ShapeId> shapes;
    for (std::size_t i = 0; i < all.size() && !pen_.full(); ++i) {
      const auto state = world_.state(all[i]);
      if (!state.ok()) continue;
      const bool moves = state->type == rigid::BodyType::dynamic;
      if ((layers & layer_bounds) || ((layers & layer_islands) && moves)) {
        shapes.clear();
        world_.shapes(all[i], shapes);
        const std::uint32_t pen = !state->awake ? asleep : (layers & layer_islands) ? island_pen(i) : 0x6b7682ff;
        for (const rigid::ShapeId shape : shapes) bounds(shape, state->pose, pen);
      }
      const Vec3d center = in_space(state->center_of_mass);
      if ((layers & layer_centers) && moves) pen_.cross(center, 0x17212bff);
      if ((layers & layer_velocities) && state->type != rigid::BodyType::fixed && state->awake) {
        pen_.arrow(center, scale_.velocity * in_space(state->linear_velocity), velocity_pen);
        if constexpr (D::dimension == 3)
          pen_.arrow(center, scale_.velocity * in_space(state->angular_velocity), spin_pen);
      }
      if ((layers & layer_forces) && moves && state->awake) {
        const double weight = double(state->mass) * scale_.force;
        pen_.arrow(center, weight * in_space(world_.definition().gravity), weight_pen);
      }
    }
  }

  void contacts(std::uint32_t layers, float dt) {
    std::vector<rigid::ContactView<D>> all;
    world_.contacts(all);
    const double scale = layers & layer_forces ? scale_.force / double(dt) : scale_.impulse;
    for (const rigid::ContactView<D>& contact : all) {
      if (pen_.full()) return;
      const Vec3d normal = in_space(contact.normal);
      const std::uint32_t color =
          contact.color < 0 ? 0x17212bff : palette[std::size_t(contact.color) % std::size(palette)];
      Vec3d middle{};
      for (int i = 0; i < contact.count; ++i) {
        const Vec3d at = in_space(contact.points[i].point);
        middle = middle + at * (1.0 / contact.count);
        if (layers & layer_errors) {
          const double deep = -double(contact.points[i].separation) / (1e-3 * size_);
          const Vec3d x =
              D::dimension == 2 ? Vec3d{1, 0, 0} : math::normalize(math::cross(normal, Vec3d{0.3, 0.1, 0.95}));
          error_mark(at, deep, x, D::dimension == 2 ? Vec3d{0, 1, 0} : math::cross(normal, x));
        }
        if (layers & layer_colors)
          pen_.arrow(at, mark_ * 2.5 * normal, color);
        else if (layers & (layer_contacts | layer_forces))
          pen_.dot(at, normal_pen);
        if (layers & (layer_contacts | layer_forces))
          pen_.arrow(at, scale * double(contact.points[i].normal_impulse) * normal, normal_pen);
      }
      if (contact.count > 0 && (layers & (layer_contacts | layer_forces)))
        pen_.arrow(middle, scale * in_space(contact.friction_impulse), friction_pen);
    }
  }

  void joints(std::uint32_t layers) {
    std::vector<rigid::JointId> all;
    world_.joints(all);
    for (const rigid::JointId id : all) {
      if (pen_.full()) return;
      const auto definition = world_.joint_definition(id);
      if (!definition.ok()) continue;
      std::visit([&](const auto& d) { joint(id, d, layers); }, *definition);
    }
  }

 private:
  template <class Joint>
  void joint(rigid::JointId id, const Joint& d, std::uint32_t layers) {
    const Place a = place(d.body_a, d.frame_a), b = place(d.body_b, d.frame_b);
    if (layers & layer_joints) {
      pen_.dot(a.origin, joint_pen);
      pen_.dot(b.origin, joint_pen);
      pen_.line(a.origin, b.origin, joint_pen);
      if (const auto body = world_.state(d.body_a); body.ok())
        pen_.line(in_space(body->center_of_mass), a.origin, 0x9b6dd680);
      if (const auto body = world_.state(d.body_b); body.ok())
        pen_.line(in_space(body->center_of_mass), b.origin, 0x9b6dd680);
      limits(d, a, b);
    }
    // Motors and hands pull toward a place; to be away from it is no error.
    constexpr bool pulls =
        std::is_same_v<Joint, rigid::MotorJointDef<D>> || std::is_same_v<Joint, rigid::MouseJointDef<D>>;
    if ((layers & layer_errors) && !pulls)
      if (const auto state = world_.joint_state(id); state.ok()) {
        // Pulled apart by a thousandth of the picture, or turned by a tenth of a radian, is the worst that is told
        // apart.
        const double apart = double(state->linear_error) / (1e-3 * size_), turned = double(state->angular_error) / 0.1;
        error_mark(b.origin, std::max(apart, turned), a.x, a.y);
        pen_.line(a.origin, b.origin, error_pen(apart));
      }
    if (layers & layer_forces)
      if (const auto state = world_.joint_state(id); state.ok())
        pen_.arrow(b.origin, scale_.force * in_space(state->force), joint_pen);
  }

  /// Green where a constraint holds, over yellow to red where it fails by all that is told apart.
  static std::uint32_t error_pen(double share) {
    const double t = math::clamp(share, 0.0, 1.0);
    const auto red = std::uint32_t(math::min(1.0, 2 * t) * 229), green = std::uint32_t(math::min(1.0, 2 - 2 * t) * 170);
    return red << 24 | green << 16 | 0x30ff;
  }
  /// A square standing on its corner, the larger the worse.
  void error_mark(Vec3d at, double share, Vec3d x, Vec3d y) {
    const double r = (0.4 + 2.6 * math::clamp(share, 0.0, 1.0)) * mark_;
    const Vec3d corners[] = {at + r * x, at + r * y, at - r * x, at - r * y};
    for (int i = 0; i < 4; ++i) pen_.line(corners[i], corners[(i + 1) % 4], error_pen(share));
  }

  struct Place {
    Vec3d origin{}, x{}, y{}, z{};
  };
  Place place(rigid::BodyId body, const typename D::Transform& frame) const {
    const auto state = world_.state(body);
    typename D::Pose pose{};
    if (state.ok()) pose = state->pose;
    Place out;
    out.origin = in_space(world_point(pose, frame.p));
    if constexpr (D::dimension == 2) {
      const auto q = pose.rotation * frame.q;
      out.x = in_space(rotate(q, {1, 0}));
      out.y = in_space(rotate(q, {0, 1}));
      out.z = {0, 0, 1};
    } else {
      const auto q = pose.rotation * frame.q;
      out.x = in_space(rotate(q, {1, 0, 0}));
      out.y = in_space(rotate(q, {0, 1, 0}));
      out.z = in_space(rotate(q, {0, 0, 1}));
    }
    return out;
  }

  /// A range of turning as an arc with both ends, and where it is now.
  void range_of_turn(const Place& a, Vec3d x, Vec3d y, const rigid::JointLimit& d, Vec3d now) {
    const double radius = 4 * mark_, low = double(d.lower), high = double(d.upper);
    const auto at = [&](double angle) { return a.origin + radius * (math::cos(angle) * x + math::sin(angle) * y); };
    pen_.arc(a.origin, x, y, radius, low, high, joint_pen);
    pen_.line(a.origin, at(low), joint_pen);
    pen_.line(a.origin, at(high), joint_pen);
    pen_.line(a.origin, a.origin + 1.2 * radius * now, normal_pen);
  }
  /// A range of sliding as a bar with both ends.
  void range_of_way(Vec3d from, Vec3d along, Vec3d across, const rigid::JointLimit& d) {
    const double low = double(d.lower), high = double(d.upper);
    pen_.line(from + low * along, from + high * along, joint_pen);
    for (const double end : {low, high})
      pen_.line(from + end * along - 2 * mark_ * across, from + end * along + 2 * mark_ * across, joint_pen);
  }

  template <class Joint>
  void limits(const Joint& d, const Place& a, const Place& b) {
    if constexpr (std::is_same_v<Joint, rigid::HingeJointDef<D>>) {
      if (d.limit.enabled) range_of_turn(a, a.x, a.y, d.limit, b.x);
    } else if constexpr (std::is_same_v<Joint, rigid::SliderJointDef<D>>) {
      if (d.limit.enabled) range_of_way(a.origin, a.x, a.y, d.limit);
    } else if constexpr (std::is_same_v<Joint, rigid::DistanceJointDef<D>>) {
      const Vec3d way = b.origin - a.origin;
      const double length = math::length(way);
      if (!(length > 0)) return;
      const Vec3d along = way * (1 / length);
      Vec3d across = math::cross(along, D::dimension == 2 ? Vec3d{0, 0, 1} : Vec3d{0.3, 0.1, 0.95});
      across = across * (1 / std::max(1e-9, math::length(across)));
      if (d.limit.enabled) range_of_way(a.origin, along, across, d.limit);
      if (d.rope) range_of_way(a.origin, along, across, {true, 0, d.length});
    } else if constexpr (std::is_same_v<Joint, rigid::BallJointDef<D>>) {
      if constexpr (D::dimension == 3) {
        if (d.cone_angle >= 0) cone(a, double(d.cone_angle));
        if (d.twist.enabled) range_of_turn(a, a.x, a.y, d.twist, b.x);
      }
    } else if constexpr (std::is_same_v<Joint, rigid::GenericJointDef<D>>) {
      const Vec3d axes[] = {a.x, a.y, a.z};
      for (int i = 0; i < D::dimension; ++i)
        if (d.linear[i].free && d.linear[i].limit.enabled)
          range_of_way(a.origin, axes[i], axes[(i + 1) % D::dimension], d.linear[i].limit);
      if constexpr (D::dimension == 2) {
        if (d.angular[0].free && d.angular[0].limit.enabled) range_of_turn(a, a.x, a.y, d.angular[0].limit, b.x);
      } else {
        const Vec3d turned[] = {b.x, b.y, b.z};
        for (int i = 0; i < 3; ++i)
          if (d.angular[i].free && d.angular[i].limit.enabled)
            range_of_turn(a, axes[(i + 1) % 3], axes[(i + 2) % 3], d.angular[i].limit, turned[(i + 1) % 3]);
      }
    } else if constexpr (requires { d.limit; }) {
      // A path shows its way (Simulation::lines); its ends are where that way is cut.
      (void)a, (void)b;
    }
  }

  void cone(const Place& a, double angle) {
    const double height = 5 * mark_ * math::cos(angle), radius = 5 * mark_ * math::sin(angle);
    constexpr int pieces = 16;
    for (int i = 0; i < pieces; ++i) {
      const auto at = [&](int k) {
        const double turn = 2 * math::pi * k / pieces;
        return a.origin + height * a.z + radius * (math::cos(turn) * a.x + math::sin(turn) * a.y);
      };
      pen_.line(at(i), at(i + 1), joint_pen);
      if (i % 4 == 0) pen_.line(a.origin, at(i), joint_pen);
    }
  }

  /// Bodies that push each other or hang together, as the engine lets them sleep: touching contacts and joints between
  /// bodies that move by forces.
  void find_islands(const std::vector<rigid::BodyId>& all) {
    parent_.resize(all.size());
    std::iota(parent_.begin(), parent_.end(), 0);
    std::vector<std::pair<std::uint64_t, std::size_t>> sorted;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (const auto state = world_.state(all[i]); state.ok() && state->type == rigid::BodyType::dynamic)
        sorted.push_back({all[i].packed(), i});
    const auto before = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::sort(sorted.begin(), sorted.end(), before);
    const auto join = [&](rigid::BodyId a, rigid::BodyId b) {
      const auto i = std::lower_bound(sorted.begin(), sorted.end(), std::pair{a.packed(), std::size_t(0)}, before);
      const auto j = std::lower_bound(sorted.begin(), sorted.end(), std::pair{b.packed(), std::size_t(0)}, before);
      if (i == sorted.end() || j == sorted.end() || i->first != a.packed() || j->first != b.packed()) return;
      const std::size_t p = root(i->second), q = root(j->second);
      parent_[std::max(p, q)] = std::min(p, q);
    };
    std::vector<rigid::ContactView<D>> contacts;
    world_.contacts(contacts);
    for (const auto& contact : contacts) {
      const auto a = world_.body_of(contact.shape_a), b = world_.body_of(contact.shape_b);
      if (a.ok() && b.ok()) join(*a, *b);
    }
    std::vector<rigid::JointId> joints;
    world_.joints(joints);
    for (const rigid::JointId id : joints)
      if (const auto state = world_.joint_state(id); state.ok()) join(state->body_a, state->body_b);
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::uint32_t island_pen(std::size_t body) { return palette[root(body) % std::size(palette)]; }

  void bounds(rigid::ShapeId id, const typename D::Pose& pose, std::uint32_t pen) {
    const auto shape = world_.shape_geometry(id);
    const auto definition = world_.shape_definition(id);
    if (!shape.ok() || !definition.ok()) return;
    if constexpr (D::dimension == 2) {
      const auto box = geometry::bounds(*shape, math::Transform2f{{}, pose.rotation} * definition->local);
      const Vec3d at = in_space(pose.position), low = at + in_space(box.low), high = at + in_space(box.high);
      const Vec3d corners[] = {low, {high.x, low.y, 0}, high, {low.x, high.y, 0}};
      for (int i = 0; i < 4; ++i) pen_.line(corners[i], corners[(i + 1) % 4], pen);
    } else {
      if (shape->type == geometry::ShapeType3::plane) return;
      const auto box = geometry::bounds(*shape, math::Transform3f{{}, pose.rotation} * definition->local);
      const Vec3d at = pose.position;
      const auto corner = [&](int i) {
        return at + Vec3d{double(i & 1 ? box.high.x : box.low.x), double(i & 2 ? box.high.y : box.low.y),
                          double(i & 4 ? box.high.z : box.low.z)};
      };
      for (int i = 0; i < 8; ++i)
        for (const int bit : {1, 2, 4})
          if (!(i & bit)) pen_.line(corner(i), corner(i | bit), pen);
    }
  }

  const rigid::World<D>& world_;
  DebugPen pen_;
  double mark_, size_;
  ArrowScale scale_;
  std::vector<std::size_t> parent_;
};

}  // namespace

template <class D>
ArrowScale arrow_scale(const rigid::World<D>& world, float dt, double size) {
  // A weight of the mean body is drawn a twentieth of the picture long, and so is the speed of a fall from that height.
  const rigid::Totals<D> totals = world.totals();
  const rigid::Counters counters = world.counters();
  const double length = 0.05 * size, g = math::max(1.0, double(math::length(world.definition().gravity)));
  const double mean = totals.mass / std::max(1, counters.bodies);
  ArrowScale out;
  out.velocity = length / math::sqrt(2 * g * length);
  out.force = mean > 0 ? length / (mean * g) : 0;
  out.impulse = out.force / double(dt);
  return out;
}

template <class D>
void debug_lines(const rigid::World<D>& world, std::uint32_t layers, float dt, double size, std::vector<Line>& out) {
  Drawing<D> drawing(world, size, arrow_scale(world, dt, size), out);
  if (layers & (layer_bounds | layer_centers | layer_islands | layer_velocities | layer_forces)) drawing.bodies(layers);
  if (layers & (layer_contacts | layer_colors | layer_forces | layer_errors)) drawing.contacts(layers, dt);
  if (layers & (layer_joints | layer_forces | layer_errors)) drawing.joints(layers);
  if (layers & layer_water) water_lines(world, size, out);
}

template ArrowScale arrow_scale(const rigid::World2&, float, double);
template ArrowScale arrow_scale(const rigid::World3&, float, double);
template void debug_lines(const rigid::World2&, std::uint32_t, float, double, std::vector<Line>&);
template void debug_lines(const rigid::World3&, std::uint32_t, float, double, std::vector<Line>&);

}  // namespace carom::host
