// The public face of grains, and what is done once. Included by granular2.cpp and granular3.cpp.
#pragma once

#include "carom/core/hash.h"
#include "carom/core/string.h"
#include "carom/math/cpu.h"
#include "carom/math/random.h"
#include "carom/particles/detail/granular_solve.inl"

namespace carom::particles {

using core::Result;
using core::Status;

template <class D>
struct Granular<D>::Implementation {
  detail::GranularState<D> state;
  std::unique_ptr<core::TaskScheduler> own_scheduler;
  core::SerialScheduler serial;

  void choose_scheduler() {
    const GranularDef<D>& d = state.definition;
    own_scheduler.reset();
    if (!d.scheduler && d.threads > 1) own_scheduler = core::make_thread_pool(d.threads);
    state.scheduler = d.scheduler ? d.scheduler : (own_scheduler ? own_scheduler.get() : &serial);
  }
};

namespace detail {

template <class V>
bool grain_finite(const V& v, int n) {
  for (int a = 0; a < n; ++a)
    if (!math::is_finite(v[a])) return false;
  return true;
}

template <class D>
Status check_granular(const GranularDef<D>& d) {
  constexpr int N = D::dimension;
  const auto range = [](const char* field, double x, double low, double high) -> Status {
    if (x >= low && x <= high) return {};
    return core::Error{core::text("Granular::create: ", field, " is ", x, ", expected ", low, " … ", high)};
  };
  for (const Status& s :
       {range("radius", d.radius, 1e-4, 10), range("radius_spread", d.radius_spread, 0, 0.5),
        range("density", d.density, 1e-3, 1e6), range("friction", d.friction, 0, 5),
        range("rolling_friction", d.rolling_friction, 0, 5), range("wall_friction", d.wall_friction, 0, 5),
        range("max_grains", d.max_grains, 1, 1 << 20), range("substeps", d.substeps, 1, 64),
        range("iterations", d.iterations, 1, 100), range("threads", d.threads, 1, 64)})
    if (!s.ok()) return s;
  if (d.lanes != 0 && d.lanes != 4 && d.lanes != 8 && d.lanes != 16)
    return core::Error{core::text("Granular::create: ", core::refused("lanes", d.lanes, "0, 4, 8 or 16"))};
  double cells = 1;
  for (int a = 0; a < N; ++a) {
    if (!math::is_finite(d.lower[a]) || !math::is_finite(d.upper[a]) || !(math::abs(d.gravity[a]) <= 1e4f))
      return core::Error{core::text("Granular::create: lower, upper or gravity is not a sensible number in component ",
                                    a, ": ", d.lower[a], ", ", d.upper[a], ", ", d.gravity[a])};
    if (!(d.upper[a] - d.lower[a] >= 2 * double(d.radius)))
      return core::Error{core::text("Granular::create: upper is ", d.upper[a] - d.lower[a],
                                    " m above lower in component ", a, ", expected two radii or more")};
    cells *= (d.upper[a] - d.lower[a]) / (double(detail::GranularState<D>::cell_radii) * double(d.radius)) + 1;
  }
  if (!(cells <= double(1 << 24)))
    return core::Error{core::text("Granular::create: the domain has ", cells, " cells of ",
                                  int(detail::GranularState<D>::cell_radii), " radii, expected 2^24 at most")};
  return {};
}

template <class D>
void GranularState<D>::make_grid() {
  inverse_cell = 1 / (cell_radii * definition.radius);
  for (int a = 0; a < N; ++a) {
    extent[a] = float(definition.upper[a] - definition.lower[a]);
    cells[a] = math::max(1, int(extent[a] * inverse_cell) + 1);
  }
  const int across = N == 2 ? cells[0] : cells[2];
  // Narrow ones leave lanes empty. Four or a multiple of it share evenly between two threads, every second at a time.
  const int wanted = int(float(across + 2) * cell_radii / (N == 2 ? 98 : 12));
  const int count = wanted < 3 ? math::max(wanted, 1) : 4 * ((wanted + 2) / 4);
  slab_cells = (across + count - 1) / count;
  slabs.resize(std::size_t((across + slab_cells - 1) / slab_cells));
  const int row = N == 2 ? 1 : cells[0];
  column_start.resize(std::size_t(across));
  for (int k = 0; k < across; ++k) column_start[k] = (k / slab_cells * cells[1] * slab_cells + k % slab_cells) * row;
  size = int(slabs.size()) * slab_cells * cells[1] * (N == 2 ? 1 : cells[0]);
  cell_start.assign(std::size_t(size) + 1, 0);
  for (auto* list : {&haste, &around, &spare}) list->assign(std::size_t(size), {});
}

template <class D>
void GranularState<D>::reserve() {
  const std::size_t n = std::size_t(definition.max_grains), contacts = n * (N == 2 ? 4 : 8);
  for (auto* list : {&grains, &sorted}) list->reserve(n);
  for (auto* list : {&cell_of, &old_place, &last_block, &last_across}) list->reserve(n);
  for (auto* list : {&first_pair, &old_first_pair, &first_touch, &old_first_touch}) list->reserve(n + 1);
  for (auto& list : near_by) list.reserve(n + grain_lanes);
  for (auto* list : {&pairs, &old_pairs, &was}) list->resize(contacts);
  first_late.reserve(n);
  late.reserve(contacts / 4);
  held.reserve(contacts * grain_held<N>);
  for (GrainSlab<N>& slab : slabs) {
    const std::size_t share = contacts / slabs.size() + 1, share_of_blocks = share / grain_lanes + 1;
    slab.pairs.resize(share);
    slab.numbers.resize(1 << 14);  // several times what cells of grains of one size have around them
    slab.near.resize(1 << 15);
    slab.blocks.reserve(share_of_blocks);
    slab.open_block.resize(share_of_blocks);
    slab.filled.resize(share_of_blocks);
    for (auto* list : {&slab.pair_of, &slab.was}) list->resize(share_of_blocks * grain_lanes);
    for (auto& list : slab.later) list.resize(share / 2);
    slab.late.reserve(share / 4);
  }
  for (auto* list : {&touches, &old_touches}) list->reserve(n + 16);
  for (auto* list : {&wall_blocks, &old_wall_blocks}) list->reserve(n / grain_lanes + 64);
  wall_of.reserve(n / grain_lanes + 64);
  place = AlignedFloats((n + slabs.size()) * grain_place);
  if constexpr (N == 2) origin = AlignedFloats((n + slabs.size()) * grain_place);
  motion = AlignedFloats((n + slabs.size()) * grain_motion<N>);
  pace = AlignedFloats(n * grain_place);
  solids.reserve(64);
  bodies.reserve(64);
  found.reserve(64);
}

template <class D>
Status GranularState<D>::add(Position at, Vector velocity, std::uint32_t tag, float radius, Angular spin,
                             const char* call) {
  bool good = grain_finite(at, N) && grain_finite(velocity, N) && math::is_finite(grain_size(spin));
  for (int a = 0; a < N && good; ++a) good = math::abs(velocity[a]) <= 1e4f;
  if (!good)
    return core::Error{core::text(call, ": place, velocity or spin is not finite, or a velocity is above 10000 m/s")};
  if (!(radius >= 0 && radius <= definition.radius))
    return core::Error{core::text(call, ": ", core::refused("radius", radius, "0 … the definition's radius"))};
  if (int(grains.size()) >= definition.max_grains)
    return core::Error{core::text(call, ": more than max_grains = ", definition.max_grains, " grains")};
  Grain<D> g;
  g.x = Vector(at - definition.lower);
  for (int a = 0; a < N; ++a)
    if (!(g.x[a] >= 0 && g.x[a] <= extent[a])) return {};  // outside of the domain: gone at once
  math::Random random(definition.seed, added++);
  g.radius = radius > 0 ? radius : definition.radius * (1 - definition.radius_spread * random.uniform_float());
  g.v = velocity;
  g.spin = spin;
  g.tag = tag;
  const float r = g.radius;
  g.curve = 1 / r;
  const float mass = definition.density * math::pi_f * r * r * (N == 2 ? 1.0f : 4.0f / 3 * r);
  g.inverse_mass = 1 / mass;
  g.inverse_inertia = 1 / ((N == 2 ? 0.5f : 0.4f) * mass * r * r);
  grains.push_back(g);
  return {};
}

template <class D>
Status GranularState<D>::fill(Position lower, Position upper, Vector velocity, std::uint32_t tag) {
  const char* call = "Granular::add_box";
  if (!grain_finite(lower, N) || !grain_finite(upper, N))
    return core::Error{core::text(call, ": lower or upper is not finite")};
  int count[3] = {1, 1, 1};
  double all = 1;
  const double step = 2 * double(definition.radius);
  for (int a = 0; a < N; ++a) {
    const double low = math::max(lower[a], definition.lower[a]), high = math::min(upper[a], definition.upper[a]);
    lower[a] = low;
    count[a] = high > low ? int((high - low) / step + 1e-3) : 0;
    all *= count[a];
  }
  if (all + double(grains.size()) > definition.max_grains)
    return core::Error{core::text(call, ": more than max_grains = ", definition.max_grains, " grains")};
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const int at[3] = {i, j, k};
        Position p = lower;
        for (int a = 0; a < N; ++a) p[a] += step * (at[a] + 0.5);
        const Status s = add(p, velocity, tag, 0, Angular{}, call);
        if (!s.ok()) return s;
        // As far aside as its radius leaves room: columns that stand exactly on top of each other would stay so.
        Grain<D>& g = grains.back();
        math::Random random(definition.seed ^ 0x6A09E667F3BCC909u, added);
        const float room = definition.radius - g.radius;
        for (int a = 0; a < N; ++a) g.x[a] += random.uniform(-room, room);
      }
  return {};
}

template <class D>
Status GranularState<D>::gather(rigid::World<D>& world) {
  typename D::Bounds bounds{definition.lower, definition.upper};
  Status seen = world.overlap_bounds(bounds, found);
  if (!seen.ok()) return seen;
  for (const rigid::ShapeId shape : found) {
    const auto details = world.shape_definition(shape);
    const auto body = world.body_of(shape);
    if (!details.ok() || !body.ok() || details->sensor) continue;
    const auto state = world.state(body.value());
    auto geometry = world.shape_geometry(shape);
    if (!state.ok() || !state->enabled || !geometry.ok()) continue;
    GrainSolid<D> solid;
    solid.shape = std::move(geometry).value();
    typename D::Pose origin{};
    origin.position = definition.lower;
    solid.at = relative(origin, state->pose) * details->local;
    solid.bounds = geometry::bounds(solid.shape, solid.at);
    solid.friction = math::sqrt(details->material.friction * definition.wall_friction);
    solid.key = 16 + shape.index;
    if constexpr (N == 2)
      solid.sheet = solid.shape.type == geometry::ShapeType2::chain ? definition.radius : 0.0f;
    else
      solid.sheet = solid.shape.type == geometry::ShapeType3::height_field ? definition.radius : 0.0f;
    if (state->type != rigid::BodyType::fixed) {
      int index = 0;
      while (index < int(bodies.size()) && !(bodies[index].id == body.value())) ++index;
      if (index == int(bodies.size())) {
        GrainBody<D> b;
        b.id = body.value();
        b.moves = state->type == rigid::BodyType::dynamic && state->mass > 0;
        b.center = Vector(state->center_of_mass - definition.lower);
        b.velocity = state->linear_velocity;
        b.spin = state->angular_velocity;
        if (b.moves) {
          const auto known = world.body_definition(b.id);
          b.gain = (known.ok() ? known->gravity_scale : 1.0f) * world.definition().gravity;
          b.inverse_mass = 1 / state->mass;
          if constexpr (N == 2) {
            const auto mass_properties = world.mass_properties2(b.id);
            if (mass_properties.ok() && mass_properties->inertia > 0)
              b.inverse_inertia = float(1 / mass_properties->inertia);
          } else {
            const auto mass_properties = world.mass_properties3(b.id);
            b.inverse_inertia = math::Mat3f::zero();
            if (mass_properties.ok())
              b.inverse_inertia = math::Mat3f(inverse(
                  geometry::rotate_inertia(mass_properties->inertia, math::Mat3d(to_matrix(state->pose.rotation)))));
          }
        }
        bodies.push_back(b);
      }
      solid.body = index;
    }
    solids.push_back(std::move(solid));
  }
  return {};
}

}  // namespace detail

