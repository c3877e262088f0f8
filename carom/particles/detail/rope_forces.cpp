// Bending and twist of a discrete elastic rod, straight and alike in all directions (Bergou et al. 2008).
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

namespace {

/// Two neighbouring segments at a particle.
struct RopeBend {
  Vec3d e, f;  ///< unit
  double le, lf, cosine;
  bool usable;
};
RopeBend bend_at(const Rope& rope, std::size_t i, double ahead) {
  RopeBend bend{};
  const Vec3d a = rope.position[i - 1] + ahead * rope.velocity[i - 1], b = rope.position[i] + ahead * rope.velocity[i],
              c = rope.position[i + 1] + ahead * rope.velocity[i + 1];
  bend.e = b - a;
  bend.f = c - b;
  bend.le = length(bend.e);
  bend.lf = length(bend.f);
  bend.usable = bend.le > 1e-9 && bend.lf > 1e-9 && !rope.broken[i - 1] && !rope.broken[i];
  if (!bend.usable) return bend;
  bend.e = bend.e * (1 / bend.le);
  bend.f = bend.f * (1 / bend.lf);
  bend.cosine = math::clamp(dot(bend.e, bend.f), -1.0, 1.0);
  return bend;
}
double voronoi(const Rope& rope, std::size_t i) { return 0.5 * (rope.rest[i - 1] + rope.rest[i]); }
/// 1 + cos φ of a fold (here 60°) beyond which bending grows no stiffer: tan φ/2 would outrun any explicit step. The
/// moment from there on is that of an energy in cos φ.
constexpr double sharpest = 1.5;

/// Carries a vector across `from` to across `to` without twist.
Vec3d carry(Vec3d v, Vec3d from, Vec3d to) {
  const Vec3d axis = cross(from, to);
  const double cosine = dot(from, to), share = 1 / math::max(1 + cosine, 1e-9);
  return cosine * v + cross(axis, v) + (share * dot(axis, v)) * axis;
}

}  // namespace

void add_bending(Rope& rope) {
  const double stiffness = rope.material.bending_stiffness;
  if (stiffness == 0) return;
  for (std::size_t i = 1; i + 1 < rope.position.size(); ++i) {
    // Kelvin and Voigt: the moment of the curvature as it will be `bending_damping` s from now.
    const RopeBend bend = bend_at(rope, i, rope.material.bending_damping);
    if (!bend.usable) continue;
    const double fold = math::max(1 + bend.cosine, sharpest);
    const double moment = 4 * stiffness / (voronoi(rope, i) * fold * fold);
    const Vec3d on_e = (moment / bend.le) * (bend.f - bend.cosine * bend.e);
    const Vec3d on_f = (moment / bend.lf) * (bend.e - bend.cosine * bend.f);
    rope.force[i - 1] -= on_e;
    rope.force[i] += on_e - on_f;
    rope.force[i + 1] += on_f;
  }
}

double bending_energy(const Rope& rope) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < rope.position.size(); ++i) {
    const RopeBend bend = bend_at(rope, i, 0);
    if (!bend.usable) continue;
    const double fold = math::max(1 + bend.cosine, sharpest), over = fold - (1 + bend.cosine);
    sum += rope.material.bending_stiffness / voronoi(rope, i) * (2 * (2 - fold) / fold + 4 * over / (fold * fold));
  }
  return sum;
}

Vec3d carried_director(const Rope& rope, Vec3d director) {
  Vec3d tangent = normalize(rope.position[1] - rope.position[0]);
  for (std::size_t i = 1; i + 1 < rope.position.size(); ++i) {
    const Vec3d next = normalize(rope.position[i + 1] - rope.position[i]);
    director = carry(director, tangent, next);
    tangent = next;
  }
  return director;
}

void add_twist(Rope& rope, std::vector<RopeBody>& bodies, double h) {
  if (rope.material.torsional_stiffness == 0) return;
  const RopeGrip *first = nullptr, *last = nullptr;
  for (const RopeGrip& grip : rope.grips) {
    if (!grip.attachment.clamped) continue;
    (grip.attachment.node == 0 ? first : last) = &grip;
  }
  if (!first || !last) return;
  for (const std::uint8_t gone : rope.broken)
    if (gone) return;
  const auto turned = [&](const RopeGrip& grip) {
    return grip.body < 0 ? grip.director : rotate(bodies[std::size_t(grip.body)].rotation, grip.director);
  };
  const std::size_t n = rope.position.size();
  const Vec3d carried = carried_director(rope, turned(*first)), held = turned(*last);
  const Vec3d tangent = normalize(rope.position[n - 1] - rope.position[n - 2]);
  const double raw = rope.twist_offset + math::atan2(dot(tangent, cross(carried, held)), dot(carried, held));
  // The angle is known but for whole turns: the one nearest to what it was.
  rope.twist = raw + 2 * math::pi * math::round((rope.twist - raw) / (2 * math::pi));
  double whole = 0;
  for (const double rest : rope.rest) whole += rest;
  const double torque = rope.material.torsional_stiffness * rope.twist / whole;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const RopeBend bend = bend_at(rope, i, 0);
    if (!bend.usable) continue;
    const Vec3d curvature = (2 / math::max(1 + bend.cosine, sharpest)) * cross(bend.e, bend.f);
    const Vec3d before = (0.5 * torque / bend.le) * curvature, after = (0.5 * torque / bend.lf) * curvature;
    rope.force[i - 1] += before;
    rope.force[i] += after - before;
    rope.force[i + 1] -= after;
  }
  const auto turn = [&](const RopeGrip& grip, Vec3d moment) {
    if (grip.body < 0) return;
    RopeBody& body = bodies[std::size_t(grip.body)];
    if (body.type != rigid::BodyType::dynamic) return;
    const Vec3d impulse = h * moment;
    body.turn += impulse;
    if (!body.moves) return;
    body.velocity += body.mixed * impulse;
    body.spin += body.angular * impulse;
  };
  turn(*first, torque * normalize(rope.position[1] - rope.position[0]));
  turn(*last, -torque * tangent);
}

}  // namespace carom::particles::detail
