#include "carom/particles/contacts.h"

#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"

namespace carom::particles {
using math::Vec3f;

core::Status check(const ContactDef& d) {
  if (!(d.restitution >= 0 && d.restitution <= 1))
    return detail::bad("contacts", "restitution", d.restitution, "0 to 1");
  if (!(d.friction >= 0 && math::is_finite(d.friction)))
    return detail::bad("contacts", "friction", d.friction, "a finite number of at least 0");
  if (!(d.rolling >= 0 && math::is_finite(d.rolling)))
    return detail::bad("contacts", "rolling", d.rolling, "a finite number of at least 0");
  if (d.iterations < 1 || d.iterations > 64) return detail::bad("contacts", "iterations", d.iterations, "1 to 64");
  if (d.substeps < 1 || d.substeps > 64) return detail::bad("contacts", "substeps", d.substeps, "1 to 64");
  return {};
}

namespace detail {
namespace {

constexpr float slack = 0.15f;        // of a radius: pairs nearer than this are watched
constexpr float farthest = 1.5f;      // of a radius: faster ones may miss each other in a step
constexpr float damping = 10.0f;      // damping ratio of the soft contact
constexpr float fastest_push = 1.0f;  // m/s, out of an overlap
constexpr float bouncing = 0.5f;      // m/s: slower impacts do not bounce

}  // namespace

void ContactSolver::reserve(std::size_t grains) {
  constexpr std::size_t contacts = 8;  // of a grain: half of its twelve nearest neighbours, and surfaces
  grains_.reserve(grains);
  slots_.reserve(grains);
  index_of_slot_.reserve(grains);
  cell_of_.reserve(grains);
  id_.reserve(grains);
  near_surface_.reserve(grains);
  memory_ids_.reserve(grains);
  memory_start_.reserve(grains + 1);
  cell_start_.reserve(8 * grains + 4097);
  fill_.reserve(8 * grains + 4097);
  contacts_.reserve(contacts * grains);
  given_.reserve(contacts * grains);
  memory_.reserve(contacts * grains);
}

void ContactSolver::sort_into_cells(const Pile& pile) {
  const std::size_t count = pile.x[0].size();
  float low[3]{}, high[3]{}, largest = 0, fastest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    largest = math::max(largest, pile.scale[i]);
    const Vec3f v{pile.v[0][i], pile.v[1][i], pile.v[2][i]};
    fastest = math::max(fastest, math::dot(v, v));
  }
  const float radius = pile.radius * largest;
  reach_ = math::min(math::sqrt(fastest) * float(pile.dt), farthest * radius);
  for (int k = 0; k < 3; ++k) {
    low[k] = high[k] = count > 0 ? pile.x[k][0] : 0;
    for (const float x : pile.x[k]) {
      low[k] = math::min(low[k], x);
      high[k] = math::max(high[k], x);
    }
  }
  // Cells that hold a pair that is watched; larger where the pile is so scattered that they would be too many.
  cell_size_ = (2 + slack) * radius + reach_ + 1e-6f;
  double cells = 0;
  for (;;) {
    cells = 1;
    for (int k = 0; k < 3; ++k) cells *= math::floor(double(high[k] - low[k]) / double(cell_size_)) + 1;
    if (cells <= 8.0 * double(count) + 4096) break;
    cell_size_ *= 1.25f;
  }
  for (int k = 0; k < 3; ++k) cells_[k] = int(math::floor(double(high[k] - low[k]) / double(cell_size_))) + 1;
  cell_start_.assign(std::size_t(cells_[0]) * std::size_t(cells_[1]) * std::size_t(cells_[2]) + 1, 0);
  cell_of_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::int32_t c[3];
    for (int k = 0; k < 3; ++k)
      c[k] = math::min(std::int32_t((pile.x[k][i] - low[k]) / cell_size_), std::int32_t(cells_[k] - 1));
    cell_of_[i] = (c[1] * cells_[2] + c[2]) * cells_[0] + c[0];
    ++cell_start_[std::size_t(cell_of_[i]) + 1];
  }
  for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
  fill_.assign(cell_start_.begin(), cell_start_.end() - 1);
  slots_.resize(count);
  index_of_slot_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    slots_[i] = fill_[std::size_t(cell_of_[i])]++;
    index_of_slot_[std::size_t(slots_[i])] = std::int32_t(i);
  }
}

