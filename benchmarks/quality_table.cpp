// What the scenes measured, as Markdown and JSON.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "benchmarks/quality.h"

namespace carom::bench {

double Figure::error() const { return std::abs(value - truth); }

std::vector<QualityScene> quality_scenes() {
  std::vector<QualityScene> all;
  for (const auto& part : {standing_scenes(), sliding_scenes(), moving_scenes(), striking_scenes()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

Stage Measurement::stage(Vec3d gravity, bool sleep) const {
  return Stage(engine_.make, {dimension_, gravity, sleep, engine_.effort});
}
void Measurement::tell(std::string scene, std::string what, std::string unit, double truth, double bar, double value) {
  figures_.push_back({std::move(scene), std::move(what), std::move(unit), truth, bar, value});
}

Body fixed_box(Vec3d position, Vec3d half, double friction) {
  Body body;
  body.fixed = true;
  body.position = position;
  body.size = half;
  body.friction = friction;
  return body;
}
Body ground(double friction, double restitution) {
  Body body = fixed_box({0, -1, 0}, {200, 1, 200}, friction);
  body.restitution = restitution;
  return body;
}
Body cube_at(Vec3d position, double half, double density, double friction) {
  Body body;
  body.size = {half, half, half};
  body.position = position;
  body.density = density;
  body.friction = friction;
  return body;
}
Body ball_at(Vec3d position, double radius, double friction, double restitution) {
  Body body;
  body.kind = Kind::sphere;
  body.size = {radius, radius, radius};
  body.position = position;
  body.friction = friction;
  body.restitution = restitution;
  return body;
}

std::vector<Figure> QualityTable::rows() const {
  std::vector<Figure> all;
  for (const auto& column : figures)
    for (const Figure& f : column) {
      bool there = false;
      for (const Figure& row : all) there = there || row.what == f.what;
      if (!there) all.push_back(f);
    }
  return all;
}
const Figure* QualityTable::find(std::size_t engine, const Figure& row) const {
  for (const Figure& f : figures[engine])
    if (f.what == row.what) return &f;
  return nullptr;
}

namespace {

std::string text(double value) {
  char buffer[32];
  const double size = std::abs(value);
  if (!std::isfinite(value)) return "no number";
  if (value == 0) return "0";
  std::snprintf(buffer, sizeof buffer, size < 1e-3 || size >= 1e5 ? "%.1e" : "%.4g", value);
  return buffer;
}
std::string with_unit(double value, const std::string& unit) {
  return text(value) + (unit.empty() || value == 0 ? "" : " " + unit);
}

}  // namespace

std::string markdown(const QualityTable& table) {
  std::string head = "| # | scene | truth | bar |", rule = "|---|---|---|---|";
  for (const Contender& engine : table.engines) {
    head += " " + engine.name + " |";
    rule += "---|";
  }
  std::string out = head + "\n" + rule + "\n";
  for (const Figure& row : table.rows()) {
    out += "| " + row.scene + " | " + row.what + " | " + with_unit(row.truth, row.unit) + " | " +
           (row.bar > 0 ? "± " + with_unit(row.bar, row.unit) : "–") + " |";
    for (std::size_t i = 0; i < table.engines.size(); ++i) {
      const Figure* f = table.find(i, row);
      out += " " + (f == nullptr ? "–" : with_unit(f->value, f->unit)) + " |";
    }
    out += "\n";
  }
  return out;
}

std::string json(const std::vector<QualityTable>& tables) {
  nlohmann::json rows = nlohmann::json::array();
  for (const QualityTable& table : tables)
    for (std::size_t i = 0; i < table.engines.size(); ++i)
      for (const Figure& f : table.figures[i])
        rows.push_back({{"dimension", table.dimension},
                        {"engine", table.engines[i].name},
                        {"version", table.engines[i].version},
                        {"scene", f.scene},
                        {"what", f.what},
                        {"unit", f.unit},
                        {"truth", f.truth},
                        {"bar", f.bar},
                        {"value", f.value}});
  return rows.dump(1) + "\n";
}

}  // namespace carom::bench
