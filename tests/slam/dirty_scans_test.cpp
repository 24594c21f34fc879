// Scans that fit neither neighbour, and a robot that stands in its own view: no wrong map comes of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "eval/trajectory_error.hpp"
#include "phasescan/slam/slam.hpp"
#include "phasescan/slam/state.hpp"
#include "sim/drive.hpp"
#include "sim/world_kinds.hpp"
#include "slam/slam_state.hpp"

namespace phasescan::dirty_scans_test {
namespace {

struct Log {
  std::vector<Scan> scans;
  std::vector<Pose2> truth;
};

Log flat(std::uint64_t seed, std::size_t most) {
  const sim::World world = sim::make_world(sim::WorldKind::kFlat, seed);
  sim::PathOptions way;
  way.speed_mps = 0.4;
  sim::Drive drive(world, sim::LidarOptions{}, sim::Path(world, way, seed), {}, seed);
  Log log;
  while (log.scans.size() < most) {
    const auto scan = drive.next();
    if (!scan) break;
    log.scans.push_back(scan->entry.scan);
    log.truth.push_back(scan->T_world_laser);
  }
  return log;
}

/// The turn begins late: every beam has the range of another.
void turn(Scan& scan, std::size_t late) {
  const auto by = static_cast<std::ptrdiff_t>(late % scan.size());
  std::rotate(scan.ranges.begin(), scan.ranges.begin() + by, scan.ranges.end());
  std::rotate(scan.states.begin(), scan.states.begin() + by, scan.states.end());
}

/// A round housing that fills the view from `from` to `to` [rad].
void add_body(Scan& scan, double from, double to, float range) {
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (wrap_positive(scan.angle(i) - from) > wrap_positive(to - from)) continue;
    scan.ranges[i] = range + 0.002F * static_cast<float>(i % 3);
    scan.states[i] = BeamState::kHit;
  }
}

double ate(const SlamResult& result, const Log& log) {
  AssociatedPoses poses;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    poses.estimate.push_back(result.scans[i].T_map_base);
    poses.reference.push_back(log.truth[i]);
  }
  return error_stats(absolute_trajectory_errors(poses)).rmse;
}

SlamResult run(const Log& log, const SlamOptions& options = {}) {
  Slam slam(options);
  for (const Scan& scan : log.scans) slam.add({scan});
  return slam.finish();
}

TEST(DirtyScans, ScansAtAWrongStartAngleAreLeftOutAndNoOthers) {
  Log log = flat(31, 400);
  const std::set<std::size_t> bad{60, 61, 140, 200, 202, 310};
  std::size_t late = 40;
  for (const std::size_t k : bad) turn(log.scans[k], late += 37);
  for (const bool bounded : {false, true}) {
    SlamOptions options;
    options.slam.bounded_memory = bounded;
    const SlamResult result = run(log, options);
    ASSERT_EQ(result.scans.size(), log.scans.size());
    for (std::size_t i = 0; i < result.scans.size(); ++i)
      EXPECT_EQ(result.scans[i].left_out, bad.contains(i)) << i << " " << bounded;
    EXPECT_LT(ate(result, log), 0.02);
    EXPECT_EQ(result.scans_left_out(), bad.size());
    const auto found = std::find_if(result.findings.begin(), result.findings.end(),
                                    [](const RunFinding& f) { return f.kind == "bad_scans"; });
    ASSERT_NE(found, result.findings.end());
    EXPECT_EQ(found->count, bad.size());
    EXPECT_EQ(found->first_stamp, log.scans[60].stamp);
    EXPECT_EQ(found->scan, 60);
    EXPECT_EQ(result.verdict.verdict, Verdict::kGood) << result.verdict.probability;
    EXPECT_EQ(result.oddities.at("bad scan").count, bad.size());
  }
}

TEST(DirtyScans, WheelsAreHeardAcrossABadScan) {
  Log log = flat(32, 250);
  const auto with_wheels = [&log] {
    Slam slam;
    for (std::size_t i = 0; i < log.scans.size(); ++i) slam.add({log.scans[i], {}, {}, log.truth[i]});
    return slam.finish();
  };
  const WheelCounts clean = with_wheels().wheels;
  for (const std::size_t k : {80u, 160u}) turn(log.scans[k], 120);
  const SlamResult result = with_wheels();
  EXPECT_EQ(result.scans_left_out(), 2u);
  EXPECT_LE(result.wheels.slipped, clean.slipped);
  EXPECT_EQ(result.wheels.steps, clean.steps - 2);
  EXPECT_LT(ate(result, log), 0.02);
}