void ContactSolver::begin(const Pile& pile, const ContactDef& definition) {
  sort_into_cells(pile);
  const std::size_t count = pile.x[0].size();
  grains_.resize(count);
  id_.resize(count);
  for (std::size_t s = 0; s < count; ++s) {
    const std::size_t i = std::size_t(index_of_slot_[s]);
    const float scale = pile.scale[i];
    grains_[s] = {{pile.x[0][i], pile.x[1][i], pile.x[2][i]},
                  {pile.v[0][i], pile.v[1][i], pile.v[2][i]},
                  {pile.w[0][i], pile.w[1][i], pile.w[2][i]},
                  1 / (pile.mass * scale * scale * scale),
                  pile.radius * scale,
                  2.5f / (pile.mass * scale * scale * scale * math::square(pile.radius * scale))};
    id_[s] = pile.ids[i];
  }
  contacts_.clear();
  near_surface_.assign(count, 0);
  find_pairs(pile, definition);
  pairs_ = contacts_.size();
}

void ContactSolver::find_pairs(const Pile& pile, const ContactDef& definition) {
  const float dt = float(pile.dt);
  const auto watch = [&](std::int32_t a, std::int32_t from, std::int32_t to) {
    const Grain& ga = grains_[std::size_t(a)];
    for (std::int32_t b = from; b < to; ++b) {
      const Grain& gb = grains_[std::size_t(b)];
      const Vec3f d = gb.x - ga.x;
      // What falls beside it may be stopped in this step: its own speed counts, not that between them.
      const float d2 = math::dot(d, d), touch = ga.radius + gb.radius, room = slack * math::min(ga.radius, gb.radius);
      if (d2 > math::square(touch + room + reach_)) continue;
      const float way = math::sqrt(math::max(math::dot(ga.v, ga.v), math::dot(gb.v, gb.v))) * dt;
      const float distance = math::sqrt(d2);
      const Vec3f n = distance > 0 ? d / distance : Vec3f{0, 1, 0};
      const float speed = math::dot(n, gb.v - ga.v);
      if (distance - touch > room + way) continue;
      contacts_.push_back({.a = a,
                           .b = b,
                           .normal = n,
                           .offset = 0,
                           .u = {},
                           .turn = {},
                           .inverse = 1 / (ga.inverse_mass + gb.inverse_mass),
                           .friction = definition.friction,
                           .restitution = definition.restitution,
                           .approach = speed});
    }
  };
  const int nx = cells_[0], ny = cells_[1], nz = cells_[2];
  // Layer by layer upward, so that a pass through the contacts carries a load down or up through all of a heap.
  for (int y = 0; y < ny; ++y)
    for (int z = 0; z < nz; ++z)
      for (int x = 0; x < nx; ++x) {
        const std::size_t cell = (std::size_t(y) * std::size_t(nz) + std::size_t(z)) * std::size_t(nx) + std::size_t(x);
        const std::int32_t begin = cell_start_[cell], end = cell_start_[cell + 1];
        if (begin == end) continue;
        // The rows ahead: three cells of each lie side by side.
        std::int32_t from[4], to[4];
        int rows = 0;
        const auto add_row = [&](int row_y, int row_z) {
          if (row_y >= ny || row_z < 0 || row_z >= nz) return;
          const std::size_t row = (std::size_t(row_y) * std::size_t(nz) + std::size_t(row_z)) * std::size_t(nx);
          from[rows] = cell_start_[row + std::size_t(math::max(x - 1, 0))];
          to[rows++] = cell_start_[row + std::size_t(math::min(x + 1, nx - 1)) + 1];
        };
        add_row(y, z + 1);
        for (int k = -1; k <= 1; ++k) add_row(y + 1, z + k);
        const std::int32_t beside = cell_start_[cell + (x + 1 < nx ? 2 : 1)];
        for (std::int32_t a = begin; a < end; ++a) {
          watch(a, a + 1, beside);
          for (int r = 0; r < rows; ++r) watch(a, from[r], to[r]);
        }
      }
}

void ContactSolver::add_surface(int index, int surface, float gap, Vec3f normal, Vec3f u, Vec3f turn, float friction,
                                float restitution) {
  const std::int32_t slot = slots_[std::size_t(index)];
  const Grain& g = grains_[std::size_t(slot)];
  const Vec3f toward = -normal;
  near_surface_[std::size_t(slot)] = 1;
  contacts_.push_back({.a = slot,
                       .b = -1 - surface,
                       .normal = toward,
                       .offset = gap + math::dot(toward, g.x),
                       .u = u,
                       .turn = turn,
                       .inverse = 1 / g.inverse_mass,
                       .friction = friction,
                       .restitution = restitution,
                       .approach = math::dot(toward, u - g.v)});
}

/// Normals and gaps where the grains are at time t of the step.
void ContactSolver::measure(float t) {
  for (Contact& c : contacts_) {
    const Grain& a = grains_[std::size_t(c.a)];
    if (c.b < 0) {
      c.gap = c.offset - math::dot(c.normal, a.x - t * c.u);
      continue;
    }
    const Grain& b = grains_[std::size_t(c.b)];
    const Vec3f d = b.x - a.x;
    const float distance = math::sqrt(math::dot(d, d));
    if (distance > 0) c.normal = d / distance;
    c.gap = distance - (a.radius + b.radius);
  }
}

