#include "carom/particles/rope.h"

#include "carom/core/hash.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles {

namespace detail {

void Rope::resize(std::size_t n) {
  for (auto* list : {&position, &velocity, &force, &start, &guess, &right, &solution, &momentum}) list->resize(n);
  for (auto* list : {&lower, &diagonal, &upper, &factor, &held}) list->resize(n);
  lump.resize(n);
  contacts.resize(n);
  edges.resize(n - 1);
  nodes.resize(n);
  mass.resize(n);
  room.resize(n);
  rest.resize(n - 1);
  tension.resize(n - 1);
  theta.resize(2 * (n - 1));
  pull.resize(n - 1);
  broken.resize(n - 1);
}

namespace {

bool finite_point(Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); }

Status check_number(const char* field, double value, bool zero_allowed) {
  if (math::is_finite(value) && (value > 0 || (zero_allowed && value == 0))) return {};
  return core::Error{core::refused(core::text("RopeMaterial::", field), value,
                                   zero_allowed ? "a finite number ≥ 0" : "a finite number > 0")};
}

Status check_material(const RopeMaterial& m) {
  const struct {
    const char* name;
    double value;
    bool zero;
  } fields[] = {{"mass_per_length", m.mass_per_length, false},
                {"radius", m.radius, false},
                {"axial_stiffness", m.axial_stiffness, false},
                {"axial_damping", m.axial_damping, true},
                {"bending_stiffness", m.bending_stiffness, true},
                {"bending_damping", m.bending_damping, true},
                {"torsional_stiffness", m.torsional_stiffness, true},
                {"friction", m.friction, true},
                {"drag_coefficient", m.drag_coefficient, true},
                {"skin_coefficient", m.skin_coefficient, true},
                {"break_tension", m.break_tension, true}};
  for (const auto& field : fields)
    if (Status status = check_number(field.name, field.value, field.zero); !status.ok()) return status;
  return {};
}

/// Points at equal spacing along a line of corners.
void lay(std::span<const Vec3d> corners, double way, int segments, std::vector<Vec3d>& out) {
  std::size_t leg = 1;
  double before = 0, here = distance(corners[0], corners[1]);
  for (int i = 0; i <= segments; ++i) {
    const double s = way * i / segments;
    while (s > before + here && leg + 1 < corners.size()) {
      before += here;
      ++leg;
      here = distance(corners[leg - 1], corners[leg]);
    }
    const double t = here > 0 ? math::min((s - before) / here, 1.0) : 0.0;
    out[std::size_t(i)] = lerp(corners[leg - 1], corners[leg], t);
  }
}

/// A rope that is longer than its way lies in folds from side to side, each segment as long as it is at rest: as struts
/// they would hold more energy than a fall.
void fold(double rest, std::vector<Vec3d>& points) {
  const int last = int(points.size()) - 1;
  const std::vector<Vec3d> way = points;
  for (int i = 1; i < last; ++i) {
    // Every other one to one side; of an odd number of segments the last two aside, by 60° from each other.
    const bool turned = last % 2 == 1 && i == last - 1;
    if (i % 2 == 0 && !turned) continue;
    const std::size_t k = std::size_t(i);
    const double reach = math::max(distance(way[k], way[k - 1]), distance(way[k], way[k + 1]));
    if (!(rest > reach)) continue;
    const Vec3d along = normalize_or(way[k + 1] - way[k - 1], Vec3d{1, 0, 0}, 1e-12);
    const Vec3d side = math::normalize(math::perpendicular(along)), other = cross(along, side);
    const double width = math::sqrt(rest * rest - reach * reach);
    points[k] += width * (turned ? 0.5 * side + math::sqrt(0.75) * other : side);
  }
}

}  // namespace
}  // namespace detail

using detail::Rope;

namespace detail {
namespace {
/// A rope to read from; an empty one for a number that names none.
const Rope& rope_at(const std::vector<Rope>& ropes, int index) {
  static const Rope none;
  return index >= 0 && index < int(ropes.size()) ? ropes[std::size_t(index)] : none;
}
}  // namespace
}  // namespace detail

RopeSet::RopeSet() = default;
RopeSet::~RopeSet() = default;
RopeSet::RopeSet(const RopeSet&) = default;
RopeSet& RopeSet::operator=(const RopeSet&) = default;
RopeSet::RopeSet(RopeSet&&) noexcept = default;
RopeSet& RopeSet::operator=(RopeSet&&) noexcept = default;

