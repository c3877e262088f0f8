#include "carom/rigid/advice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>

#include "carom/math/elementary.h"
#include "carom/rigid/detail/load.h"
#include "carom/rigid/detail/shape_manifolds.h"

namespace carom::rigid {
namespace {

constexpr double touching = 0.02;  // m: bodies so near rest on each other
constexpr int no_part = -1;

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, pattern, values...);
  return buffer;
}

/// A body as the adviser sees it.
template <class D>
struct Part {
  BodyId id{};
  BodyState<D> state{};
  typename D::Inertia inverse_inertia{};  ///< world axes
  double inverse_mass = 0, weight = 0;    ///< 1/kg, N
  double height = 0;                      ///< m against gravity
  double load = 0;                        ///< N that rests or hangs on it, its own weight included
  double sag = 0;                         ///< m
  bool jointed = false;
  double factor = 1;  ///< the solver's mass over its own (detail/load.h)
  std::string name;
};
/// A contact or joint that carries `above` by `below` (no_part: what does not move).
struct Support {
  int above = no_part, below = no_part;
  double stiffness = 0;  ///< N/m, of a joint; 1/s², ω² of a contact
  JointId joint{};
  int points = 0;                      ///< of a contact
  double mobility[2][4] = {{0}, {0}};  ///< 1/kg, of the body above and below at each point

  double yields(double force, double above_factor, double below_factor) const {
    if (points == 0) return force / stiffness;
    double sum = 0;
    for (int i = 0; i < points; ++i) sum += 1 / (mobility[0][i] / above_factor + mobility[1][i] / below_factor);
    return force / (stiffness * sum);
  }
};

float inverse_inertia_of(const World2& world, BodyId body, const BodyState<Dim2>&) {
  const auto p = world.mass_properties2(body);
  return p.ok() && p->inertia > 0 ? float(1 / p->inertia) : 0;
}
Mat3f inverse_inertia_of(const World3& world, BodyId body, const BodyState<Dim3>& state) {
  const auto p = world.mass_properties3(body);
  if (!p.ok() || !(p->inertia.cx.x > 0)) return Mat3f::zero();
  const Mat3d r = to_matrix(Quatd(state.pose.rotation));
  return Mat3f(r * inverse(p->inertia) * transpose(r));
}
double inner(float a, float b) { return double(a) * double(b); }
double inner(const Vec3f& a, const Vec3f& b) { return double(dot(a, b)); }

template <class D>
double mobility(const Part<D>& part, const typename D::Position& point, const typename D::Vector& n) {
  if (part.inverse_mass == 0) return 0;
  const auto turn = cross(typename D::Vector(point - part.state.center_of_mass), n);
  return part.inverse_mass + inner(turn, part.inverse_inertia * turn);
}

template <class D>
class Adviser {
 public:
  Adviser(const World<D>& world, float dt, const AdviceOptions& options)
      : world_(world), definition_(world.definition()), options_(options), dt_(double(dt)) {
    h_ = dt_ / definition_.substeps;
    contact_hertz_ = std::min(double(definition_.contact_hertz), double(detail::most_contact_turns) / h_);
    joint_turns_ = double(detail::most_turns_of_joints(definition_.joint_solver));
    joint_hertz_ = std::min(double(definition_.joint_hertz), joint_turns_ / h_);
    const double g = double(math::length(definition_.gravity));
    if (g > 0) up_ = definition_.gravity / float(-g);
    gravity_ = g;
    std::vector<BodyId> ids;
    world.bodies(ids);
    for (const BodyId id : ids) add_part(id);
    std::vector<JointId> joints;
    world.joints(joints);
    for (const JointId id : joints)
      if (const auto joint = world.joint_state(id); joint.ok())
        for (const BodyId body : {joint->body_a, joint->body_b})
          if (const int part = place_of(body); part != no_part) parts_[std::size_t(part)].jointed = true;
  }

  std::vector<Advice> all() {
    capped();
    springs();
    fast_bodies();
    if (gravity_ > 0) {
      contacts();
      carry(AdviceKind::sag, options_.sag_share);
      joints();
      carry(AdviceKind::stretch, options_.stretch_share);
    }
    return std::move(advice_);
  }