void ContactSolver::solve_contact(std::size_t i, float h, bool push_out) {
  Contact& c = contacts_[i];
  const Vec3f n = c.normal;
  const float gap = c.gap;
  const Grain& a = grains_[std::size_t(c.a)];
  const Grain* const b = c.b >= 0 ? &grains_[std::size_t(c.b)] : nullptr;
  const Vec3f apart = (b != nullptr ? b->v : c.u) - a.v;
  const float along = math::dot(n, apart);
  if (gap > 0 && c.push == 0 && along + gap / h >= 0) return;  // most of them: near, but not closing
  // Of what touches: the spins carry the surfaces along.
  const Vec3f carried = a.radius * a.w + (b != nullptr ? b->radius * b->w : Vec3f{});
  const Vec3f v = apart - math::cross(carried, n);
  float bias = 0, stiff = 1, leak = 0;
  if (gap > 0) {
    bias = gap / h;
  } else if (push_out) {
    bias = math::max(soft_.rate * gap, -fastest_push);
    stiff = soft_.mass;
    leak = soft_.leak;
  }
  const float before = c.push;
  c.push = math::max(c.push - (along + bias) * c.inverse * stiff - leak * c.push, 0.0f);
  c.most = math::max(c.most, c.push);
  const Vec3f grip_before = c.grip, roll_before = c.roll;
  if (c.push > 0) {
    // A ball gives way to a force on its rim 7/2 times as easily as to one on its middle.
    c.grip -= (c.inverse * (2.0f / 7)) * (v - along * n);
    const float length = math::length(c.grip), limit = c.friction * c.push;
    if (length > limit) c.grip *= limit / length;
    if (rolling_ > 0) {
      const Vec3f turning = (b != nullptr ? b->w : c.turn) - a.w;
      c.roll -= turning / (a.inverse_inertia + (b != nullptr ? b->inverse_inertia : 0.0f));
      const float size = math::length(c.roll), most = rolling_ * a.radius * c.push;
      if (size > most) c.roll *= most / size;
    }
  } else {
    c.grip = {};
    c.roll = {};
  }
  give(c, (c.push - before) * n, c.grip - grip_before, c.roll - roll_before, i);
}

void ContactSolver::give(const Contact& c, Vec3f push, Vec3f grip, Vec3f roll, std::size_t i) {
  Grain& a = grains_[std::size_t(c.a)];
  const Vec3f impulse = push + grip, about = math::cross(c.normal, grip);
  a.v -= a.inverse_mass * impulse;
  a.w -= a.inverse_inertia * (a.radius * about + roll);
  if (c.b < 0) {
    given_[i] += impulse;
    return;
  }
  Grain& b = grains_[std::size_t(c.b)];
  b.v += b.inverse_mass * impulse;
  b.w -= b.inverse_inertia * (b.radius * about - roll);
}

void ContactSolver::solve_up(float h, bool push_out) {
  for (std::size_t i = pairs_; i < contacts_.size(); ++i) solve_contact(i, h, push_out);
  for (std::size_t i = 0; i < pairs_; ++i) solve_contact(i, h, push_out);
}
void ContactSolver::solve_down(float h, bool push_out) {
  for (std::size_t i = pairs_; i-- > 0;) solve_contact(i, h, push_out);
  for (std::size_t i = pairs_; i < contacts_.size(); ++i) solve_contact(i, h, push_out);
}

void ContactSolver::restitute() {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& c = contacts_[i];
    if (!(c.most > 0) || c.approach > -bouncing || c.restitution == 0) continue;
    Grain& a = grains_[std::size_t(c.a)];
    Grain* const b = c.b >= 0 ? &grains_[std::size_t(c.b)] : nullptr;
    const Vec3f n = c.normal;
    const float along = math::dot(n, (b != nullptr ? b->v : c.u) - a.v);
    const float before = c.push;
    c.push = math::max(c.push - (along + c.restitution * c.approach) * c.inverse, 0.0f);
    const Vec3f impulse = (c.push - before) * n;
    a.v -= a.inverse_mass * impulse;
    if (b != nullptr)
      b->v += b->inverse_mass * impulse;
    else
      given_[i] += impulse;
    c.push = before;  // a blow is not what the next step begins with
  }
}

