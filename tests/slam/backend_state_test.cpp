// A back end that is stopped after any batch and goes on from its state gives the same bytes as one that never stopped.
#include <gtest/gtest.h>

#include "slam/backend.hpp"
#include "slam/state_types.hpp"
#include "support/state_bytes.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::backend_state_test {
namespace {

using testing::to_bytes;
using testing::toy_keyframes;
using testing::toy_tour;
using testing::two_rooms;

constexpr std::size_t kBatch = 10;

std::vector<Keyframe> batch_at(const std::vector<Keyframe>& keyframes, std::size_t from) {
  const auto begin = keyframes.begin() + static_cast<std::ptrdiff_t>(from);
  return {begin, begin + static_cast<std::ptrdiff_t>(std::min(kBatch, keyframes.size() - from))};
}

/// Stops and resumes after every `every`-th batch; 0: never.
BackendState map_of(const SlamOptions& options, const std::vector<Keyframe>& keyframes, std::size_t every,
                    bool finish) {
  auto backend = std::make_unique<Backend>(options);
  std::size_t batches = 0;
  for (std::size_t from = 0; from < keyframes.size(); from += kBatch) {
    backend->add_batch(batch_at(keyframes, from));
    if (every > 0 && ++batches % every == 0) backend = std::make_unique<Backend>(options, backend->state());
  }
  if (finish) backend->finish();
  return backend->state();
}

void expect_that_stopping_changes_nothing(const SlamOptions& options, const std::vector<Keyframe>& keyframes) {
  for (const bool finish : {false, true}) {
    const std::string never = to_bytes(map_of(options, keyframes, 0, finish));
    EXPECT_TRUE(never == to_bytes(map_of(options, keyframes, 1, finish))) << finish;
    EXPECT_TRUE(never == to_bytes(map_of(options, keyframes, 3, finish))) << finish;
  }
}

/// Odometry that turns too far, slips where 0.6 of the way is done, and breaks where 0.8 is.
std::vector<Keyframe> hard_drive(int laps, double bias, const Pose2& slip, bool breaks) {
  const auto tour = toy_tour(0.5, 0.4, 0.5, laps);
  std::vector<Pose2> odometry = {tour[0]};
  for (std::size_t i = 1; i < tour.size(); ++i) {
    const Pose2 step = tour[i - 1].inverse() * tour[i];
    const Pose2 slipped = i == tour.size() * 6 / 10 ? slip : Pose2{};
    odometry.push_back(odometry.back() * slipped * step * Pose2{0.0, 0.0, bias * std::hypot(step.x, step.y)});
  }
  Random random(6);
  auto keyframes = toy_keyframes(two_rooms(), tour, random, {}, [&](std::size_t i) { return odometry[i]; });
  if (breaks) keyframes[tour.size() * 8 / 10].new_segment = true;
  return keyframes;
}

TEST(BackendState, AppendingWithDriftLoopsAndABreak) {
  const auto keyframes = hard_drive(3, 0.01, {}, true);
  expect_that_stopping_changes_nothing({}, keyframes);
  const BackendState end = map_of({}, keyframes, 0, false);
  EXPECT_GT(end.loops.found, 10u);
  EXPECT_EQ(end.session.keyframes.size(), keyframes.size());
}

TEST(BackendState, BoundedWithASlipWhoseKeyframesWait) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  for (const Pose2& slip : {Pose2{1.5, 0.0, 0.0}, Pose2{-0.4, 0.3, 0.1}}) {
    const auto keyframes = hard_drive(4, 0.0, slip, false);
    expect_that_stopping_changes_nothing(options, keyframes);
  }
  // The law is worth something only where keyframes wait while a batch ends.
  bool waited = false;
  const auto keyframes = hard_drive(4, 0.0, {1.5, 0.0, 0.0}, false);
  Backend backend(options);
  for (std::size_t from = 0; from < keyframes.size(); from += kBatch) {
    backend.add_batch(batch_at(keyframes, from));
    waited = waited || !backend.state().admission.waiting.empty();
  }
  EXPECT_TRUE(waited);
}

TEST(BackendState, EachPartOfItIsNeeded) {
  // Taking one part away must show, else nothing above says that it is saved.
  const auto keyframes = hard_drive(3, 0.01, {}, true);
  const std::size_t half = keyframes.size() / 2 / kBatch * kBatch;
  Backend first({});
  for (std::size_t from = 0; from < half; from += kBatch) first.add_batch(batch_at(keyframes, from));
  const auto rest = [&](BackendState state) {
    Backend backend({}, std::move(state));
    for (std::size_t from = half; from < keyframes.size(); from += kBatch) backend.add_batch(batch_at(keyframes, from));
    return to_bytes(backend.state());
  };
  const std::string all = rest(first.state());
  BackendState no_loops = first.state(), no_places = first.state(), another_time = first.state();
  no_loops.loops = {};
  no_places.places = {};
  another_time.session.nodes_at_optimize -= 30;
  EXPECT_FALSE(rest(no_loops) == all);
  EXPECT_FALSE(rest(no_places) == all);
  EXPECT_FALSE(rest(another_time) == all);
}

TEST(BackendState, PiecesAreThoseOfTheGraphAfterEachBatch) {
  // Kept step by step, and found anew from nodes and edges by a back end that resumes.
  auto keyframes = hard_drive(3, 0.01, {}, true);
  keyframes[20].new_segment = keyframes[45].new_segment = true;
  SlamOptions options;
  options.loops.undo_chi2 = 1e-3;  // nearly all loops are undone when the graph is optimised
  Backend backend(options);
  int most = 0;
  for (std::size_t from = 0; from < keyframes.size(); from += kBatch) {
    backend.add_batch(batch_at(keyframes, from));
    EXPECT_EQ(Backend(options, backend.state()).pieces().of_node, backend.pieces().of_node) << from;
    most = std::max(most, backend.pieces().count);
  }
  EXPECT_GT(most, 1);
  EXPECT_GT(backend.loop_counts().undone, 0u);
}

}  // namespace
}  // namespace phasescan::backend_state_test
