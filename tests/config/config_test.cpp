#include "config/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "methods/any_matcher.hpp"
#include "support/temp.hpp"

namespace phasescan::config_test {
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
  config.match.match.general.fast = true;
  config.match.match.general.min_confidence = 0.1 + 0.2;
  const std::string text = option_table(config).dump();
  Config again;
  option_table(again).load_text(text, "dump");
  EXPECT_EQ(again.match.match.method, MatchMethod::kNdt);
  EXPECT_EQ(again.match.match.general.min_confidence, 0.1 + 0.2);
  EXPECT_EQ(option_table(again).dump(), text);
}

TEST(Config, AnEarlierNameOfASectionIsUnderstood) {
  Config config;
  option_table(config).load_text("mh:\n  twins: false\nmatch:\n  method: fft-mh\n", "c.yaml");
  EXPECT_FALSE(config.match.global.twins);
  EXPECT_EQ(config.match.match.method, MatchMethod::kGlobal);
  EXPECT_THAT(message_of("mh:\n  twins: false\nglobal:\n  twins: true\n"), HasSubstr("c.yaml:3: section"));
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

TEST(Config, OptionsThatDoNotGoTogetherAreNamedWithTheLineThatSpoiledIt) {
  EXPECT_THAT(message_of("image:\n  size: 127\n"), HasSubstr("c.yaml:2: image.size is 127; expected an even number"));
  EXPECT_THAT(message_of("image:\n  fft_size: 8\n"), HasSubstr("c.yaml:2: image.fft_size is 8; expected 16..2048 px"));
  EXPECT_THAT(message_of("\nspectrum: {angle_bins: 181}\n"), HasSubstr("c.yaml:2: spectrum.angle_bins is 181"));
  EXPECT_THAT(message_of("image:\n  fft_size: 64\n"),
              HasSubstr("c.yaml:2: image.fft_size is 64; expected at least image.size, 128 by default"));
  EXPECT_THAT(message_of("image:\n  fft_size: 64\n  dmax_m: 5\n  size: 128\nmatch:\n  fast: true\n"),
              HasSubstr("c.yaml:4: image.fft_size is 64; expected at least image.size, 128"));
  EXPECT_THAT(message_of("image:\n  size: 512\n"), HasSubstr("c.yaml:2: image.fft_size is 256; expected at least"));
  EXPECT_EQ(message_of("image:\n  size: 512\n  fft_size: 512\n"), "no error");
  EXPECT_EQ(message_of("image:\n  fft_size: 64\n  size: 32\n"), "no error");
  EXPECT_THAT(message_of("spectrum:\n  radius_max: 0.01\n"), HasSubstr("c.yaml:2: spectrum.radius_max is 0.01"));
  EXPECT_THAT(message_of("glass:\n  facing_deg: 20\n  oblique_deg: 15\n"), HasSubstr("c.yaml:3: glass.oblique_deg"));
}

TEST(Config, TheLibraryRefusesThemToo) {
  const auto said_of = [](const AnyMatchOptions& options) {
    try {
      AnyMatcher{options};
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  AnyMatchOptions odd, swapped;
  odd.image.size = 127;
  EXPECT_THAT(said_of(odd), HasSubstr("image.size: value 127 is odd"));
  swapped.image.fft_size = 64;
  EXPECT_THAT(said_of(swapped), HasSubstr("image.fft_size: value 64 is below image.size"));
  Config config;
  config.slam.glass.facing_deg = 20;
  config.slam.glass.oblique_deg = 15;
  EXPECT_THROW(config.slam.validate(), std::invalid_argument);
}

TEST(Config, AFileThatDoesNotExistIsAnInputError) {
  const test::TempFolder folder;
  EXPECT_THROW(load_config(folder / "none.yaml"), InputError);
  EXPECT_THROW(load_config(folder.path()), InputError);
}

TEST(Config, SlamReadsTheSectionsOfTheMatcher) {
  const test::TempFolder folder;
  folder.put("options.yaml", "match: {min_confidence: 0.5}\nmh: {candidates: 3}\nslam: {polish: false}\n");
  const Config config = load_config(folder / "options.yaml");
  EXPECT_EQ(config.slam.match.match.min_confidence, 0.5);
  EXPECT_EQ(config.slam.match.global.candidates, 3);
  EXPECT_EQ(config.sections_set, (std::vector<std::string>{"match", "global", "slam"}));
}

}  // namespace
}  // namespace phasescan::config_test
