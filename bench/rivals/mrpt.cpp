// The Mobile Robot Programming Toolkit's ICP of two point maps.
#include <fmt/format.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/poses/CPosePDF.h>
#include <mrpt/slam/CICP.h>
#include <mrpt/system/os.h>

#include <memory>
#include <numbers>

#include "contender.hpp"
#include "scan/points.hpp"

namespace phasescan::rivals {
namespace {

constexpr double kGate_m = 2.0;
constexpr double kLastGate_m = 0.05;

void fill(const Scan& scan, mrpt::maps::CSimplePointsMap& map) {
  ScanPoints points;
  scan_to_points(scan, points);
  const std::vector<float> z(points.size(), 0.0F);
  map.setAllPoints(points.x, points.y, z);
}

class Icp {
 public:
  explicit Icp(int starts) : starts_(starts) {
    auto& options = engine_.options;
    options.maxIterations = kIterations;
    options.thresholdDist = kGate_m;
    options.smallestThresholdDist = kLastGate_m;
    options.corresponding_points_decimation = 1;
    options.skip_cov_calculation = true;
  }

  Pose2 match(const Scan& reference, const Scan& scan) {
    fill(reference, reference_);
    fill(scan, scan_);
    if (reference_.empty() || scan_.empty()) return {};
    Pose2 best;
    double best_goodness = -1.0;
    for (int k = 0; k < starts_; ++k) {
      mrpt::slam::CICP::TReturnInfo info;
      const double heading = 2.0 * std::numbers::pi * k / starts_;
      const auto found = engine_.Align(&reference_, &scan_, mrpt::poses::CPose2D(0.0, 0.0, wrap_angle(heading)), info);
      if (info.goodness <= best_goodness) continue;
      best_goodness = info.goodness;
      const mrpt::poses::CPose2D pose = found->getMeanVal();
      best = {pose.x(), pose.y(), wrap_angle(pose.phi())};
    }
    return best;
  }

 private:
  int starts_;
  mrpt::slam::CICP engine_;
  mrpt::maps::CSimplePointsMap reference_, scan_;
};

Contender icp(const std::string& name, const std::string& start, int starts) {
  auto engine = std::make_shared<Icp>(starts);
  return {name,
          fmt::format("CICP of {}: icpClassic, threshold {} m, halved at each convergence down to {} m, {} iterations "
                      "at most, every point; {}",
                      mrpt::system::MRPT_getVersion(), kGate_m, kLastGate_m, kIterations, start),
          [engine](const Scan& reference, const Scan& scan) { return engine->match(reference, scan); }};
}

}  // namespace

std::vector<Contender> mrpt_contenders() {
  return {icp("MRPT CICP", "one start", 1),
          icp("MRPT CICP, 12 starts", "12 start headings 30 degrees apart, the answer of the best goodness", 12)};
}

}  // namespace phasescan::rivals
