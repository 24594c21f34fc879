// PoseEvidence against a plain version of the same definition, and what it must say in plain cases.
#include "match/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/fast_math.hpp"
#include "support/prepared.hpp"
#include "support/rooms.hpp"

namespace phasescan::evidence_test {
namespace {

using test::prepared;

// What `other` says of every hit of `mine`, one hit at a time.
void plain_one_way(const PreparedScan& other, const PreparedScan& mine, const Pose2& T, float slack,
                   PoseEvidence& sum) {
  const SurfacePoints& ref = other.surface;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const SurfacePoint& from = mine.surface[i];
    const float sigma = mine.surface.sigma[i];
    const Eigen::Vector2d q = T * Eigen::Vector2d(static_cast<double>(from.x), static_cast<double>(from.y));
    const Eigen::Vector2d n =
        T.rotation() * Eigen::Vector2d(static_cast<double>(from.nx), static_cast<double>(from.ny));
    const auto qx = static_cast<float>(q.x()), qy = static_cast<float>(q.y());
    double match = 0.0;
    if (const int near = other.nearest.nearest(qx, qy); near >= 0) {
      std::size_t index = static_cast<std::size_t>(std::max(near - 2, 0));
      float best = 1e9F;
      for (int k = near - 2; k <= near + 2; ++k) {
        const auto at = static_cast<std::size_t>(std::clamp(k, 0, static_cast<int>(ref.size()) - 1));
        const float d = std::hypot(ref[at].x - qx, ref[at].y - qy);
        if (d < best) {
          best = d;
          index = at;
        }
      }
      const SurfacePoint& to = ref[index];
      double across = static_cast<double>(best) * static_cast<double>(best), agree = 0.6;
      if (from.has_normal() && to.has_normal()) {
        const double cosine = n.x() * static_cast<double>(to.nx) + n.y() * static_cast<double>(to.ny);
        agree = std::clamp((cosine - 0.4) * 2.0, 0.0, 1.0);
        const float dx = qx - to.line_x, dy = qy - to.line_y;
        const float d = dx * to.nx + dy * to.ny;
        const float along = std::max(0.0F, std::abs(dy * to.nx - dx * to.ny) - 0.5F * (to.length + from.length));
        across = static_cast<double>(d * d + along * along);
      }
      const float noise = sigma * sigma + ref.sigma[index] * ref.sigma[index] + slack * slack;
      match = agree * std::max(0.0, 1.0 - across / (9.0 * static_cast<double>(noise)));
    }
    sum.matched += match;
    const double rest = 1.0 - match;
    const auto bins = static_cast<float>(other.bearings.size());
    const auto bin = std::min(static_cast<std::size_t>(direction_turns(qx, qy) * bins), other.bearings.size() - 1);
    const float r = std::hypot(qx, qy), margin = 3.0F * std::max(sigma, ref.noise.sigma(r)) + slack;
    const float low = other.bearings.near_range[bin], high = other.bearings.far_range[bin];
    double* kind = &sum.stray;
    if (match < 0.8 && high > 0.0F && r < low - margin) kind = &sum.violation;
    if (match < 0.8 && high > 0.0F && r > high + margin) kind = &sum.occluded;
    if (match < 0.8 && high <= 0.0F) kind = r < other.bearings.empty_to[bin] ? &sum.empty : &sum.silent;
    *kind += rest;
  }
  sum.hits += static_cast<int>(mine.size());
}

TEST(Evidence, IsWhatAPlainLoopSays) {
  const PreparedScan reference = prepared(test::cast_room({}, 360, 0.01, 0.05, 1, 3.0));
  const PreparedScan scan = prepared(test::cast_room({0.4, 0.2, 0.5}, 360, 0.01, 0.05, 2, 3.0));
  Random random(9);
  for (int k = 0; k < 30; ++k) {
    const Pose2 pose{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-kPi, kPi)};
    PoseEvidence plain;
    plain_one_way(reference, scan, pose, 0.03F, plain);
    plain_one_way(scan, reference, pose.inverse(), 0.03F, plain);
    const PoseEvidence fast = weigh_evidence(reference, scan, reference.all, scan.all, pose, 0.03);
    EXPECT_EQ(fast.hits, plain.hits);
    // A hit on the edge of two cells or bins may fall to either side.
    const double tolerance = 3.0;
    EXPECT_NEAR(fast.matched, plain.matched, tolerance);
    EXPECT_NEAR(fast.violation, plain.violation, tolerance);
    EXPECT_NEAR(fast.occluded, plain.occluded, tolerance);
    EXPECT_NEAR(fast.empty, plain.empty, tolerance);
    EXPECT_NEAR(fast.stray, plain.stray, tolerance);
    EXPECT_NEAR(fast.silent, plain.silent, tolerance);
  }
}

TEST(Evidence, TheTruePoseBeatsWrongOnes) {
  const Pose2 truth{0.4, 0.2, 0.5};
  const PreparedScan reference = prepared(test::cast_room({}, 360, 0.01)),
                     scan = prepared(test::cast_room(truth, 360, 0.01, 0.0, 2));
  const EvidenceWeights weights;
  const double right = weigh_evidence(reference, scan, reference.all, scan.all, truth, 0.01).score(weights);
  EXPECT_GT(right, 0.7);
  for (const Pose2& wrong : {Pose2{0.7, 0.2, 0.5}, Pose2{0.4, 0.2, 0.7}, Pose2{0.4, 0.2, 0.5 + kPi}}) {
    EXPECT_LT(weigh_evidence(reference, scan, reference.all, scan.all, wrong, 0.01).score(weights), right - 0.2);
  }
}

}  // namespace
}  // namespace phasescan::evidence_test
