// What a demo says about itself, once: the page's sliders, plots and keys, the command line and the sweep all read it.
// SI units everywhere; `display_unit` is what a person sees.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "carom/math/vec.h"

namespace carom::host {

using math::Vec2d;
using math::Vec3d;
using math::Vec3f;

struct Parameter {
  std::string name;  ///< identifier, as `--set name=value` takes it
  std::string label;
  std::string unit;          ///< of the SI value
  std::string display_unit;  ///< empty: the same
  std::string description;
  double minimum = 0, maximum = 1;
  double step = 0;  ///< 0: continuous
  double value = 0;
  bool live = false;                   ///< acts at once; the others restart the demo
  std::vector<std::string> choices{};  ///< names of minimum, minimum + 1, … to maximum; empty: any number between
};
/// One of several that have names: the values 0, 1, …
inline Parameter choice(std::string name, std::string label, std::string description, std::vector<std::string> choices,
                        double value = 0, bool live = false) {
  const double last = double(choices.size()) - 1;
  return {std::move(name),   std::move(label), "", "", std::move(description), 0, last, 1, value, live,
          std::move(choices)};
}
/// Yes (1) or no (0).
inline Parameter yes_or_no(std::string name, std::string label, std::string description, bool value,
                           bool live = false) {
  return choice(std::move(name), std::move(label), std::move(description), {"no", "yes"}, value ? 1 : 0, live);
}

struct Axis {
  std::string label, unit;
};

struct Series {
  enum class Style { line, points };
  std::string name;
  Style style = Style::line;
  std::vector<Vec2d> points{};  ///< a fixed curve (analytic or published); empty: fed while the demo runs
  std::uint32_t color = 0;      ///< 0xRRGGBB, 0: the viewer's choice
  bool latest = false;          ///< a sample replaces the one at the same x: a histogram that fills
};

struct Plot {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
};

struct Camera {
  Vec3d position{0, 4, 12}, target{};
  double field_of_view = 0.75;  ///< rad, vertical (3D)
  double height = 10;           ///< m from bottom to top (2D)
  double width = 0;             ///< m from left to right, through the target, that narrow pictures must show too
  int follow = -1;              ///< the id of a body, or −1
};

struct Input {
  std::string action, label;
  std::vector<std::string> keys;  ///< KeyboardEvent.code
  bool press = false;             ///< once a press, or as long as held
  double value = 1;
};

struct Declaration {
  std::string id, title, summary, group, chapter;
  int dimension = 3;
  std::string text;  ///< paragraphs apart by an empty line; a paragraph indented by two spaces is a formula
  double dt = 1.0 / 60;
  double duration = 10;  ///< s, what `carom run` simulates unless told otherwise
  bool loop = false;     ///< a page starts it anew after its duration
  Camera camera;
  std::optional<double> ground;  ///< m, height of a floor to draw
  std::vector<Parameter> parameters;
  std::vector<Plot> plots;
  std::vector<Input> inputs;
};

/// A number that must come out, and where it is published.
struct Expectation {
  std::string name, unit, source;
  double found = 0, expected = 0, tolerance = 0;  ///< absolute
  bool passed() const {
    const double error = found - expected;
    return math::is_finite(found) && (error < 0 ? -error : error) <= tolerance;
  }
};

struct Sample {
  int plot = 0, series = 0;
  double x = 0, y = 0;
};

struct Line {
  Vec3d a, b;
  std::uint32_t rgba = 0xffffffff;
};

/// Many small balls: of particles, of a fluid. All arrays of one length.
struct Points {
  std::vector<Vec3f> positions;  ///< m, in the world
  std::vector<float> radii;      ///< m
  std::vector<std::uint32_t> rgbas;
  void clear() { positions.clear(), radii.clear(), rgbas.clear(); }
};

/// Triangles whose corners move: cloth, a soft body, water.
struct Surface {
  std::vector<Vec3f> corners;            ///< m, in the world
  std::vector<std::uint32_t> triangles;  ///< three corners each
  std::uint32_t rgba = 0xffffffff;
  std::uint32_t topology = 0;  ///< counts how often `triangles` changed
};

}  // namespace carom::host
