/// Poses that a robot on a map may have, and what speaks for each.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "localize/global_search.hpp"

namespace phasescan {

/// One of them. Frame "grid" as in MapGrid.
struct Hypothesis {
  Pose2 T_grid_odom;
  FoundPose at;         ///< with the last scan
  double weight = 0.0;  ///< log-likelihood of what was seen so far
  /// Of log-likelihood, how far it is ahead of a place that the map has not, which explains about half of most scans.
  double ahead_of_none = 0.0;
  int views = 0;  ///< since it was found
};

/// What odometry says of a pose: of nothing, where the robot's place was not known or odometry broke since.
enum class Led { kUnknown, kThere, kElsewhere };

/// What a view says for a pose against a place that the map has not: below 0 where the map explains too little of it.
/// @param usual  share explained of late, which counts where odometry leads
double evidence_of_view(const MapFit& fit, Led led, double usual = 0.0);

/// Log-likelihood of a scan at a pose that odometry leads to: what lies where the map knows nothing does not speak
/// against it.
double log_likelihood_where_led(const MapFit& fit);
/// Share of the hits explained, of those that lie where the map knows something.
double explained_of_known(const MapFit& fit);

/// How far a pose that a search found is ahead of none. The confidence is fitted on single looks: a place that the map
/// has not may look like one that it has, and many looks find a place that explains a scan by chance. Views of the way
/// must confirm it, those before the search too. What odometry leads to is more than chance; what it contradicts, less.
inline constexpr double kFoundFirst = 34.0, kFoundAgain = 10.0, kFoundWhereLed = 52.0, kFoundElsewhere = 10.0;
inline constexpr int kFirstLooks = 1;
/// What was followed over two metres and is found again by a search is no less sure than this.
inline constexpr double kFoundWhereFollowed = 34.0;
inline constexpr int kFollowedViews = 8;

/// Where a pose that was ok is now by odometry alone, which did not break since.
struct KnownPlace {
  Pose2 T_grid_odom;
  double way_m = 0.0;  ///< since then
};

/// Hypotheses best first, and how far the best is ahead where it is alone.
struct HypothesisSet {
  std::vector<Hypothesis> all;
  double margin_alone = 0.0;
  std::optional<KnownPlace> known;
  double usual_explained = 0.7;
  int looks = 0;  ///< searches since nothing was known, or since odometry broke

  /// Odometry broke: the robot may be anywhere.
  void forget_way();

  bool empty() const { return all.empty(); }
  /// Of the best to the next, and to a place that the map has not.
  double margin() const;
  /// Replaces all by what a search found.
  /// @param keep_gap  of log-likelihood, to the best
  void restart(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap, std::size_t most);
  /// Adds what a search found and is not known, as if it had explained the past as well as the best.
  void merge(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap, std::size_t most);
  /// A search finds what is followed, as its best.
  void find_again(const FoundPose& pose, const Pose2& T_odom_base, Hypothesis& known_one) const;
  /// A new view, matched: `at` and `weight` are those with it.
  void see(const Pose2& T_odom_base, double least_margin);
  double found_ahead(const FoundPose& pose, Led led) const;
  double log_likelihood(const FoundPose& pose, const Pose2& T_odom_base) const;
  Led led(const Pose2& T_grid_base, const Pose2& T_odom_base) const;
  /// Orders them, joins those that came to one pose, and drops those far behind.
  void prune(double keep_gap, std::size_t most);
};

}  // namespace phasescan
