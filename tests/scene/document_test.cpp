// The JSON tree and the errors of scene files: file, line, path, found, expected, nearest known name.
#include <gtest/gtest.h>

#include <cstdlib>

#include "carom/scene/detail/document.h"
#include "carom/scene/scene.h"

namespace carom::scene {
namespace {

std::string error_of(std::string_view text, const Resolver& resolver = {}) {
  const Result<Scene> scene = parse_scene(text, "scenes/wall.json", resolver);
  return scene ? "" : scene.error().message;
}
bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

TEST(Document, KnowsTheLineOfEveryValue) {
  const auto node = detail::parse_document(
      "// a comment\n{\n \"a\": 12,\n \"b\": [true,\n  \"x\"], /* and\n another */ \"c\": null\n}\n", "t", 0);
  ASSERT_TRUE(node.ok()) << node.error().message;
  EXPECT_EQ(node->find("a")->line, 3);
  EXPECT_EQ(node->find("a")->number, 12);
  EXPECT_EQ(node->find("b")->children[0].line, 4);
  EXPECT_EQ(node->find("b")->children[1].line, 5);
  EXPECT_EQ(node->find("c")->line, 6);
}

TEST(Document, RefusesWhatIsNotJson) {
  for (const char* bad : {"", "{", "[1,2", "{\"a\":}", "{\"a\":1,}", "nul", "\"\\x\"", "{\"a\":1e999}", "{\"a\":1}{}",
                          "\xff", "{\"a\":1,\"a\":2}"}) {
    const auto node = detail::parse_document(bad, "t", 0);
    EXPECT_FALSE(node.ok()) << bad;
    if (!node.ok()) EXPECT_EQ(node.error().message.rfind("t:1: ", 0), 0u) << node.error().message;
  }
}

TEST(Document, LimitsDepthAndSize) {
  EXPECT_TRUE(holds(detail::parse_document(std::string(100, '['), "t", 0).error().message, "deeper than 64"));
  detail::DocumentLimits small;
  small.nodes = 10;
  EXPECT_FALSE(detail::parse_document("[1,2,3,4,5,6,7,8,9,10,11]", "t", 0, small).ok());
  small.bytes = 4;
  EXPECT_FALSE(detail::parse_document("[1,2,3]", "t", 0, small).ok());
}

TEST(Document, ShortestDigitsRestoreTheBits) {
  for (const double v : {0.1, 1.0 / 3, 1e-310, -9.80665, 6.02214076e23})
    EXPECT_EQ(std::strtod(detail::shortest(v).c_str(), nullptr), v);
}

TEST(SceneErrors, NameFileLinePathFoundAndExpected) {
  const std::string e =
      error_of("{\n\"bodies\": [\n{},\n{\"shape\": {\"type\": \"sphere\"},\n\"mass\": \"1200 kgg\"}\n]}");
  EXPECT_EQ(e.rfind("scenes/wall.json:5: bodies[1].mass: found \"1200 kgg\", expected a mass such as \"1200 kg\"", 0),
            0u)
      << e;
  EXPECT_TRUE(holds(e, "kg")) << e;
}

TEST(SceneErrors, SuggestTheNearestKey) {
  const std::string e = error_of("{\"bodies\": [\n{\"postion\": [0, 1, 2]}]}");
  EXPECT_TRUE(holds(e, "scenes/wall.json:2: bodies[0].postion: found the unknown key \"postion\"")) << e;
  EXPECT_TRUE(holds(e, "did you mean \"position\"")) << e;
}

TEST(SceneErrors, CoverEveryKindOfField) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"[]", "expected an object (scene)"},
      {"{\"dimension\": 4}", "a whole number from 2 to 3"},
      {"{\"dimension\": \"two\"}", "dimension: found \"two\", expected a plain number"},
      {"{\"step\": \"2 kg\"}", "expected a time such as \"1/60 s\" instead of a mass"},
      {"{\"step\": 0}", "expected a time above zero"},
      {"{\"gravity\": [0, 1]}", "expected a list of three, each an acceleration"},
      {"{\"bodies\": {}}", "expected a list"},
      {"{\"bodies\": [{\"type\": \"dynamc\"}]}", "did you mean \"dynamic\""},
      {"{\"bodies\": [{\"shape\": {\"type\": \"sphere\", \"radius\": -1}}]}", "bodies[0].shape"},
      {"{\"bodies\": [{\"shape\": {\"radius\": 1}}]}", "the key \"type\" is missing in a shape"},
      {"{\"bodies\": [{\"shape\": \"brik\"}], \"shapes\": {\"brick\": {\"type\": \"sphere\"}}}",
       "did you mean \"brick\""},
      {"{\"bodies\": [{\"shape\": {\"type\": \"circle\"}}]}", "a scene of dimension 3 does not have"},
      {"{\"bodies\": [{\"color\": \"red\"}]}", "expected a color such as"},
      {"{\"bodies\": [{\"name\": \"a\"}, {\"name\": \"a\"}]}", "a second time"},
      {"{\"bodies\": [{\"mass\": 3}]}", "no shape with a volume"},
      {"{\"bodies\": [{\"locks\": [\"rotationx\"]}]}", "did you mean \"rotation_x\""},
      {"{\"bodies\": [{\"position\": [\"=1/0\", 0, 0]}]}", "not finite"},
      {"{\"bodies\": [{\"position\": [\"=1 m + 2 s\", 0, 0]}]}", "a sum needs two of one kind"},
      {"{\"bodies\": [{\"position\": [\"=sped\", 0, 0]}], \"parameters\": {\"speed\": {\"value\": 1, \"minimum\": 0, "
       "\"maximum\": 2}}}",
       "did you mean \"speed\""},
      {"{\"joints\": [{\"type\": \"ball\", \"body_a\": \"x\", \"body_b\": \"y\", \"anchor\": [0,0,0]}]}",
       "expected the name of a body"},
      {"{\"joints\": [{\"type\": \"hinge\"}]}", "the key \"body_a\" is missing"},
      {"{\"joints\": [{}]}", "the key \"type\" is missing in a joint"},
      {"{\"effectors\": [{\"type\": \"thrust\", \"body\": \"rocket\"}]}", "expected the name of a body"},
      {"{\"parameters\": {\"a\": {\"value\": \"3 kg\", \"minimum\": \"0 m\", \"maximum\": \"5 kg\"}}}",
       "expected a mass like the value"},
      {"{\"parameters\": {\"a\": {\"value\": 9, \"minimum\": 0, \"maximum\": 5}}}", "from minimum to maximum"},
      {"{\"plots\": [{\"title\": \"t\", \"series\": [{\"name\": \"s\", \"quantity\": \"boll.speed\"}]}], \"bodies\": "
       "[{\"name\": \"ball\"}]}",
       "did you mean \"ball\""},
      {"{\"expectations\": [{\"quantity\": \"time\", \"expected\": \"3 m\", \"tolerance\": 0}]}", "expected a time"},
      {"{\"include\": [\"../secret.json\"]}", "without \"..\""},
      {"{\"bodies\": [{\"preset\": \"ball/golf\"}]}", "no folder to read from"},
      {"{\"bodies\": [{\"repeat\": {\"i\": 1000, \"j\": 1000}, \"bodies\": [{}]}]}", "more than 200000"},
      {"{\"kind\": \"flight\"}", "the key \"flight\" is missing"},
      {"{\"camera\": {\"follow\": \"nobody\"}}", "expected the name of a body"},
  };
  for (const auto& c : cases) {
    const std::string e = error_of(c.text);
    EXPECT_TRUE(holds(e, c.part)) << c.text << "\n" << e;
    EXPECT_EQ(e.rfind("scenes/wall.json:1: ", 0), 0u) << e;
  }
}

