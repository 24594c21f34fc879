#include "io/tum.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "phasescan/io/error.hpp"

namespace phasescan::tum_test {
namespace {

class Tum : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  ~Tum() override { std::filesystem::remove(path_); }
  const std::string path_ =
      (std::filesystem::temp_directory_path() / ("phasescan_tum_" + std::to_string(::getpid()))).string();
};

TEST_F(Tum, RoundTripKeepsEveryNanosecond) {
  const std::vector<StampedPose> poses = {
      {976052905'167303123, {1.25, -2.5, 3.1}}, {0, {0, 0, -kPi / 2}}, {-1'500'000'001, {7, 8, kPi}}};
  const std::string text = format_tum(poses);
  EXPECT_EQ(text.substr(0, text.find(' ')), "976052905.167303123");
  const auto back = read_tum(write(text));
  ASSERT_EQ(back.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(back[i].stamp, poses[i].stamp);
    EXPECT_NEAR(back[i].pose.x, poses[i].pose.x, 1e-6);
    EXPECT_NEAR(back[i].pose.y, poses[i].pose.y, 1e-6);
    EXPECT_LT(angle_distance(back[i].pose.theta, poses[i].pose.theta), 1e-8);
  }
}

TEST_F(Tum, EightNumbersALineAndNothingElse) {
  EXPECT_EQ(read_tum(write("# stamp x y z qx qy qz qw\n\n1e3 1 2 0 0 0 0 1\n")).at(0).stamp, 1'000'000'000'000);
  for (const char* bad :
       {"1 2 3 0 0 0 0\n", "1 2 3 0 0 0 0 1 9\n", "1 nan 3 0 0 0 0 1\n", "1 2 3 0 0 0 0 1x\n", "a b\n"}) {
    try {
      read_tum(write(std::string("1 2 3 0 0 0 0 1\n") + bad));
      FAIL() << bad;
    } catch (const InputError& e) {
      EXPECT_EQ(e.line(), 2);
    }
  }
}

}  // namespace
}  // namespace phasescan::tum_test
