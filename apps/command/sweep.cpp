// `carom sweep`: a scene over ranges of its parameters, as cases that are written one by one, so that a run that was
// killed goes on where it was and many machines can share one sweep.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/command/canvas.h"
#include "apps/command/chart.h"
#include "apps/command/command.h"
#include "apps/command/report.h"
#include "apps/command/sweep_report.h"
#include "apps/host/simulation.h"

namespace carom::command {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t most_cases = 1'000'000;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out{""};
  for (const char c : text)
    if (c == at)
      out.emplace_back();
    else
      out.back().push_back(c);
  return out;
}

/// "name=from:to:count" evenly spaced, both ends included, or "name=a,b,c"; numbers with their units.
core::Result<Varied> parse_varied(const host::Declaration& d, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return core::Error{"--vary " + text + ": expected name=from:to:count or name=a,b,c"};
  const std::string name = text.substr(0, equals), range = text.substr(equals + 1);
  Varied out;
  const auto one = [&](const std::string& value) -> core::Result<double> {
    const core::Result<std::vector<double>> all = parse_settings(d, {name + "=" + value});
    if (!all.ok()) return core::Error{"--vary " + text + ": " + all.error().message};
    for (std::size_t i = 0; i < d.parameters.size(); ++i)
      if (d.parameters[i].name == name) out.parameter = i;
    return (*all)[out.parameter];
  };
  if (const std::vector<std::string> ends = split(range, ':'); ends.size() == 3) {
    const core::Result<double> from = one(ends[0]), to = one(ends[1]);
    if (!from.ok()) return from.error();
    if (!to.ok()) return to.error();
    char* rest = nullptr;
    const long count = std::strtol(ends[2].c_str(), &rest, 10);
    if (*rest != 0 || count < 2 || count > long(most_cases))
      return core::Error{"--vary " + text + ": found \"" + ends[2] + "\" values, expected 2 to 1000000"};
    for (long i = 0; i < count; ++i) out.values.push_back(*from + (*to - *from) * double(i) / double(count - 1));
    return out;
  }
  for (const std::string& value : split(range, ',')) {
    const core::Result<double> number = one(value);
    if (!number.ok()) return number.error();
    out.values.push_back(*number);
  }
  return out;
}

class Sweep {
 public:
  Sweep(const SweepOptions& options, host::Declaration declaration, std::vector<double> base,
        std::vector<Varied> varied)
      : options_(options), d_(std::move(declaration)), base_(std::move(base)), varied_(std::move(varied)) {
    for (const Varied& v : varied_) count_ *= v.values.size();
    done_.resize(count_);
    const double duration = options.duration > 0 ? options.duration : d_.duration;
    steps_ = options.steps > 0 ? options.steps : (long long)(std::ceil(duration / d_.dt - 1e-9));
    // What a line of an earlier run must agree with to count.
    key_ = Json({{"scene", d_.id}, {"dt", d_.dt}, {"steps", steps_}, {"base", base_}});
    for (const Varied& v : varied_) key_["varied"].push_back({{"name", name(v)}, {"values", v.values}});
  }

  int run() {
    std::error_code error;
    fs::create_directories(options_.out, error);
    if (error) return fail(exit_system, options_.out + ": cannot make the folder: " + error.message());
    if (const core::Status status = check_key(); !status.ok()) return fail(exit_input, status.error().message);
    read_all();
    const std::size_t before = finished();
    if (const int code = compute(); code != exit_ok) return code;
    read_all();
    const std::size_t now = finished();
    if (!options_.quiet) std::fprintf(stderr, "%zu of %zu cases (%zu of them from before)\n", now, count_, before);
    if (now < count_) return interrupted ? exit_interrupted : exit_ok;  // the other shards have the rest
    return merge();
  }

 private:
  const std::string& name(const Varied& v) const { return d_.parameters[v.parameter].name; }
  std::string path(const std::string& file) const { return (fs::path(options_.out) / file).string(); }

  std::vector<double> values_of(std::size_t index) const {
    std::vector<double> values = base_;
    for (std::size_t k = varied_.size(); k-- > 0;) {
      values[varied_[k].parameter] = varied_[k].values[index % varied_[k].values.size()];
      index /= varied_[k].values.size();
    }
    return values;
  }

  /// A folder belongs to one sweep.
  core::Status check_key() {
    const std::string file = path("sweep.json");
    if (std::ifstream in(file); in) {
      const Json found = Json::parse(in, nullptr, false);
      if (found == key_) return {};
      return core::Error{file + ": this folder holds another sweep; choose another --out, or remove it"};
    }
    return write_file(file, key_.dump(1) + "\n");
  }

