// What is set down at rest in contact bears its load from the first step on.
//
// Rows that are solved one after the other agree on the loads of a stack by some of its rows a step. A tall one that
// begins with no impulse at all falls into itself until they have, and is thrown up again. But where all is at rest the
// loads follow from statics, from the top down: each body hands its weight and what it bears to those that it stands
// on.
#include <algorithm>
#include <span>

#include "carom/rigid/detail/joint_figure.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr float least_support = 0.1f;  ///< cosine of a normal with the vertical: what is steeper bears nothing yet
constexpr float closed_gap = 0.5f;     ///< of the way that a body falls in a substep: it has closed such a gap then
constexpr double compliance = 1e-6;    ///< of the mean of rows: a face has more points than a body has motions
constexpr double unborne = 0.02;       ///< part of its load that a body's supports may leave to friction
constexpr float crushing = 50 * most_load_factor;  ///< of its weight, on a point: it would be shot out from below
constexpr int most_supports = 32;                  ///< points under one body that share its load

template <class D>
struct LoadedBody {
  std::int32_t body = none;
  double height = 0;             ///< m, against gravity
  typename D::Vector force{};    ///< N·s in a substep, on it from above
  typename D::Angular moment{};  ///< about its centre
  typename D::Vector sum{};      ///< of all impulses on it, and
  float size = 0;                ///< of their sizes (load.h)
};

/// A point that a body stands on: the impulse along `up` on it is to be found.
template <class D>
struct Support {
  static constexpr int motions = D::dimension == 2 ? 3 : 6;
  float* impulse = nullptr;
  std::int32_t other = none;
  typename D::Vector arm{}, up{};
  double row[motions] = {};  ///< what a unit impulse does to the body: force, moment over its size
  double share = 0;
  bool bears = true;
};

template <class D>
bool lies_still(const WorldImplementation<D>& world, std::int32_t body) {
  const SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
  return s.linear_velocity == typename D::Vector{} && s.angular_velocity == typename D::Angular{};
}

/// Is it free to fall, and does nothing bear it yet?
template <class D>
bool is_set_down(const WorldImplementation<D>& world, std::int32_t body) {
  const BodyRecord& record = world.bodies.record[std::size_t(body)];
  if (record.type != BodyType::dynamic || record.locks != 0 || record.joint_count > 0 || record.awake_index == none)
    return false;
  for (std::int32_t key = record.first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    key = c.next[key & 1];
    for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next)
      for (const float impulse : world.contacts.manifold(m).impulses.normal)
        if (impulse > 0) return false;
  }
  return true;
}

/// Solves the symmetric positive matrix a (lower half) for b, in place: L D Lᵀ.
template <int N>
void solve_in_place(double (&a)[N][N], double (&b)[N]) {
  for (int j = 0; j < N; ++j) {
    for (int k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k] * a[k][k];
    for (int i = j + 1; i < N; ++i) {
      for (int k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] /= a[j][j];
    }
    for (int k = 0; k < j; ++k) b[j] -= a[j][k] * b[k];
  }
  for (int j = N - 1; j >= 0; --j) {
    b[j] /= a[j][j];
    for (int i = j + 1; i < N; ++i) b[j] -= a[i][j] * b[i];
  }
}

template <int N>
double dot(const double (&a)[N], const double (&b)[N]) {
  double sum = 0;
  for (int i = 0; i < N; ++i) sum += a[i] * b[i];
  return sum;
}

/// The least impulses, in the mean of their squares, that bear `load` (as the rows count it); none of them pulls. False
/// where nothing but friction or a neighbour at its side would hold the body.
template <class D>
bool share_load(std::span<Support<D>> supports, const double (&load)[Support<D>::motions]) {
  constexpr int n = Support<D>::motions;
  for (int round = 0; round < 4; ++round) {
    double matrix[n][n] = {}, y[n], trace = 0;
    for (const Support<D>& s : supports) {
      if (!s.bears) continue;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) matrix[i][j] += s.row[i] * s.row[j];
        trace += s.row[i] * s.row[i];
      }
    }
    if (!(trace > 0)) return false;
    for (int i = 0; i < n; ++i) matrix[i][i] += compliance * trace, y[i] = -load[i];
    solve_in_place(matrix, y);
    bool pulls = false;
    for (Support<D>& s : supports) {
      s.share = s.bears ? dot(s.row, y) : 0;
      if (s.share < 0) s.share = 0, s.bears = false, pulls = true;
    }
    if (pulls) continue;
    double left[n];
    for (int i = 0; i < n; ++i) left[i] = load[i];
    for (const Support<D>& s : supports)
      for (int i = 0; i < n; ++i) left[i] += s.share * s.row[i];
    return dot(left, left) <= square(unborne) * dot(load, load);
  }
  return false;
}

