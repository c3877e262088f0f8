#include "carom/rigid/detail/articulation_tree.h"

#include "carom/math/elementary.h"

namespace carom::rigid::detail {
namespace {

Vec3d axis_of_degree(const TreeLink& link, int k) {
  return k == 0 ? link.axes.cx : k == 1 ? link.axes.cy : link.axes.cz;
}

/// Σ sₖ qₖ.
Vec3d along_axes(const TreeLink& link, std::span<const double> values) {
  Vec3d sum{};
  for (int k = 0; k < link.degrees; ++k)
    sum += axis_of_degree(link, k) * values[std::size_t(link.first) + std::size_t(k)];
  return sum;
}

}  // namespace

void tree_forces(std::span<const TreeLink> links, const TreeRoot& root, std::span<const double> speeds,
                 std::span<const double> accelerations, const Vec3d& gravity, std::span<const TreeForce> outside,
                 TreeMotion& motion, std::span<double> torques) {
  const std::size_t n = links.size();
  motion.spin.resize(n), motion.acceleration.resize(n), motion.angular_acceleration.resize(n), motion.load.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const TreeLink& link = links[i];
    if (link.parent < 0) {
      motion.spin[i] = root.spin;
      motion.acceleration[i] = root.acceleration;
      motion.angular_acceleration[i] = root.angular_acceleration;
      continue;
    }
    const std::size_t p = std::size_t(link.parent);
    const Vec3d w = motion.spin[p], turn = motion.angular_acceleration[p];
    const Vec3d speed = along_axes(link, speeds), push = along_axes(link, accelerations);
    // The axes move with the parent, or, where they are the link's own, in the same way: (w + s) × s = w × s.
    if (link.slides) {
      const Vec3d arm = link.center - links[p].center;
      motion.spin[i] = w;
      motion.angular_acceleration[i] = turn;
      motion.acceleration[i] =
          motion.acceleration[p] + cross(turn, arm) + cross(w, cross(w, arm)) + push + 2.0 * cross(w, speed);
    } else {
      const Vec3d out = link.anchor - links[p].center, in = link.center - link.anchor;
      motion.spin[i] = w + speed;
      motion.angular_acceleration[i] = turn + push + cross(w, speed);
      motion.acceleration[i] = motion.acceleration[p] + cross(turn, out) + cross(w, cross(w, out)) +
                               cross(motion.angular_acceleration[i], in) +
                               cross(motion.spin[i], cross(motion.spin[i], in));
    }
  }
  // What each link takes, about its anchor (the root: its centre); then inward what its children hand on.
  for (std::size_t i = 0; i < n; ++i) {
    const TreeLink& link = links[i];
    TreeForce& load = motion.load[i];
    load.force = link.mass * (motion.acceleration[i] - gravity);
    load.moment = link.inertia * motion.angular_acceleration[i] + cross(motion.spin[i], link.inertia * motion.spin[i]);
    if (!outside.empty()) load.force -= outside[i].force, load.moment -= outside[i].moment;
    if (link.parent >= 0) load.moment += cross(link.center - link.anchor, load.force);
  }
  for (std::size_t i = n; i-- > 1;) {
    const TreeLink& link = links[i];
    const TreeForce& load = motion.load[i];
    for (int k = 0; k < link.degrees; ++k)
      torques[std::size_t(link.first) + std::size_t(k)] =
          dot(axis_of_degree(link, k), link.slides ? load.force : load.moment);
    const std::size_t p = std::size_t(link.parent);
    const Vec3d base = links[p].parent < 0 ? links[p].center : links[p].anchor;
    motion.load[p].force += load.force;
    motion.load[p].moment += load.moment + cross(link.anchor - base, load.force);
  }
  motion.root = motion.load[0];
}

TreeWhole whole_of(std::span<const TreeLink> links) {
  TreeWhole whole;
  for (const TreeLink& link : links) whole.mass += link.mass, whole.center += link.mass * link.center;
  if (!(whole.mass > 0)) return whole;
  whole.center = whole.center * (1 / whole.mass);
  for (const TreeLink& link : links)
    whole.inertia = whole.inertia + geometry::transfer_inertia(link.inertia, link.mass, link.center - whole.center);
  return whole;
}

// The whole as one rigid body, M a + M α × c = F and, about its own centre, I α = N − c × F.
void free_root(const TreeWhole& whole, const Vec3d& root_center, const TreeForce& force, TreeRoot& root) {
  const Vec3d c = whole.center - root_center;
  const Vec3d turn = inverse(whole.inertia) * (force.moment - cross(c, force.force));
  root.angular_acceleration += turn;
  root.acceleration += force.force * (1 / whole.mass) - cross(turn, c);
}

double settling_acceleration(double x, double v, double omega, double zeta, double dt) {
  // v(t) = e^(−ζωt) [v c − (ζω v + ω² x) s], with c, s = cos βt, sin βt/β below critical damping, cosh and sinh above.
  const double square = (1 - zeta * zeta) * omega * omega, a = math::abs(square) * dt * dt;
  double c = 1 - 0.5 * square * dt * dt, s = dt * (1 - square * dt * dt / 6);
  if (a > 1e-4) {
    const double beta = math::sqrt(math::abs(square));
    if (square > 0) {
      const auto turn = math::sincos(beta * dt);
      c = turn.cos, s = turn.sin / beta;
    } else {  // with the decay inside, for a product that is large and small
      const double slow = math::exp((beta - zeta * omega) * dt), fast = math::exp(-(beta + zeta * omega) * dt);
      c = 0.5 * (slow + fast), s = 0.5 * (slow - fast) / beta;
      return (v * c - (zeta * omega * v + omega * omega * x) * s - v) / dt;
    }
  }
  const double decay = math::exp(-zeta * omega * dt);
  return (decay * (v * c - (zeta * omega * v + omega * omega * x) * s) - v) / dt;
}

}  // namespace carom::rigid::detail
