// A step of particles that touch each other: forces change velocities, contacts decide where that leads.
#include "carom/geometry/query.h"
#include "carom/math/elementary.h"
#include "carom/particles/system.h"

namespace carom::particles {
using math::Vec3d;
using math::Vec3f;

void ParticleSystem::find_surfaces(double dt, const detail::Kernels& kernels) {
  detail::Path path;
  const detail::Arrays arrays = pointers();
  float fastest = 0;
  for (int i = 0; i < count_; ++i) fastest = math::max(fastest, math::length(Vec3f(velocity(i))));
  const float margin = definition_.radius + fastest * float(dt);
  for (std::size_t c = 0; c < surfaces_.size(); ++c) {
    const detail::SurfaceData& s = surfaces_[c];
    const Vec3f spin{s.spin[0], s.spin[1], s.spin[2]}, center{s.center[0], s.center[1], s.center[2]};
    for (int from = 0; from < count_; from += detail::block_size) {
      const int last = math::min(from + detail::block_size, count_), to = (last + 15) / 16 * 16;
      if (s.form == detail::Form::given)
        distance_block(s, colliders_[c].shape, margin, from, last, path);
      else
        kernels.find_near(collide_, s, arrays, margin, from, to, path);
      for (int i = from; i < last; ++i) {
        const std::size_t k = std::size_t(i - from);
        const float gap = path.gap[k];
        if (!(gap < detail::far_gap)) continue;
        const Vec3f n{path.normal[0][k], path.normal[1][k], path.normal[2][k]};
        const Vec3f x{arrays_[0][std::size_t(i)], arrays_[1][std::size_t(i)], arrays_[2][std::size_t(i)]};
        Vec3f u{};
        if (s.moves) u = Vec3f{s.velocity[0], s.velocity[1], s.velocity[2]} + math::cross(spin, x - center);
        const float approach = -math::dot(n, solver_.grain(i).v - u);
        if (gap > 0.15f * definition_.radius + math::max(approach, 0.0f) * float(dt) * 1.5f) continue;
        solver_.add_surface(i, int(c), gap, n, u, spin, s.friction, s.restitution);
        ++contact_touching_[c];
      }
    }
  }
}

void ParticleSystem::step_contacts(double dt, core::TaskScheduler& scheduler, const detail::Kernels& kernels) {
  const std::size_t count = std::size_t(count_);
  const detail::Arrays arrays = pointers();
  detail::ContactSolver::Pile pile{};
  for (int k = 0; k < 3; ++k) {
    pile.x[k] = array(k);
    pile.v[k] = array(3 + k);
    pile.w[k] = {spin_[k].data(), count};
  }
  pile.scale = {arrays_[8].data(), count};
  pile.ids = {ids_.data(), count};
  pile.radius = definition_.radius;
  pile.mass = definition_.mass;
  pile.dt = dt;
  solver_.begin(pile, definition_.contacts);
  move_.velocity_only = true;
  move_.keep_path = true;
  scheduler.parallel_for(count_, 4 * detail::block_size, [&](int begin, int end, int) {
    detail::Path path;
    for (int from = begin; from < end; from += detail::block_size) {
      const int last = math::min(from + detail::block_size, end), to = (last + 15) / 16 * 16;
      kernels.move(move_, arrays, from, to, path);
      for (int i = from; i < last; ++i)
        for (int k = 0; k < 3; ++k)
          gained_[std::size_t(i)][k] = arrays_[3 + k][std::size_t(i)] - path.speed[k][i - from];
    }
  });
  contact_touching_.assign(surfaces_.size(), 0);
  find_surfaces(dt, kernels);
  solver_.solve(definition_.contacts, {gained_.data(), count}, dt);
  contact_exchanged_.assign(surfaces_.size() * 6, 0);
  contact_centers_.clear();
  for (const detail::SurfaceData& s : surfaces_) contact_centers_.push_back({s.center[0], s.center[1], s.center[2]});
  solver_.exchanged(contact_exchanged_, contact_centers_);
  solver_.finish();
  worst_overlap_ = solver_.worst_overlap();
}

void ParticleSystem::place_grains(int from, int to, detail::Path& path) {
  for (int i = from; i < to; ++i) {
    const std::size_t k = std::size_t(i - from), index = std::size_t(i);
    path.left[k] = path.reach[k] = 0;
    if (i >= count_) continue;
    const detail::ContactSolver::Grain& g = solver_.grain(i);
    // What flies fast may pass a thin surface that was not near at the start: it is swept. Those that were near are
    // the solver's.
    const bool fast = move_.dt * math::length(g.v) > 0.5f * definition_.radius && !solver_.near_surface(i);
    path.left[k] = fast ? move_.dt : 0;
    for (int c = 0; c < 3; ++c) {
      path.start[c][k] = arrays_[c][index];
      arrays_[c][index] = g.x[c];
      path.speed[c][k] = g.v[c];
      arrays_[3 + c][index] = g.v[c];
      spin_[c][index] = g.w[c];
    }
    const Vec3f way{arrays_[0][index] - path.start[0][k], arrays_[1][index] - path.start[1][k],
                    arrays_[2][index] - path.start[2][k]};
    path.reach[k] = g.radius + math::length(way);
    if (definition_.planar) arrays_[2][index] = arrays_[5][index] = 0;
  }
}

void ParticleSystem::distance_block(const detail::SurfaceData& s, const geometry::Shape3& shape, float margin, int from,
                                    int to, detail::Path& path) const {
  for (int i = from; i < to; ++i) {
    const std::size_t k = std::size_t(i - from), index = std::size_t(i);
    path.gap[k] = detail::far_gap;
    const Vec3f r{arrays_[0][index] - s.place0[0], arrays_[1][index] - s.place0[1], arrays_[2][index] - s.place0[2]};
    const float radius = definition_.radius * arrays_[8][index];
    if (!(math::length(r) < s.reach + radius + margin)) continue;
    const float* m = s.turn0;
    const Vec3f q{m[0] * r.x + m[3] * r.y + m[6] * r.z, m[1] * r.x + m[4] * r.y + m[7] * r.z,
                  m[2] * r.x + m[5] * r.y + m[8] * r.z};
    // From a core within the grain, so that what touches or overlaps a little still has a normal.
    const geometry::Shape3 core = geometry::Sphere{0.01f * radius};
    const geometry::Distance3 near = geometry::distance(shape, core, {q, {}});
    const Vec3f n = near.normal;
    if (!(math::length(n) > 0.5f)) continue;
    path.gap[k] = near.distance - 0.99f * radius;
    path.normal[0][k] = m[0] * n.x + m[1] * n.y + m[2] * n.z;
    path.normal[1][k] = m[3] * n.x + m[4] * n.y + m[5] * n.z;
    path.normal[2][k] = m[6] * n.x + m[7] * n.y + m[8] * n.z;
  }
}

}  // namespace carom::particles