template <class D>
class SetDown {
 public:
  explicit SetDown(StepContext<D>& context) : context_(context), world_(context.world) {}

  void run() {
    find();
    if (bodies_.empty()) return;
    for (LoadedBody<D>& loaded : bodies_) hand_down(loaded);
    for (const LoadedBody<D>& loaded : bodies_) {
      BodyMotion<D>& m = world_.bodies.motion[std::size_t(loaded.body)];
      m.load_level = level_of_load(context_, m, {loaded.sum, loaded.size}, math::length(acceleration(loaded.body)));
    }
  }

 private:
  using V = typename D::Vector;

  /// m/s², of what acts on it from afar.
  V acceleration(std::int32_t body) const {
    const BodyMotion<D>& m = world_.bodies.motion[std::size_t(body)];
    const float pace = world_.bodies.pace(body);
    return (pace * pace) * (m.gravity_scale * world_.definition.gravity + m.inverse_mass * m.force);
  }

  /// The bodies that were set down, from the highest on.
  void find() {
    const std::vector<std::int32_t>& touches = world_.scratch.new_touches;
    const auto both_rest = [&](std::int32_t contact) {
      const ContactRecord<D>& c = world_.contacts.at(contact);
      return lies_still(world_, c.body[0]) && lies_still(world_, c.body[1]);
    };
    const std::size_t count = std::size_t(std::count_if(touches.begin(), touches.end(), both_rest));
    if (count == 0) return;
    slots_ = context_.arena.template allocate<std::int32_t>(2 * count);
    std::size_t next = 0;
    for (const std::int32_t contact : touches)
      if (both_rest(contact))
        for (const std::int32_t body : world_.contacts.at(contact).body) slots_[next++] = body;
    std::sort(slots_.begin(), slots_.end());
    auto end = std::unique(slots_.begin(), slots_.end());
    end = std::remove_if(slots_.begin(), end, [&](std::int32_t body) { return !is_set_down(world_, body); });
    slots_ = slots_.first(std::size_t(end - slots_.begin()));
    bodies_ = context_.arena.template allocate<LoadedBody<D>>(slots_.size());
    const typename D::Position down(world_.definition.gravity);
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      bodies_[i] = {};
      bodies_[i].body = slots_[i];
      bodies_[i].height = -dot(down, world_.bodies.motion[std::size_t(slots_[i])].center);
    }
    std::sort(bodies_.begin(), bodies_.end(), [](const LoadedBody<D>& l, const LoadedBody<D>& r) {
      return l.height != r.height ? l.height > r.height : l.body < r.body;
    });
    places_ = context_.arena.template allocate<std::int32_t>(slots_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) places_[index_of(bodies_[i].body)] = std::int32_t(i);
  }
  std::size_t index_of(std::int32_t body) const {
    return std::size_t(std::lower_bound(slots_.begin(), slots_.end(), body) - slots_.begin());
  }
  LoadedBody<D>* find_loaded(std::int32_t body) {
    const std::size_t i = index_of(body);
    return i < slots_.size() && slots_[i] == body ? &bodies_[std::size_t(places_[i])] : nullptr;
  }

  void add_supports(const LoadedBody<D>& loaded, const V& upward, float most_gap) {
    const BodyRecord& record = world_.bodies.record[std::size_t(loaded.body)];
    const BodyMotion<D>& motion = world_.bodies.motion[std::size_t(loaded.body)];
    const double size = max(double(motion.outer_extent), 1e-9);
    count_ = 0;
    for (std::int32_t key = record.first_contact; key != none;) {
      const ContactRecord<D>& c = world_.contacts.at(key >> 1);
      const int side = key & 1;
      key = c.next[side];
      const LoadedBody<D>* other = find_loaded(c.body[1 - side]);
      if (other != nullptr && other <= &loaded) continue;  // higher
      const typename D::Pose pose = shape_pose(world_, world_.shapes.at(c.shape[0]));
      for (std::int32_t i = c.first_manifold; i != none; i = world_.contacts.manifold(i).next) {
        ManifoldRecord<D>& m = world_.contacts.manifold(i);
        const V normal = rotate(pose.rotation, m.manifold.normal), up = side == 1 ? normal : -normal;
        if (m.disabled || dot(up, upward) < least_support) continue;
        for (int k = 0; k < m.manifold.count && count_ < most_supports; ++k) {
          if (m.manifold.points[k].separation > most_gap) continue;
          Support<D>& s = supports_[count_++];
          s = {};
          s.impulse = &m.impulses.normal[k];
          s.other = c.body[1 - side];
          s.up = up;
          s.arm = V(world_point(pose, m.manifold.points[k].point) - motion.center);
          fill(s.row, up, cross(s.arm, up), size);
        }
      }
    }
  }
  static void fill(double (&row)[Support<D>::motions], const V& force, const typename D::Angular& moment, double size) {
    for (int i = 0; i < D::dimension; ++i) row[i] = double(force[i]);
    if constexpr (D::dimension == 2) {
      row[2] = double(moment) / size;
    } else {
      for (int i = 0; i < 3; ++i) row[3 + i] = double(moment[i]) / size;
    }
  }

  /// Is the impulse on what bears it far more than its mass can follow (load.h)?
  bool crushes(const Support<D>& s) const {
    const float inverse_mass = world_.bodies.motion[std::size_t(s.other)].inverse_mass;
    return float(s.share) * inverse_mass > crushing * math::length(acceleration(s.other)) * context_.h;
  }

  void hand_down(LoadedBody<D>& loaded) {
    const BodyMotion<D>& motion = world_.bodies.motion[std::size_t(loaded.body)];
    const V own = acceleration(loaded.body);
    const float size = math::length(own);
    if (!(size > 0 && motion.inverse_mass > 0)) return;
    add_supports(loaded, own * (-1 / size), closed_gap * size * context_.h * context_.h);
    if (count_ == 0) return;
    const std::span<Support<D>> supports(supports_, std::size_t(count_));
    double load[Support<D>::motions];
    fill(load, loaded.force + own * (context_.h / motion.inverse_mass), loaded.moment,
         max(double(motion.outer_extent), 1e-9));
    if (!share_load<D>(supports, load)) return;
    if (std::any_of(supports.begin(), supports.end(), [&](const Support<D>& s) { return crushes(s); })) return;
    for (const Support<D>& s : supports) {
      const float impulse = float(s.share);
      if (!(impulse > 0)) continue;
      *s.impulse = impulse;
      loaded.sum += s.up * impulse, loaded.size += impulse;
      LoadedBody<D>* const below = find_loaded(s.other);
      if (below == nullptr) continue;
      const V push = s.up * -impulse;
      const V arm = s.arm + V(motion.center - world_.bodies.motion[std::size_t(s.other)].center);
      below->force += push;
      below->moment += cross(arm, push);
      below->sum += push, below->size += impulse;
    }
  }

  StepContext<D>& context_;
  WorldImplementation<D>& world_;
  std::span<std::int32_t> slots_;    ///< of the bodies, rising
  std::span<std::int32_t> places_;   ///< in bodies_, in the order of slots_
  std::span<LoadedBody<D>> bodies_;  ///< from the highest on
  Support<D> supports_[most_supports];
  int count_ = 0;
};

