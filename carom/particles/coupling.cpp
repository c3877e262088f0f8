#include "carom/particles/coupling.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"

namespace carom::particles {
using math::Vec2d;
using math::Vec2f;
using math::Vec3d;
using math::Vec3f;
using rigid::Dim2;
using rigid::Dim3;

namespace {

constexpr float prism = 1.0f;      // m, half the depth that shapes of the plane get
constexpr float thinnest = 1e-4f;  // m, radius of a segment

Vec3f lifted(Vec2f v) { return {v.x, v.y, 0}; }
Vec3d lifted(Vec2d v) { return {v.x, v.y, 0}; }
Vec3f lifted(Vec3f v) { return v; }
Vec3d lifted(Vec3d v) { return v; }
Vec3f turning(float w) { return {0, 0, w}; }
Vec3f turning(Vec3f w) { return w; }
/// About z by the angle of a rotation of the plane: half angles from c = cos φ, s = sin φ.
math::Quatf lifted(math::Rot2f q) {
  const float w = math::sqrt(math::max(0.5f * (1 + q.c), 0.0f)), z = math::sqrt(math::max(0.5f * (1 - q.c), 0.0f));
  return math::normalize(math::Quatf{w, 0, 0, q.s < 0 ? -z : z});
}
math::Pose3 lifted(const math::Pose2& p) { return {lifted(p.position), lifted(p.rotation)}; }

/// A shape of the plane as one of space, at `local`.
geometry::Shape3 lift(const geometry::Shape2& s, math::Pose3& local) {
  const auto capsule = [&](Vec2f a, Vec2f b) -> geometry::Shape3 {
    const Vec2f middle = 0.5f * (a + b), along = b - a;
    const float length = math::length(along);
    if (!(length > 0)) return geometry::Sphere{thinnest};
    local.position = lifted(Vec2d(middle));
    // Local y lies along the segment.
    local.rotation = lifted(math::Rot2f{along.y / length, -along.x / length});
    return geometry::Capsule3{0.5f * length, thinnest};
  };
  switch (s.type) {
    case geometry::ShapeType2::circle:
      return geometry::Sphere{s.circle.radius};
    case geometry::ShapeType2::capsule:
      return geometry::Capsule3{s.capsule.half_length, s.capsule.radius};
    case geometry::ShapeType2::segment:
      return capsule(s.segment.a, s.segment.b);
    case geometry::ShapeType2::chain_segment:
      return capsule(s.chain_segment.a, s.chain_segment.b);
    case geometry::ShapeType2::polygon: {
      Vec3f corners[2 * geometry::max_polygon_vertices];
      int n = 0;
      for (int i = 0; i < s.polygon.count; ++i)
        for (const float z : {-prism, prism}) corners[n++] = {s.polygon.vertices[i].x, s.polygon.vertices[i].y, z};
      auto hull = geometry::make_hull({corners, std::size_t(n)}, {.radius = s.polygon.radius});
      if (hull) return *hull;
      return geometry::Sphere{thinnest};
    }
    case geometry::ShapeType2::chain: {
      // Solid on the left of the way: seen from the free side, on the right, each piece is counterclockwise.
      std::vector<Vec3f> vertices;
      std::vector<std::uint32_t> indices;
      for (int i = 0; i < s.chain->segment_count(); ++i) {
        const geometry::ChainSegment c = s.chain->segment(i);
        const std::uint32_t at = std::uint32_t(vertices.size());
        for (const Vec2f p : {c.a, c.b})
          for (const float z : {-prism, prism}) vertices.push_back({p.x, p.y, z});
        indices.insert(indices.end(), {at, at + 2, at + 1, at + 1, at + 2, at + 3});
      }
      auto mesh = geometry::make_triangle_mesh(std::move(vertices), std::move(indices));
      if (mesh) return *mesh;
      return geometry::Sphere{thinnest};
    }
  }
  return geometry::Sphere{thinnest};
}

template <class D>
void put_inertia(const rigid::World<D>& world, rigid::BodyId body, const rigid::BodyState<D>& state, Collider& c) {
  const auto definition = world.body_definition(body);
  if (!definition) return;
  const rigid::MotionLocks& locks = definition->locks;
  const bool fixed = locks.x && locks.y && (D::dimension == 2 || locks.z);
  c.inverse_mass = fixed ? 0 : 1 / state.mass;
  if constexpr (D::dimension == 2) {
    const auto m = world.mass_properties2(body);
    const float inertia = m ? float(m->inertia) : 0;
    c.inverse_inertia.cz.z = inertia > 0 && !locks.rotation_z ? 1 / inertia : 0;
  } else {
    const auto m = world.mass_properties3(body);
    if (!m || locks.rotation_x || locks.rotation_y || locks.rotation_z) return;
    const math::Mat3f turn = math::to_matrix(state.pose.rotation);
    c.inverse_inertia = turn * math::Mat3f(math::inverse(m->inertia)) * math::transpose(turn);
  }
}

}  // namespace

template <class D>
core::Status Coupling<D>::check(const CouplingDef& d) {
  if (!(d.restitution >= 0 && d.restitution <= 1))
    return detail::bad("coupling", "restitution", d.restitution, "0 to 1");
  if (!(d.friction >= 0 && math::is_finite(d.friction)))
    return detail::bad("coupling", "friction", d.friction, "a finite number of at least 0");
  if (!(d.margin >= 0 && math::is_finite(d.margin))) return detail::bad("coupling", "margin", d.margin, "at least 0 m");
  return {};
}

template <class D>
const typename Coupling<D>::Form& Coupling<D>::form_of(rigid::ShapeId shape, const typename D::Shape& geometry) {
  // Shapes are found in the same order from step to step: the one looked for is most often the next.
  for (std::size_t k = 0; k < forms_.size(); ++k) {
    const std::size_t i = (cursor_ + k) % forms_.size();
    if (forms_[i].shape == shape) {
      cursor_ = i + 1;
      return forms_[i];
    }
  }
  if (forms_.size() > 4096) forms_.clear();
  Form form{.shape = shape};
  if constexpr (D::dimension == 2) {
    form.form = lift(geometry, form.local);
  } else {
    form.form = geometry;
  }
  forms_.push_back(form);
  cursor_ = forms_.size();
  return forms_.back();
}

template <class D>
core::Status Coupling<D>::add_body(const rigid::World<D>& world, rigid::ShapeId shape) {
  const auto body = world.body_of(shape);
  const auto geometry = world.shape_geometry(shape);
  const auto definition = world.shape_definition(shape);
  if (!body || !geometry || !definition) return {};
  if (definition->sensor) return {};
  const auto state = world.state(*body);
  if (!state || !state->enabled) return {};
  const rigid::Material& material =
      definition->surfaces.empty() ? definition->material : definition->surfaces.front().material;
  Collider c;
  c.velocity = lifted(state->linear_velocity);
  c.angular_velocity = turning(state->angular_velocity);
  c.center_of_mass = lifted(state->center_of_mass);
  c.restitution = math::clamp(math::max(definition_.restitution, material.restitution), 0.0f, 1.0f);
  c.friction = math::sqrt(math::max(definition_.friction * material.friction, 0.0f));
  c.answer = definition_.answer;
  if (definition_.two_way && state->type == rigid::BodyType::dynamic && state->mass > 0) {
    c.two_way = true;
    put_inertia(world, *body, *state, c);
  }
  const auto place = [&](const geometry::Shape3& form, const math::Pose3& pose) {
    c.shape = form;
    c.pose = pose;
    colliders_.push_back(c);
    bodies_.push_back(*body);
  };
  if constexpr (D::dimension == 2) {
    const math::Pose3 at = lifted(state->pose * definition->local);
    const Form& form = form_of(shape, *geometry);
    place(form.form, {at.position + Vec3d(math::rotate(at.rotation, Vec3f(form.local.position))),
                      math::normalize(at.rotation * form.local.rotation)});
  } else {
    const math::Pose3 at = state->pose * definition->local;
    if (geometry->type == geometry::ShapeType3::compound) {
      for (const geometry::CompoundChild& child : geometry->compound->children) place(child.shape, at * child.local);
    } else {
      place(*geometry, at);
    }
  }
  return {};
}

template <class D>
core::Status Coupling<D>::gather(const rigid::World<D>& world, ParticleSystem& system, std::span<const Collider> own) {
  if (const core::Status status = check(definition_); !status) return status;
  colliders_.assign(own.begin(), own.end());
  bodies_.assign(own.size(), rigid::BodyId{});
  own_ = own.size();
  if (system.size() > 0) {
    // Where particles are, and may come to be within a tenth of a second.
    float low[6], high[6];
    for (int k = 0; k < 6; ++k) {
      low[k] = high[k] = system.array(k)[0];
      for (const float value : system.array(k)) {
        low[k] = math::min(low[k], value);
        high[k] = math::max(high[k], value);
      }
    }
    Vec3d from{}, to{};
    for (int k = 0; k < 3; ++k) {
      from[k] = system.definition().anchor[k] + low[k] + 0.1 * math::min(low[3 + k], 0.0f) - definition_.margin;
      to[k] = system.definition().anchor[k] + high[k] + 0.1 * math::max(high[3 + k], 0.0f) + definition_.margin;
    }
    typename D::Bounds bounds{};
    if constexpr (D::dimension == 2) {
      bounds = {{from.x, from.y}, {to.x, to.y}};
    } else {
      bounds = {from, to};
    }
    if (const core::Status status = world.overlap_bounds(bounds, found_, definition_.filter); !status) return status;
    std::sort(found_.begin(), found_.end(), [](rigid::ShapeId a, rigid::ShapeId b) { return a.packed() < b.packed(); });
    cursor_ = 0;
    for (const rigid::ShapeId shape : found_)
      if (const core::Status status = add_body(world, shape); !status) return status;
  }
  return system.set_colliders(colliders_);
}

template <class D>
core::Status Coupling<D>::give_back(rigid::World<D>& world, const ParticleSystem& system) const {
  const std::span<const Exchange> exchanges = system.exchanges();
  for (std::size_t i = own_; i < exchanges.size() && i < bodies_.size(); ++i) {
    const Exchange& e = exchanges[i];
    if (!colliders_[i].two_way || e.touching == 0 || (e.impulse == Vec3d{} && e.angular_impulse == Vec3d{})) continue;
    if constexpr (D::dimension == 2) {
      if (auto s = world.add_impulse(bodies_[i], {float(e.impulse.x), float(e.impulse.y)}); !s) return s;
      if (auto s = world.add_angular_impulse(bodies_[i], float(e.angular_impulse.z)); !s) return s;
    } else {
      if (auto s = world.add_impulse(bodies_[i], Vec3f(e.impulse)); !s) return s;
      if (auto s = world.add_angular_impulse(bodies_[i], Vec3f(e.angular_impulse)); !s) return s;
    }
  }
  return {};
}

template <class D>
core::Status Coupling<D>::step(rigid::World<D>& world, ParticleSystem& system, double dt, std::span<const Collider> own,
                               core::TaskScheduler* scheduler) {
  if (const core::Status status = gather(world, system, own); !status) return status;
  if (const core::Status status = system.step(dt, scheduler); !status) return status;
  return give_back(world, system);
}

template <class D>
rigid::BodyId Coupling<D>::body_of(int collider) const {
  return collider >= 0 && std::size_t(collider) < bodies_.size() ? bodies_[std::size_t(collider)] : rigid::BodyId{};
}

template class Coupling<Dim2>;
template class Coupling<Dim3>;

}  // namespace carom::particles
