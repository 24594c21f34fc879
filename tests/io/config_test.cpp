#include "phasescan/io/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "phasescan/io/error.hpp"
#include "phasescan/io/file.hpp"
#include "support/temp.hpp"

namespace phasescan {
namespace {

using ::testing::HasSubstr;

std::string message_of(const std::string& yaml) {
  Config config;
  try {
    option_table(config).load_text(yaml, "c.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Config, TheDumpLoadsBackAndDumpsTheSame) {
  Config config;
  config.match.match.method = MatchMethod::kNdt;
  config.match.match.fast = true;
  config.match.match.min_confidence = 0.1 + 0.2;
  const std::string text = option_table(config).dump();
  Config again;
  option_table(again).load_text(text, "dump");
  EXPECT_EQ(again.match.match.method, MatchMethod::kNdt);
  EXPECT_EQ(again.match.match.min_confidence, 0.1 + 0.2);
  EXPECT_EQ(option_table(again).dump(), text);
}

TEST(Config, EveryOptionHasAMeaningAndADefaultInsideItsBounds) {
  Config config;
  const OptionTable table = option_table(config);
  ASSERT_FALSE(table.entries().empty());
  for (const auto& entry : table.entries()) {
    EXPECT_FALSE(entry.meaning.empty()) << entry.section << "." << entry.name;
    EXPECT_NO_THROW(entry.set(entry.default_value)) << entry.section << "." << entry.name;
    EXPECT_EQ(entry.get(), entry.default_value) << entry.section << "." << entry.name;
  }
}

TEST(Config, WhatIsUnknownOrWrongIsNamedWithItsLine) {
  EXPECT_THAT(message_of("match:\n  fast: true\n  fats: true\n"), HasSubstr("c.yaml:3: unknown option 'match.fats'"));
  EXPECT_THAT(message_of("\nmtach:\n  fast: true\n"),
              HasSubstr("c.yaml:2: unknown section 'mtach'; expected one of match"));
  EXPECT_THAT(message_of("match:\n  fast: maybe\n"),
              HasSubstr("c.yaml:2: match.fast is 'maybe'; expected true or false"));
  EXPECT_THAT(message_of("match:\n  min_points: 1.5\n"), HasSubstr("expected a whole number"));
  EXPECT_THAT(message_of("match:\n  min_confidence: 2\n"),
              HasSubstr("c.yaml:2: match.min_confidence is 2; expected 0..1"));
  EXPECT_THAT(message_of("match:\n  min_confidence: .nan\n"), HasSubstr("expected"));
  EXPECT_THAT(message_of("match:\n  min_confidence: nan\n"), HasSubstr("expected 0..1"));
  EXPECT_THAT(message_of("match:\n  method: magic\n"), HasSubstr("is not one of icp"));
  EXPECT_THAT(message_of("match:\n  fast: true\n  fast: false\n"), HasSubstr("stands twice"));
  EXPECT_THAT(message_of("match: [1, 2]\n"), HasSubstr("c.yaml:1"));
  EXPECT_THAT(message_of("match:\n  fast: [1]\n"), HasSubstr("c.yaml:2"));
  EXPECT_THAT(message_of("just a word\n"), HasSubstr("is no map"));
  EXPECT_THAT(message_of("match: {fast: \n"), HasSubstr("c.yaml:"));
  EXPECT_EQ(message_of(""), "no error");
  EXPECT_EQ(message_of("match:\n"), "no error");
}

TEST(Config, AFileThatDoesNotExistIsAnInputError) {
  const test::TempFolder folder;
  EXPECT_THROW(load_config(folder / "none.yaml"), InputError);
  EXPECT_THROW(load_config(folder.path()), InputError);
}

}  // namespace
}  // namespace phasescan
