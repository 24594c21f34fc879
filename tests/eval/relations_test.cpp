#include "eval/relations.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "phasescan/io/error.hpp"

namespace phasescan::relations_test {
namespace {

std::string temporary(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / ("phasescan_" + std::to_string(::getpid()) + "_" + name);
  std::ofstream(path) << text;
  return path.string();
}

TEST(Relations, ReadsFileAndNamesTheBadLine) {
  const auto path = temporary("ok.relations", "# a comment\n1.5 2.25 0.5 -0.25 0 0 0 1.0\n\n3 4 1 2 0 0 0 -4.0\n");
  const auto relations = read_relations(path);
  ASSERT_EQ(relations.size(), 2u);
  EXPECT_EQ(relations[0].stamp_a, 1'500'000'000);
  EXPECT_EQ(relations[0].stamp_b, 2'250'000'000);
  EXPECT_DOUBLE_EQ(relations[0].T_a_b.y, -0.25);
  EXPECT_NEAR(relations[1].T_a_b.theta, kTwoPi - 4.0, 1e-12);
  std::filesystem::remove(path);
  const auto bad = temporary("bad.relations", "1 2 3 4 0 0 0 1\n1 2 3 x\n");
  try {
    read_relations(bad);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.line(), 2);
  }
  std::filesystem::remove(bad);
  EXPECT_THROW(read_relations("/nonexistent/file"), InputError);
}

TEST(Relations, ErrorIsInverseRelationTimesEstimate) {
  const std::vector<StampedPose> trajectory = {
      {0, {0, 0, 0}}, {1'000'000'000, {1, 0, kPi / 2}}, {2'000'000'000, {1, 1, kPi / 2}}};
  // First relation exact, second 0.1 m and 0.2 rad off, third has no pose at 7 s.
  const std::vector<Relation> relations = {{0, 1'000'000'000, {1, 0, kPi / 2}},
                                           {1'000'000'000, 2'000'000'000, {0.9, 0, -0.2}},
                                           {0, 7'000'000'000, {1, 0, 0}}};
  const RelationErrors errors = relation_errors(trajectory, relations);
  EXPECT_EQ(errors.relations, 3u);
  EXPECT_EQ(errors.unanswered, 1u);
  ASSERT_EQ(errors.translation.size(), 2u);
  EXPECT_NEAR(errors.translation[0], 0.0, 1e-12);
  EXPECT_NEAR(errors.rotation[0], 0.0, 1e-12);
  EXPECT_NEAR(errors.translation[1], 0.1, 1e-12);
  EXPECT_NEAR(errors.rotation[1], 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(errors.worst_translation_stamp_a, 1.0);
}

TEST(Relations, PosesOfTheLaser) {
  // The base turns on the spot by 90 degrees; a laser 0.5 m ahead moves by (-0.5, 0.5) in its own old frame.
  const std::vector<StampedPose> trajectory = {{0, {0, 0, 0}}, {1'000'000'000, {0, 0, kPi / 2}}};
  const std::vector<Relation> relations = {{0, 1'000'000'000, {-0.5, 0.5, kPi / 2}}};
  EXPECT_NEAR(relation_errors(trajectory, relations, {0.5, 0, 0}).translation.at(0), 0.0, 1e-12);
  EXPECT_NEAR(relation_errors(trajectory, relations).translation.at(0), std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace phasescan::relations_test
