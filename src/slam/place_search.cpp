#include "slam/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "phasescan/match/scan_matcher.hpp"
#include "scan/points.hpp"
#include "slam/place_check.hpp"
#include "slam/place_index.hpp"

namespace phasescan {
namespace {

constexpr int kBeams = 360;
constexpr int kViewNodes = 6;        // keyframes before it that a view is made of as well
constexpr int kEvery = 2;            // keyframes to a view
constexpr int kVisitViews = 10;      // views nearer to each other than this are one visit
constexpr std::size_t kLooked = 12;  // descriptors looked at for candidates
constexpr double kMostSigmaM = 0.1;  // of a pose that counts as known in both directions
// Squared distance of descriptors beyond which they are of different places.
constexpr auto kMostDistance = static_cast<std::uint32_t>(1.0 * kDescriptorLength * kDescriptorLength);

double most_sigma(const Eigen::Matrix3d& covariance) {
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(0.5 * (covariance(0, 0) + covariance(1, 1)) + std::hypot(half, covariance(0, 1)));
}

}  // namespace

Scan view_at(std::span<const Keyframe> keyframes, std::span<const Pose2> poses, int node, int back) {
  std::vector<float> nearest(kBeams, 0.0F);
  MapPoints points;
  const Pose2 T_node_world = poses[static_cast<std::size_t>(node)].inverse();
  for (int k = node; k >= std::max(0, node - back); --k) {
    const Keyframe& keyframe = keyframes[static_cast<std::size_t>(k)];
    const Pose2 T_node_k = T_node_world * poses[static_cast<std::size_t>(k)];
    const auto c = static_cast<float>(std::cos(T_node_k.theta)), s = static_cast<float>(std::sin(T_node_k.theta));
    const auto tx = static_cast<float>(T_node_k.x), ty = static_cast<float>(T_node_k.y);
    keyframe.points->unpack(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float x = c * points.x[i] - s * points.y[i] + tx, y = s * points.x[i] + c * points.y[i] + ty;
      const auto degrees = static_cast<int>(std::lround(rad_to_deg(std::atan2(y, x))));
      float& range = nearest[static_cast<std::size_t>((degrees + kBeams) % kBeams)];
      const float here = std::hypot(x, y);
      if (range == 0.0F || here < range) range = here;
    }
    if (keyframe.new_segment) break;
  }
  for (float& range : nearest) {
    // Nothing is known there; a beam that is too near to tell says nothing of what stands farther off either.
    if (range == 0.0F) range = -std::numeric_limits<float>::infinity();
  }
  return make_scan(nearest, {0.0, kTwoPi / kBeams, 0.0, 0.0});
}

struct PlaceSearch::Impl {
  LoopOptions options;
  PlaceSearchState state;
  PlaceDescriber describer;
  ScanMatcher matcher;
  ScanPoints points;

  PlaceDescriptor describe(const Scan& view) {
    scan_to_points(view, points);
    return describer.describe(points.x, points.y);
  }

  /// How many of the places are at the first `nodes` keyframes.
  std::size_t places_before(std::size_t nodes) const {
    const auto end = std::lower_bound(state.nodes.begin(), state.nodes.end(), static_cast<int>(nodes));
    return static_cast<std::size_t>(end - state.nodes.begin());
  }

  /// The first `limit` places that show what the view shows, by descriptor and match.
  std::vector<PlaceMatch> search(const Scan& view, const PlaceDescriptor& descriptor, std::size_t limit,
                                 std::span<const Keyframe> keyframes, std::span<const Pose2> poses) {
    std::vector<PlaceMatch> found;
    if (limit == 0) return found;
    std::vector<int> visits;
    for (const PlaceHit& hit : state.index.most_alike(descriptor, kLooked, limit)) {
      const int other = state.nodes[hit.place];
      if (visits.size() >= static_cast<std::size_t>(options.place_candidates)) break;
      if (hit.distance > kMostDistance) continue;
      if (std::any_of(visits.begin(), visits.end(), [&](int v) { return std::abs(v - other) < kVisitViews; })) continue;
      visits.push_back(other);
      ++state.matched;
      const MatchResult match = matcher.match(view_at(keyframes, poses, other, kViewNodes), view);
      if (is_same_place(match) && most_sigma(match.diagnostics.noise_covariance) < kMostSigmaM)
        found.push_back({other, match.T_ref_scan});
    }
    return found;
  }
};

PlaceSearch::PlaceSearch(const LoopOptions& options, const MatchOptions& match, PlaceSearchState state)
    : impl_(std::make_unique<Impl>()) {
  impl_->matcher = ScanMatcher(match);
  impl_->options = options;
  impl_->state = std::move(state);
}
PlaceSearch::~PlaceSearch() = default;
PlaceSearch::PlaceSearch(PlaceSearch&&) noexcept = default;

const PlaceSearchState& PlaceSearch::state() const {
  return impl_->state;
}

std::vector<PlaceMatch> PlaceSearch::add(std::span<const Keyframe> keyframes, std::span<const Pose2> poses,
                                         bool search) {
  Impl& m = *impl_;
  const int node = static_cast<int>(keyframes.size()) - 1;
  if (node < 0 || node % kEvery != 0) return {};
  const Scan view = view_at(keyframes, poses, node, kViewNodes);
  const PlaceDescriptor descriptor = m.describe(view);
  m.state.index.add(descriptor);
  m.state.nodes.push_back(node);
  if (!search) return {};
  const auto old = std::upper_bound(m.state.nodes.begin(), m.state.nodes.end(), node - m.options.min_nodes_apart);
  return m.search(view, descriptor, static_cast<std::size_t>(old - m.state.nodes.begin()), keyframes, poses);
}

std::vector<PlaceMatch> PlaceSearch::find_again(int node, std::span<const Keyframe> keyframes,
                                                std::span<const Pose2> poses, std::size_t nodes) {
  Impl& m = *impl_;
  if (node % kEvery != 0) return {};
  const Scan view = view_at(keyframes, poses, node, kViewNodes);
  return m.search(view, m.describe(view), m.places_before(nodes), keyframes, poses);
}

void PlaceSearch::append(const PlaceSearchState& other, int first_node) {
  PlaceSearchState& state = impl_->state;
  state.index.append(other.index);
  for (const int node : other.nodes) state.nodes.push_back(first_node + node);
  state.matched += other.matched;
}

std::vector<PlaceMatch> PlaceSearch::find(const Keyframe& query, std::span<const Keyframe> keyframes,
                                          std::span<const Pose2> poses, std::size_t nodes) {
  const Pose2 origin;
  const Scan view = view_at({&query, 1}, {&origin, 1}, 0, 0);
  return impl_->search(view, impl_->describe(view), impl_->places_before(nodes), keyframes, poses);
}

}  // namespace phasescan
