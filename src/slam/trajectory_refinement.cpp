#include "slam/trajectory_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/motion.hpp"
#include "odometry/registration.hpp"
#include "odometry/scan_clock.hpp"
#include "scan/surface.hpp"
#include "slam/scan_ledger.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMaxKeyframes = 24;                  // that make the map of what is around one
constexpr double kLeastPeriods = 0.3, kMostPeriods = 3.0;  // between two scans that tell of the motion during a turn
constexpr double kGateM = 0.2;                             // [m] distance at which points find partners at first

/// Motion of the base during a scan's turn: from the way to the next scan, or from the one before where beams are
/// listed last to first; zero where the times between them tell nothing. Messages that repeat another are no scans of
/// their own, and neither are scans that were left out.
/// @param before  the last scan that was neither
Twist2 turn_twist(const ScanLedger& ledger, std::span<const Pose2> guess, std::size_t scan, std::size_t before,
                  double time_increment, const ScanTiming& timing) {
  const std::vector<ScanRecord>& records = ledger.records;
  std::size_t from = scan, to = scan;
  if (time_increment < 0.0) {
    from = before;
  } else {
    do ++to;
    while (to < records.size() && (records[to].repeated || records[to].left_out));
  }
  if (timing.duration_s <= 0.0 || timing.period_s <= 0.0 || to >= records.size()) return {};
  if (ledger.session_of(from) != ledger.session_of(to)) return {};
  const double step_s = stamp_to_seconds(records[to].stamp - records[from].stamp);
  if (step_s <= kLeastPeriods * timing.period_s || step_s >= kMostPeriods * timing.period_s) return {};
  return mean_twist(guess[from].inverse() * guess[to], step_s);
}

/// How well a pose is known before it is refined, and by how much less than what it may be moved [m], [rad].
struct PoseBefore {
  double sigma_m, sigma_rad, most_move_m, most_move_rad;
};
constexpr PoseBefore kTracked{0.03, 0.01, 0.15, 0.06};
// Of a scan that was lost and led back: the scan after it may be a little off as well.
constexpr PoseBefore kLedBack{0.1, 0.1, 0.3, 0.2};

/// The pose near `T_map_base` that lays the points on the map; the same where the match fails or moves it far.
Pose2 refine_pose(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base, const PoseBefore& known,
                  double min_overlap, RefinementFit& fit) {
  PosePrior prior;
  prior.T_map_base = map.T_world_map().inverse() * T_map_base;
  const double per_m2 = 1.0 / (known.sigma_m * known.sigma_m);
  prior.information.diagonal() << per_m2, per_m2, 1.0 / (known.sigma_rad * known.sigma_rad);
  RegistrationOptions fine;
  fine.gate_start_m = kGateM;
  const Registration found = register_points(map, points, prior.T_map_base, fine, prior);
  const Pose2 moved = prior.T_map_base.inverse() * found.T_map_base;
  ++fit.scans;
  fit.overlap_sum += found.overlap;
  if (found.overlap < min_overlap || std::hypot(moved.x, moved.y) > known.most_move_m ||
      std::abs(moved.theta) > known.most_move_rad)
    return ++fit.kept, T_map_base;
  return map.T_world_map() * found.T_map_base;
}

/// Scans that were left out move as the one before them did; one that repeats another stands where that does.
void place_others(std::span<const ScanRecord> records, std::span<const Pose2> guess, std::vector<Pose2>& out) {
  for (std::size_t i = 1; i < records.size(); ++i) {
    if (records[i].repeated && records[i].keyframe >= 0) {
      out[i] = out[i - 1];
    } else if (records[i].left_out) {
      out[i] = out[i - 1] * (guess[i - 1].inverse() * guess[i]);
    }
  }
}

/// Matches scans against the map of what is around a keyframe. Made anew where that changes.
class ScanRefiner {
 public:
  ScanRefiner(const Backend& backend, const ScanStore& scans, const OdometryOptions& options)
      : backend_(backend), scans_(scans), options_(options) {}