void ContactSolver::solve(const ContactDef& definition, std::span<const Vec3f> gained, double dt) {
  recall();
  given_.assign(contacts_.size(), Vec3f{});
  const float h = float(dt / definition.substeps), part = 1.0f / float(definition.substeps);
  // A stiff, overdamped spring, as fast as the substep allows (E. Catto, Soft constraints, GDC 2011).
  const float turn = 1.9634954f, a1 = 2 * damping + turn, a2 = turn * a1;
  soft_ = {turn / (h * a1), a2 / (1 + a2), 1 / (1 + a2)};
  rolling_ = definition.rolling;
  float t = 0;
  measure(t);
  for (int sub = 0; sub < definition.substeps; ++sub) {
    for (std::size_t s = 0; s < grains_.size(); ++s) grains_[s].v += part * gained[std::size_t(index_of_slot_[s])];
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      Contact& c = contacts_[i];
      if (!(c.push > 0)) continue;
      c.grip -= math::dot(c.grip, c.normal) * c.normal;
      give(c, c.push * c.normal, c.grip, c.roll, i);
    }
    for (int k = 0; k < definition.iterations; ++k) {
      solve_down(h, true);
      solve_up(h, true);
    }
    for (Grain& g : grains_) g.x += h * g.v;
    t += h;
    measure(t);
    solve_down(h, false);
    solve_up(h, false);
  }
  restitute();
}

void ContactSolver::recall() {
  for (Contact& c : contacts_) {
    const std::int32_t ia = index_of_slot_[std::size_t(c.a)];
    const std::int32_t ib = c.b >= 0 ? index_of_slot_[std::size_t(c.b)] : -1;
    const bool swapped = ib >= 0 && ib < ia;
    const std::size_t owner = std::size_t(swapped ? ib : ia);
    const std::uint32_t other = c.b < 0 ? std::uint32_t(-1 - c.b) : id_[std::size_t(swapped ? c.a : c.b)];
    // The id at that index may be another's by now, where someone died.
    if (owner >= memory_ids_.size() || memory_ids_[owner] != id_[std::size_t(swapped ? c.b : c.a)]) continue;
    for (std::int32_t k = memory_start_[owner]; k < memory_start_[owner + 1]; ++k) {
      const Memory& m = memory_[std::size_t(k)];
      if (m.other != other || m.surface != (c.b < 0)) continue;
      c.push = m.push;
      c.grip = swapped ? -m.grip : m.grip;
      c.roll = swapped ? -m.roll : m.roll;
      break;
    }
  }
}

void ContactSolver::finish() {
  const std::size_t count = grains_.size();
  memory_start_.assign(count + 1, 0);
  memory_ids_.resize(count);
  for (std::size_t s = 0; s < count; ++s) memory_ids_[std::size_t(index_of_slot_[s])] = id_[s];
  const auto owner_of = [&](const Contact& c, bool& swapped) {
    const std::int32_t ia = index_of_slot_[std::size_t(c.a)];
    const std::int32_t ib = c.b >= 0 ? index_of_slot_[std::size_t(c.b)] : -1;
    swapped = ib >= 0 && ib < ia;
    return std::size_t(swapped ? ib : ia);
  };
  bool swapped = false;
  for (const Contact& c : contacts_)
    if (c.push > 0) ++memory_start_[owner_of(c, swapped) + 1];
  for (std::size_t i = 1; i <= count; ++i) memory_start_[i] += memory_start_[i - 1];
  memory_.resize(std::size_t(memory_start_[count]));
  fill_.assign(memory_start_.begin(), memory_start_.end() - 1);
  for (const Contact& c : contacts_) {
    if (!(c.push > 0)) continue;
    const std::size_t owner = owner_of(c, swapped);
    const std::uint32_t other = c.b < 0 ? std::uint32_t(-1 - c.b) : id_[std::size_t(swapped ? c.a : c.b)];
    memory_[std::size_t(fill_[owner]++)] = {other, c.b < 0, c.push, swapped ? -c.grip : c.grip,
                                            swapped ? -c.roll : c.roll};
  }
}

void ContactSolver::exchanged(std::span<double> out, std::span<const Vec3f> centers) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = contacts_[i];
    if (c.b >= 0) continue;
    const std::size_t s = std::size_t(-1 - c.b);
    const math::Vec3d j(given_[i]), r(grains_[std::size_t(c.a)].x - centers[s]);
    const math::Vec3d moment = math::cross(r, j);
    for (int k = 0; k < 3; ++k) {
      out[6 * s + std::size_t(k)] += j[k];
      out[6 * s + 3 + std::size_t(k)] += moment[k];
    }
  }
}

double ContactSolver::worst_overlap() const {
  double worst = 0;
  for (const Contact& c : contacts_) {
    if (c.b < 0) continue;
    const float radius = math::min(grains_[std::size_t(c.a)].radius, grains_[std::size_t(c.b)].radius);
    worst = math::max(worst, double(-c.gap / radius));
  }
  return worst;
}

}  // namespace detail
}  // namespace carom::particles