 private:
  void add_part(BodyId id) {
    Part<D> part;
    part.id = id;
    part.state = world_.state(id).value();
    const auto definition = world_.body_definition(id);
    if (definition.ok()) part.name = std::string(definition->name);
    if (part.name.empty()) part.name = "body " + std::to_string(id.index);
    if (part.state.type == BodyType::dynamic && part.state.mass > 0) {
      part.inverse_mass = 1 / double(part.state.mass);
      part.inverse_inertia = inverse_inertia_of(world_, id, part.state);
      const float scale =
          definition.ok() ? definition->gravity_scale * definition->time_scale * definition->time_scale : 1;
      part.weight = std::max(0.0, double(part.state.mass) * gravity_ * double(scale));
    }
    part.height = double(dot(part.state.center_of_mass, typename D::Position(up_)));
    if (std::size_t(id.index) >= place_.size()) place_.resize(std::size_t(id.index) + 1, no_part);
    place_[std::size_t(id.index)] = int(parts_.size());
    parts_.push_back(part);
  }
  int place_of(BodyId id) const { return id.is_null() ? no_part : place_[std::size_t(id.index)]; }
  bool moves(int part) const { return part != no_part && parts_[std::size_t(part)].inverse_mass > 0; }
  void say(AdviceKind kind, BodyId body, JointId joint, double predicted, int substeps, std::string message) {
    advice_.push_back({kind, body, joint, predicted, substeps, std::move(message)});
  }
  /// Substeps at which a soft row of `hertz` (as it is now) gives way by `share` of what it does, 0 where over 64 do
  /// not.
  int substeps_for(double hertz, double cap, double share) const {
    const double wanted = hertz / std::sqrt(share);
    const int substeps = int(std::ceil(wanted * dt_ / cap - 1e-4));
    return substeps <= 64 ? std::max(substeps, definition_.substeps) : 0;
  }

  void capped() {
    const auto look = [&](const char* what, double wanted, double used, double cap) {
      if (wanted <= used * 1.0001) return;
      const int substeps = int(std::ceil(wanted * dt_ / cap - 1e-4));
      say(AdviceKind::capped_stiffness, {}, {}, used, substeps <= 64 ? substeps : 0,
          format("%s of %.4g Hz is capped at %.4g Hz by %d substeps of %.3g ms; %d substeps would use it whole", what,
                 wanted, used, definition_.substeps, 1e3 * h_, substeps));
    };
    look("contact_hertz", double(definition_.contact_hertz), contact_hertz_, double(detail::most_contact_turns));
    look("joint_hertz", double(definition_.joint_hertz), joint_hertz_, joint_turns_);
  }

  /// Springs are exact up to ω h = .7 and implicit, which damps, from there on.
  void stiff_spring(const std::string& what, double hertz, BodyId body, JointId joint) {
    const double angle = 2 * math::pi * hertz * h_;
    if (!(angle > 0.7)) return;
    const int substeps = int(std::ceil(2 * math::pi * hertz * dt_ / 0.7 - 1e-4));
    say(AdviceKind::stiff_spring, body, joint, angle, substeps <= 64 ? substeps : 0,
        format("%s: a spring of %.4g Hz turns by %.2g rad in a substep and will be damped; exact up to %.4g Hz, or "
               "with %d "
               "substeps",
               what.c_str(), hertz, angle, 0.7 / (2 * math::pi * h_), substeps));
  }
  void springs() {
    std::vector<JointId> ids;
    world_.joints(ids);
    for (const JointId id : ids) {
      const auto definition = world_.joint_definition(id);
      if (!definition.ok()) continue;
      const auto state = world_.joint_state(id);
      const std::string what = "joint of " + parts_[std::size_t(place_of(state->body_b))].name;
      std::visit(
          [&](const auto& d) {
            if constexpr (requires { d.spring.hertz; }) stiff_spring(what, double(d.spring.hertz), state->body_b, id);
            if constexpr (requires { d.linear.hertz; }) {
              stiff_spring(what, double(std::max(d.linear.hertz, d.angular.hertz)), state->body_b, id);
            }
          },
          definition.value());
    }
    std::vector<EffectorId> effectors;
    world_.effectors(effectors);
    for (const EffectorId id : effectors) {
      const auto definition = world_.effector_definition(id);
      if (!definition.ok()) continue;
      const auto* spring = std::get_if<SpringDamper<D>>(&definition.value());
      if (spring == nullptr) continue;
      double inverse = 0;
      for (const BodyId body : {spring->body_a, spring->body_b})
        if (const int part = place_of(body); part != no_part) inverse += parts_[std::size_t(part)].inverse_mass;
      const BodyId subject = spring->body_a;
      const int part = place_of(subject);
      stiff_spring("spring of " + (part == no_part ? std::string("the world") : parts_[std::size_t(part)].name),
                   std::sqrt(std::max(0.0, spring->stiffness) * inverse) / (2 * math::pi), subject, {});
    }
  }