TEST(DirtyScans, ASuspectScanIsNotOk) {
  Log log = flat(33, 120);
  turn(log.scans[70], 100);
  Slam slam;
  std::vector<TrackingStatus> said;
  for (const Scan& scan : log.scans) said.push_back(slam.add({scan}).status);
  EXPECT_TRUE(said[70] == TrackingStatus::kDegraded || said[70] == TrackingStatus::kLost);
  EXPECT_EQ(said[71], TrackingStatus::kOk);
  EXPECT_EQ(slam.finish().scans[70].status, TrackingStatus::kLost);
}

TEST(DirtyScans, ARunResumedBesideABadScanGoesOnWithTheSameBytes) {
  Log log = flat(34, 130);
  turn(log.scans[70], 100);
  const SlamResult whole = run(log);
  for (const std::size_t cut : {70u, 71u, 72u}) {
    Slam first;
    for (std::size_t i = 0; i < cut; ++i) first.add({log.scans[i]});
    Slam second(first.checkpoint(), {});
    for (std::size_t i = cut; i < log.scans.size(); ++i) second.add({log.scans[i]});
    const SlamResult resumed = second.finish();
    for (std::size_t i = 0; i < whole.scans.size(); ++i) {
      ASSERT_EQ(resumed.scans[i].T_map_base, whole.scans[i].T_map_base) << cut << " " << i;
      ASSERT_EQ(resumed.scans[i].left_out, whole.scans[i].left_out) << cut << " " << i;
    }
  }
}

TEST(OwnBody, AHousingInHalfTheViewIsFoundAndTheRunIsAsWithoutIt) {
  for (const std::uint64_t seed : {41u, 42u}) {
    Log log = flat(seed, 500);
    for (Scan& scan : log.scans) add_body(scan, deg_to_rad(100.0), deg_to_rad(-100.0), 0.25F);
    const SlamResult result = run(log);
    EXPECT_LT(ate(result, log), 0.03) << seed;
    ASSERT_FALSE(result.findings.empty());
    const auto body = std::find_if(result.findings.begin(), result.findings.end(),
                                   [](const RunFinding& f) { return f.kind == "own_body"; });
    ASSERT_NE(body, result.findings.end());
    EXPECT_EQ(body->count, 1u);
    EXPECT_EQ(result.oddities.count("own body"), 1u);
  }
}

TEST(OwnBody, ARunSavedBeforeOrAfterItBeganAnewGoesOnWithTheSameBytes) {
  // The second of two drives begins anew once the body is found: what was before it stays.
  const Log before = flat(48, 60);
  Log log = flat(41, 400);
  for (Scan& scan : log.scans) add_body(scan, deg_to_rad(100.0), deg_to_rad(-100.0), 0.25F);
  Slam whole;
  for (const Scan& scan : before.scans) whole.add({scan});
  whole.begin_session();
  std::vector<std::string> saved;  // after every 40th scan of the second drive
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    whole.add({log.scans[i]});
    if (i % 40 == 20) saved.push_back(encode_state({whole.checkpoint(), {}}));
  }
  const SlamResult end = whole.finish();
  ASSERT_EQ(end.oddities.count("own body"), 1u);
  // It was found between two of them: some begin anew after they are resumed, some did before they were saved.
  EXPECT_GT(end.oddities.at("own body").first, 60 + 21);
  EXPECT_LT(end.oddities.at("own body").first, 60 + 340);
  for (std::size_t k = 0; k < saved.size(); ++k) {
    Slam resumed(decode_state(saved[k]).state, {});
    for (std::size_t i = 40 * k + 21; i < log.scans.size(); ++i) resumed.add({log.scans[i]});
    const SlamResult result = resumed.finish();
    ASSERT_EQ(result.scans.size(), end.scans.size());
    for (std::size_t i = 0; i < end.scans.size(); ++i)
      ASSERT_EQ(result.scans[i].T_map_base, end.scans[i].T_map_base) << k << " " << i;
  }
}

