#include "io/nearest_word.hpp"

#include <gtest/gtest.h>

namespace phasescan::nearest_word_test {
namespace {

TEST(NearestWord, CountsLettersAndSwapsOfNeighbours) {
  EXPECT_EQ(word_distance("", "abc"), 3u);
  EXPECT_EQ(word_distance("slam", "slam"), 0u);
  EXPECT_EQ(word_distance("slma", "slam"), 1u);
  EXPECT_EQ(word_distance("slm", "slam"), 1u);
  EXPECT_EQ(word_distance("Slab", "slam"), 1u);
  EXPECT_EQ(word_distance("kitten", "sitting"), 3u);
}

TEST(NearestWord, NamesTheNearestAndNothingThatIsFar) {
  const std::vector<std::string> words{"match", "slam", "convert", "calibrate"};
  const auto near = [&](std::string_view word) { return did_you_mean(word, std::span<const std::string>(words)); };
  EXPECT_EQ(near("mtach"), "; did you mean 'match'?");
  EXPECT_EQ(near("cal"), "; did you mean 'calibrate'?");
  EXPECT_EQ(near("quaternion"), "");
  EXPECT_EQ(near("slam"), "");
  EXPECT_EQ(near(""), "");
  EXPECT_EQ(near(std::string(100'000, 'a')), "");
}

}  // namespace
}  // namespace phasescan::nearest_word_test
