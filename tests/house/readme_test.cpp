// The README's first program is the one that is compiled and run.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace carom::test {
namespace {

std::string contents(const std::string& file) {
  std::ifstream stream(std::string(CAROM_SOURCE_DIR) + "/" + file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(House, ReadmeShowsTheHelloWorldThatIsCompiled) {
  const std::string readme = contents("README.md"), program = contents("examples/hello_world.cpp");
  ASSERT_FALSE(program.empty());
  EXPECT_NE(readme.find("```cpp\n" + program + "```"), std::string::npos)
      << "README.md does not hold examples/hello_world.cpp word for word";
}

TEST(House, ReadmeNamesTheTwoCommandsFirst) {
  const std::string readme = contents("README.md");
  const std::size_t play = readme.find("./play"), check = readme.find("./check");
  ASSERT_NE(play, std::string::npos);
  ASSERT_NE(check, std::string::npos);
  EXPECT_LT(play, readme.find("```cpp"));
  EXPECT_LT(check, readme.find("```cpp"));
}

}  // namespace
}  // namespace carom::test