template <class D>
Granular<D>::Granular(std::unique_ptr<Implementation> self) : self_(std::move(self)) {}
template <class D>
Granular<D>::Granular(const Granular& other) : self_(std::make_unique<Implementation>()) {
  self_->state = other.self_->state;
  self_->choose_scheduler();
}
template <class D>
Granular<D>& Granular<D>::operator=(const Granular& other) {
  if (this == &other) return *this;
  self_->state = other.self_->state;
  self_->choose_scheduler();
  return *this;
}
template <class D>
Granular<D>::Granular(Granular&&) noexcept = default;
template <class D>
Granular<D>& Granular<D>::operator=(Granular&&) noexcept = default;
template <class D>
Granular<D>::~Granular() = default;
template <class D>
const GranularDef<D>& Granular<D>::definition() const {
  return self_->state.definition;
}

template <class D>
Result<Granular<D>> Granular<D>::create(const GranularDef<D>& d) {
  const Status checked = detail::check_granular(d);
  if (!checked.ok()) return checked.error();
  auto self = std::make_unique<Implementation>();
  self->state.definition = d;
  self->choose_scheduler();
  const math::InstructionSet set = d.lanes == 0 ? math::detect_instruction_set()
                                                : math::choose_instruction_set(math::instruction_set_of_width(d.lanes));
  self->state.kernels = &detail::grain_kernels<D::dimension>(math::simd_width(set));
  self->state.make_grid();
  self->state.reserve();
  return Granular(std::move(self));
}

