#include "carom/particles/cloth.h"

#include "carom/core/hash.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles {

using core::Status;
using math::Vec3d;
using math::Vec3f;

namespace {

bool all_finite(Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); }

Status check_fabric(const Fabric& f) {
  const struct {
    const char* name;
    double value, lowest, highest;
    bool open;  // the lowest itself is refused
  } fields[] = {{"mass_per_area", f.mass_per_area, 0, 1e6, true},
                {"warp_stiffness", f.warp_stiffness, 0, 1e9, true},
                {"weft_stiffness", f.weft_stiffness, 0, 1e9, true},
                {"poisson_ratio", f.poisson_ratio, 0, 0.49, false},
                {"shear_stiffness", f.shear_stiffness, 0, 1e9, true},
                {"bending_stiffness", f.bending_stiffness, 0, 1e6, false},
                {"damping", f.damping, 0, 10, false},
                {"thickness", f.thickness, 0, 1, true},
                {"friction", f.friction, 0, 1e3, false},
                {"normal_coefficient", f.normal_coefficient, 0, 100, false},
                {"tangential_coefficient", f.tangential_coefficient, 0, 100, false},
                {"tear_tension", f.tear_tension, 0, 1e9, false}};
  for (const auto& field : fields)
    if (!math::is_finite(field.value) || field.value < field.lowest || field.value > field.highest ||
        (field.open && field.value == field.lowest))
      return core::Error{
          core::refused(core::text("Fabric::", field.name), field.value,
                        core::text(field.open ? "above " : "from ", field.lowest, " to ", field.highest))};
  if (f.poisson_ratio * f.poisson_ratio * f.weft_stiffness >= 0.99 * f.warp_stiffness)
    return core::Error{core::refused("Fabric::poisson_ratio", f.poisson_ratio,
                                     "ν² below warp_stiffness/weft_stiffness (a stable fabric)")};
  return {};
}

}  // namespace

ClothSheet make_cloth_sheet(Vec3d corner, Vec3d along, Vec3d across, int columns, int rows) {
  ClothSheet sheet;
  columns = math::clamp(columns, 2, 2000);
  rows = math::clamp(rows, 2, 2000);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      sheet.points.push_back(corner + along * (double(c) / (columns - 1)) + across * (double(r) / (rows - 1)));
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      const std::uint32_t i = std::uint32_t(r * columns + c), w = std::uint32_t(columns);
      // All diagonals lie the same way: a lattice of one vertex bends and strains evenly, while one of alternating
      // diagonals gives way within its cells and bends a quarter too easily.
      sheet.triangles.insert(sheet.triangles.end(), {i, i + 1, i + w + 1, i, i + w + 1, i + w});
    }
  return sheet;
}

Cloth::Cloth() : state_(std::make_unique<detail::ClothState>()) {}
Cloth::~Cloth() = default;
Cloth::Cloth(const Cloth& other) : state_(std::make_unique<detail::ClothState>(*other.state_)) {}
Cloth& Cloth::operator=(const Cloth& other) {
  if (this == &other) return *this;
  if (state_)
    *state_ = *other.state_;  // keeps the memory
  else
    state_ = std::make_unique<detail::ClothState>(*other.state_);
  return *this;
}
Cloth::Cloth(Cloth&&) noexcept = default;
Cloth& Cloth::operator=(Cloth&&) noexcept = default;

