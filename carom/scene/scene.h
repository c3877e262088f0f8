// Scene files: a world, its parameters, plots and expectations as JSON with units (docs/scene-files.md).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/transform.h"
#include "carom/scene/scene_world.h"

namespace carom::scene {

namespace detail {
struct SceneDocument;
}

/// A number of the scene that a command line, a sweep or a slider may change.
struct Parameter {
  std::string name;          ///< as expressions and the command line write it
  std::string label;         ///< for people; the name where the file gives none
  std::string unit;          ///< SI unit of the numbers below, "" for a plain number
  std::string display_unit;  ///< the unit people see, such as "mph"
  std::string description;
  double minimum = 0, maximum = 0, step = 0, value = 0;  ///< SI
  double display_scale = 1;                              ///< one display unit in SI units
  bool live = false;                                     ///< may change while the scene runs (Scene::apply)
};
struct ParameterValue {
  std::string name;
  double value = 0;  ///< SI
};

/// Samples and points are in SI units; divide by display_scale to show them in display_unit.
struct Axis {
  std::string label, unit, display_unit;
  double display_scale = 1;
};
struct Series {
  std::string name;
  std::string style = "line";                     ///< "line" or "points"
  std::string expression;                         ///< a quantity of the world; empty for a fixed curve
  std::vector<std::pair<double, double>> points;  ///< of a fixed (analytic or published) curve
};
struct Plot {
  std::string title;
  Axis x, y;
  std::string x_expression = "time";
  double interval = 0;  ///< s between samples, 0: every step
  std::vector<Series> series;
};
struct Camera {
  math::Vec3d position{8, 6, 14};  ///< m
  math::Vec3d target{};
  double field_of_view = 0.8;  ///< rad, space
  double height = 20;          ///< m from the bottom to the top of the picture, plane
  double width = 0;            ///< m from left to right that must be seen too, plane
  std::string follow;          ///< name of a body, or empty
};
/// A number that the run must reach: what `carom run` checks and reports.
struct Expectation {
  double time = 0;  ///< s; negative: at the end of the run
  std::string quantity;
  std::string unit, display_unit;
  double display_scale = 1;
  double expected = 0, tolerance = 0;  ///< SI; passes where |found − expected| ≤ tolerance
  std::string source;
};

struct InstantiateOptions {
  int threads = 1;
  core::TaskScheduler* scheduler = nullptr;  ///< as in rigid::WorldDef
  core::Profiler* profiler = nullptr;        ///< likewise
};

/// A file that a scene was read from.
struct SourceFile {
  std::string name;  ///< as the scene names it
  std::string bytes;
};

/// A checked scene file. Copies share the document.
class CAROM_API Scene {
 public:
  std::string file;  ///< as errors name it
  std::string name, description;
  Kind kind = Kind::rigid;
  int dimension = 3;
  double step = 1.0 / 60;        ///< s
  double duration = 10;          ///< s
  bool loop = false;             ///< the playground starts it anew after its duration
  std::optional<double> ground;  ///< m: height of a ground plane that pictures draw
  Camera camera;
  std::vector<Parameter> parameters;
  std::vector<Plot> plots;
  std::vector<Expectation> expectations;  ///< for the default values of the parameters

  /// "speed=30 mph": a parameter of this scene, its dimension and its range checked.
  Result<ParameterValue> parse_parameter(std::string_view text) const;
  /// A new world with these values in place of the defaults.
  Result<SceneWorld> instantiate(std::span<const ParameterValue> values = {},
                                 const InstantiateOptions& options = {}) const;
  /// The expectations with these values in place of the defaults: expected numbers may be expressions of parameters.
  Result<std::vector<Expectation>> expectations_for(const SceneWorld& world,
                                                    std::span<const ParameterValue> values) const;
  /// Puts what a running world can change to the given values: gravity, effectors, joint motors, limits and springs,
  /// materials, damping. Bodies stay where they are.
  Status apply(SceneWorld& world, std::span<const ParameterValue> values) const;

  /// The scene file and all that it includes or names: with these alone it is read again.
  std::span<const SourceFile> sources() const;

  std::shared_ptr<const detail::SceneDocument> document;
};

/// Gives the text of a file that a scene names: path relative to the scene's root folder, never with "..".
using Resolver = std::function<Result<std::string>(std::string_view path)>;

struct LoadOptions {
  std::string root;     ///< no include or mesh may lie outside it; empty: the scene file's own folder
  std::string presets;  ///< folder of presets; empty: "presets" beside the scene's folder, or in the working folder
  int maximum_objects = 200000;  ///< bodies, shapes, joints and effectors that a scene may make
};
/// Reads and checks a scene file. Errors name file, line, JSON path, what was found and what was expected.
CAROM_API Result<Scene> load_scene(const std::string& path, const LoadOptions& options = {});
/// The same from memory. Includes, presets ("presets/ball/golf.json") and meshes are asked of `resolver`.
CAROM_API Result<Scene> parse_scene(std::string_view text, std::string_view name, const Resolver& resolver = {},
                                    const LoadOptions& options = {});

/// The JSON Schema of scene files, generated from the tables that the loader reads with.
CAROM_API std::string scene_schema();

}  // namespace carom::scene
