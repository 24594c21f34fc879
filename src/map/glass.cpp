#include "map/glass.hpp"

#include <algorithm>
#include <cmath>

#include "map/glass_candidates.hpp"
#include "map/glass_evidence.hpp"
#include "map/view_rays.hpp"

namespace phasescan {
namespace {

constexpr double kSameM = 0.15;      // two panes nearer to each other than this are one
constexpr double kLeastOpenM = 0.1;  // a cell that the robot stood in is free, whatever is asked for

double distance(const Eigen::Vector2d& p, const GlassPane& pane) {
  const Eigen::Vector2d d = pane.b - pane.a;
  const double t = std::clamp((p - pane.a).dot(d) / std::max(1e-12, d.squaredNorm()), 0.0, 1.0);
  return (pane.a + t * d - p).norm();
}

/// Whether most of the shorter one lies on the other.
bool same(const GlassPane& a, const GlassPane& b) {
  const GlassPane &shorter = a.length() < b.length() ? a : b, &longer = a.length() < b.length() ? b : a;
  int near = 0;
  for (int k = 0; k <= 10; ++k) near += distance(shorter.a + 0.1 * k * (shorter.b - shorter.a), longer) < kSameM;
  return near > 5;
}

}  // namespace

std::vector<GlassPane> find_glass(std::size_t count, const std::function<PlacedScan(std::size_t)>& scan_of,
                                  const OccupancyGrid& grid, const GlassOptions& options) {
  GlassCandidates candidates(options);
  double farthest = 0.0, step_rad = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const PlacedScan view = scan_of(k);
    farthest = std::max(farthest, view.scan.effective_range_max());
    candidates.add(view_rays(view, &step_rad), step_rad);
  }
  std::vector<GlassEvidence> evidence;
  for (const GlassCandidate& candidate : candidates.take()) evidence.emplace_back(candidate, options);
  if (evidence.empty()) return {};
  for (std::size_t k = 0; k < count; ++k) {
    const PlacedScan view = scan_of(k);
    const double stated = view.scan.geometry.range_max, range_max = stated > 0.0 ? stated : farthest;
    const std::vector<ViewRay> rays = view_rays(view, &step_rad);
    for (GlassEvidence& e : evidence) e.add(rays, range_max, grid);
  }
  std::vector<GlassPane> panes;
  for (const GlassEvidence& e : evidence) {
    for (const GlassPane& pane : e.panes()) {
      const auto twin = std::find_if(panes.begin(), panes.end(), [&](const GlassPane& p) { return same(p, pane); });
      if (twin == panes.end())
        panes.push_back(pane);
      else if (pane.views > twin->views)
        *twin = pane;
    }
  }
  return panes;
}

std::vector<GlassPane> cut_where_driven(std::vector<GlassPane> panes, std::span<const Pose2> way, double keep_open_m,
                                        double min_length_m) {
  const double open = std::max(keep_open_m, kLeastOpenM);
  std::vector<GlassPane> out;
  for (const GlassPane& pane : panes) {
    const double length = pane.length();
    if (length <= 0.0) continue;
    const Eigen::Vector2d along = (pane.b - pane.a) / length, normal(-along.y(), along.x());
    std::vector<std::pair<double, double>> cuts;
    for (std::size_t i = 0; i < way.size(); ++i) {
      const Eigen::Vector2d p = way[i].translation() - pane.a;
      const double off = normal.dot(p), place = along.dot(p);
      if (std::abs(off) < kLeastOpenM && place > -open && place < length + open)
        cuts.emplace_back(place - open, place + open);
      if (i == 0) continue;
      const Eigen::Vector2d q = way[i - 1].translation() - pane.a;
      const double before = normal.dot(q);
      if (before * off >= 0.0) continue;
      const double crossing = along.dot(q) + (place - along.dot(q)) * before / (before - off);
      cuts.emplace_back(crossing - open, crossing + open);
    }
    std::sort(cuts.begin(), cuts.end());
    double from = 0.0;
    const auto keep = [&](double low, double high) {
      if (high - low < min_length_m) return;
      GlassPane piece = pane;
      piece.a = pane.a + low * along;
      piece.b = pane.a + high * along;
      out.push_back(piece);
    };
    for (const auto& [low, high] : cuts) {
      if (low > length) break;
      if (low > from) keep(from, low);
      from = std::max(from, high);
    }
    if (from < length) keep(from, length);
  }
  return out;
}

std::vector<std::size_t> cells_of(const TrinaryMap& map, const GlassPane& pane) {
  std::vector<std::size_t> cells;
  const int steps = std::max(1, static_cast<int>(std::ceil(4.0 * pane.length() / map.resolution_m)));
  for (int s = 0; s <= steps; ++s) {
    const Eigen::Vector2d p = map.origin.inverse() * (pane.a + (pane.b - pane.a) * s / steps);
    const int i = static_cast<int>(std::floor(p.x() / map.resolution_m)),
              k = static_cast<int>(std::floor(p.y() / map.resolution_m));
    if (i < 0 || k < 0 || i >= map.width || k >= map.height) continue;
    cells.push_back(static_cast<std::size_t>(k) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(i));
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

}  // namespace phasescan
