#include "match/prepared_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "scan/directions.hpp"

namespace phasescan {
namespace {

constexpr double kLeastScale_m = 0.2, kFixedScale_m = 6.3;

// Length of surface that each hit stands for, up to a limit, and the sum of it.
float fill_lengths(const SurfacePoints& surface, std::vector<float>& out) {
  const float most = 0.1F * static_cast<float>(surface.extent);
  float total = 0.0F;
  out.resize(surface.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = std::min(surface[i].length, most);
    total += out[i];
  }
  return total;
}

// Picks hits so that equal lengths of surface lie between them: a near wall has many beams but no more to say.
struct EvenPick {
  EvenPick(std::size_t hits, float total, int count, std::vector<int>& to)
      : step(total / static_cast<float>(count)), reached(0.5F * step), out(to) {
    out.resize(hits);
  }
  void offer(std::size_t hit, float length) {
    reached += length;
    out[picked] = static_cast<int>(hit);
    const bool pick = reached >= step;
    picked += pick;
    reached = pick ? std::min(reached - step, step) : reached;
  }

  float step, reached;
  std::size_t picked = 0;
  std::vector<int>& out;
};

// About `sparse` and about `middle` of the hits; all where there are no more. Both in one pass, as each addition waits
// for the one before.
void sample_evenly(const std::vector<float>& lengths, float total, const PrepareOptions& options,
                   PrepareWorkspace& work) {
  const std::size_t n = lengths.size();
  EvenPick sparse(n, total, options.sparse_points, work.sparse), middle(n, total, options.middle_points, work.middle);
  for (std::size_t i = 0; i < n; ++i) {
    sparse.offer(i, lengths[i]);
    middle.offer(i, lengths[i]);
  }
  for (const auto& [pick, count] : {std::pair{&sparse, options.sparse_points}, {&middle, options.middle_points}}) {
    if (n > static_cast<std::size_t>(count)) {
      pick->out.resize(pick->picked);
    } else {
      std::iota(pick->out.begin(), pick->out.end(), 0);
    }
  }
}

void level_variances(SurfacePoints& surface) {
  float mean = 0.0F;
  for (const SurfacePoint& point : surface.points) mean += point.variance / static_cast<float>(surface.size());
  for (SurfacePoint& point : surface.points) point.variance = mean;
}

// Revolutions of a motor without an encoder do not start at one angle: by 0.1 of the spacing of the beams for RPLidar
// A1 and 0.06 deg for URG-04LX, at their stops. Scanners that see half a turn (SICK) showed none.
constexpr double kTurnOfSpacing = 0.12, kLeastTurn_deg = 0.06, kMostViewWithoutTurn_deg = 200.0;

double turn_variance_of(const Scan& scan, double spacing, double stated_deg) {
  if (stated_deg >= 0.0) return deg_to_rad(stated_deg) * deg_to_rad(stated_deg);
  if (spacing * static_cast<double>(scan.ranges.size()) < deg_to_rad(kMostViewWithoutTurn_deg)) return 0.0;
  const double turn = std::max(kTurnOfSpacing * spacing, deg_to_rad(kLeastTurn_deg));
  return turn * turn;
}

}  // namespace

void prepare_scan(const Scan& scan, const Twist2& twist, const PrepareOptions& options, PrepareWorkspace& work,
                  PreparedScan& out) {
  find_surface(scan, twist, work.surface, out.surface);
  if (!options.noise_weights) level_variances(out.surface);
  out.range_max_m = scan.effective_range_max();
  out.turn_variance = turn_variance_of(scan, out.surface.spacing, options.revolution_turn_deg);
  out.all.fill(out.surface);
  work.turns.resize(out.all.padded());
  fill_directions(out.all.x.data(), out.all.y.data(), out.all.padded(), work.turns.data());
  fill_bearing_table(scan, out.surface, work.turns.data(), work.surface, twist.omega * scan.time_increment,
                     options.min_empty_run_rad, work.bearings, out.bearings);
  // The table must hold translations as long as people move between scans, yet keep its cells small in small places.
  const double extent = out.surface.extent;
  out.scale_m = std::max(1.05 * extent, std::min(3.2, 2.2 * extent));
  out.scale_m = options.adaptive_scale ? std::max(out.scale_m, kLeastScale_m) : kFixedScale_m;
  const auto half_width = static_cast<float>(out.scale_m);
  out.nearest.build(out.surface.points,
                    std::max(half_width, static_cast<float>(std::min(1.5 * out.scale_m, 1.05 * out.range_max_m))),
                    half_width / 50.0F);
  fill_directions(out.all.nx.data(), out.all.ny.data(), out.all.padded(), work.turns.data());
  fill_normal_histogram(out.surface, work.turns.data(), out.normals);
  const float length = fill_lengths(out.surface, work.lengths);
  sample_evenly(work.lengths, length, options, work);
  out.sparse.fill(out.surface, work.sparse);
  out.middle.fill(out.surface, work.middle);
  if (options.with_table) out.table.build(out.surface, out.bearings, out.scale_m, options.values);
}

}  // namespace phasescan