TEST(SceneErrors, IncludesKnowTheirOwnFileAndCycles) {
  const Resolver files = [](std::string_view path) -> Result<std::string> {
    if (path == "a.json") return std::string("{\n\"bodies\": [{\"masss\": 1}]}");
    if (path == "loop.json") return std::string("{\"include\": [\"loop.json\"]}");
    if (path == "sub/b.json") return std::string("{\"include\": [\"c.json\"]}");
    if (path == "sub/c.json") return std::string("{\"bodies\": [{\"name\": \"deep\"}]}");
    if (path == "presets/p.json")
      return std::string("{\"description\": \"d\", \"source\": \"s\", \"values\": {\"mas\": 1}}");
    return core::Error{"no such file"};
  };
  EXPECT_TRUE(holds(error_of("{\"include\": [\"a.json\"]}", files), "scenes/a.json:2: bodies[0].masss"))
      << error_of("{\"include\": [\"a.json\"]}", files);
  EXPECT_TRUE(holds(error_of("{\"include\": [\"loop.json\"]}", files), "includes itself"));
  EXPECT_TRUE(holds(error_of("{\"include\": [\"none.json\"]}", files), "no such file"));
  EXPECT_TRUE(holds(error_of("{\"bodies\": [{\"preset\": \"p\"}]}", files), "presets/p.json:1: bodies[0].mas"));
  const Result<Scene> good = parse_scene("{\"include\": [\"sub/b.json\"]}", "scenes/x.json", files);
  ASSERT_TRUE(good.ok()) << good.error().message;
  const Result<SceneWorld> world = good->instantiate();
  ASSERT_TRUE(world.ok());
  EXPECT_NE(world->find_body("deep"), nullptr);
}

}  // namespace
}  // namespace carom::scene
