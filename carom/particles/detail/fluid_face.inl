// The public face of a fluid. Included by fluid2.cpp and fluid3.cpp.
#pragma once

#include "carom/core/hash.h"
#include "carom/core/string.h"
#include "carom/particles/detail/fluid_setup.inl"

namespace carom::particles {

using core::Result;
using core::Status;

template <class D>
struct Fluid<D>::Implementation {
  detail::FluidState<D> state;
  std::unique_ptr<core::TaskScheduler> own_scheduler;
  core::SerialScheduler serial;

  void choose_scheduler() {
    const FluidDef<D>& d = state.definition;
    own_scheduler.reset();
    if (!d.scheduler && d.threads > 1) own_scheduler = core::make_thread_pool(d.threads);
    state.scheduler = d.scheduler ? d.scheduler : (own_scheduler ? own_scheduler.get() : &serial);
  }
};

namespace detail {

template <class V>
bool fluid_finite(const V& v, int n) {
  for (int a = 0; a < n; ++a)
    if (!math::is_finite(v[a])) return false;
  return true;
}

inline Status fluid_range(const char* field, double x, double low, double high) {
  if (x >= low && x <= high) return {};
  return core::Error{core::text("Fluid::create: ", field, " is ", x, ", expected ", low, " … ", high)};
}

template <class D>
Status check_fluid(const FluidDef<D>& d) {
  constexpr int N = D::dimension;
  for (const Status& s :
       {fluid_range("spacing", d.spacing, 1e-4, 100), fluid_range("density", d.density, 1e-3, 1e6),
        fluid_range("viscosity", d.viscosity, 0, 1e3), fluid_range("surface_tension", d.surface_tension, 0, 10),
        fluid_range("max_particles", d.max_particles, 1, 1 << 22), fluid_range("courant", d.courant, 0.1, 5),
        fluid_range("max_substeps", d.max_substeps, 1, 64), fluid_range("threads", d.threads, 1, 64)})
    if (!s.ok()) return s;
  double cells = 1;
  for (int a = 0; a < N; ++a) {
    if (!math::is_finite(d.lower[a]) || !math::is_finite(d.upper[a]) || !math::is_finite(d.gravity[a]))
      return core::Error{core::text("Fluid::create: lower, upper or gravity is not finite in component ", a)};
    if (!(math::abs(d.gravity[a]) <= 1e4f))
      return core::Error{core::text("Fluid::create: gravity is ", d.gravity[a], " m/s² in component ", a,
                                    ", expected −10000 … 10000")};
    if (!(d.upper[a] - d.lower[a] >= 2 * double(d.spacing)))
      return core::Error{core::text("Fluid::create: upper is ", d.upper[a] - d.lower[a], " m above lower in component ",
                                    a, ", expected two spacings or more")};
    cells *= (d.upper[a] - d.lower[a]) / (2 * double(d.spacing)) + 2;
  }
  if (!(cells <= double(1 << 24)))
    return core::Error{
        core::text("Fluid::create: the domain has ", cells, " cells of two spacings, expected 2^24 at most")};
  return {};
}

}  // namespace detail

template <class D>
Fluid<D>::Fluid(std::unique_ptr<Implementation> self) : self_(std::move(self)) {}
template <class D>
Fluid<D>::Fluid(const Fluid& other) : self_(std::make_unique<Implementation>()) {
  self_->state = other.self_->state;
  self_->state.reserve();
  self_->choose_scheduler();
}
template <class D>
Fluid<D>& Fluid<D>::operator=(const Fluid& other) {
  if (this == &other) return *this;
  core::TaskScheduler* const scheduler = self_->state.scheduler;
  const int threads = self_->state.definition.threads;
  const bool same = other.self_->state.definition.scheduler == self_->state.definition.scheduler &&
                    other.self_->state.definition.threads == threads;
  self_->state = other.self_->state;
  if (same)
    self_->state.scheduler = scheduler;
  else
    self_->choose_scheduler();
  return *this;
}
template <class D>
Fluid<D>::Fluid(Fluid&&) noexcept = default;
template <class D>
Fluid<D>& Fluid<D>::operator=(Fluid&&) noexcept = default;
template <class D>
Fluid<D>::~Fluid() = default;
template <class D>
const FluidDef<D>& Fluid<D>::definition() const {
  return self_->state.definition;
}

template <class D>
Result<Fluid<D>> Fluid<D>::create(const FluidDef<D>& d) {
  const Status checked = detail::check_fluid(d);
  if (!checked.ok()) return checked.error();
  auto self = std::make_unique<Implementation>();
  self->state.definition = d;
  self->choose_scheduler();
  self->state.make_grid();
  self->state.reserve();
  return Fluid(std::move(self));
}

template <class D>
Status Fluid<D>::add_particle(Position position, Vector velocity, std::uint32_t tag) {
  return self_->state.fill_lattice(position, position, -1, velocity, tag, "Fluid::add_particle");
}
template <class D>
Status Fluid<D>::add_box(Position lower, Position upper, Vector velocity, std::uint32_t tag) {
  return self_->state.fill_lattice(lower, upper, 0, velocity, tag, "Fluid::add_box");
}
template <class D>
Status Fluid<D>::add_ball(Position center, float radius, Vector velocity, std::uint32_t tag) {
  if (!(radius > 0 && math::is_finite(radius)))
    return core::Error{core::text("Fluid::add_ball: ", core::refused("radius", radius, "a finite number > 0"))};
  return self_->state.fill_lattice(center, center, radius, velocity, tag, "Fluid::add_ball");
}
template <class D>
void Fluid<D>::clear() {
  self_->state.particles.clear();
  self_->state.places.clear();
  self_->state.cell_of.clear();
  self_->state.pressure_dt = 0;
}

namespace detail {

template <class D>
Status check_tap(const FluidTap<D>& tap, const char* call) {
  constexpr int N = D::dimension;
  if (!fluid_finite(tap.center, N) || !fluid_finite(tap.velocity, N))
    return core::Error{core::text(call, ": center or velocity is not finite")};
  const float speed = length(tap.velocity);
  if (!(speed > 1e-6f && speed <= 1e4f))
    return core::Error{core::text(call, ": velocity is ", speed, " m/s, expected 0.000001 … 10000")};
  if (!(tap.radius > 0 && tap.radius <= 1e3f))
    return core::Error{core::text(call, ": ", core::refused("radius", tap.radius, "more than 0, up to 1000 m"))};
  return {};
}
template <class D>
Status check_drain(const FluidDrain<D>& drain, const char* call) {
  for (int a = 0; a < D::dimension; ++a)
    if (!math::is_finite(drain.lower[a]) || !math::is_finite(drain.upper[a]) || !(drain.lower[a] <= drain.upper[a]))
      return core::Error{core::text(call, ": lower is ", drain.lower[a], " and upper ", drain.upper[a],
                                    " in component ", a, ", expected finite numbers, lower ≤ upper")};
  return {};
}
inline Status check_number(int index, std::size_t count, const char* call) {
  if (index >= 0 && std::size_t(index) < count) return {};
  return core::Error{core::text(call, ": index is ", index, ", expected 0 … ", int(count) - 1)};
}

}  // namespace detail

template <class D>
Result<int> Fluid<D>::add_tap(const FluidTap<D>& tap) {
  const Status s = detail::check_tap(tap, "Fluid::add_tap");
  if (!s.ok()) return s.error();
  self_->state.taps.push_back(tap);
  self_->state.tap_phase.push_back(0);
  return int(self_->state.taps.size()) - 1;
}
template <class D>
Status Fluid<D>::set_tap(int index, const FluidTap<D>& tap) {
  Status s = detail::check_number(index, self_->state.taps.size(), "Fluid::set_tap");
  if (s.ok()) s = detail::check_tap(tap, "Fluid::set_tap");
  if (s.ok()) self_->state.taps[index] = tap;
  return s;
}
template <class D>
Result<int> Fluid<D>::add_drain(const FluidDrain<D>& drain) {
  const Status s = detail::check_drain(drain, "Fluid::add_drain");
  if (!s.ok()) return s.error();
  self_->state.drains.push_back(drain);
  return int(self_->state.drains.size()) - 1;
}
template <class D>
Status Fluid<D>::set_drain(int index, const FluidDrain<D>& drain) {
  Status s = detail::check_number(index, self_->state.drains.size(), "Fluid::set_drain");
  if (s.ok()) s = detail::check_drain(drain, "Fluid::set_drain");
  if (s.ok()) self_->state.drains[index] = drain;
  return s;
}

template <class D>
Status Fluid<D>::step(rigid::World<D>& world, float dt) {
  if (!(dt > 0 && dt <= 0.1f))
    return core::Error{core::text("Fluid::step: ", core::refused("dt", dt, "0 < dt ≤ 0.1 s"))};
  return self_->state.step(&world, dt);
}
template <class D>
Status Fluid<D>::step(float dt) {
  if (!(dt > 0 && dt <= 0.1f))
    return core::Error{core::text("Fluid::step: ", core::refused("dt", dt, "0 < dt ≤ 0.1 s"))};
  return self_->state.step(nullptr, dt);
}

template <class D>
int Fluid<D>::size() const {
  return int(self_->state.particles.size());
}
template <class D>
typename Fluid<D>::Position Fluid<D>::position(int index) const {
  const detail::FluidState<D>& s = self_->state;
  Position p = s.definition.lower;
  for (int a = 0; a < D::dimension; ++a) p[a] += double(s.particles[index].x[a]) * double(s.cell);
  return p;
}
template <class D>
typename Fluid<D>::Vector Fluid<D>::velocity(int index) const {
  Vector v{};
  for (int a = 0; a < D::dimension; ++a) v[a] = self_->state.particles[index].v[a];
  return v;
}
template <class D>
core::Status Fluid<D>::set_velocity(int index, Vector velocity) {
  if (index < 0 || index >= size())
    return core::Error{core::refused("particle", index, core::text("0 … ", size() - 1))};
  if (!detail::fluid_finite(velocity, D::dimension))
    return core::Error{"velocity of a particle is not finite, expected m/s"};
  for (int a = 0; a < D::dimension; ++a) self_->state.particles[index].v[a] = velocity[a];
  return {};
}
template <class D>
std::uint32_t Fluid<D>::tag(int index) const {
  return self_->state.particles[index].tag;
}
template <class D>
std::span<const typename Fluid<D>::Vector> Fluid<D>::positions() const {
  return self_->state.places;
}
template <class D>
float Fluid<D>::particle_mass() const {
  return self_->state.particle_mass;
}
template <class D>
float Fluid<D>::pressure(Position point) const {
  return self_->state.pressure_at(point);
}
template <class D>
float Fluid<D>::density(Position point) const {
  return self_->state.at_cells(self_->state.fill, point);
}
template <class D>
double Fluid<D>::volume() const {
  return double(size()) * double(self_->state.particle_mass) / double(self_->state.definition.density);
}
template <class D>
double Fluid<D>::surface_height(Position point) const {
  return self_->state.surface_height(point);
}
template <class D>
const FluidStatistics& Fluid<D>::statistics() const {
  return self_->state.statistics;
}
template <class D>
double Fluid<D>::kinetic_energy() const {
  return self_->state.kinetic_energy();
}
template <class D>
double Fluid<D>::potential_energy() const {
  return self_->state.potential_energy();
}
template <class D>
typename Fluid<D>::Position Fluid<D>::momentum() const {
  Position sum{};
  for (const auto& p : self_->state.particles)
    for (int a = 0; a < D::dimension; ++a) sum[a] += p.v[a];
  return double(self_->state.particle_mass) * sum;
}
template <class D>
std::conditional_t<D::dimension == 2, double, math::Vec3d> Fluid<D>::angular_momentum() const {
  return self_->state.angular_momentum();
}
template <class D>
typename Fluid<D>::Position Fluid<D>::wall_impulse() const {
  return self_->state.wall_impulse;
}
template <class D>
std::uint64_t Fluid<D>::state_hash() const {
  core::StateHash hash;
  for (const auto& p : self_->state.particles) {
    for (const float x : p.x) hash.add(x);
    for (const float v : p.v) hash.add(v);
    for (const float c : p.c) hash.add(c);
    hash.add(p.tag);
  }
  return hash.digest();
}
template <class D>
std::size_t Fluid<D>::bytes() const {
  return self_->state.bytes();
}

}  // namespace carom::particles
