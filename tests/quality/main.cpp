// test_quality: the gates as tests. With --table FILE the measured values also go into the Markdown file, between the
// lines <!-- gates --> and <!-- end of gates --> (docs/quality.md), from the same run.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

#include "tests/quality/gate.h"

namespace {

bool replace_between(std::string& document, const std::string& begin, const std::string& end, const std::string& text) {
  const std::size_t from = document.find(begin), to = document.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) return false;
  document.replace(from + begin.size(), to - from - begin.size(), "\n" + text);
  return true;
}

int write_table(const char* file) {
  std::ifstream in(file);
  std::stringstream content;
  content << in.rdbuf();
  std::string document = content.str();
  if (!in || !replace_between(document, "<!-- gates -->", "<!-- end of gates -->", carom::quality::gate_table())) {
    std::fprintf(stderr, "%s: no lines <!-- gates -->, <!-- end of gates -->\n", file);
    return 1;
  }
  std::ofstream(file) << document;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const char* table = argc == 3 && std::strcmp(argv[1], "--table") == 0 ? argv[2] : nullptr;
  if (argc > 1 && table == nullptr) {
    std::fprintf(stderr, "test_quality: unknown argument '%s'; known: --table FILE\n", argv[1]);
    return 2;
  }
  const int failed = RUN_ALL_TESTS();
  if (table != nullptr) {
    if (std::strcmp(table, "-") == 0)
      std::printf("%s", carom::quality::gate_table().c_str());
    else if (write_table(table) != 0)
      return 1;
  }
  return failed;
}
