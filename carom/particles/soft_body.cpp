#include "carom/particles/soft_body.h"

#include <algorithm>

#include "carom/core/hash.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_state.h"

namespace carom::particles {

using core::Status;
using math::Vec3d;
using math::Vec3f;

namespace {

bool soft_finite(Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); }

Status check_solid(const SoftMaterial& m) {
  const struct {
    const char* name;
    double value, lowest, highest;
    bool open;
  } fields[] = {{"density", m.density, 0, 1e6, true},
                {"youngs_modulus", m.youngs_modulus, 0, 1e12, true},
                {"poisson_ratio", m.poisson_ratio, 0, 0.48, false},
                {"damping", m.damping, 0, 10, false},
                {"friction", m.friction, 0, 1e3, false},
                {"skin", m.skin, 0, 1, true}};
  for (const auto& field : fields)
    if (!math::is_finite(field.value) || field.value < field.lowest || field.value > field.highest ||
        (field.open && field.value == field.lowest))
      return core::Error{
          core::refused(core::text("SoftMaterial::", field.name), field.value,
                        core::text(field.open ? "above " : "from ", field.lowest, " to ", field.highest))};
  return {};
}

double six_volumes(Vec3d a, Vec3d b, Vec3d c, Vec3d d) { return triple(b - a, c - a, d - a); }

}  // namespace

namespace detail {

Status SoftState::set_mesh() {
  const std::size_t n = position.size();
  elements.assign(corners.size() / 4, SoftElement{});
  crushes.assign(elements.size(), SoftCrush{});
  mass.assign(n, 0.0f);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::uint32_t* c = &corners[4 * e];
    double six = six_volumes(position[c[0]], position[c[1]], position[c[2]], position[c[3]]);
    if (six < 0) {
      std::swap(c[2], c[3]);
      six = -six;
    }
    const Vec3d d1 = position[c[1]] - position[c[0]], d2 = position[c[2]] - position[c[0]],
                d3 = position[c[3]] - position[c[0]];
    const double size = math::max(length(d1), math::max(length(d2), length(d3)));
    if (!(six > 1e-6 * size * size * size))
      return core::Error{core::text("tetrahedron ", e, " of SoftBodyDef has a volume of ", six / 6,
                                    " m³, expected four corners that are not in a plane")};
    SoftElement& element = elements[e];
    element.volume = float(six / 6);
    const Vec3d g1 = cross(d2, d3) / six, g2 = cross(d3, d1) / six, g3 = cross(d1, d2) / six;
    element.gradient[0] = Vec3f(-(g1 + g2 + g3));
    element.gradient[1] = Vec3f(g1);
    element.gradient[2] = Vec3f(g2);
    element.gradient[3] = Vec3f(g3);
    steepest =
        math::max(steepest, length(element.gradient[1]) + length(element.gradient[2]) + length(element.gradient[3]));
    for (int a = 0; a < 4; ++a) mass[c[a]] += 0.25f * element.volume * float(material.density);
  }
  for (std::size_t i = 0; i < n; ++i)
    if (mass[i] == 0) return core::Error{core::text("point ", i, " of SoftBodyDef is in no tetrahedron")};
  matrix.build(int(n), corners, 4, {});
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        elements[e].slots[4 * a + b] = matrix.slot(corners[4 * e + a], corners[4 * e + b]);
  first.assign(n + 1, 0);
  for (const std::uint32_t c : corners) ++first[c + 1];
  for (std::size_t i = 0; i < n; ++i) first[i + 1] += first[i];
  list.resize(corners.size());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (std::size_t k = 0; k < corners.size(); ++k) list[std::size_t(next[corners[k]]++)] = int(k);
  find_surface();
  load.assign(n, Vec3f{});
  pin_of.assign(n, -1);
  touches.assign(n, SoftTouch{});
  solver.resize(matrix);
  return {};
}

