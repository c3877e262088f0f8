// What the recipes and the scenes of quality ask of an engine: the few things that Carom and its peers can all do, so
// that each builds exactly the same bodies in the same order. One file an engine: *_engine.cpp.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/recipe.h"
#include "carom/math/quat.h"

namespace carom::bench {

using math::Quatd;
using math::Vec3d;

/// In the plane z, and turns about other axes, are not looked at. A pair's friction is √(ab), its restitution the
/// greater, whatever the engine's own rule.
struct Body {
  Kind kind = Kind::box;
  bool fixed = false;
  Vec3d size{0.5, 0.5, 0.5};  ///< as in BodyRecipe
  Vec3d position{};
  Quatd rotation{};
  Vec3d velocity{}, spin{};      ///< m/s, rad/s in world axes
  double density = 1000;         ///< kg/m³ (kg/m²)
  double mass = 0;               ///< kg; 0: by the density
  std::optional<Vec3d> moments;  ///< kg m² about the body's axes, in place of the shape's
  double friction = 0.6, restitution = 0;
  bool collides = true;
  /// What engines ask their users to switch on for such bodies, where they have it:
  bool bullet = false;  ///< continuous collision
  bool spins = false;   ///< gyroscopic torque, and no limit to the speed of turning
  bool slides = false;  ///< care about edges between shapes that lie flush
};
double volume(const Body& body, int dimension);  ///< m³ (m²)
/// The body's density, or that which gives its mass.
double density(const Body& body, int dimension);
double mass(const Body& body, int dimension);
Vec3d moments(const Body& body, int dimension);

struct Joint {
  bool weld = false;  ///< else a ball joint (2D: a hinge)
  int body_a = -1;    ///< −1: the world
  int body_b = 0;
  Vec3d at{};  ///< in the world
};
struct BodyMotion {
  Vec3d position{};
  Quatd rotation{};
  Vec3d velocity{}, spin{};
};
struct Setting {
  int dimension = 3;
  Vec3d gravity{0, -9.81, 0};
  bool sleep = true;
  int effort = 0;  ///< substeps, collision steps or iterations of a step; 0: the engine's default
};

class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;
  /// Bodies count from 0 in the order in which they are added.
  virtual void add(const Body& body) = 0;
  virtual void join(const Joint& joint) = 0;
  virtual void step() = 0;  ///< 1/60 s
  virtual BodyMotion motion(int body) const = 0;
  virtual void set_velocity(int body, Vec3d velocity, Vec3d spin) = 0;
  virtual bool awake(int body) const = 0;
  /// m, at contacts; 0 where the engine does not tell.
  virtual double deepest_overlap() const { return 0; }
};
using MakeEngine = std::unique_ptr<Engine> (*)(const Setting&);
std::unique_ptr<Engine> make_carom(const Setting&);
std::unique_ptr<Engine> make_bullet(const Setting&);
std::unique_ptr<Engine> make_box2d_2(const Setting&);
std::unique_ptr<Engine> make_box2d_3(const Setting&);
std::unique_ptr<Engine> make_box3d(const Setting&);
std::unique_ptr<Engine> make_jolt(const Setting&);
/// As the libraries tell it.
std::string bullet_version();
std::string box2d_2_version();
std::string box2d_3_version();
std::string box3d_version();
std::string jolt_version();

/// An engine with what was put into it, and how well its joints hold.
class Stage {
 public:
  Stage(MakeEngine make, const Setting& setting) : setting_(setting), engine_(make(setting)) {}
  int add(const Body& body);
  void join(const Joint& joint);
  void step() { engine_->step(); }
  void run(int steps);
  Engine& engine() { return *engine_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  BodyMotion motion(int body) const { return engine_->motion(body); }
  double widest_gap() const;  ///< m, of all joints now
  double fastest() const;     ///< m/s, of all bodies that move
  int awake() const;          ///< bodies

 private:
  struct Anchors {
    int body_a, body_b;
    Vec3d local_a, local_b;
  };
  Setting setting_;
  std::unique_ptr<Engine> engine_;
  std::vector<Body> bodies_;
  std::vector<Anchors> joints_;
};

/// A recipe in an engine at its defaults; the settings' threads and width are not looked at.
RecipeOutcome run_recipe(MakeEngine make, const Recipe& recipe, const RecipeSettings& settings);

}  // namespace carom::bench
