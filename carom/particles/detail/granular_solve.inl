// The impulses of grains that touch.
#pragma once

#include <chrono>

#include "carom/particles/detail/granular_find.inl"

namespace carom::particles::detail {

/// Normals and gaps where the grains are now.
template <class D>
void GranularState<D>::measure() {
  scheduler->parallel_for(int(contacts.size()), 2048, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      Contact& c = contacts[k];
      const Grain<D>&a = grains[c.a], &b = grains[c.b];
      const Vector d = b.x - a.x;
      const float distance = length(d);
      if (distance > 0)
        c.normal = d / distance;
      else
        c.normal = Vector{}, c.normal[1] = 1;
      c.gap = distance - a.radius - b.radius;
    }
  });
  for (Contact& c : surface_contacts) {
    const Grain<D>& g = grains[c.a];
    const int surface = -1 - c.b;
    if (surface < 2 * N) {
      const int axis = surface / 2;
      c.gap = (surface % 2 ? extent[axis] - g.x[axis] : g.x[axis]) - g.radius;
      continue;
    }
    const GrainSolid<D>& solid = solids[surface - 2 * N];
    const Vector local = inverse_transform_point(solid.at, g.x);
    const float d = signed_distance(solid.shape, local, solid.sheet), step = 0.02f * g.radius;
    Vector slope{};
    for (int b = 0; b < N; ++b) {
      Vector up = local, down = local;
      up[b] += step;
      down[b] -= step;
      slope[b] = signed_distance(solid.shape, up, solid.sheet) - signed_distance(solid.shape, down, solid.sheet);
    }
    const float size = length(slope);
    if (!(size > 0)) {
      c.gap = 1;
      continue;
    }
    c.normal = rotate(solid.at.q, slope / -size);
    c.gap = d - g.radius;
    if (solid.body >= 0) c.arm = g.x + d * c.normal - bodies[solid.body].center;
  }
}

template <class D>
void GranularState<D>::apply_pair(const Contact& c, float normal, Vector friction, Angular rolling) {
  Grain<D>&a = grains[c.a], &b = grains[c.b];
  const Vector impulse = normal * c.normal + friction;
  a.v -= a.inverse_mass * impulse;
  b.v += b.inverse_mass * impulse;
  // Arms are r n and −r n: only friction turns.
  const Angular twist = grain_cross(c.normal, friction);
  a.spin -= a.inverse_inertia * (a.radius * twist + rolling);
  b.spin -= b.inverse_inertia * (b.radius * twist - rolling);
}

template <class D>
void GranularState<D>::apply_surface(const Contact& c, float normal, Vector friction, Angular rolling) {
  Grain<D>& a = grains[c.a];
  const Vector impulse = normal * c.normal + friction;
  a.v -= a.inverse_mass * impulse;
  a.spin -= a.inverse_inertia * (a.radius * grain_cross(c.normal, friction) + rolling);
  const int surface = -1 - c.b;
  const int body = surface < 2 * N ? -1 : solids[surface - 2 * N].body;
  if (body < 0 || !bodies[body].moves) {
    wall_impulse += Position(impulse);
    return;
  }
  GrainBody<D>& b = bodies[body];
  const Angular turn = grain_cross(c.arm, impulse) + rolling;
  b.velocity += b.inverse_mass * impulse;
  b.spin += b.inverse_inertia * turn;
  b.impulse += impulse;
  b.turn += turn;
}

namespace {
constexpr float grain_slop = 0.005f, grain_part = 0.3f;  // overlap that stays, of a radius; share of the rest taken out

/// The change of a limited impulse: `wanted` added to `held`, cut off at `limit`.
template <class V>
V limited_change(V& held, V wanted, float limit) {
  V next = held + wanted;
  const float size = grain_size(next);
  if (size > limit) next = (size > 0 ? limit / size : 0.0f) * next;
  const V change = next - held;
  held = next;
  return change;
}
}  // namespace

template <class D>
[[gnu::always_inline]] inline void GranularState<D>::solve_pair(Contact& c, float h) {
  Grain<D>&a = grains[c.a], &b = grains[c.b];
  const float masses = a.inverse_mass + b.inverse_mass;
  const Vector across = b.v - a.v;
  const float speed = dot(across, c.normal);
  const float bias = c.gap > 0 ? c.gap / h : 0.0f;
  const float next = math::max(c.normal_impulse - (speed + bias) / masses, 0.0f);
  const float normal = next - c.normal_impulse;
  c.normal_impulse = next;
  if (next == 0 && normal == 0 && grain_size(c.rolling) == 0 && dot(c.friction, c.friction) == 0) return;
  const Vector push = normal * c.normal;
  a.v -= a.inverse_mass * push;
  b.v += b.inverse_mass * push;
  const Vector slip = b.v - a.v - grain_turn(b.radius * b.spin + a.radius * a.spin, c.normal);
  const Vector tangent = slip - dot(slip, c.normal) * c.normal;
  const float turning = masses + a.radius * a.radius * a.inverse_inertia + b.radius * b.radius * b.inverse_inertia;
  const Vector friction = limited_change(c.friction, -tangent / turning, definition.friction * next);
  const float lever = 2 * a.radius * b.radius / (a.radius + b.radius);
  Angular rolling{};
  if (definition.rolling_friction > 0)
    rolling = limited_change(c.rolling, (a.spin - b.spin) / (a.inverse_inertia + b.inverse_inertia),
                             definition.rolling_friction * lever * next);
  a.v -= a.inverse_mass * friction;
  b.v += b.inverse_mass * friction;
  const Angular twist = grain_cross(c.normal, friction);
  a.spin -= a.inverse_inertia * (a.radius * twist + rolling);
  b.spin -= b.inverse_inertia * (b.radius * twist - rolling);
}

