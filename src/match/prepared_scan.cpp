#include "phasescan/match/prepared_scan.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr double kLeastScale_m = 0.2, kFixedScale_m = 6.3;

// Picks about `count` hits so that equal lengths of surface lie between them: a near wall has many beams but no more to
// say.
void sample_evenly(const SurfacePoints& surface, int count, std::vector<int>& out) {
  out.clear();
  const std::size_t n = surface.size();
  if (n <= static_cast<std::size_t>(count)) {
    for (std::size_t i = 0; i < n; ++i) out.push_back(static_cast<int>(i));
    return;
  }
  const float most = 0.1F * static_cast<float>(surface.extent);
  const auto length = [&](std::size_t i) { return std::min(surface[i].length, most); };
  float total = 0.0F;
  for (std::size_t i = 0; i < n; ++i) total += length(i);
  const float step = total / static_cast<float>(count);
  float reached = 0.5F * step;
  for (std::size_t i = 0; i < n; ++i) {
    reached += length(i);
    if (reached < step) continue;
    out.push_back(static_cast<int>(i));
    reached = std::min(reached - step, step);
  }
}

void level_variances(SurfacePoints& surface) {
  float mean = 0.0F;
  for (const SurfacePoint& point : surface.points) mean += point.variance / static_cast<float>(surface.size());
  for (SurfacePoint& point : surface.points) point.variance = mean;
}

}  // namespace

void prepare_scan(const Scan& scan, const Twist2& twist, const PrepareOptions& options, PrepareWorkspace& work,
                  PreparedScan& out) {
  find_surface(scan, twist, work.surface, out.surface);
  if (!options.noise_weights) level_variances(out.surface);
  out.range_max_m = scan.effective_range_max();
  fill_bearing_table(scan, out.surface, work.surface, twist.omega * scan.time_increment, options.min_empty_run_rad,
                     work.bearings, out.bearings);
  // The table must hold translations as long as people move between scans, yet keep its cells small in small places.
  const double extent = out.surface.extent;
  out.scale_m = std::max(1.05 * extent, std::min(3.2, 2.2 * extent));
  out.scale_m = options.adaptive_scale ? std::max(out.scale_m, kLeastScale_m) : kFixedScale_m;
  const auto half_width = static_cast<float>(out.scale_m);
  out.nearest.build(out.surface.points,
                    std::max(half_width, static_cast<float>(std::min(1.5 * out.scale_m, 1.05 * out.range_max_m))),
                    half_width / 50.0F);
  fill_normal_histogram(out.surface, out.normals);
  sample_evenly(out.surface, options.sparse_points, work.indices);
  out.sparse.fill(out.surface, work.indices);
  sample_evenly(out.surface, options.middle_points, work.indices);
  out.middle.fill(out.surface, work.indices);
  out.all.fill(out.surface);
  if (options.with_missing) work.missing.find(scan, 0.0, deg_to_rad(MissingOptions{}.min_width_deg), out.missing);
  if (options.with_table) out.table.build(out.surface, out.bearings, out.scale_m, options.values);
}

}  // namespace phasescan
