#include "eval/place_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"
#include "scan/points.hpp"
#include "sim/places.hpp"
#include "slam/place_index.hpp"
#include "slam/place_projection.hpp"

namespace phasescan::place_fit_test {
namespace {

TEST(PlaceProjection, LettersKeepNumbers) {
  for (int n = -kMostLetter; n <= kMostLetter; ++n) EXPECT_EQ(place_number(place_letter(n)), n);
}

TEST(PlaceProjection, NeitherOverflowsNorIgnoresAFeature) {
  PlaceFeatures features;
  PlaceDescriptor out;
  features.fill(1e6F);
  place_projection().apply(features, out);
  EXPECT_GE(*std::min_element(out.numbers.begin(), out.numbers.end()), -127);
  for (const auto& of_feature : place_projection().weights)
    EXPECT_TRUE(std::any_of(of_feature.begin(), of_feature.end(), [](float w) { return w != 0.0F; }));
  // The innermost rings have too few cells to hold high harmonics.
  for (const auto& of_harmonic : place_projection().turning) {
    const auto is_used = [](const auto& of_ring) {
      return std::any_of(of_ring.begin(), of_ring.end(), [](auto w) { return std::norm(w) > 0.0F; });
    };
    EXPECT_GE(std::count_if(of_harmonic.begin(), of_harmonic.end(), is_used), 20);
  }
}

TEST(PlaceProjection, ATurnOfTheFeaturesLeavesTheNumbersAndTurnsTheRest) {
  Random random(4);
  PlaceFeatures features, turned;
  const std::size_t steps = 5;  // of the 64 turns that are compared
  for (std::size_t f = 0; f < kPlaceFeatures; ++f) {
    features[f] = {static_cast<float>(random.normal()), static_cast<float>(random.normal())};
    const auto h = static_cast<double>(f % kPlaceHarmonics);
    turned[f] = features[f] * std::complex<float>(std::polar(1.0, -h * kTwoPi * steps / 64));
  }
  PlaceDescriptor a, b;
  place_projection().apply(features, a);
  place_projection().apply(turned, b);
  for (std::size_t d = 0; d < kDescriptorSize; ++d) EXPECT_NEAR(a.numbers[d], b.numbers[d], 1);
  EXPECT_NE(a.turning, b.turning);
  EXPECT_GT(turned_likeness(a, b), 0.97 * turned_likeness(a, a));
}

TEST(PlaceProjection, FindsPlacesOfBuildingsItWasNotFittedTo) {
  PlaceDescriber describer;
  PlaceIndex index;
  ScanPoints points;
  std::vector<PlaceDescriptor> queries;
  std::vector<std::vector<std::uint32_t>> right;
  for (std::uint64_t building = 0; index.size() < 300; ++building) {
    const auto first = static_cast<std::uint32_t>(index.size());
    for (const sim::Place& place : sim::make_places({}, {}, 31, building)) {
      scan_to_points(place.scan, points);
      index.add(describer.describe(points.x, points.y));
      scan_to_points(place.query, points);
      queries.push_back(describer.describe(points.x, points.y));
      right.emplace_back();
      for (const std::uint32_t k : place.in_reach) right.back().push_back(first + k);
    }
  }
  std::size_t among_one = 0, among_ten = 0;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const auto hits = index.most_alike(queries[q], 10);
    const auto is_right = [&](const PlaceHit& hit) {
      return std::find(right[q].begin(), right[q].end(), hit.place) != right[q].end();
    };
    among_one += is_right(hits[0]);
    among_ten += std::any_of(hits.begin(), hits.end(), is_right);
  }
  EXPECT_GT(static_cast<double>(among_one), 0.94 * static_cast<double>(queries.size()));
  EXPECT_GT(static_cast<double>(among_ten), 0.985 * static_cast<double>(queries.size()));
}

TEST(PlaceFit, WritesARowForEachNumberAndRefusesTooFewPlaces) {
  const std::string text = fit_place_projection(3, 600);
  EXPECT_EQ(std::count(text.begin(), text.end(), '"'), 2 * static_cast<std::ptrdiff_t>(kDescriptorSize + kTurningSize));
  EXPECT_THROW(fit_place_projection(3, 10), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::place_fit_test