template <class D>
Status Granular<D>::add_box(Position lower, Position upper, Vector velocity, std::uint32_t tag) {
  return self_->state.fill(lower, upper, velocity, tag);
}
template <class D>
Status Granular<D>::add_grain(Position position, Vector velocity, std::uint32_t tag, float radius, Angular spin) {
  return self_->state.add(position, velocity, tag, radius, spin, "Granular::add_grain");
}
template <class D>
void Granular<D>::clear() {
  detail::GranularState<D>& s = self_->state;
  s.grains.clear();
  s.first_pair.clear();
  s.first_touch.clear();
}

template <class D>
Status Granular<D>::step(rigid::World<D>& world, float dt) {
  if (!(dt > 0 && dt <= 0.1f))
    return core::Error{core::text("Granular::step: ", core::refused("dt", dt, "0 < dt ≤ 0.1 s"))};
  return self_->state.step(&world, dt);
}
template <class D>
Status Granular<D>::step(float dt) {
  if (!(dt > 0 && dt <= 0.1f))
    return core::Error{core::text("Granular::step: ", core::refused("dt", dt, "0 < dt ≤ 0.1 s"))};
  return self_->state.step(nullptr, dt);
}

template <class D>
int Granular<D>::size() const {
  return int(self_->state.grains.size());
}
template <class D>
typename Granular<D>::Position Granular<D>::position(int index) const {
  return self_->state.definition.lower + Position(self_->state.grains[index].x);
}
template <class D>
typename Granular<D>::Vector Granular<D>::velocity(int index) const {
  return self_->state.grains[index].v;
}
template <class D>
core::Status Granular<D>::set_velocity(int index, Vector velocity) {
  if (index < 0 || index >= size()) return core::Error{core::refused("grain", index, core::text("0 … ", size() - 1))};
  if (!detail::grain_finite(velocity, D::dimension))
    return core::Error{"velocity of a grain is not finite, expected m/s"};
  self_->state.grains[index].v = velocity;
  return {};
}
template <class D>
typename Granular<D>::Angular Granular<D>::spin(int index) const {
  return self_->state.grains[index].spin;
}
template <class D>
float Granular<D>::radius(int index) const {
  return self_->state.grains[index].radius;
}
template <class D>
std::uint32_t Granular<D>::tag(int index) const {
  return self_->state.grains[index].tag;
}
template <class D>
const GranularStatistics& Granular<D>::statistics() const {
  return self_->state.statistics;
}
template <class D>
double Granular<D>::mass() const {
  double sum = 0;
  for (const auto& g : self_->state.grains) sum += 1 / double(g.inverse_mass);
  return sum;
}
template <class D>
double Granular<D>::kinetic_energy() const {
  double sum = 0;
  for (const auto& g : self_->state.grains) {
    const double spin = detail::grain_size(g.spin);
    sum += 0.5 * double(dot(g.v, g.v)) / double(g.inverse_mass) + 0.5 * spin * spin / double(g.inverse_inertia);
  }
  return sum;
}
template <class D>
double Granular<D>::potential_energy() const {
  const detail::GranularState<D>& s = self_->state;
  double sum = 0;
  for (const auto& g : s.grains)
    for (int a = 0; a < D::dimension; ++a)
      sum -= double(s.definition.gravity[a]) * (s.definition.lower[a] + double(g.x[a])) / double(g.inverse_mass);
  return sum;
}
template <class D>
typename Granular<D>::Position Granular<D>::momentum() const {
  Position sum{};
  for (const auto& g : self_->state.grains)
    for (int a = 0; a < D::dimension; ++a) sum[a] += double(g.v[a]) / double(g.inverse_mass);
  return sum;
}
template <class D>
typename Granular<D>::Position Granular<D>::wall_impulse() const {
  return self_->state.wall_impulse;
}
template <class D>
std::uint64_t Granular<D>::state_hash() const {
  core::StateHash hash;
  for (const auto& g : self_->state.grains) {
    for (int a = 0; a < D::dimension; ++a) hash.add(g.x[a]).add(g.v[a]);
    if constexpr (D::dimension == 2)
      hash.add(g.spin);
    else
      hash.add(g.spin.x).add(g.spin.y).add(g.spin.z);
    hash.add(g.radius);
  }
  return hash.digest();
}

}  // namespace carom::particles