void SoftState::find_surface() {
  struct Face {
    std::uint32_t sorted[3], corner[3];
    int element;
  };
  std::vector<Face> faces;
  constexpr int of[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};  // outward for a positive volume
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (const auto& f : of) {
      Face face{};
      face.element = int(e);
      for (int k = 0; k < 3; ++k) face.corner[k] = face.sorted[k] = corners[4 * e + std::size_t(f[k])];
      std::sort(face.sorted, face.sorted + 3);
      faces.push_back(face);
    }
  std::stable_sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::lexicographical_compare(a.sorted, a.sorted + 3, b.sorted, b.sorted + 3);
  });
  surface.clear();
  behind.clear();
  outside.assign(position.size(), 0);
  const auto same = [](const Face& a, const Face& b) { return std::equal(a.sorted, a.sorted + 3, b.sorted); };
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k + 1 < faces.size() && same(faces[k], faces[k + 1])) {
      ++k;
      continue;
    }
    behind.push_back(faces[k].element);
    for (const std::uint32_t c : faces[k].corner) {
      surface.push_back(c);
      outside[c] = 1;
    }
  }
  folded.assign(behind.size(), 0);
  double sum = 0;
  for (std::size_t k = 0; k < surface.size(); ++k)
    sum += length(position[surface[k]] - position[surface[k % 3 == 2 ? k - 2 : k + 1]]);
  mean_edge = float(sum / double(surface.size()));
}

}  // namespace detail

SoftMesh make_soft_box(Vec3d corner, Vec3d size, int nx, int ny, int nz) {
  SoftMesh mesh;
  nx = math::clamp(nx, 1, 200);
  ny = math::clamp(ny, 1, 200);
  nz = math::clamp(nz, 1, 200);
  for (int z = 0; z <= nz; ++z)
    for (int y = 0; y <= ny; ++y)
      for (int x = 0; x <= nx; ++x)
        mesh.points.push_back(corner + Vec3d{size.x * x / nx, size.y * y / ny, size.z * z / nz});
  const auto at = [&](int x, int y, int z) { return std::uint32_t((z * (ny + 1) + y) * (nx + 1) + x); };
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        std::uint32_t c[8];
        for (int k = 0; k < 8; ++k) c[k] = at(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
        constexpr int even[5][4] = {{0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}, {1, 2, 4, 7}};
        constexpr int odd[5][4] = {{1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}, {0, 3, 5, 6}};
        for (const auto& t : (x + y + z) % 2 == 0 ? even : odd)
          for (const int k : t) mesh.tetrahedra.push_back(c[k]);
      }
  return mesh;
}

SoftMesh make_soft_ball(Vec3d center, double radius, int cells) {
  cells = math::clamp(cells, 2, 40);
  SoftMesh mesh = make_soft_box({-1, -1, -1}, {2, 2, 2}, cells, cells, cells);
  for (Vec3d& p : mesh.points) {
    // The cube's shells become spheres: a point goes out along its ray by its largest coordinate, half way evened.
    const double largest = math::max(math::abs(p.x), math::max(math::abs(p.y), math::abs(p.z))), l = length(p);
    if (l > 0) p = p * (largest / l);
    p = center + radius * p;
  }
  return mesh;
}

SoftBody::SoftBody() : state_(std::make_unique<detail::SoftState>()) {}
SoftBody::~SoftBody() = default;
SoftBody::SoftBody(const SoftBody& other) : state_(std::make_unique<detail::SoftState>(*other.state_)) {}
SoftBody& SoftBody::operator=(const SoftBody& other) {
  if (this == &other) return *this;
  if (state_)
    *state_ = *other.state_;
  else
    state_ = std::make_unique<detail::SoftState>(*other.state_);
  return *this;
}
SoftBody::SoftBody(SoftBody&&) noexcept = default;
SoftBody& SoftBody::operator=(SoftBody&&) noexcept = default;

