// Winches: segments at the ends of a rope grow and shrink, particles come and go.
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

void RopeSolver::wind_winches(Rope& rope) {
  for (int end = 0; end < 2; ++end) {
    if (rope.winch[end] == 0) continue;
    const auto last = [&] { return end == 0 ? std::size_t(0) : rope.rest.size() - 1; };
    const double shortest = 0.5 * rope.segment;
    const double rest = rope.rest[last()];
    if (rest < shortest && rope.rest.size() > 1) {
      // The particle beside the end is taken off; its neighbour's segment reaches to the end.
      const std::size_t node = end == 0 ? 1 : rope.position.size() - 2;
      const std::size_t gone = last(), kept = end == 0 ? 1 : gone - 1;
      for (const RopeGrip& grip : rope.grips)
        if (std::size_t(grip.attachment.node) == node) return;  // reeled in as far as it goes
      rope.rest[kept] += rope.rest[gone];
      rope.lump[end == 0 ? 0 : rope.lump.size() - 1] += rope.lump[node];
      const auto erase = [](auto& list, std::size_t at) { list.erase(list.begin() + std::ptrdiff_t(at)); };
      erase(rope.position, node);
      erase(rope.velocity, node);
      erase(rope.lump, node);
      erase(rope.contacts, node);
      erase(rope.rest, gone);
      erase(rope.tension, gone);
      erase(rope.broken, gone);
      erase(rope.edges, gone);
      for (RopeGrip& grip : rope.grips)
        if (std::size_t(grip.attachment.node) > node) --grip.attachment.node;
      rope.resize(rope.position.size());
    } else if (rest > 1.5 * rope.segment) {
      const std::size_t at = last(), node = at + 1;  // the new particle, between `at` and what was `at + 1`
      const double share = end == 0 ? (rest - rope.segment) / rest : rope.segment / rest;
      const auto insert = [](auto& list, std::size_t place, auto value) {
        list.insert(list.begin() + std::ptrdiff_t(place), value);
      };
      const double far = rope.segment, near = rest - rope.segment;
      insert(rope.position, node, lerp(rope.position[at], rope.position[at + 1], share));
      insert(rope.velocity, node, lerp(rope.velocity[at], rope.velocity[at + 1], share));
      insert(rope.lump, node, 0.0);
      insert(rope.contacts, node, RopeContact{});
      insert(rope.tension, at, rope.tension[at]);
      insert(rope.broken, at, std::uint8_t(0));
      insert(rope.edges, at, RopeEdge{});
      insert(rope.rest, at, 0.0);
      rope.rest[at] = end == 0 ? near : far;
      rope.rest[at + 1] = end == 0 ? far : near;
      for (RopeGrip& grip : rope.grips)
        if (std::size_t(grip.attachment.node) >= node) ++grip.attachment.node;
      rope.resize(rope.position.size());
    }
  }
}

void RopeSolver::weigh(Rope& rope) {
  for (int end = 0; end < 2; ++end) {
    double& rest = rope.rest[end == 0 ? 0 : rope.rest.size() - 1];
    rest = math::max(rest - h * rope.winch[end], math::min(rest, 0.2 * rope.segment));
  }
  const int n = rope.count();
  const double half = 0.5 * rope.material.mass_per_length;
  for (int i = 0; i < n; ++i) {
    const std::size_t k = std::size_t(i);
    rope.mass[k] = rope.lump[k] + half * ((i > 0 ? rope.rest[k - 1] : 0) + (i + 1 < n ? rope.rest[k] : 0));
  }
}

}  // namespace carom::particles::detail
