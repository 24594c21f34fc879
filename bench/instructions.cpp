// What scripts/instructions counts under callgrind: matches and tracking steps on fixed, simulated input. Every part is
// run once before it is counted, so that buffers have their size, and prints its name and how many times it was done.
#include <hwy/highway.h>
#include <valgrind/callgrind.h>

#include <cstdio>

#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "support/toy_world.hpp"

namespace {

using namespace phasescan;

/// Counts what `work` does, under a name; `times` is what the sum is divided by.
template <class Work>
void count(const char* name, std::size_t times, Work&& work) {
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  work();
  CALLGRIND_DUMP_STATS_AT(name);
  CALLGRIND_STOP_INSTRUMENTATION;
  std::printf("%s %zu\n", name, times);
}

/// A tour of the toy world with an RPLidar A1's beams, period and noise.
std::vector<Scan> toy_scans() {
  const auto walls = testing::two_rooms();
  Random random(1);
  std::vector<Scan> scans;
  for (const Pose2& pose : testing::toy_tour(0.18, 0.4, 1.2))
    scans.push_back(
        testing::toy_scan(walls, pose, {}, random, stamp_from_seconds(0.18 * static_cast<double>(scans.size()))));
  return scans;
}

void count_matches(const std::vector<Scan>& scans) {
  constexpr std::size_t kPairs = 8, kApart = 12;
  ScanMatcher matcher;
  const auto match_all = [&] {
    for (std::size_t k = 0; k < kPairs; ++k) matcher.match(scans[kApart * k], scans[kApart * (k + 1)]);
  };
  match_all();
  count("match_raw", kPairs, match_all);
  const Reference reference = matcher.prepare(scans[0]);
  const auto match_prepared = [&] {
    for (std::size_t k = 1; k <= kPairs; ++k) matcher.match(reference, scans[k]);
  };
  match_prepared();
  count("match_prepared", kPairs, match_prepared);
}

void count_tracking(const std::vector<Scan>& scans) {
  const std::size_t warm = scans.size() / 3;
  Odometry odometry;
  const auto track = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) odometry.add(RangeMeasurement{scans[k]});
  };
  track(0, warm);
  count("tracking_step", scans.size() - warm, [&] { track(warm, scans.size()); });
}

}  // namespace

int main() {
  // One instruction set everywhere: what callgrind runs and every x86-64 machine since 2013 has.
  if ((hwy::SupportedTargets() & HWY_AVX2) == 0) {
    std::fprintf(stderr, "instructions: needs AVX2\n");
    return 3;
  }
  hwy::SetSupportedTargetsForTest(HWY_AVX2);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  const std::vector<Scan> scans = toy_scans();
  count_matches(scans);
  count_tracking(scans);
  return 0;
}
