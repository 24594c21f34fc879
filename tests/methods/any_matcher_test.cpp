// The six methods behind one door.
#include "methods/any_matcher.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/rooms.hpp"

namespace phasescan::any_matcher_test {
namespace {

AnyMatchOptions options_of(MatchMethod method, RotationsFrom rotations = RotationsFrom::kOwn) {
  AnyMatchOptions options;
  options.match.method = method;
  options.match.rotations = rotations;
  return options;
}

TEST(AnyMatcher, TheRotationsOfThePaperCanTakeThePlaceOfItsOwn) {
  const Scan reference = test::cast_room({}, 360, 0.01, 0.02, 1);
  const Pose2 truth{0.4, -0.3, deg_to_rad(100)};
  const Scan scan = test::cast_room(truth, 360, 0.01, 0.02, 2);
  for (const auto& [from, source] : {std::pair{RotationsFrom::kOwn, RotationSource::kNormals},
                                     {RotationsFrom::kSpectrum, RotationSource::kSpectrum}}) {
    AnyMatcher matcher(options_of(MatchMethod::kGlobal, from));
    const MatchResult raw = matcher.match(reference, scan), prepared = matcher.match(matcher.prepare(reference), scan);
    EXPECT_LT(translation_distance(raw.T_ref_scan, truth), 0.02);
    EXPECT_EQ(raw.diagnostics.rotation_source, source);
    EXPECT_EQ(raw.T_ref_scan, prepared.T_ref_scan);
  }
}

TEST(AnyMatcher, AReferenceOfAnotherMethodIsTheCallersMistake) {
  const Scan room = test::cast_room({}, 90);
  AnyMatcher global(options_of(MatchMethod::kGlobal)), icp(options_of(MatchMethod::kIcp)),
      spectrum(options_of(MatchMethod::kGlobal, RotationsFrom::kMissing));
  EXPECT_THROW(global.match(icp.prepare(room), room), std::invalid_argument);
  EXPECT_THROW(icp.match(global.prepare(room), room), std::invalid_argument);
  EXPECT_THROW(spectrum.match(global.prepare(room), room), std::invalid_argument);
}

TEST(AnyMatcher, TheEarlierNameOfTheDefaultIsUnderstood) {
  EXPECT_EQ(enum_from_string<MatchMethod>("fft-mh"), MatchMethod::kGlobal);
  EXPECT_EQ(to_string(MatchMethod::kGlobal), "global");
  EXPECT_THROW(enum_from_string<MatchMethod>("mh"), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::any_matcher_test
