// The scenes of docs/quality.md that any engine can do, as programs on an engine-neutral stage: each measures figures
// beside what mechanics says. The same for Carom and for its peers; tests/quality holds Carom alone to its bars.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/engine.h"

namespace carom::bench {

/// One row of the table.
struct Figure {
  std::string scene;  ///< of docs/quality.md: a gate's number, or the letter of a scene of its second table
  std::string what, unit;
  double truth = 0;
  double bar = 0;  ///< error that the gate allows, in the unit; 0: a count without a bar
  double value = 0;
  double error() const;  ///< in the unit
};

/// An engine in one of its settings, as the table names it.
struct Contender {
  std::string name;
  MakeEngine make = nullptr;
  int effort = 0;
  std::string version;
};
std::vector<Contender> contenders(int dimension);

/// One engine's figures, as the scenes find them.
class Measurement {
 public:
  Measurement(const Contender& engine, int dimension) : engine_(engine), dimension_(dimension) {}
  bool plane() const { return dimension_ == 2; }
  int dimension() const { return dimension_; }
  Stage stage(Vec3d gravity = {0, -9.81, 0}, bool sleep = true) const;
  void tell(std::string scene, std::string what, std::string unit, double truth, double bar, double value);
  const std::vector<Figure>& figures() const { return figures_; }

 private:
  const Contender& engine_;
  int dimension_;
  std::vector<Figure> figures_;
};
struct QualityScene {
  const char* name;
  void (*measure)(Measurement&);
  bool space_only = false;
};
std::vector<QualityScene> quality_scenes();
std::vector<QualityScene> standing_scenes();  ///< the parts of that list: quality_standing.cpp, …
std::vector<QualityScene> sliding_scenes();
std::vector<QualityScene> moving_scenes();
std::vector<QualityScene> striking_scenes();

// What several scenes are built of.
inline constexpr double standard_g = 9.81;
Body ground(double friction = 0.6, double restitution = 0);
Body cube_at(Vec3d position, double half = 0.5, double density = 1000, double friction = 0.6);
Body ball_at(Vec3d position, double radius, double friction = 0.6, double restitution = 0);
Body fixed_box(Vec3d position, Vec3d half, double friction = 0.6);

/// Rows by engines, the columns.
struct QualityTable {
  int dimension = 3;
  std::vector<Contender> engines;
  std::vector<std::vector<Figure>> figures;  ///< by engine
  std::vector<Figure> rows() const;          ///< without values, in the order of the scenes
  const Figure* find(std::size_t engine, const Figure& row) const;
};
std::string markdown(const QualityTable& table);
std::string json(const std::vector<QualityTable>& tables);
/// Errors over the bars of their gates on a logarithmic axis, a row a figure, a mark an engine.
std::string svg(const QualityTable& table);

}  // namespace carom::bench