  /// Lines of all shards. A line that was cut off when a run was killed does not count.
  void read_all() {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(options_.out, error)) {
      if (entry.path().extension() != ".jsonl") continue;
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        Json row = Json::parse(line, nullptr, false);
        if (!row.is_object() || !row.contains("case") || !row["case"].is_number_unsigned()) continue;
        const std::size_t index = row["case"];
        if (index < count_) done_[index] = std::move(row);
      }
    }
  }
  std::size_t finished() const {
    return std::size_t(std::count_if(done_.begin(), done_.end(), [](const Json& row) { return row.is_object(); }));
  }

  int compute() {
    std::vector<std::size_t> todo;
    for (std::size_t i = std::size_t(options_.shard); i < count_; i += std::size_t(options_.shards))
      if (!done_[i].is_object()) todo.push_back(i);
    const std::string file =
        path("cases-" + std::to_string(options_.shard) + "-of-" + std::to_string(options_.shards) + ".jsonl");
    const int out = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND, 0644);
    if (out < 0) return fail(exit_system, file + ": cannot be written");
    // After a line that was cut off, a new one begins.
    if (const off_t size = ::lseek(out, 0, SEEK_END); size > 0) {
      char last = 0;
      if (::pread(out, &last, 1, size - 1) != 1 || last != '\n') (void)!::write(out, "\n", 1);
    }
    Progress progress("sweep of " + d_.title, !options_.quiet);
    std::mutex mutex;
    std::size_t next = 0, ready = 0;
    std::string trouble;
    const auto work = [&] {
      for (;;) {
        std::size_t index = 0;
        {
          const std::lock_guard lock(mutex);
          if (interrupted || next >= todo.size() || !trouble.empty()) return;
          index = todo[next++];
        }
        const std::string line = simulate(index).dump() + "\n";
        const std::lock_guard lock(mutex);
        // One write a line: what is in the file is whole.
        if (::write(out, line.data(), line.size()) != ssize_t(line.size())) trouble = file + ": cannot be written";
        progress.update(double(++ready) / double(todo.size()));
      }
    };
    std::vector<std::thread> workers;
    for (int i = 1; i < options_.threads; ++i) workers.emplace_back(work);
    work();
    for (std::thread& worker : workers) worker.join();
    ::close(out);
    return trouble.empty() ? exit_ok : fail(exit_system, trouble);
  }

  Json simulate(std::size_t index) const {
    const std::vector<double> values = values_of(index);
    Json row{{"case", index}};
    for (const Varied& v : varied_) row[name(v)] = values[v.parameter];
    core::Result<std::unique_ptr<host::Demo>> demo = open_demo(options_.scene);
    if (!demo.ok()) return row["error"] = demo.error().message, row;
    host::Demo& opener = **demo;
    core::Result<std::unique_ptr<host::Simulation>> opened = opener.open(std::move(demo).value(), values, {});
    if (!opened.ok()) return row["error"] = opened.error().message, row;
    host::Simulation& simulation = **opened;
    struct Curve {
      double last = NAN, most = -INFINITY, least = INFINITY;
    };
    std::map<std::pair<int, int>, Curve> curves;
    for (long long i = 0; i < steps_; ++i) {
      if (const core::Status status = simulation.step(); !status.ok()) {
        row["error"] = status.error().message;
        break;
      }
      for (const host::Sample& s : simulation.base().state.samples) {
        Curve& curve = curves[{s.plot, s.series}];
        curve.last = s.y;
        curve.most = std::max(curve.most, s.y);
        curve.least = std::min(curve.least, s.y);
      }
      simulation.base().state.samples.clear();
    }
    for (const auto& [where, curve] : curves) {
      const host::Plot& plot = d_.plots[std::size_t(where.first)];
      const std::string label = plot.title + ": " + plot.series[std::size_t(where.second)].name;
      const std::string unit = plot.y.unit.empty() ? "" : " (" + plot.y.unit + ")";
      row[label + ", last" + unit] = curve.last;
      row[label + ", least" + unit] = curve.least;
      row[label + ", most" + unit] = curve.most;
    }
    const host::Budget budget = simulation.budget();
    row["kinetic energy (J)"] = budget.kinetic;
    row["potential energy (J)"] = budget.potential;
    row["message"] = simulation.base().state.message;
    row["state hash"] = hex(simulation.state_hash());
    return row;
  }

  static std::string field(const Json& value) {
    if (!value.is_string()) return value.dump();
    std::string out = "\"";
    for (const char c : value.get<std::string>()) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
  }

  int merge() {
    std::vector<std::string> columns;
    for (const Json& row : done_)
      for (const auto& [column, value] : row.items())
        if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    std::string csv;
    for (const std::string& column : columns) csv += (csv.empty() ? "" : ",") + field(column);
    csv += "\n";
    for (const Json& row : done_) {
      for (std::size_t i = 0; i < columns.size(); ++i)
        csv += (i ? "," : "") + (row.contains(columns[i]) ? field(row[columns[i]]) : std::string());
      csv += "\n";
    }
    Json table{{"sweep", key_}, {"cases", done_}};
    for (const auto& [file, text] : {std::pair{"table.csv", csv}, std::pair{"table.json", table.dump(1) + "\n"}})
      if (const core::Status status = write_file(path(file), text); !status.ok())
        return fail(exit_system, status.error().message);
    if (const core::Status status = report(columns); !status.ok()) return fail(exit_system, status.error().message);
    if (!options_.quiet)
      std::printf("%s\n%s\n%s\n", path("table.csv").c_str(), path("table.json").c_str(), path("report.html").c_str());
    return exit_ok;
  }

  /// Every number over the first parameter, a curve for each value of the second; the other parameters at their first.
  core::Status report(const std::vector<std::string>& columns) const {
    const Varied& across = varied_[0];
    const host::Parameter& p = d_.parameters[across.parameter];
    std::string page =
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>" + escaped(d_.title) +
        "</title><body style=\"font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em\"><h1>" +
        escaped(d_.title) + "</h1><p>" + std::to_string(count_) + " cases of " + std::to_string(steps_) + " steps of " +
        short_number(d_.dt * 1e3) + " ms. <a href=\"table.csv\">CSV</a> <a href=\"table.json\">JSON</a></p>" +
        sweep_settings(d_, varied_, values_of(0), done_);
    int number = 0;
    for (const std::string& column : columns) {
      const bool result = column != "case" && std::none_of(varied_.begin(), varied_.end(),
                                                           [&](const Varied& v) { return name(v) == column; });
      if (!result || !done_[0].contains(column) || !done_[0][column].is_number()) continue;
      Chart chart{column, d_.title, p.label + (p.unit.empty() ? "" : " (" + p.unit + ")"), column, {}};
      const std::size_t curves = varied_.size() > 1 ? varied_[1].values.size() : 1;
      std::size_t inner = 1;
      for (std::size_t k = 2; k < varied_.size(); ++k) inner *= varied_[k].values.size();
      for (std::size_t k = 0; k < std::min<std::size_t>(curves, 8); ++k) {
        ChartSeries series;
        series.name = column;
        if (varied_.size() > 1) {
          char text[64];
          std::snprintf(text, sizeof text, "%s = %.4g", name(varied_[1]).c_str(), varied_[1].values[k]);
          series.name = text;
        }
        for (std::size_t i = 0; i < across.values.size(); ++i) {
          const Json& row = done_[(i * curves + k) * inner];
          if (row.contains(column) && row[column].is_number()) series.data.push_back({across.values[i], row[column]});
        }
        chart.series.push_back(std::move(series));
      }
      const std::string file = "plot-" + std::to_string(++number);
      if (const core::Status status = write_chart(chart, path(file)); !status.ok()) return status;
      page += "<h2>" + escaped(column) + "</h2><img src=\"" + file + ".svg\" alt=\"" + escaped(column) +
              "\" width=\"100%\">";
    }
    return write_file(path("report.html"), page + sweep_table(columns, done_) + "</body></html>\n");
  }

  const SweepOptions& options_;
  host::Declaration d_;
  std::vector<double> base_;
  std::vector<Varied> varied_;
  std::size_t count_ = 1;
  long long steps_ = 0;
  Json key_;
  std::vector<Json> done_;
};

}  // namespace

int sweep(const SweepOptions& given) {
  SweepOptions options = given;
  core::Result<std::unique_ptr<host::Demo>> demo = open_demo(options.scene);
  if (!demo.ok()) return fail(exit_input, demo.error().message);
  const host::Declaration declaration = (*demo)->declaration();
  const core::Result<std::vector<double>> base = parse_settings(declaration, options.settings);
  if (!base.ok()) return fail(exit_usage, base.error().message);
  std::vector<Varied> varied;
  double cases = 1;
  for (const std::string& text : options.vary) {
    core::Result<Varied> one = parse_varied(declaration, text);
    if (!one.ok()) return fail(exit_usage, one.error().message);
    cases *= double(one->values.size());
    varied.push_back(std::move(one).value());
  }
  if (cases > double(most_cases)) return fail(exit_usage, "found more than 1000000 cases");
  if (options.shard < 0 || options.shard >= options.shards)
    return fail(exit_usage, "--shard: expected i/n with i from 0 to n − 1");
  if (options.out.empty()) options.out = "out/sweep-" + fs::path(declaration.id).filename().string();
  watch_for_interrupts();
  return Sweep(options, declaration, *base, std::move(varied)).run();
}

}  // namespace carom::command