  void fast_bodies() {
    if (definition_.continuous) return;
    for (const Part<D>& part : parts_) {
      if (part.inverse_mass == 0) continue;
      const double way = double(math::length(part.state.linear_velocity)) * dt_, size = smallest_extent(part.id);
      if (way > size)
        say(AdviceKind::fast_body, part.id, {}, way, 0,
            format("%s goes %.3g m in a step and is %.3g m thick: it may pass through walls; set continuous",
                   part.name.c_str(), way, size));
    }
  }
  double smallest_extent(BodyId body) const {
    std::vector<ShapeId> shapes;
    world_.shapes(body, shapes);
    double least = 1e30;
    for (const ShapeId id : shapes) {
      const auto extents = geometry::bounds(world_.shape_geometry(id).value(), typename D::Transform{}).extents();
      for (int i = 0; i < D::dimension; ++i) least = std::min(least, 2 * double(extents[i]));
    }
    return shapes.empty() ? 0 : least;
  }

  /// Who rests on whom: touching pairs whose normal is more upright than level.
  void contacts() {
    supports_.clear();
    std::vector<ShapeId> shapes, near;
    for (int b = 0; b < int(parts_.size()); ++b) {
      if (!moves(b)) continue;
      world_.shapes(parts_[std::size_t(b)].id, shapes);
      for (const ShapeId own : shapes) {
        const auto geometry = world_.shape_geometry(own).value();
        if (!convex(geometry)) continue;
        const auto definition = world_.shape_definition(own).value();
        if (definition.sensor) continue;
        const typename D::Pose pose = parts_[std::size_t(b)].state.pose * definition.local;
        const auto box =
            geometry::grow(geometry::bounds(geometry, typename D::Transform{{}, pose.rotation}), float(touching));
        const typename D::Bounds bounds{pose.position + typename D::Position(box.low),
                                        pose.position + typename D::Position(box.high)};
        if (!world_.overlap_bounds(bounds, near).ok()) continue;
        for (const ShapeId other : near) add_contact(b, geometry, definition, pose, own, other);
      }
    }
  }
  static bool convex(const geometry::Shape2& s) { return s.type != geometry::ShapeType2::chain; }
  static bool convex(const geometry::Shape3& s) { return geometry::is_convex(s); }

  void add_contact(int b, const typename D::Shape& geometry, const ShapeDef<D>& definition,
                   const typename D::Pose& pose, ShapeId own, ShapeId other) {
    const int a = place_of(world_.body_of(other).value());
    if (a == b) return;
    const auto theirs = world_.shape_geometry(other).value();
    const auto their_definition = world_.shape_definition(other).value();
    // Pairs of two moving convex bodies are met twice: the older shape tells.
    if (moves(a) && convex(theirs) && other.index < own.index) return;
    if (their_definition.sensor || (definition.filter.category & their_definition.filter.mask) == 0 ||
        (their_definition.filter.category & definition.filter.mask) == 0)
      return;
    const typename D::Pose placed = parts_[std::size_t(a)].state.pose * their_definition.local;
    detail::for_manifolds(theirs, geometry, relative(placed, pose), float(touching), {{}, float(touching)},
                          [&](const typename D::Manifold& m) {
                            const typename D::Vector n = rotate(placed.rotation, m.normal);
                            const double upright = double(dot(n, up_));
                            if (std::abs(upright) < 0.5) return;
                            const int above = upright > 0 ? b : a, below = upright > 0 ? a : b;
                            if (!moves(above)) return;
                            const double omega = 2 * math::pi * contact_hertz_ * (moves(below) ? 1 : 2);
                            Support support{above, moves(below) ? below : no_part, omega * omega, {}};
                            for (; support.points < m.count; ++support.points) {
                              const typename D::Position point = world_point(placed, m.points[support.points].point);
                              support.mobility[0][support.points] = mobility(parts_[std::size_t(above)], point, n);
                              support.mobility[1][support.points] = mobility(parts_[std::size_t(below)], point, n);
                            }
                            supports_.push_back(support);
                          });
  }