  Pose2 refine(std::size_t index, const Scan& scan, int keyframe, const Twist2& twist, const Pose2& T_map_base,
               const PoseBefore& known, RefinementFit& fit) {
    if (keyframe != built_for_) {
      built_for_ = keyframe;
      backend_.build_surroundings(built_for_, kMaxKeyframes, map_);
    }
    const Pose2& T_base_laser = scans_.T_base_laser(index);
    find_surface(scan, twist_of_frame(T_base_laser, twist), work_, surface_, kTrackingLines);
    to_map_points(surface_, T_base_laser, options_.map_range_m, points_);
    return refine_pose(map_, points_, T_map_base, known, options_.min_overlap, fit);
  }

 private:
  const Backend& backend_;
  const ScanStore& scans_;
  const OdometryOptions& options_;
  int built_for_ = -1;
  LocalMap map_;
  SurfaceWorkspace work_;
  SurfacePoints surface_;
  MapPoints points_;
};

/// Pose of the base with a scan, seen from that with another one, by the match without a guess.
std::optional<Pose2> match_bases(const ScanStore& scans, ScanMatcher& matcher, std::size_t reference,
                                 std::size_t scan) {
  const MatchResult match = matcher.match(scans.scan(reference), scans.scan(scan));
  if (!match.usable) return std::nullopt;
  return scans.T_base_laser(reference) * match.T_ref_scan * scans.T_base_laser(scan).inverse();
}

bool tells_motion(const ScanRecord& record) {
  return !record.repeated && !record.left_out;
}

/// Scans that were lost before tracking found its way again: where the match with the scan after them puts them, or the
/// way back from there, and the map agrees.
/// Another piece of the map has no way back.
/// @param placed  whether a scan's pose is to be relied on
void place_lost_scans(const ScanStore& scans, const ScanLedger& ledger, const MapPieces& pieces,
                      const MatchOptions& match, std::vector<char>& placed, ScanRefiner& refiner,
                      std::vector<Pose2>& out) {
  std::optional<ScanMatcher> matcher;  // most runs lose no scan
  const auto piece = [&](std::size_t scan) {
    return pieces.of_node[static_cast<std::size_t>(ledger.records[scan].keyframe)];
  };
  const std::vector<ScanRecord>& records = ledger.records;
  std::size_t next = records.size(), after = records.size();
  for (std::size_t i = records.size(); i-- > 0;) {
    if (!tells_motion(records[i]) || records[i].keyframe < 0) continue;
    const bool leads_back = next < records.size() && placed[next] && ledger.session_of(i) == ledger.session_of(next) &&
                            piece(i) == piece(next);
    if (!placed[i] && leads_back) {
      Pose2 step;
      if (after < records.size() && placed[after]) step = out[next].inverse() * out[after];
      if (!matcher) matcher.emplace(match);
      const Pose2 back = match_bases(scans, *matcher, next, i).value_or(step.inverse());
      RefinementFit fit;
      const Pose2 found = refiner.refine(i, scans.scan(i), records[next].keyframe, {}, out[next] * back, kLedBack, fit);
      if (fit.kept == 0) out[i] = found, placed[i] = 1;
    }
    after = next, next = i;
  }
}

}  // namespace

std::vector<Pose2> refine_trajectory(const Backend& backend, const ScanStore& scans, std::span<const Pose2> guess,
                                     const ScanLedger& ledger, const OdometryOptions& options,
                                     const MatchOptions& match, RefinementFit* fit) {
  const std::vector<ScanRecord>& records = ledger.records;
  std::vector<Pose2> out(guess.begin(), guess.end());
  ScanRefiner refiner(backend, scans, options);
  ScanClock clock;
  RefinementFit counts;
  std::vector<char> placed(records.size(), 0);
  std::size_t before = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Scan scan = scans.scan(i);
    const ScanTiming timing = clock.add(scan);
    if (records[i].keyframe < 0 || !tells_motion(records[i])) continue;
    Twist2 twist;
    if (options.deskew) twist = turn_twist(ledger, guess, i, before, scan.time_increment, timing);
    before = i;
    out[i] = refiner.refine(i, scan, records[i].keyframe, twist, guess[i], kTracked, counts);
    placed[i] = is_tracked(records[i].status);  // what was lost may fit the map anywhere
  }
  place_lost_scans(scans, ledger, backend.pieces(), match, placed, refiner, out);
  place_others(records, guess, out);
  if (fit != nullptr) *fit = counts;
  return out;
}

}  // namespace phasescan