template <class D>
void GranularState<D>::solve_surface(Contact& c, float h) {
  const Grain<D>& a = grains[c.a];
  const int surface = -1 - c.b;
  const int body = surface < 2 * N ? -1 : solids[surface - 2 * N].body;
  const float rub = surface < 2 * N ? definition.wall_friction : solids[surface - 2 * N].friction;
  const GrainBody<D>* b = body >= 0 ? &bodies[body] : nullptr;
  const auto velocity = [&] { return b ? b->velocity + grain_turn(b->spin, c.arm) : Vector{}; };
  // What a unit impulse along `direction` changes between the two.
  const auto response = [&](const Vector& direction, bool rubs) {
    float sum = a.inverse_mass + (rubs ? a.radius * a.radius * a.inverse_inertia : 0.0f);
    if (b && b->moves) {
      const Angular turn = b->inverse_inertia * grain_cross(c.arm, direction);
      sum += b->inverse_mass + dot(grain_turn(turn, c.arm), direction);
    }
    return sum;
  };
  const float speed = dot(velocity() - a.v, c.normal);
  const float bias = c.gap > 0 ? c.gap / h : 0.0f;
  const float next = math::max(c.normal_impulse - (speed + bias) / response(c.normal, false), 0.0f);
  const float normal = next - c.normal_impulse;
  c.normal_impulse = next;
  if (next == 0 && normal == 0 && grain_size(c.rolling) == 0 && dot(c.friction, c.friction) == 0) return;
  apply_surface(c, normal, Vector{}, Angular{});
  const Vector slip = velocity() - a.v - grain_turn(a.radius * a.spin, c.normal);
  const Vector tangent = slip - dot(slip, c.normal) * c.normal;
  const float size = length(tangent);
  Vector wanted{};
  if (size > 0) wanted = tangent / -response(tangent / size, true);
  const Vector friction = limited_change(c.friction, wanted, rub * next);
  Angular rolling{};
  if (definition.rolling_friction > 0) {
    const Angular spin = b ? b->spin : Angular{};
    rolling =
        limited_change(c.rolling, (a.spin - spin) / a.inverse_inertia, definition.rolling_friction * a.radius * next);
  }
  apply_surface(c, 0, friction, rolling);
}

/// Every second slab of layers at a time: no two threads then touch the same grain, and the order is always the same.
/// A thread goes through several slabs in step: each contact waits for the one before it in its slab, and meanwhile the
/// processor has those of the other slabs to do.
template <class D>
template <class F>
void GranularState<D>::for_slabs(bool back, F&& f) {
  constexpr int together = 4;
  const int slabs = int(slab_start.size()) - 1;
  for (int color = 0; color < 2; ++color) {
    const int odd = back ? 1 - color : color, count = (slabs + 1 - odd) / 2;
    const int share = math::clamp(count / scheduler->thread_count(), 1, together);
    scheduler->parallel_for(count, share, [&](int begin, int end, int) {
      for (int s = begin; s < end; s += together) {
        const int streams = math::min(together, end - s);
        int first[together], size[together], longest = 0;
        for (int k = 0; k < streams; ++k) {
          first[k] = slab_start[2 * (s + k) + odd];
          size[k] = slab_start[2 * (s + k) + odd + 1] - first[k];
          longest = math::max(longest, size[k]);
        }
        for (int n = 0; n < longest; ++n)
          for (int k = 0; k < streams; ++k)
            if (n < size[k]) f(contacts[back ? first[k] + size[k] - 1 - n : first[k] + n]);
      }
    });
  }
}

/// Back and forth by turns: weight goes down through a heap in the one direction, what the ground answers in the other.
template <class D>
void GranularState<D>::sweep(float h, bool back) {
  if (!back)
    for (Contact& c : surface_contacts) solve_surface(c, h);
  for_slabs(back, [&](Contact& c) { solve_pair(c, h); });
  if (back)
    for (Contact& c : surface_contacts) solve_surface(c, h);
}