  /// Joints that hold up: rigid in position, to what is nearer the ground by joints.
  void joints() {
    supports_.clear();
    // The direct solver gives way to nothing; whom an automatic world gives to it shows after the first step.
    if (definition_.joint_solver == JointSolver::direct) return;
    if (definition_.joint_solver == JointSolver::automatic && world_.step_count() == 0) return;
    struct Link {
      int a, b;
      JointId id;
    };
    std::vector<Link> links;
    std::vector<JointId> ids;
    world_.joints(ids);
    for (const JointId id : ids) {
      const auto definition = world_.joint_definition(id);
      const auto state = world_.joint_state(id);
      if (!definition.ok() || !state.ok() || state->direct) continue;
      const bool rigid = std::visit(
          [](const auto& d) {
            using Def = std::remove_cvref_t<decltype(d)>;
            if constexpr (std::is_same_v<Def, WeldJointDef<D>>) return !(d.linear.hertz > 0);
            if constexpr (std::is_same_v<Def, DistanceJointDef<D>>) return !(d.spring.hertz > 0);
            return std::is_same_v<Def, BallJointDef<D>> || std::is_same_v<Def, HingeJointDef<D>>;
          },
          definition.value());
      if (rigid) links.push_back({place_of(state->body_a), place_of(state->body_b), id});
    }
    // Outward from what does not move, a round a level.
    std::vector<int> level(parts_.size(), 0);
    bool grew = true;
    for (int round = 1; grew; ++round) {
      grew = false;
      for (const Link& link : links)
        for (const auto& [from, to] : {std::pair{link.a, link.b}, {link.b, link.a}}) {
          if (!moves(to) || level[std::size_t(to)] != 0) continue;
          const bool held = !moves(from) ? round == 1 : level[std::size_t(from)] == round - 1 && round > 1;
          if (!held) continue;
          level[std::size_t(to)] = round;
          grew = true;
        }
      if (round == 1 && !grew) return;
    }
    for (Part<D>& part : parts_) part.height = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].height = level[i];
    const double omega = 2 * math::pi * joint_hertz_;
    for (const Link& link : links) {
      const int la = moves(link.a) ? level[std::size_t(link.a)] : 0,
                lb = moves(link.b) ? level[std::size_t(link.b)] : 0;
      if (la == lb) continue;
      const int above = la > lb ? link.a : link.b, below = la > lb ? link.b : link.a;
      const double k =
          parts_[std::size_t(above)].inverse_mass + (moves(below) ? parts_[std::size_t(below)].inverse_mass : 0);
      supports_.push_back({above, moves(below) ? below : no_part, omega * omega / k, link.id});
    }
  }

  /// Loads from the top down, what gives way from the bottom up; then a word about the worst of each heap.
  void carry(AdviceKind kind, double share) {
    if (supports_.empty()) return;
    std::vector<int> order, degree(parts_.size(), 0), root(parts_.size(), no_part);
    for (int i = 0; i < int(parts_.size()); ++i) {
      parts_[std::size_t(i)].load = parts_[std::size_t(i)].weight;
      parts_[std::size_t(i)].sag = 0;
      if (moves(i)) order.push_back(i);
    }
    const auto height = [&](int i) { return parts_[std::size_t(i)].height; };
    std::stable_sort(order.begin(), order.end(), [&](int l, int r) { return height(l) > height(r); });
    std::vector<std::vector<int>> under(parts_.size());
    for (int s = 0; s < int(supports_.size()); ++s) {
      const Support& support = supports_[std::size_t(s)];
      if (support.below != no_part && !(height(support.below) < height(support.above))) continue;
      under[std::size_t(support.above)].push_back(s);
    }
    std::vector<double> force(supports_.size(), 0);
    for (const int i : order)
      for (const int s : under[std::size_t(i)]) {
        force[std::size_t(s)] = parts_[std::size_t(i)].load / double(under[std::size_t(i)].size());
        const int below = supports_[std::size_t(s)].below;
        if (below != no_part) parts_[std::size_t(below)].load += force[std::size_t(s)];
      }
    for (const int i : order) parts_[std::size_t(i)].factor = load_factor(parts_[std::size_t(i)]);
    std::vector<double> length(parts_.size(), 0);
    std::vector<Support> worst(parts_.size());
    for (std::size_t k = order.size(); k-- > 0;) {
      const int i = order[k];
      Part<D>& part = parts_[std::size_t(i)];
      double sum = 0, longest = 0;
      for (const int s : under[std::size_t(i)]) {
        const Support& support = supports_[std::size_t(s)];
        const double below = support.below == no_part ? 0 : parts_[std::size_t(support.below)].sag;
        sum += below + support.yields(force[std::size_t(s)], part.factor,
                                      support.below == no_part ? 1 : parts_[std::size_t(support.below)].factor);
        longest = std::max(longest, support.below == no_part ? 0 : length[std::size_t(support.below)]);
        root[std::size_t(i)] = support.below == no_part ? i : root[std::size_t(support.below)];
        worst[std::size_t(i)] = support;
      }
      if (under[std::size_t(i)].empty()) continue;
      part.sag = sum / double(under[std::size_t(i)].size());
      length[std::size_t(i)] = longest + smallest_extent(part.id);
    }
    std::vector<int> top(parts_.size(), no_part);  // of each heap, by its lowest body
    for (const int i : order) {
      const int r = root[std::size_t(i)];
      if (r == no_part) continue;
      int& t = top[std::size_t(r)];
      if (t == no_part || parts_[std::size_t(i)].sag > parts_[std::size_t(t)].sag) t = i;
    }
    std::vector<int> worst_first;
    for (const int t : top)
      if (t != no_part && parts_[std::size_t(t)].sag > share * length[std::size_t(t)]) worst_first.push_back(t);
    std::stable_sort(worst_first.begin(), worst_first.end(),
                     [&](int l, int r) { return parts_[std::size_t(l)].sag > parts_[std::size_t(r)].sag; });
    if (int(worst_first.size()) > options_.most) worst_first.resize(std::size_t(options_.most));
    for (const int t : worst_first) report(kind, t, length[std::size_t(t)], share, worst[std::size_t(t)].joint);
  }
  /// What squeezes a body beyond what it bears raises its mass for the contact solver (detail/load.h).
  double load_factor(const Part<D>& part) const {
    if (part.jointed) return 1;
    const double omega = 2 * math::pi * contact_hertz_, squeeze = (part.load - part.weight) * part.inverse_mass;
    const double borne = std::min(double(detail::load_weights) * gravity_,
                                  double(detail::load_yield) * 0.5 * smallest_extent(part.id) * omega * omega);
    return std::clamp(squeeze / borne, 1.0, double(detail::most_load_factor));
  }
  void report(AdviceKind kind, int i, double length, double share, JointId joint) {
    const Part<D>& part = parts_[std::size_t(i)];
    const bool sag = kind == AdviceKind::sag;
    const double wanted = share * length / part.sag;
    const int substeps = substeps_for(sag ? contact_hertz_ : joint_hertz_,
                                      sag ? double(detail::most_contact_turns) : joint_turns_, wanted);
    const double hertz = (sag ? contact_hertz_ : joint_hertz_) / std::sqrt(wanted);
    std::string text = format("%s will %s by %.3g m (%.2g %% of %.3g m)", part.name.c_str(), sag ? "sink" : "hang low",
                              part.sag, 100 * part.sag / length, length);
    if (substeps > 0)
      text += format("; for %.2g %% use %d substeps and %s of %.3g Hz", 100 * share, substeps,
                     sag ? "contact_hertz" : "joint_hertz", hertz);
    else
      text += format("; no number of substeps cures that: bring the masses nearer to each other%s",
                     sag ? "" : ", or let a rope joint from end to end carry the load");
    say(kind, part.id, joint, part.sag, substeps, std::move(text));
  }

  const World<D>& world_;
  const WorldDef<D>& definition_;
  AdviceOptions options_;
  double dt_, h_ = 0, contact_hertz_ = 0, joint_hertz_ = 0, joint_turns_ = 0, gravity_ = 0;
  typename D::Vector up_{};
  std::vector<Part<D>> parts_;
  std::vector<int> place_;
  std::vector<Support> supports_;
  std::vector<Advice> advice_;
};

}  // namespace

template <class D>
std::vector<Advice> advise(const World<D>& world, float dt, const AdviceOptions& options) {
  if (!(dt > 0 && dt <= 1)) return {};
  return Adviser<D>(world, dt, options).all();
}

template <class D>
int apply_advice(World<D>& world, std::span<const Advice> advice) {
  int set = 0;
  for (const Advice& a : advice) {
    if (a.kind != AdviceKind::sag && a.kind != AdviceKind::stretch) continue;
    const int substeps = std::min(a.substeps, 64);
    const auto body = world.body_definition(a.body);
    if (!body.ok() || substeps <= std::max(body->substeps, world.definition().substeps)) continue;
    if (world.set_substeps(a.body, substeps).ok()) ++set;
  }
  return set;
}

template CAROM_API int apply_advice(World<Dim2>&, std::span<const Advice>);
template CAROM_API int apply_advice(World<Dim3>&, std::span<const Advice>);
template std::vector<Advice> advise(const World<Dim2>&, float, const AdviceOptions&);
template std::vector<Advice> advise(const World<Dim3>&, float, const AdviceOptions&);

}  // namespace carom::rigid
