#include "io/yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "output/map_file.hpp"
#include "config/option_table.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "sim/world_file.hpp"
#include "support/temp.hpp"

namespace phasescan::yaml_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string message_of(const std::string& text, const YamlBounds& bounds = {}) {
  try {
    static_cast<void>(parse_yaml(text, "f.yaml", bounds));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Yaml, OneDocumentIsRead) {
  EXPECT_EQ(parse_yaml("a: 1\nb: [2, 3]\n", "f.yaml")["b"][1].as<int>(), 3);
  EXPECT_EQ(parse_yaml("---\na: 1\n...\n", "f.yaml")["a"].as<int>(), 1);
  EXPECT_TRUE(parse_yaml("", "f.yaml").IsNull());
  EXPECT_TRUE(parse_yaml("# nothing\n", "f.yaml").IsNull());
}

// yaml-cpp makes one empty document after the other of these, for ever.
TEST(Yaml, TextThatBeginsNoDocumentEnds) {
  for (const char* text : {",", ",,", "a: 1\n---\n,", ", a: 1", "]", "}", "[a],", "{a: 1} }", "- a\n,"})
    EXPECT_THAT(message_of(text), StartsWith("f.yaml:")) << text;
  EXPECT_EQ(message_of(","), "f.yaml:1: text after the end of the YAML document; expected one");
}

TEST(Yaml, ASecondDocumentIsNamedWithItsLine) {
  EXPECT_THAT(message_of("a: 1\n---\nb: 2\n"), HasSubstr("f.yaml:2: text after the end"));
  EXPECT_THAT(message_of("a: [1\n"), HasSubstr("f.yaml:2: is not YAML"));
}

TEST(Yaml, SizeValuesAndDepthAreBounded) {
  EXPECT_THAT(message_of(std::string((std::size_t{1} << 20) + 1, ' ')), HasSubstr("larger than 1024 KiB"));
  EXPECT_EQ(message_of("[1, 2, 3]", {1024, 4, 1}), "no error");
  EXPECT_THAT(message_of("[1, 2,\n3]", {1024, 3, 1}), HasSubstr("f.yaml:2: more than 3 values"));
  EXPECT_EQ(message_of(std::string(32, '[') + std::string(32, ']')), "no error");
  EXPECT_THAT(message_of(std::string(33, '[') + std::string(33, ']')), HasSubstr("more than 32 deep"));
  EXPECT_THAT(message_of(std::string(100'000, '[')), HasSubstr("more than 32 deep"));
  EXPECT_THAT(message_of("&a [1,\n{b: *a}]"), HasSubstr("f.yaml:2: a list or map that contains itself"));
}

TEST(Yaml, EveryFileReadAsYamlGoesThroughTheBounds) {
  const test::TempFolder folder;
  const std::string comma = folder.put("comma.yaml", ",");
  OptionTable table;
  EXPECT_THROW(table.load_file(comma), InputError);
  EXPECT_THROW(static_cast<void>(read_map(comma)), InputError);
  EXPECT_THROW(static_cast<void>(sim::read_world(comma)), InputError);
  EXPECT_THROW(static_cast<void>(sim::read_points(comma)), InputError);
  const test::TempFolder recording;
  recording.put("metadata.yaml", ",");
  EXPECT_THROW(static_cast<void>(open_log(recording.path())), InputError);
}

}  // namespace
}  // namespace phasescan::yaml_test
