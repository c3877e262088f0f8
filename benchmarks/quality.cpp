// bench_quality: the scenes of docs/quality.md in Carom and in the peers found at build time, one after the other.
//   bench_quality [--only SCENE] [--engine NAME] [--dimension 2|3] [--json FILE] [--plot FILE] [--table FILE]
//     [--commits TEXT]
// --table writes the tables into a Markdown file between <!-- peers --> and <!-- end of peers -->; else they are
// printed; --commits says of which states the peers' sources are. --plot writes FILE for space; the plane's goes beside
// it as FILE with 2d before its extension.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>

#include "benchmarks/quality.h"

using namespace carom::bench;

namespace carom::bench {

std::vector<Contender> contenders(int dimension) {
  std::vector<Contender> all{{"Carom", make_carom, 0, ""}};
  if (dimension == 2) {
#ifdef CAROM_WITH_BOX2D_3
    all.push_back({"Box2D 3", make_box2d_3, 0, box2d_3_version()});
#endif
#ifdef CAROM_WITH_BOX2D
    all.push_back({"Box2D 2.4", make_box2d_2, 0, box2d_2_version()});
#endif
    return all;
  }
#ifdef CAROM_WITH_BOX3D
  all.push_back({"Box3D", make_box3d, 0, box3d_version()});
  all.push_back({"Box3D, 8 substeps", make_box3d, 8, box3d_version()});
#endif
#ifdef CAROM_WITH_JOLT
  all.push_back({"Jolt", make_jolt, 0, jolt_version()});
  all.push_back({"Jolt, 4 steps", make_jolt, 4, jolt_version()});
#endif
#ifdef CAROM_WITH_BULLET
  all.push_back({"Bullet", make_bullet, 0, bullet_version()});
#endif
  return all;
}

}  // namespace carom::bench

namespace {

struct Options {
  std::string only, engine, json, plot, table, commits;
  int dimension = 0;
};

Options read_options(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0; };
    std::string* value = is("--only")      ? &o.only
                         : is("--engine")  ? &o.engine
                         : is("--json")    ? &o.json
                         : is("--plot")    ? &o.plot
                         : is("--table")   ? &o.table
                         : is("--commits") ? &o.commits
                                           : nullptr;
    if ((value == nullptr && !is("--dimension")) || i + 1 == argc) {
      std::fprintf(
          stderr,
          "bench_quality: what is '%s'? Known: --only, --engine, --dimension, --json, --plot, --table, --commits, "
          "each with a value\n",
          argv[i]);
      std::exit(2);
    }
    if (value != nullptr)
      *value = argv[++i];
    else
      o.dimension = std::atoi(argv[++i]);
  }
  return o;
}

QualityTable measure(int dimension, const Options& options) {
  QualityTable table{dimension, {}, {}};
  for (const Contender& engine : contenders(dimension)) {
    if (engine.name.find(options.engine) == std::string::npos) continue;
    Measurement measurement(engine, dimension);
    for (const QualityScene& scene : quality_scenes()) {
      if (scene.space_only && dimension == 2) continue;
      if (std::string(scene.name).find(options.only) == std::string::npos) continue;
      std::fprintf(stderr, "%s %dD: %s\n", engine.name.c_str(), dimension, scene.name);
      scene.measure(measurement);
    }
    table.engines.push_back(engine);
    table.figures.push_back(measurement.figures());
  }
  return table;
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  return "unknown processor";
}
/// When, where and with what the tables were measured.
std::string circumstances(const std::vector<QualityTable>& tables, const std::string& commits) {
  char day[16];
  const std::time_t now = std::time(nullptr);
  std::strftime(day, sizeof day, "%Y-%m-%d", std::gmtime(&now));
  std::string versions, last;
  for (const QualityTable& table : tables)
    for (const Contender& engine : table.engines) {
      const std::string name = engine.name.substr(0, engine.name.find(',')) + " (" + engine.version + ")";
      if (engine.version.empty() || name == last) continue;
      versions += (versions.empty() ? "" : ", ") + name;
      last = name;
    }
  return std::string(day) + ", one run on one thread, " + processor() + ". " + versions +
         (commits.empty() ? "" : "; " + commits) + ".\n\n";
}

bool write(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (out.flush()) return true;
  std::fprintf(stderr, "%s: cannot write\n", file.c_str());
  return false;
}
bool write_between(const std::string& file, const std::string& text) {
  static const std::string begin = "<!-- peers -->", end = "<!-- end of peers -->";
  std::stringstream content;
  content << std::ifstream(file).rdbuf();
  std::string document = content.str();
  const std::size_t from = document.find(begin), to = document.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) {
    std::fprintf(stderr, "%s: no lines %s, %s\n", file.c_str(), begin.c_str(), end.c_str());
    return false;
  }
  document.replace(from + begin.size(), to - from - begin.size(), "\n" + text);
  return write(file, document);
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  std::vector<QualityTable> tables;
  std::string text;
  bool written = true;
  for (const int dimension : {3, 2}) {
    if (options.dimension != 0 && options.dimension != dimension) continue;
    tables.push_back(measure(dimension, options));
    text += (text.empty() ? "" : "\n") + markdown(tables.back());
    if (options.plot.empty()) continue;
    std::string file = options.plot;
    if (dimension == 2) file.insert(std::min(file.rfind('.'), file.size()), "2d");
    written = write(file, svg(tables.back())) && written;
  }
  if (!options.json.empty()) written = write(options.json, json(tables)) && written;
  text = circumstances(tables, options.commits) + text;
  if (!options.table.empty())
    written = write_between(options.table, text) && written;
  else
    std::printf("%s", text.c_str());
  return written ? 0 : 1;
}