core::Result<Cloth> Cloth::make(const ClothDef& def) {
  if (Status status = check_fabric(def.fabric); !status.ok()) return status.error();
  if (def.points.size() < 3 || def.points.size() > 4'000'000)
    return core::Error{core::refused("number of ClothDef::points", def.points.size(), "3 … 4 000 000")};
  if (def.triangles.empty() || def.triangles.size() % 3 != 0)
    return core::Error{core::refused("number of ClothDef::triangles' indices", def.triangles.size(),
                                     "three a triangle, at least one")};
  for (std::size_t i = 0; i < def.points.size(); ++i)
    if (!all_finite(def.points[i]))
      return core::Error{core::text("ClothDef::points[", i, "] is not finite, expected metres")};
  for (std::size_t k = 0; k < def.triangles.size(); ++k)
    if (def.triangles[k] >= def.points.size())
      return core::Error{core::refused(core::text("ClothDef::triangles[", k, "]"), def.triangles[k],
                                       core::text("below ", def.points.size()))};
  if (!all_finite(def.warp) || !(length(def.warp) > 1e-9))
    return core::Error{"ClothDef::warp has no direction, expected a finite vector that is not zero"};
  if (def.lanes != 0 && def.lanes != 4 && def.lanes != 8 && def.lanes != 16)
    return core::Error{core::refused("ClothDef::lanes", def.lanes, "0, 4, 8 or 16")};
  if (!all_finite(def.velocity)) return core::Error{"ClothDef::velocity is not finite, expected m/s"};
  Cloth cloth;
  detail::ClothState& s = *cloth.state_;
  s.fabric = def.fabric;
  s.apart = def.fabric.thickness;
  s.friction = def.fabric.friction;
  s.collide = def.collide;
  s.self_collide = def.self_collide;
  s.self_collide_edges = def.self_collide && def.self_collide_edges;
  s.filter = def.filter;
  s.scheduler = def.scheduler;
  s.solver.set_lanes(def.lanes);
  s.position.assign(def.points.begin(), def.points.end());
  s.velocity.assign(def.points.size(), Vec3f(def.velocity));
  s.corners.assign(def.triangles.begin(), def.triangles.end());
  if (Status status = s.set_mesh(def.points, normalize(def.warp)); !status.ok()) return status.error();
  return cloth;
}

Status Cloth::pin(int vertex, rigid::BodyId body, Vec3d point, const rigid::World3& world) {
  if (Status status = unpin(vertex); !status.ok()) return status;
  if (!all_finite(point)) return core::Error{"point of a pin is not finite, expected metres"};
  if (body != rigid::BodyId{} && !world.contains(body))
    return core::Error{core::text("pin of vertex ", vertex, ": the world has no such body")};
  detail::ClothState& s = *state_;
  s.pin_of[std::size_t(vertex)] = int(s.pins.size());
  s.pins.push_back({body, point, -1});
  s.pinned.push_back(vertex);
  s.pin_impulse.push_back({});
  return {};
}

Status Cloth::pin(int vertex) {
  if (Status status = unpin(vertex); !status.ok()) return status;
  detail::ClothState& s = *state_;
  s.pin_of[std::size_t(vertex)] = int(s.pins.size());
  s.pins.push_back({{}, s.position[std::size_t(vertex)], -1});
  s.pinned.push_back(vertex);
  s.pin_impulse.push_back({});
  return {};
}

Status Cloth::unpin(int vertex) {
  detail::ClothState& s = *state_;
  if (vertex < 0 || vertex >= vertex_count())
    return core::Error{core::refused("vertex", vertex, core::text("0 … ", vertex_count() - 1))};
  const int k = s.pin_of[std::size_t(vertex)];
  if (k < 0) return {};
  s.pins.erase(s.pins.begin() + k);
  s.pinned.erase(s.pinned.begin() + k);
  s.pin_impulse.erase(s.pin_impulse.begin() + k);
  s.pin_of[std::size_t(vertex)] = -1;
  for (std::size_t j = std::size_t(k); j < s.pinned.size(); ++j) s.pin_of[std::size_t(s.pinned[j])] = int(j);
  return {};
}

Status Cloth::set_air(double density, const environment::Wind& wind, const environment::WindPatch& beyond) {
  if (!math::is_finite(density) || density < 0)
    return core::Error{core::refused("density of the air", density, "a finite number ≥ 0 in kg/m³")};
  if (!all_finite(wind.velocity)) return core::Error{"Wind::velocity is not finite, expected m/s"};
  state_->air_density = density;
  state_->wind = wind;
  state_->beyond = beyond;
  return {};
}

Status Cloth::set_velocity(int vertex, Vec3d velocity) {
  if (vertex < 0 || vertex >= vertex_count())
    return core::Error{core::refused("vertex", vertex, core::text("0 … ", vertex_count() - 1))};
  if (!all_finite(velocity)) return core::Error{"velocity of a vertex is not finite, expected m/s"};
  state_->velocity[std::size_t(vertex)] = Vec3f(velocity);
  return {};
}