TEST(OwnBody, SectorsAreThoseOfTheBody) {
  Log log = flat(43, 500);
  for (Scan& scan : log.scans) add_body(scan, deg_to_rad(150.0), deg_to_rad(-120.0), 0.3F);
  OwnBody own_body;
  OwnBodyState state;
  for (const Scan& scan : log.scans) own_body.add(scan, state);
  ASSERT_TRUE(state.decided);
  ASSERT_EQ(state.sectors.size(), 1u);
  EXPECT_NEAR(rad_to_deg(state.sectors[0].from), 150.0, 4.0);
  EXPECT_NEAR(rad_to_deg(state.sectors[0].to), -120.0, 4.0);
  const Scan left = without_sectors(log.scans[9], state.sectors);
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (left.is_hit(i)) {
      EXPECT_EQ(left.ranges[i], log.scans[9].ranges[i]);
    }
    const double off = wrap_angle(left.angle(i) - deg_to_rad(-165.0));
    if (std::abs(off) < deg_to_rad(40.0)) {
      EXPECT_FALSE(left.is_hit(i));
    }
  }
}

TEST(OwnBody, ScansWithAWrongStartAngleDoNotHideTheBody) {
  for (const std::uint64_t seed : {43u, 48u, 49u}) {
    Log log = flat(seed, 500);
    Random random(seed);
    for (Scan& scan : log.scans) {
      add_body(scan, deg_to_rad(80.0), deg_to_rad(-140.0), 0.4F);
      if (random.uniform() < 0.05) turn(scan, 40 + static_cast<std::size_t>(60.0 * random.uniform()));
    }
    OwnBody own_body;
    OwnBodyState state;
    for (const Scan& scan : log.scans) own_body.add(scan, state);
    ASSERT_EQ(state.sectors.size(), 1u) << seed << " " << format_sectors(state.sectors);
    EXPECT_NEAR(rad_to_deg(state.sectors[0].from), 80.0, 4.0);
    EXPECT_NEAR(rad_to_deg(state.sectors[0].to), -140.0, 4.0);
  }
}

TEST(OwnBody, NoiseAndLostBeamsDoNotHideItAndMakeNone) {
  for (const std::uint64_t seed : {43u, 48u, 49u}) {
    for (const bool in_view : {true, false}) {
      Log log = flat(seed, 500);
      Random random(seed);
      for (Scan& scan : log.scans) {
        if (in_view) add_body(scan, deg_to_rad(100.0), deg_to_rad(-60.0), 0.5F);
        for (std::size_t i = 0; i < scan.size(); ++i) {
          if (!scan.is_hit(i)) continue;
          scan.ranges[i] = std::max(0.05F, scan.ranges[i] + static_cast<float>(0.04 * random.normal()));
          if (random.uniform() < 0.2) scan.miss(i, BeamState::kInvalid);
        }
      }
      OwnBody own_body;
      OwnBodyState state;
      for (const Scan& scan : log.scans) own_body.add(scan, state);
      ASSERT_EQ(state.sectors.size(), in_view ? 1u : 0u) << seed << " " << format_sectors(state.sectors);
      if (!in_view) continue;
      EXPECT_NEAR(rad_to_deg(state.sectors[0].from), 100.0, 5.0);
      EXPECT_NEAR(rad_to_deg(state.sectors[0].to), -60.0, 5.0);
    }
  }
}

TEST(OwnBody, ARobotThatIsNotInItsViewHasNoSectors) {
  for (const std::uint64_t seed : {44u, 45u, 46u}) {
    const Log log = flat(seed, 500);
    OwnBody own_body;
    OwnBodyState state;
    for (const Scan& scan : log.scans) own_body.add(scan, state);
    EXPECT_TRUE(state.decided) << seed;
    EXPECT_TRUE(state.sectors.empty()) << format_sectors(state.sectors);
  }
}

TEST(OwnBody, AtRestNothingIsTold) {
  Log log = flat(47, 1);
  OwnBody own_body;
  OwnBodyState state;
  for (int i = 0; i < 300; ++i) EXPECT_FALSE(own_body.add(log.scans[0], state));
  EXPECT_FALSE(state.decided);
  EXPECT_EQ(state.pairs, 0u);
}

}  // namespace
}  // namespace phasescan::dirty_scans_test
