// Every instruction set that this CPU has, and plain C++ in the place of SIMD, give the same answers. The kernels are
// built into this program once more, with every target that the compiler can make for this machine.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "slam/place_index.hpp"
#include "simd/answers.hpp"

namespace phasescan::targets_test {
namespace {

/// Runs with one target at a time; the best of the CPU again at the end.
template <class Run>
void on_every_target(Run&& run) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    run(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(Simd, ThereIsAPathWithoutSimdAndOneWith) {
  const auto targets = hwy::SupportedAndGeneratedTargets();
  EXPECT_GE(targets.size(), 2u);
  EXPECT_TRUE(targets.back() == HWY_SCALAR || targets.back() == HWY_EMU128) << "plain C++ comes last";
  std::string names;
  for (const std::int64_t target : targets) names += std::string(" ") + hwy::TargetName(target);
  RecordProperty("targets", names);
  std::printf("targets of this run:%s\n", names.c_str());
}

TEST(Simd, IntegerKernelsAgreeBitForBit) {
  const std::vector<std::uint32_t> expected = test::integer_answers();
  on_every_target([&](std::int64_t) { EXPECT_TRUE(test::integer_answers() == expected); });
}

TEST(Simd, PlacesAreFoundAgainBitForBit) {
  Random random(7);
  const auto draw = [&] {
    PlaceDescriptor d;
    for (auto& v : d.numbers) v = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
    for (auto& v : d.turning) v = static_cast<std::uint8_t>(random.below(256));
    return d;
  };
  PlaceIndex index;
  for (int k = 0; k < 700; ++k) index.add(draw());
  const PlaceDescriptor query = draw();
  const std::vector<PlaceHit> expected = index.most_alike(query, 100);
  on_every_target([&](std::int64_t) {
    const std::vector<PlaceHit> found = index.most_alike(query, 100);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].place, expected[k].place) << k;
      EXPECT_EQ(found[k].distance, expected[k].distance) << k;
      EXPECT_EQ(found[k].likeness, expected[k].likeness) << k;
    }
  });
}

TEST(Simd, PosesAgreeWithinAMillionth) {
  const std::vector<MatchResult> expected = test::match_answers();
  on_every_target([&](std::int64_t) {
    const std::vector<MatchResult> found = test::match_answers();
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k].T_ref_scan.x, expected[k].T_ref_scan.x, 1e-6) << k;
      EXPECT_NEAR(found[k].T_ref_scan.y, expected[k].T_ref_scan.y, 1e-6) << k;
      EXPECT_LT(angle_distance(found[k].T_ref_scan.theta, expected[k].T_ref_scan.theta), 1e-6) << k;
      EXPECT_NEAR(*found[k].confidence, *expected[k].confidence, 1e-3) << k;
      EXPECT_EQ(found[k].usable, expected[k].usable) << k;
    }
  });
}

}  // namespace
}  // namespace phasescan::targets_test