core::Result<SoftBody> SoftBody::make(const SoftBodyDef& def) {
  if (Status status = check_solid(def.material); !status.ok()) return status.error();
  if (def.points.size() < 4 || def.points.size() > 4'000'000)
    return core::Error{core::refused("number of SoftBodyDef::points", def.points.size(), "4 … 4 000 000")};
  if (def.tetrahedra.empty() || def.tetrahedra.size() % 4 != 0)
    return core::Error{core::refused("number of SoftBodyDef::tetrahedra's indices", def.tetrahedra.size(),
                                     "four a tetrahedron, at least one")};
  for (std::size_t i = 0; i < def.points.size(); ++i)
    if (!soft_finite(def.points[i]))
      return core::Error{core::text("SoftBodyDef::points[", i, "] is not finite, expected metres")};
  for (std::size_t k = 0; k < def.tetrahedra.size(); ++k)
    if (def.tetrahedra[k] >= def.points.size())
      return core::Error{core::refused(core::text("SoftBodyDef::tetrahedra[", k, "]"), def.tetrahedra[k],
                                       core::text("below ", def.points.size()))};
  if (def.lanes != 0 && def.lanes != 4 && def.lanes != 8 && def.lanes != 16)
    return core::Error{core::refused("SoftBodyDef::lanes", def.lanes, "0, 4, 8 or 16")};
  if (!soft_finite(def.velocity)) return core::Error{"SoftBodyDef::velocity is not finite, expected m/s"};
  SoftBody body;
  detail::SoftState& s = *body.state_;
  s.material = def.material;
  s.apart = def.material.skin;
  s.friction = def.material.friction;
  s.closed = true;
  s.collide = def.collide;
  s.filter = def.filter;
  s.scheduler = def.scheduler;
  s.solver.set_lanes(def.lanes);
  s.position.assign(def.points.begin(), def.points.end());
  s.velocity.assign(def.points.size(), Vec3f(def.velocity));
  s.corners.assign(def.tetrahedra.begin(), def.tetrahedra.end());
  if (Status status = s.set_mesh(); !status.ok()) return status.error();
  return body;
}

namespace {
Status check_vertex(int vertex, int count) {
  if (vertex >= 0 && vertex < count) return {};
  return core::Error{core::refused("vertex", vertex, core::text("0 … ", count - 1))};
}
}  // namespace

