#include "apps/host/debug_draw.h"

#include <algorithm>
#include <numeric>

#include "apps/host/stage.h"

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
      : world_(world), mark_(0.012 * size), scale_(scale), out_(out) {}

  void bodies(std::uint32_t layers) {
    std::vector<rigid::BodyId> all;
    world_.bodies(all);
    if (layers & layer_islands) find_islands(all);
    std::vector<rigid::ShapeId> shapes;
    for (std::size_t i = 0; i < all.size() && out_.size() < max_lines; ++i) {
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
      if ((layers & layer_centers) && moves) cross(center, 0x17212bff);
      if ((layers & layer_velocities) && state->type != rigid::BodyType::fixed && state->awake) {
        arrow(center, scale_.velocity * in_space(state->linear_velocity), velocity_pen);
        if constexpr (D::dimension == 3) arrow(center, scale_.velocity * in_space(state->angular_velocity), spin_pen);
      }
      if ((layers & layer_forces) && moves && state->awake) {
        const double weight = double(state->mass) * scale_.force;
        arrow(center, weight * in_space(world_.definition().gravity), weight_pen);
      }
    }
  }

  void contacts(std::uint32_t layers, float dt) {
    std::vector<rigid::ContactView<D>> all;
    world_.contacts(all);
    const double scale = layers & layer_forces ? scale_.force / double(dt) : scale_.impulse;
    for (const rigid::ContactView<D>& contact : all) {
      if (out_.size() >= max_lines) return;
      const Vec3d normal = in_space(contact.normal);
      const std::uint32_t color =
          contact.color < 0 ? 0x17212bff : palette[std::size_t(contact.color) % std::size(palette)];
      Vec3d middle{};
      for (int i = 0; i < contact.count; ++i) {
        const Vec3d at = in_space(contact.points[i].point);
        middle = middle + at * (1.0 / contact.count);
        if (layers & layer_colors)
          arrow(at, mark_ * 2.5 * normal, color);
        else
          dot(at, normal_pen);
        if (layers & (layer_contacts | layer_forces))
          arrow(at, scale * double(contact.points[i].normal_impulse) * normal, normal_pen);
      }
      if (contact.count > 0 && (layers & (layer_contacts | layer_forces)))
        arrow(middle, scale * in_space(contact.friction_impulse), friction_pen);
    }
  }

  void joints(std::uint32_t layers) {
    std::vector<rigid::JointId> all;
    world_.joints(all);
    for (const rigid::JointId id : all) {
      if (out_.size() >= max_lines) return;
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
      dot(a.origin, joint_pen);
      dot(b.origin, joint_pen);
      line(a.origin, b.origin, joint_pen);
      if (const auto body = world_.state(d.body_a); body.ok())
        line(in_space(body->center_of_mass), a.origin, 0x9b6dd680);
      if (const auto body = world_.state(d.body_b); body.ok())
        line(in_space(body->center_of_mass), b.origin, 0x9b6dd680);
      if constexpr (requires { d.limit; }) limit(d, a, b);
      if constexpr (std::is_same_v<Joint, rigid::BallJointDef<D>>)
        if (D::dimension == 3 && d.cone_angle >= 0) cone(a, double(d.cone_angle));
    }
    if (layers & layer_forces)
      if (const auto state = world_.joint_state(id); state.ok())
        arrow(b.origin, scale_.force * in_space(state->force), joint_pen);
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

  /// A hinge's range as an arc, a slider's and a rope's as a bar.
  template <class Joint>
  void limit(const Joint& d, const Place& a, const Place& b) {
    if (!d.limit.enabled) return;
    const double low = double(d.limit.lower), high = double(d.limit.upper);
    if constexpr (std::is_same_v<Joint, rigid::HingeJointDef<D>>) {
      const double radius = 4 * mark_;
      const auto at = [&](double angle) {
        return a.origin + radius * (math::cos(angle) * a.x + math::sin(angle) * a.y);
      };
      constexpr int pieces = 16;
      for (int i = 0; i < pieces; ++i)
        line(at(low + (high - low) * i / pieces), at(low + (high - low) * (i + 1) / pieces), joint_pen);
      line(a.origin, at(low), joint_pen);
      line(a.origin, at(high), joint_pen);
      line(a.origin, b.origin + 1.2 * radius * b.x, normal_pen);
    } else if constexpr (std::is_same_v<Joint, rigid::SliderJointDef<D>>) {
      line(a.origin + low * a.x, a.origin + high * a.x, joint_pen);
      for (const double end : {low, high})
        line(a.origin + end * a.x - 2 * mark_ * a.y, a.origin + end * a.x + 2 * mark_ * a.y, joint_pen);
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
      line(at(i), at(i + 1), joint_pen);
      if (i % 4 == 0) line(a.origin, at(i), joint_pen);
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
      for (int i = 0; i < 4; ++i) line(corners[i], corners[(i + 1) % 4], pen);
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
          if (!(i & bit)) line(corner(i), corner(i | bit), pen);
    }
  }

  void line(Vec3d a, Vec3d b, std::uint32_t pen) {
    if (out_.size() < max_lines && math::is_finite(a) && math::is_finite(b)) out_.push_back({a, b, pen});
  }
  void dot(Vec3d at, std::uint32_t pen) { cross(at, pen, 0.5); }
  void cross(Vec3d at, std::uint32_t pen, double share = 1) {
    const double r = share * mark_;
    line(at - Vec3d{r, 0, 0}, at + Vec3d{r, 0, 0}, pen);
    line(at - Vec3d{0, r, 0}, at + Vec3d{0, r, 0}, pen);
    if (D::dimension == 3) line(at - Vec3d{0, 0, r}, at + Vec3d{0, 0, r}, pen);
  }
  void arrow(Vec3d from, Vec3d way, std::uint32_t pen) {
    const double length = math::length(way);
    if (!(length > 0.25 * mark_)) return;
    const Vec3d to = from + way, along = way * (1 / length);
    Vec3d side = math::cross(along, D::dimension == 2 ? Vec3d{0, 0, 1} : Vec3d{0.3, 0.1, 0.95});
    side = side * (1 / std::max(1e-9, math::length(side)));
    const double head = std::min(0.35 * length, mark_);
    line(from, to, pen);
    line(to, to - head * along + 0.5 * head * side, pen);
    line(to, to - head * along - 0.5 * head * side, pen);
  }

  const rigid::World<D>& world_;
  double mark_;
  ArrowScale scale_;
  std::vector<Line>& out_;
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
  if (layers & (layer_contacts | layer_colors | layer_forces)) drawing.contacts(layers, dt);
  if (layers & (layer_joints | layer_forces)) drawing.joints(layers);
}

template ArrowScale arrow_scale(const rigid::World2&, float, double);
template ArrowScale arrow_scale(const rigid::World3&, float, double);
template void debug_lines(const rigid::World2&, std::uint32_t, float, double, std::vector<Line>&);
template void debug_lines(const rigid::World3&, std::uint32_t, float, double, std::vector<Line>&);

}  // namespace carom::host