Result<int> RopeSet::add(const RopeDef& def) {
  if (Status status = detail::check_material(def.material); !status.ok()) return status.error();
  if (def.points.size() < 2)
    return core::Error{core::refused("RopeDef::points", def.points.size(), "two points or more")};
  double way = 0;
  for (std::size_t i = 0; i < def.points.size(); ++i) {
    if (!detail::finite_point(def.points[i]))
      return core::Error{core::text("RopeDef::points[", i, "] is not finite, expected metres")};
    if (i > 0) way += distance(def.points[i - 1], def.points[i]);
  }
  if (def.segments < 1 || def.segments > 10'000)
    return core::Error{core::refused("RopeDef::segments", def.segments, "1 … 10 000")};
  if (!math::is_finite(def.length) || def.length < 0)
    return core::Error{core::refused("RopeDef::length", def.length, "a finite number ≥ 0 (0: as long as it lies)")};
  const double rest = def.length > 0 ? def.length : way;
  if (!(way / def.segments > 1e-6) || !(rest / def.segments > 1e-6))
    return core::Error{
        core::refused("length of a segment of RopeDef", math::min(way, rest) / def.segments, "above 1e-6 m")};
  Rope rope;
  rope.material = def.material;
  rope.filter = def.filter;
  rope.collide = def.collide;
  rope.touch = def.touch;
  rope.segment = rest / def.segments;
  rope.resize(std::size_t(def.segments) + 1);
  detail::lay(def.points, way, def.segments, rope.position);
  if (rest > 1.02 * way) detail::fold(rope.segment, rope.position);
  for (double& length : rope.rest) length = rope.segment;
  ropes_.push_back(std::move(rope));
  return int(ropes_.size()) - 1;
}

namespace detail {
namespace {
Status check_node(const std::vector<Rope>& ropes, int rope, int& node) {
  if (rope < 0 || rope >= int(ropes.size()))
    return core::Error{core::refused("rope", rope, core::text("0 … ", int(ropes.size()) - 1))};
  const int count = ropes[std::size_t(rope)].count();
  if (node == -1) node = count - 1;
  if (node < 0 || node >= count)
    return core::Error{
        core::refused(core::text("node of rope ", rope), node, core::text("0 … ", count - 1, ", or −1"))};
  return {};
}
}  // namespace
}  // namespace detail

Status RopeSet::attach(int index, const RopeAttachment& given, const rigid::World3& world) {
  RopeAttachment attachment = given;
  if (Status status = detail::check_node(ropes_, index, attachment.node); !status.ok()) return status;
  if (!detail::finite_point(attachment.point))
    return core::Error{"RopeAttachment::point is not finite, expected metres"};
  Rope& rope = ropes_[std::size_t(index)];
  const int last = rope.count() - 1;
  if (attachment.clamped && attachment.node != 0 && attachment.node != last)
    return core::Error{
        core::refused("RopeAttachment::node, clamped,", attachment.node, core::text("an end, 0 or ", last))};
  math::Pose3 pose;
  if (attachment.body != rigid::BodyId{}) {
    const auto state = world.state(attachment.body);
    if (!state) return core::Error{core::text("RopeAttachment::body: ", state.error().message)};
    pose = state->pose;
  }
  if (const Status gone = detach(index, attachment.node); !gone.ok()) return gone;
  detail::RopeGrip grip;
  grip.attachment = attachment;
  if (attachment.clamped) {
    const bool front = attachment.node == 0;
    const Vec3d along =
        normalize(rope.position[std::size_t(front ? 1 : last - 1)] - rope.position[std::size_t(attachment.node)]);
    const math::Quatd turn(pose.rotation);
    grip.second = attachment.point + rope.rest[std::size_t(front ? 0 : last - 1)] * inverse_rotate(turn, along);
    Vec3d across = math::abs(along.x) < 0.6 ? cross(along, Vec3d{1, 0, 0}) : cross(along, Vec3d{0, 1, 0});
    across = normalize(across);
    if (!front)  // what the first end's director is when it is carried along the rope: no twist to begin with
      for (const detail::RopeGrip& other : rope.grips)
        if (other.attachment.clamped && other.attachment.node == 0) {
          math::Pose3 base;
          if (other.attachment.body != rigid::BodyId{})
            if (const auto state = world.state(other.attachment.body)) base = state->pose;
          across = detail::carried_director(rope, rotate(math::Quatd(base.rotation), other.director));
        }
    grip.director = inverse_rotate(turn, across);
  }
  rope.grips.push_back(grip);
  return {};
}

Status RopeSet::detach(int index, int node) {
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  std::erase_if(ropes_[std::size_t(index)].grips,
                [&](const detail::RopeGrip& grip) { return grip.attachment.node == node; });
  return {};
}

Status RopeSet::add_mass(int index, int node, double mass) {
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  double& lump = ropes_[std::size_t(index)].lump[std::size_t(node)];
  if (!math::is_finite(mass) || lump + mass < 0)
    return core::Error{core::refused("mass of a lump", lump + mass, "a finite number ≥ 0 in all")};
  lump += mass;
  return {};
}

Status RopeSet::set_winch(int index, int end, double speed) {
  int node = end == 0 ? 0 : -1;
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  if (end != 0 && end != 1) return core::Error{core::refused("end", end, "0 (first) or 1 (last)")};
  if (!math::is_finite(speed)) return core::Error{core::refused("speed of a winch", speed, "a finite number in m/s")};
  ropes_[std::size_t(index)].winch[end] = speed;
  return {};
}

Status RopeSet::set_twist(int index, double angle) {
  int node = 0;
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  if (!math::is_finite(angle)) return core::Error{core::refused("twist", angle, "a finite number in rad")};
  Rope& rope = ropes_[std::size_t(index)];
  rope.twist += angle - rope.twist_offset;
  rope.twist_offset = angle;
  return {};
}

Status RopeSet::set_velocity(int index, int node, Vec3d velocity) {
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  if (!detail::finite_point(velocity)) return core::Error{"velocity of a particle is not finite, expected m/s"};
  ropes_[std::size_t(index)].velocity[std::size_t(node)] = velocity;
  return {};
}

namespace detail {
namespace {
double node_mass(const Rope& rope, int i) {
  const double before = i > 0 ? rope.rest[std::size_t(i) - 1] : 0,
               after = i + 1 < rope.count() ? rope.rest[std::size_t(i)] : 0;
  return 0.5 * rope.material.mass_per_length * (before + after) + rope.lump[std::size_t(i)];
}
}  // namespace
}  // namespace detail

Status RopeSet::add_impulse(int index, int node, Vec3d impulse, rigid::World3& world) {
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  if (!detail::finite_point(impulse)) return core::Error{"impulse on a particle is not finite, expected N s"};
  Rope& rope = ropes_[std::size_t(index)];
  for (const detail::RopeGrip& grip : rope.grips)
    if (grip.attachment.node == node) {
      const rigid::BodyId body = grip.attachment.body;
      if (!world.contains(body)) return {};
      return world.add_impulse_at(body, Vec3f(impulse), rope.position[std::size_t(node)]);
    }
  rope.velocity[std::size_t(node)] += impulse / detail::node_mass(rope, node);
  return {};
}

Status RopeSet::cut(int index, int segment) {
  int node = 0;
  if (Status status = detail::check_node(ropes_, index, node); !status.ok()) return status;
  Rope& rope = ropes_[std::size_t(index)];
  if (segment < 0 || segment >= int(rope.rest.size()))
    return core::Error{core::refused("segment", segment, core::text("0 … ", rope.rest.size() - 1))};
  rope.broken[std::size_t(segment)] = 1;
  rope.tension[std::size_t(segment)] = 0;
  return {};
}

Status RopeSet::set_substeps(int substeps) {
  if (substeps < 1 || substeps > 256) return core::Error{core::refused("substeps", substeps, "1 … 256")};
  substeps_ = substeps;
  return {};
}

Status RopeSet::step(rigid::World3& world, double dt) {
  if (!(dt > 0 && dt <= 1)) return core::Error{core::refused("dt", dt, "above 0 and at most 1 s")};
  return detail::RopeSolver{*this, world, dt}.run();
}

int RopeSet::size() const { return int(ropes_.size()); }
std::span<const Vec3d> RopeSet::positions(int rope) const { return detail::rope_at(ropes_, rope).position; }
std::span<const Vec3d> RopeSet::velocities(int rope) const { return detail::rope_at(ropes_, rope).velocity; }
std::span<const double> RopeSet::tensions(int rope) const { return detail::rope_at(ropes_, rope).tension; }
std::span<const std::uint8_t> RopeSet::broken(int rope) const { return detail::rope_at(ropes_, rope).broken; }
double RopeSet::peak_tension(int rope) const { return detail::rope_at(ropes_, rope).peak; }
double RopeSet::twist(int rope) const { return detail::rope_at(ropes_, rope).twist; }
const RopeMaterial& RopeSet::material(int rope) const { return detail::rope_at(ropes_, rope).material; }

double RopeSet::rest_length(int rope) const {
  double sum = 0;
  for (const double length : detail::rope_at(ropes_, rope).rest) sum += length;
  return sum;
}
double RopeSet::length(int index) const {
  const Rope& rope = detail::rope_at(ropes_, index);
  double sum = 0;
  for (int i = 0; i + 1 < rope.count(); ++i)
    if (!rope.broken[std::size_t(i)]) sum += distance(rope.position[std::size_t(i)], rope.position[std::size_t(i) + 1]);
  return sum;
}
double RopeSet::mass(int index) const {
  double sum = rest_length(index) * detail::rope_at(ropes_, index).material.mass_per_length;
  for (const double lump : detail::rope_at(ropes_, index).lump) sum += lump;
  return sum;
}
double RopeSet::mass(int index, int node) const {
  const Rope& rope = detail::rope_at(ropes_, index);
  return detail::node_mass(rope, math::clamp(node, 0, rope.count() - 1));
}
Vec3d RopeSet::attachment_force(int index, int node) const {
  const Rope& rope = detail::rope_at(ropes_, index);
  if (node == -1) node = rope.count() - 1;
  for (const detail::RopeGrip& grip : rope.grips)
    if (grip.attachment.node == node) return grip.force;
  return {};
}
int RopeSet::contact_count(int index) const {
  int count = 0;
  for (const detail::RopeContact& contact : detail::rope_at(ropes_, index).contacts)
    count += contact.state != detail::RopeHold::none;
  for (const detail::RopeEdge& edge : detail::rope_at(ropes_, index).edges)
    count += edge.contact.state != detail::RopeHold::none;
  return count;
}

Vec3d RopeSet::momentum() const {
  Vec3d sum{};
  for (const Rope& rope : ropes_)
    for (int i = 0; i < rope.count(); ++i) sum += detail::node_mass(rope, i) * rope.velocity[std::size_t(i)];
  return sum;
}
double RopeSet::kinetic_energy() const {
  double sum = 0;
  for (const Rope& rope : ropes_)
    for (int i = 0; i < rope.count(); ++i)
      sum += 0.5 * detail::node_mass(rope, i) * length_squared(rope.velocity[std::size_t(i)]);
  return sum;
}
double RopeSet::potential_energy(Vec3d gravity) const {
  double sum = 0;
  for (const Rope& rope : ropes_)
    for (int i = 0; i < rope.count(); ++i)
      sum -= detail::node_mass(rope, i) * dot(gravity, rope.position[std::size_t(i)]);
  return sum;
}
double RopeSet::elastic_energy() const {
  double sum = 0;
  for (const Rope& rope : ropes_) {
    for (std::size_t i = 0; i + 1 < rope.position.size(); ++i) {
      if (rope.broken[i]) continue;
      const double stretch = distance(rope.position[i], rope.position[i + 1]) - rope.rest[i];
      sum += 0.5 * rope.material.axial_stiffness / rope.rest[i] * stretch * stretch;
    }
    sum += detail::bending_energy(rope);
    sum +=
        0.5 * rope.material.torsional_stiffness / (rope.segment * double(rope.rest.size())) * rope.twist * rope.twist;
  }
  return sum;
}
std::uint64_t RopeSet::state_hash() const {
  core::StateHash hash;
  for (const Rope& rope : ropes_) {
    for (std::size_t i = 0; i < rope.position.size(); ++i) {
      const Vec3d x = rope.position[i], v = rope.velocity[i];
      hash.add(x.x).add(x.y).add(x.z).add(v.x).add(v.y).add(v.z);
    }
    for (const double length : rope.rest) hash.add(length);
    for (const std::uint8_t gone : rope.broken) hash.add(std::uint32_t{gone});
    hash.add(rope.twist);
  }
  return hash.digest();
}

}  // namespace carom::particles
