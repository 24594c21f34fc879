#include "match/paper_engine.hpp"

#include "match/stage_clock.hpp"
#include "phasescan/refine/icp.hpp"
#include "phasescan/scan/points.hpp"

namespace phasescan {
namespace {

struct PaperReference final : Reference::Data {
  using Data::Data;
  ScanPoints points;
  PointIndex index;
};

class PaperEngine final : public MatchEngine {
 public:
  explicit PaperEngine(const MatchOptions& options)
      : options_(options), icp_(options.icp), own_(std::make_shared<PaperReference>(options.match.method)) {}

  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints) override {
    MatchTimes ms;
    prepare_into(reference, hints.reference_twist, *own_, ms);
    return match_prepared(*own_, scan, hints, ms);
  }

  std::shared_ptr<const Reference::Data> prepare(const Scan& reference, const Twist2& twist) override {
    MatchTimes ms;
    auto data = std::make_shared<PaperReference>(options_.match.method);
    prepare_into(reference, twist, *data, ms);
    return data;
  }

  MatchResult match(const Reference::Data& reference, const Scan& scan, const MatchHints& hints) override {
    return match_prepared(static_cast<const PaperReference&>(reference), scan, hints, {});
  }

 private:
  void prepare_into(const Scan& reference, const Twist2& twist, PaperReference& data, MatchTimes& ms) {
    StageClock clock;
    scan_to_points(reference, data.points, 0.0, twist);
    clock.add_to(ms.image);
    data.index.build(data.points);
    clock.add_to(ms.refine);
  }

  MatchResult match_prepared(const PaperReference& reference, const Scan& scan, const MatchHints& hints, const MatchTimes& ms) {
    MatchResult result;
    result.ms = ms;
    result.T_ref_scan = hints.guess.value_or(Pose2{});
    result.rotation_source = hints.guess ? RotationSource::kGuess : RotationSource::kNone;
    StageClock clock;
    scan_to_points(scan, points_, 0.0, hints.scan_twist);
    clock.add_to(result.ms.image);
    const auto least = static_cast<std::size_t>(options_.match.min_points);
    if (reference.points.size() < least || points_.size() < least) return result;

    const IcpResult refined =
        icp_.align(reference.index, points_, result.T_ref_scan, hints.guess ? 0.0 : options_.icp.gate_start_m);
    clock.add_to(result.ms.refine);
    result.T_ref_scan = refined.T_ref_scan;
    result.iterations = refined.iterations;
    result.overlap = refined.overlap;
    result.status = !refined.converged                               ? MatchStatus::kNotConverged
                    : refined.overlap < options_.icp.min_overlap ? MatchStatus::kLowOverlap
                                                                 : MatchStatus::kConverged;
    result.usable = result.status == MatchStatus::kConverged;
    return result;
  }

  MatchOptions options_;
  Icp icp_;
  std::shared_ptr<PaperReference> own_;
  ScanPoints points_;
};

}  // namespace

std::unique_ptr<MatchEngine> make_paper_engine(const MatchOptions& options) {
  return std::make_unique<PaperEngine>(options);
}

}  // namespace phasescan
