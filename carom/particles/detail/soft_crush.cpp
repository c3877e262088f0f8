// Elements of a soft body that are crushed so far that they would turn inside out.
#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_state.h"

namespace carom::particles::detail {

namespace {
constexpr float crush_limit = 0.2f;     // of an element's heights at rest
constexpr float crush_stiffness = 50;   // times what the corners weigh: it bears far more than they
constexpr float crush_recovery = 0.5f;  // m/s, at which what is crushed beyond the limit comes back at most

Mat3f cofactors(const Mat3f& f) { return {cross(f.cy, f.cz), cross(f.cz, f.cx), cross(f.cx, f.cy)}; }
float size_of(const Mat3f& m) { return math::sqrt(dot(m.cx, m.cx) + dot(m.cy, m.cy) + dot(m.cz, m.cz)); }
}  // namespace

Mat3f SoftState::deformation(std::size_t k) const {
  const std::uint32_t* const c = &corners[4 * k];
  Mat3f f = Mat3f::zero();
  for (int a = 1; a < 4; ++a) f = f + math::outer(Vec3f(position[c[a]] - position[c[0]]), elements[k].gradient[a]);
  return f;
}

Mat3f SoftState::rate(std::size_t k, const SoftVector* change) const {
  const std::uint32_t* const c = &corners[4 * k];
  const auto after = [&](std::uint32_t i) {
    return change != nullptr ? velocity[i] + change[i].vector() : velocity[i];
  };
  const Vec3f first = after(c[0]);
  Mat3f f = Mat3f::zero();
  for (int a = 1; a < 4; ++a) f = f + math::outer(after(c[a]) - first, elements[k].gradient[a]);
  return f;
}

/// Of an element's four heights that one which comes nearest to its limit within the substep. With q = cof(F) ∇N the
/// normal of the face opposite to corner a is q_a/|q_a|, the height J/|q_a| and its rate Σ_b (q_b·q_a)/|q_a|² n·v_b:
/// all finite, and of the right sign, where the element is flat or inside out.
void SoftState::foresee_crush(std::size_t k, const Mat3f& f, float h, const SoftVector* change) {
  SoftElement& element = elements[k];
  SoftCrush& crush = crushes[k];
  const std::uint32_t* const c = &corners[4 * k];
  const Mat3f cofactor = cofactors(f);
  const float j = dot(f.cx, cofactor.cx);
  Vec3f q[4], v[4];
  for (int a = 0; a < 4; ++a) {
    q[a] = cofactor * element.gradient[a];
    v[a] = change != nullptr ? velocity[c[a]] + change[c[a]].vector() : velocity[c[a]];
  }
  float worst = 1e30f;
  int corner = -1;
  for (int a = 0; a < 4; ++a) {
    const float square = dot(q[a], q[a]), rest = dot(element.gradient[a], element.gradient[a]);
    if (!(square > 1e-6f * rest)) continue;
    float along = 0;
    for (int b = 0; b < 4; ++b) along += dot(q[b], q[a]) * dot(q[a], v[b]);
    const float size = math::sqrt(square), share = math::sqrt(rest) * (j / size + h * along / (square * size));
    if (share >= worst) continue;
    worst = share;
    corner = a;
  }
  const bool was = element.crushed;
  element.crushed = false;
  crush = {};
  if (corner < 0) return;
  const Vec3f way = q[corner];
  const float square = dot(way, way), size = math::sqrt(square);
  crush.normal = way * (1 / size);
  float lightness = 0;
  for (int b = 0; b < 4; ++b) {
    crush.weight[b] = dot(q[b], way) / square;
    crush.before += crush.weight[b] * dot(crush.normal, velocity[c[b]]);
    lightness += math::square(crush.weight[b]) / mass[c[b]];
  }
  crush.gap = j / size - crush_limit / length(element.gradient[corner]);
  crush.stiff = crush_stiffness / lightness;
  crush.wanted = crush.gap >= 0 ? -crush.gap / h : math::min(-0.5f * crush.gap / h, crush_recovery);
  element.crushed = was || worst < crush_limit;
}

/// What the deformation of any element changes by in a substep, at most: where nothing moves against the rest of the
/// body no element needs a look of its own.
float SoftState::greatest_way(float h, const SoftVector* change) const {
  const auto after = [&](std::size_t i) { return change != nullptr ? velocity[i] + change[i].vector() : velocity[i]; };
  Vec3f low = after(0), high = low;
  for (std::size_t i = 1; i < velocity.size(); ++i) {
    const Vec3f v = after(i);
    low = min(low, v);
    high = max(high, v);
  }
  return h * steepest * length(high - low);
}

void SoftState::find_crush(std::size_t k, const Mat3f& f, float h) {
  const Mat3f cofactor = cofactors(f);
  SoftElement& element = elements[k];
  element.thick = dot(f.cx, cofactor.cx) / (size_of(cofactor) + 1e-10f);
  if (element.thick - way < crush_limit && element.thick - h * size_of(rate(k, nullptr)) < crush_limit)
    foresee_crush(k, f, h, nullptr);
  else
    element.crushed = false;
}

/// Adds what holds an element's height to the system, or takes it out again.
void SoftState::enter_crush(std::size_t k, float sign) {
  const SoftElement& element = elements[k];
  const SoftCrush& crush = crushes[k];
  for (int a = 0; a < 4; ++a) {
    solver.right[corners[4 * k + std::size_t(a)]] +=
        (sign * crush.stiff * (crush.wanted - crush.before) * crush.weight[a]) * crush.normal;
    for (int b = 0; b < 4; ++b) crush.add_block(a, b, sign, matrix.blocks[std::size_t(element.slots[4 * a + b])]);
  }
  solver.remade = true;
}

bool SoftState::revise(float h) {
  bool again = SoftThing::revise(h);
  const SoftVector* const change = solver.change.data();
  const float most = greatest_way(h, change);
  if (slimmest - math::max(way, most) >= crush_limit) return again;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const SoftCrush& crush = crushes[k];
    SoftElement& element = elements[k];
    if (element.crushed) {
      float along = 0;
      for (int b = 0; b < 4; ++b) {
        const std::uint32_t i = corners[4 * k + std::size_t(b)];
        along += crush.weight[b] * dot(crush.normal, velocity[i] + change[i].vector());
      }
      if (along <= crush.wanted) continue;
      enter_crush(k, -1);  // it would be drawn together
      element.crushed = false;
      again = true;
      continue;
    }
    if (element.thick - most >= crush_limit || element.thick - h * size_of(rate(k, change)) >= crush_limit) continue;
    foresee_crush(k, deformation(k), h, change);
    if (!element.crushed) continue;
    enter_crush(k, 1);
    again = true;
  }
  return again;
}

}  // namespace carom::particles::detail
