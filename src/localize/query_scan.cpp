#include "localize/query_scan.hpp"

#include <algorithm>
#include <cmath>

#include "core/motion.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kSparse = 64, kJudged = 120;
constexpr std::size_t kLeastOnLines = 12, kLeastDirections = 16;
// Beside the range noise: beams are wide and point a little beside where they say [rad].
constexpr float kDirectionSigma = 0.004F;

MapPoints sparse_of(const MapPoints& points) {
  MapPoints out;
  const std::size_t stride = std::max<std::size_t>(1, points.with_normal / kSparse);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.lone(i)) continue;
    if (seen++ % stride == 0) out.append(points, i);
  }
  return out;
}

JudgedBeams judged_of(const MapPoints& points, const SurfacePoints& surface, const Pose2& T_base_laser, double most) {
  JudgedBeams beams;
  beams.origin_x = static_cast<float>(T_base_laser.x), beams.origin_y = static_cast<float>(T_base_laser.y);
  const std::size_t n = points.size(), count = std::min(n, kJudged);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * n / count;
    const float dx = points.x[i] - beams.origin_x, dy = points.y[i] - beams.origin_y;
    const float range = std::sqrt(dx * dx + dy * dy);
    if (!(range > 0.0F) || static_cast<double>(range) > most) continue;
    const float across = kDirectionSigma * range, sigma = surface.noise.sigma(range);
    beams.x.push_back(points.x[i]);
    beams.y.push_back(points.y[i]);
    beams.dx.push_back(dx / range);
    beams.dy.push_back(dy / range);
    beams.range.push_back(range);
    beams.variance.push_back(sigma * sigma + across * across);
  }
  return beams;
}

}  // namespace

bool QueryScan::usable() const {
  return points.with_normal >= kLeastOnLines && view.known_count >= kLeastDirections;
}

QueryScan prepare_query(const RangeMeasurement& measurement, const Twist2& twist_base, double most_range_m,
                        bool with_view, QueryWorkspace& work) {
  QueryScan query;
  query.T_base_laser = measurement.T_base_laser;
  find_surface(measurement.scan, twist_of_frame(measurement.T_base_laser, twist_base), work.surface_work, work.surface,
               kTrackingLines);
  to_map_points(work.surface, measurement.T_base_laser, most_range_m, query.points);
  std::fill(query.points.free_standing.begin(), query.points.free_standing.end(), std::uint8_t{0});
  query.beams = judged_of(query.points, work.surface, measurement.T_base_laser, most_range_m);
  query.sparse = sparse_of(query.points);
  if (with_view) query.view = view_of(measurement.scan);
  return query;
}

}  // namespace phasescan
