// Small worlds for tests of mechanics: bodies with given mass and inertia, no shapes, nothing to collide.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "carom/math/elementary.h"
#include "carom/rigid/world.h"

namespace carom::rigid::test {

template <class D>
WorldDef<D> weightless() {
  WorldDef<D> definition;
  definition.gravity = {};
  definition.allow_sleep = false;
  return definition;
}

inline Vec3f at(Dim3, float x, float y) { return {x, y, 0}; }
inline Vec2f at(Dim2, float x, float y) { return {x, y}; }
template <class D>
typename D::Vector vec(float x, float y) {
  return at(D{}, x, y);
}
template <class D>
typename D::Position pos(double x, double y) {
  if constexpr (D::dimension == 2)
    return {x, y};
  else
    return {x, y, 0};
}
template <class D>
typename D::Angular about_z(float w) {
  if constexpr (D::dimension == 2)
    return w;
  else
    return {0, 0, w};
}
inline float z_of(float w) { return w; }
inline float z_of(Vec3f w) { return w.z; }
/// The turn about z, rad.
inline double angle_of(Rot2f q) { return double(math::atan2(q.s, q.c)); }
inline double angle_of(Quatf q) { return 2 * double(math::atan2(q.z, q.w)); }
template <class D>
typename D::Rotation turned(double angle) {
  if constexpr (D::dimension == 2)
    return {float(math::cos(angle)), float(math::sin(angle))};
  else
    return {float(math::cos(angle / 2)), 0, 0, float(math::sin(angle / 2))};
}

/// A body of `mass` with moment of inertia `inertia` about every axis, without shapes.
template <class D>
BodyId add_mass(World<D>& world, BodyDef<D> definition, double mass, double inertia) {
  const BodyId body = world.create_body(definition).value();
  typename D::MassProperties properties;
  properties.mass = mass;
  if constexpr (D::dimension == 2)
    properties.inertia = inertia;
  else
    properties.inertia = Mat3d::diagonal({inertia, inertia, inertia});
  world.set_mass_properties(body, properties).value();
  return body;
}
template <class D>
BodyId add_mass(World<D>& world, double x, double y, double mass, double inertia) {
  BodyDef<D> definition;
  definition.position = pos<D>(x, y);
  return add_mass(world, definition, mass, inertia);
}
template <class D>
BodyId add_fixed(World<D>& world, double x = 0, double y = 0) {
  BodyDef<D> definition;
  definition.type = BodyType::fixed;
  definition.position = pos<D>(x, y);
  return world.create_body(definition).value();
}
template <class D>
BodyState<D> state_of(const World<D>& world, BodyId body) {
  return world.state(body).value();
}

/// Times at which a signal passes zero upward, interpolated.
class Crossings {
 public:
  void add(double time, double value) {
    if (have_ && before_ < 0 && value >= 0) times.push_back(last_ + (time - last_) * (-before_ / (value - before_)));
    have_ = true;
    before_ = value;
    last_ = time;
  }
  double period() const { return times.size() < 2 ? 0 : (times.back() - times.front()) / double(times.size() - 1); }
  std::vector<double> times;

 private:
  bool have_ = false;
  double before_ = 0, last_ = 0;
};

inline constexpr float frame = 1.0f / 60;

}  // namespace carom::rigid::test