template <class D>
bool touches(const WorldImplementation<D>& world, std::int32_t body) {
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    if (c.first_manifold != none) return true;
    key = c.next[key & 1];
  }
  return false;
}

/// What stands with some of its bodies, held together by joints, presses on these with its weight in even shares until
/// contacts tell better. They have more mass for it at once: they would give way until they had (load.h).
template <class D>
void load_figure(const StepContext<D>& context, std::int32_t body) {
  WorldImplementation<D>& world = context.world;
  const Figure<D> figure(world, body);
  const auto weight_of = [&](std::int32_t member) {
    const BodyMotion<D>& m = world.bodies.motion[std::size_t(member)];
    return (context.h * m.mass * m.gravity_scale) * world.definition.gravity;
  };
  typename D::Vector weight{};
  int standing = 0;
  for (const std::int32_t member : figure.bodies()) weight += weight_of(member), standing += touches(world, member);
  if (standing == 0) return;
  weight *= -1 / float(standing);
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  const BodyLoad<D> load = jointed_load<D>({weight, math::length(weight)}, weight_of(body));
  const std::uint16_t level = level_of_load(context, m, load, math::length(world.definition.gravity));
  if (level > 0) m.load_level = min(level, figure.most_level(body));
}

template <class D>
void load_figures(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  if (world.joints.slots.size() == 0) return;
  for (const std::int32_t contact : world.scratch.new_touches) {
    const ContactRecord<D>& c = world.contacts.at(contact);
    if (!lies_still(world, c.body[0]) || !lies_still(world, c.body[1])) continue;
    for (const std::int32_t body : c.body)
      if (world.bodies.is_dynamic(body) && world.bodies.record[std::size_t(body)].joint_count > 0)
        load_figure(context, body);
  }
}

}  // namespace

template <class D>
void hand_down_loads(StepContext<D>& context) {
  SetDown<D>(context).run();
  load_figures(context);
}

template void hand_down_loads<Dim2>(StepContext<Dim2>&);
template void hand_down_loads<Dim3>(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
