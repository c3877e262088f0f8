// The house keeps its floors: a room includes only rooms of lower floors (docs/architecture.md), and no simulation
// path calls what would make its bits depend on the machine.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace carom::test {
namespace {

const std::map<std::string, int>& floors() {
  static const std::map<std::string, int> table = {
      {"math", 0},  {"core", 1},      {"ode", 1},      {"geometry", 2}, {"environment", 3}, {"forces", 3},
      {"rigid", 4}, {"particles", 5}, {"vehicles", 6}, {"sports", 6},   {"ballistics", 6},  {"blast", 6},
      {"sound", 6}, {"devices", 6},   {"display", 6},  {"scene", 7}};
  return table;
}

struct Source {
  std::string room;
  std::string path;
  std::vector<std::string> lines;
};

std::vector<Source> library_sources() {
  std::vector<Source> sources;
  const std::filesystem::path root = std::filesystem::path(CAROM_SOURCE_DIR) / "carom";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cpp" && extension != ".inl") continue;
    const auto relative = std::filesystem::relative(entry.path(), root);
    if (relative.begin() == --relative.end()) continue;  // carom.h and export.h stand outside every room
    Source source{relative.begin()->string(), relative.string(), {}};
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) source.lines.push_back(line);
    sources.push_back(std::move(source));
  }
  return sources;
}

TEST(House, RoomsIncludeOnlyLowerFloors) {
  const std::regex include(R"(^\s*#\s*include\s*"carom/([a-z_0-9]+)/)");
  int includes = 0;
  for (const Source& source : library_sources()) {
    ASSERT_TRUE(floors().contains(source.room)) << "carom/" << source.path << " is in a room without a floor";
    const int floor = floors().at(source.room);
    for (std::size_t i = 0; i < source.lines.size(); ++i) {
      std::smatch match;
      if (!std::regex_search(source.lines[i], match, include)) continue;
      const std::string target = match[1];
      ++includes;
      ASSERT_TRUE(floors().contains(target)) << "carom/" << source.path << ":" << i + 1 << " includes " << target;
      EXPECT_TRUE(target == source.room || floors().at(target) < floor)
          << "carom/" << source.path << ":" << i + 1 << ": room " << source.room << " (floor " << floor
          << ") includes room " << target << " (floor " << floors().at(target) << ")";
    }
  }
  EXPECT_GT(includes, 50);
}

TEST(House, SimulationCodeCallsNoMathOfTheMachine) {
  const std::regex forbidden(
      R"(std::(sin|cos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|log10|pow|cbrt|hypot|sinh|cosh|tanh|fma|nth_element|shuffle|random_device|mt19937|unordered_map|unordered_set)\b)");
  for (const Source& source : library_sources())
    for (std::size_t i = 0; i < source.lines.size(); ++i) {
      const std::string code = source.lines[i].substr(0, source.lines[i].find("//"));
      EXPECT_FALSE(std::regex_search(code, forbidden)) << "carom/" << source.path << ":" << i + 1 << ": " << code;
    }
}

}  // namespace
}  // namespace carom::test