Status SoftBody::pin(int vertex) {
  if (Status status = unpin(vertex); !status.ok()) return status;
  detail::SoftState& s = *state_;
  s.pin_of[std::size_t(vertex)] = int(s.pins.size());
  s.pins.push_back({{}, s.position[std::size_t(vertex)], -1});
  s.pinned.push_back(vertex);
  return {};
}
Status SoftBody::pin(int vertex, rigid::BodyId body, Vec3d point, const rigid::World3& world) {
  if (!soft_finite(point)) return core::Error{"point of a pin is not finite, expected metres"};
  if (body != rigid::BodyId{} && !world.contains(body))
    return core::Error{core::text("pin of vertex ", vertex, ": the world has no such body")};
  if (Status status = pin(vertex); !status.ok()) return status;
  state_->pins.back().body = body;
  state_->pins.back().point = point;
  return {};
}
Status SoftBody::unpin(int vertex) {
  if (Status status = check_vertex(vertex, vertex_count()); !status.ok()) return status;
  detail::SoftState& s = *state_;
  const int k = s.pin_of[std::size_t(vertex)];
  if (k < 0) return {};
  s.pins.erase(s.pins.begin() + k);
  s.pinned.erase(s.pinned.begin() + k);
  s.pin_of[std::size_t(vertex)] = -1;
  for (std::size_t j = std::size_t(k); j < s.pinned.size(); ++j) s.pin_of[std::size_t(s.pinned[j])] = int(j);
  return {};
}
Status SoftBody::set_velocity(int vertex, Vec3d velocity) {
  if (Status status = check_vertex(vertex, vertex_count()); !status.ok()) return status;
  if (!soft_finite(velocity)) return core::Error{"velocity of a vertex is not finite, expected m/s"};
  state_->velocity[std::size_t(vertex)] = Vec3f(velocity);
  return {};
}
Status SoftBody::add_impulse(int vertex, Vec3d impulse, rigid::World3& world) {
  if (Status status = check_vertex(vertex, vertex_count()); !status.ok()) return status;
  if (!soft_finite(impulse)) return core::Error{"impulse on a vertex is not finite, expected N s"};
  return detail::push_vertex(state_->velocity, state_->touching(), state_->pin_of, vertex, impulse, world);
}
Status SoftBody::set_force(int vertex, Vec3d force) {
  if (Status status = check_vertex(vertex, vertex_count()); !status.ok()) return status;
  if (!soft_finite(force)) return core::Error{"force on a vertex is not finite, expected N"};
  state_->load[std::size_t(vertex)] = Vec3f(force);
  return {};
}
Status SoftBody::set_substeps(int substeps) {
  if (substeps < 1 || substeps > 64) return core::Error{core::refused("substeps", substeps, "1 … 64")};
  state_->substeps = substeps;
  return {};
}
Status SoftBody::set_pressure(double pressure) {
  if (!math::is_finite(pressure)) return core::Error{core::refused("pressure", pressure, "a finite number in Pa")};
  state_->pressure = pressure;
  return {};
}
Status SoftBody::step(rigid::World3& world, double dt) {
  if (!(dt > 0 && dt <= 1)) return core::Error{core::refused("dt", dt, "above 0 and at most 1 s")};
  detail::SoftThing* const self = state_.get();
  detail::step_together({&self, 1}, nullptr, world, dt);
  return {};
}

int SoftBody::vertex_count() const { return int(state_->position.size()); }
std::span<const Vec3d> SoftBody::positions() const { return state_->position; }
std::span<const Vec3f> SoftBody::velocities() const { return state_->velocity; }
std::span<const std::uint32_t> SoftBody::surface() const { return state_->surface; }
int SoftBody::iterations() const { return state_->iterations; }

double SoftBody::mass() const {
  double sum = 0;
  for (const float m : state_->mass) sum += double(m);
  return sum;
}
double SoftBody::volume() const {
  double sum = 0;
  const auto& x = state_->position;
  const auto& c = state_->corners;
  for (std::size_t e = 0; e < c.size(); e += 4) sum += six_volumes(x[c[e]], x[c[e + 1]], x[c[e + 2]], x[c[e + 3]]) / 6;
  return sum;
}
double SoftBody::rest_volume() const {
  double sum = 0;
  for (const detail::SoftElement& element : state_->elements) sum += double(element.volume);
  return sum;
}
Vec3d SoftBody::momentum() const {
  Vec3d sum{};
  for (std::size_t i = 0; i < state_->mass.size(); ++i) sum += double(state_->mass[i]) * Vec3d(state_->velocity[i]);
  return sum;
}
double SoftBody::kinetic_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < state_->mass.size(); ++i)
    sum += 0.5 * double(state_->mass[i]) * double(length_squared(state_->velocity[i]));
  return sum;
}
double SoftBody::elastic_energy() const { return state_->elastic_energy(); }
Vec3d SoftBody::center() const {
  Vec3d sum{};
  double all = 0;
  for (std::size_t i = 0; i < state_->mass.size(); ++i) {
    sum += double(state_->mass[i]) * state_->position[i];
    all += double(state_->mass[i]);
  }
  return sum / all;
}
std::uint64_t SoftBody::state_hash() const {
  core::StateHash hash;
  for (const Vec3d x : state_->position) hash.add(x.x).add(x.y).add(x.z);
  for (const Vec3f v : state_->velocity) hash.add(v.x).add(v.y).add(v.z);
  return hash.digest();
}

}  // namespace carom::particles
