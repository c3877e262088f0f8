#include "benchmarks/engine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace carom::bench {

using std::numbers::pi;

double volume(const Body& body, int dimension) {
  const Vec3d s = body.size;
  const bool plane = dimension == 2;
  switch (body.kind) {
    case Kind::box:
      return plane ? 4 * s.x * s.y : 8 * s.x * s.y * s.z;
    case Kind::sphere:
      return plane ? pi * s.x * s.x : 4.0 / 3 * pi * s.x * s.x * s.x;
    case Kind::capsule:
      return plane ? 4 * s.x * s.y + pi * s.y * s.y : pi * s.y * s.y * (2 * s.x + 4.0 / 3 * s.y);
    case Kind::cylinder:
      return plane ? 4 * s.x * s.y : 2 * pi * s.y * s.y * s.x;
  }
  return 0;
}
double density(const Body& body, int dimension) {
  return body.mass > 0 ? body.mass / volume(body, dimension) : body.density;
}
double mass(const Body& body, int dimension) {
  return body.mass > 0 ? body.mass : body.density * volume(body, dimension);
}
Vec3d moments(const Body& body, int dimension) {
  if (body.moments) return *body.moments;
  const Vec3d s = body.size;
  const double m = mass(body, dimension);
  if (body.kind == Kind::box) return m / 3 * Vec3d{s.y * s.y + s.z * s.z, s.x * s.x + s.z * s.z, s.x * s.x + s.y * s.y};
  if (body.kind == Kind::capsule && dimension == 2) {  // a box and two half discs
    const double area = volume(body, 2), ends = pi * s.y * s.y;
    const double i =
        (area - ends) / 3 * (s.x * s.x + s.y * s.y) + ends * (0.5 * s.y * s.y + s.x * s.x + 8 / (3 * pi) * s.x * s.y);
    return {0, 0, m / area * i};
  }
  // Others that are no balls are not asked for.
  const double i = (dimension == 2 ? 0.5 : 0.4) * m * s.x * s.x;
  return {i, i, i};
}

int Stage::add(const Body& body) {
  engine_->add(body);
  bodies_.push_back(body);
  return int(bodies_.size()) - 1;
}
void Stage::join(const Joint& joint) {
  const auto local = [&](int body) {
    if (body < 0) return joint.at;
    const Body& b = bodies_[std::size_t(body)];
    return math::inverse_rotate(b.rotation, joint.at - b.position);
  };
  engine_->join(joint);
  joints_.push_back({joint.body_a, joint.body_b, local(joint.body_a), local(joint.body_b)});
}
void Stage::run(int steps) {
  for (int i = 0; i < steps; ++i) engine_->step();
}
double Stage::widest_gap() const {
  const auto place = [&](int body, Vec3d local) {
    if (body < 0) return local;
    const BodyMotion m = engine_->motion(body);
    return m.position + math::rotate(m.rotation, local);
  };
  double widest = 0;
  for (const Anchors& j : joints_)
    widest = std::fmax(widest, math::length(place(j.body_b, j.local_b) - place(j.body_a, j.local_a)));
  return widest;
}
double Stage::fastest() const {
  double most = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (!bodies_[i].fixed) most = std::fmax(most, math::length(engine_->motion(int(i)).velocity));
  return most;
}
int Stage::awake() const {
  int count = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) count += !bodies_[i].fixed && engine_->awake(int(i));
  return count;
}

RecipeOutcome run_recipe(MakeEngine make, const Recipe& recipe, const RecipeSettings& settings) {
  Stage stage(make, {recipe.dimension, {0, -double(recipe.gravity), 0}, recipe.sleep});
  for (const BodyRecipe& b : recipe.bodies) {
    Body body;
    body.kind = b.kind;
    body.fixed = b.fixed;
    body.size = {b.size[0], b.size[1], b.size[2]};
    body.position = {b.position[0], b.position[1], b.position[2]};
    body.rotation = {b.rotation[0], b.rotation[1], b.rotation[2], b.rotation[3]};
    body.density = recipe.density;
    body.friction = b.fixed ? recipe.ground_friction : recipe.friction;
    body.collides = b.collides;
    stage.add(body);
  }
  for (const JointRecipe& j : recipe.joints) {
    const Body& a = stage.bodies()[std::size_t(j.body_a)];
    const Vec3d anchor{j.anchor_a[0], j.anchor_a[1], j.anchor_a[2]};
    stage.join({false, j.body_a, j.body_b, a.position + math::rotate(a.rotation, anchor)});
  }
  RecipeOutcome outcome;
  const int steps = settings.steps > 0 ? settings.steps : recipe.steps;
  for (int i = 0; i < steps; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    stage.step();
    outcome.step_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  double sum = 0;
  int moving = 0;
  for (std::size_t i = 0; i < stage.bodies().size(); ++i) {
    if (stage.bodies()[i].fixed) continue;
    const BodyMotion m = stage.motion(int(i));
    ++moving;
    sum += math::dot(m.velocity, m.velocity);
    outcome.worst_drift = std::fmax(outcome.worst_drift, math::length(m.position - stage.bodies()[i].position));
    outcome.escaped += math::length(m.position) > 200;
  }
  outcome.rms_speed = std::sqrt(sum / std::fmax(1, moving));
  outcome.worst_speed = stage.fastest();
  outcome.worst_penetration = stage.engine().deepest_overlap();
  outcome.worst_joint_gap = stage.widest_gap();
  return outcome;
}

}  // namespace carom::bench