Status Cloth::add_impulse(int vertex, Vec3d impulse, rigid::World3& world) {
  if (vertex < 0 || vertex >= vertex_count())
    return core::Error{core::refused("vertex", vertex, core::text("0 … ", vertex_count() - 1))};
  if (!all_finite(impulse)) return core::Error{"impulse on a vertex is not finite, expected N s"};
  return detail::push_vertex(state_->velocity, state_->touching(), state_->pin_of, vertex, impulse, world);
}

Status Cloth::set_substeps(int substeps) {
  if (substeps < 1 || substeps > 64) return core::Error{core::refused("substeps", substeps, "1 … 64")};
  state_->substeps = substeps;
  return {};
}

Status Cloth::step(rigid::World3& world, double dt) {
  if (!(dt > 0 && dt <= 1)) return core::Error{core::refused("dt", dt, "above 0 and at most 1 s")};
  detail::SoftThing* const self = state_.get();
  detail::step_together({&self, 1}, nullptr, world, dt);
  return {};
}

int Cloth::vertex_count() const { return int(state_->position.size()); }
std::span<const Vec3d> Cloth::positions() const { return state_->position; }
std::span<const Vec3f> Cloth::velocities() const { return state_->velocity; }
std::span<const float> Cloth::masses() const { return state_->mass; }
std::span<const std::uint32_t> Cloth::triangles() const { return state_->corners; }
bool Cloth::torn() const { return state_->torn; }
Vec3d Cloth::wind_force() const { return state_->wind_force; }
double Cloth::greatest_tension() const { return state_->greatest_tension; }
int Cloth::iterations() const { return state_->iterations; }

double Cloth::mass() const {
  double sum = 0;
  for (const float m : state_->mass) sum += double(m);
  return sum;
}
double Cloth::area() const {
  double sum = 0;
  const auto& x = state_->position;
  const auto& c = state_->corners;
  for (std::size_t t = 0; t + 2 < c.size(); t += 3)
    sum += 0.5 * length(cross(x[c[t + 1]] - x[c[t]], x[c[t + 2]] - x[c[t]]));
  return sum;
}
Vec3d Cloth::momentum() const {
  Vec3d sum{};
  for (std::size_t i = 0; i < state_->mass.size(); ++i) sum += double(state_->mass[i]) * Vec3d(state_->velocity[i]);
  return sum;
}
double Cloth::kinetic_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < state_->mass.size(); ++i)
    sum += 0.5 * double(state_->mass[i]) * double(length_squared(state_->velocity[i]));
  return sum;
}
double Cloth::elastic_energy() const {
  detail::ClothState now = *state_;
  now.stretch();
  double sum = 0;
  for (std::size_t t = 0; t < now.triangles.size(); ++t) {
    const detail::ClothStrain& strain = now.strains[t];
    const math::Vec3f along = strain.image_of_warp(), across = strain.image_of_weft();
    const double e1 = 0.5 * (double(dot(along, along)) - 1), e2 = 0.5 * (double(dot(across, across)) - 1),
                 e3 = double(dot(along, across));
    sum += 0.5 * double(now.triangles[t].area) *
           (e1 * double(strain.warp) + e2 * double(strain.weft) + e3 * double(strain.shear));
  }
  for (const detail::ClothPatch& patch : now.patches)
    for (const auto& weight : patch.weight) {
      Vec3f curvature{};
      for (int p = 1; p < 6; ++p)
        curvature += weight[p] * Vec3f(now.position[patch.corner[p]] - now.position[patch.corner[0]]);
      sum += 0.5 * double(length_squared(curvature));
    }
  return sum;
}
Vec3d Cloth::pin_force(int vertex) const {
  const detail::ClothState& s = *state_;
  if (vertex < 0 || vertex >= vertex_count() || s.pin_of[std::size_t(vertex)] < 0) return {};
  return s.pin_impulse[std::size_t(s.pin_of[std::size_t(vertex)])] / math::max(s.last_step, 1e-9);
}
std::uint64_t Cloth::state_hash() const {
  core::StateHash hash;
  for (const Vec3d x : state_->position) hash.add(x.x).add(x.y).add(x.z);
  for (const Vec3f v : state_->velocity) hash.add(v.x).add(v.y).add(v.z);
  for (const std::uint32_t c : state_->corners) hash.add(c);
  return hash.digest();
}

}  // namespace carom::particles