/// Overlaps are taken out of the places alone, so that no speed comes of them.
template <class D>
void GranularState<D>::separate() {
  const float slop = grain_slop * definition.radius;
  for_slabs(false, [&](Contact& c) {
    Grain<D>&a = grains[c.a], &b = grains[c.b];
    const float touch = a.radius + b.radius - slop;
    const Vector d = b.x - a.x;
    const float square = dot(d, d);
    if (square >= touch * touch || !(square > 0)) return;
    const float distance = math::sqrt(square), masses = a.inverse_mass + b.inverse_mass;
    const Vector way = (grain_part * (touch - distance) / (distance * masses)) * d;
    a.x -= a.inverse_mass * way;
    b.x += b.inverse_mass * way;
  });
  for (Contact& c : surface_contacts) {
    Grain<D>& a = grains[c.a];
    const int surface = -1 - c.b;
    float gap = 0;
    if (surface < 2 * N) {
      const int axis = surface / 2;
      gap = (surface % 2 ? extent[axis] - a.x[axis] : a.x[axis]) - a.radius;
    } else {
      const GrainSolid<D>& solid = solids[surface - 2 * N];
      gap = signed_distance(solid.shape, inverse_transform_point(solid.at, a.x), solid.sheet) - a.radius;
    }
    if (gap < -slop) a.x += (grain_part * (gap + slop)) * c.normal;
  }
}

template <class D>
void GranularState<D>::warm_start() {
  for (Contact& c : contacts) {
    c.friction -= dot(c.friction, c.normal) * c.normal;
    apply_pair(c, c.normal_impulse, c.friction, c.rolling);
  }
  for (Contact& c : surface_contacts) {
    c.friction -= dot(c.friction, c.normal) * c.normal;
    apply_surface(c, c.normal_impulse, c.friction, c.rolling);
  }
}

template <class D>
void GranularState<D>::round(float dt, int parts) {
  // Contacts name grains by their ids while the grains are sorted anew.
  for (Contact& c : contacts) c.a = int(grains[c.a].id);
  for (Contact& c : surface_contacts) c.a = int(grains[c.a].id);
  sort();
  find_contacts(dt);
  find_surfaces(dt);
  const float h = dt / float(parts);
  const float scale = last_h > 0 ? h / last_h : 0;  // impulses of a steady load go with the substep
  if (scale != 1)
    for (auto* list : {&contacts, &surface_contacts})
      for (Contact& c : *list) {
        c.normal_impulse *= scale;
        c.friction = scale * c.friction;
        c.rolling = scale * c.rolling;
      }
  last_h = h;
  for (int part = 0; part < parts; ++part) {
    measure();
    for (Grain<D>& g : grains) g.v += h * definition.gravity;
    for (GrainBody<D>& b : bodies)
      if (b.moves) b.velocity += h * b.gain;
    warm_start();
    for (int k = 0; k < definition.iterations; ++k) sweep(h, k % 2 == 0);
    scheduler->parallel_for(int(grains.size()), 4096, [&](int begin, int end, int) {
      for (int i = begin; i < end; ++i) grains[i].x += h * grains[i].v;
    });
    separate();
  }
  statistics.contacts = int(contacts.size());
  statistics.wall_contacts = int(surface_contacts.size());
}

template <class D>
core::Status GranularState<D>::step(rigid::World<D>* world, float dt) {
  const auto began = std::chrono::steady_clock::now();
  statistics = {};
  wall_impulse = {};
  solids.clear();
  bodies.clear();
  if (world) {
    const core::Status gathered = gather(*world);
    if (!gathered.ok()) return gathered;
  }
  // Contacts are looked for as often as the fastest grain moves by half a radius.
  float fastest = 0;
  for (const Grain<D>& g : grains) fastest = math::max(fastest, dot(g.v, g.v));
  fastest = math::sqrt(fastest) + dt * length(definition.gravity);
  statistics.max_speed = fastest;
  const float ways = 2 * fastest * dt / definition.radius;
  const int rounds = ways < 64 ? math::max(1, int(ways) + (ways > float(int(ways)) ? 1 : 0)) : 64;
  const int parts = math::max(1, (definition.substeps + rounds - 1) / rounds);
  for (int k = 0; k < rounds; ++k) round(dt / float(rounds), parts);
  for (const Contact& c : contacts) {
    const float overlap = grains[c.a].radius + grains[c.b].radius - length(grains[c.b].x - grains[c.a].x);
    statistics.max_overlap = math::max(statistics.max_overlap, overlap);
  }
  statistics.grains = int(grains.size());
  for (const GrainBody<D>& b : bodies) {
    if (!b.moves || (dot(b.impulse, b.impulse) == 0 && grain_size(b.turn) == 0)) continue;
    core::Status pushed = world->add_force(b.id, b.impulse / dt);
    if (!pushed.ok()) return pushed;
    core::Status twisted = world->add_torque(b.id, b.turn / dt);
    if (!twisted.ok()) return twisted;
  }
  const auto now = std::chrono::steady_clock::now();
  statistics.milliseconds = std::chrono::duration<double, std::milli>(now - began).count();
  return {};
}

}  // namespace carom::particles::detail
