#include "fft_icp/ndt/ndt.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr double kReachCells = 256.0;

/// Sums of the points in a cell.
struct CellSums {
  double n, x, y, xx, xy, yy;
};

}  // namespace

void NdtMap::build(const ScanPoints& points, double cell_m, const NdtOptions& options) {
  per_cell_ = 1.0 / cell_m;
  cells_.clear();
  const double reach = kReachCells * cell_m;
  double low_x = reach, low_y = reach, high_x = -reach, high_y = -reach;
  const auto within = [&](std::size_t i) {
    return std::abs(static_cast<double>(points.x[i])) < reach && std::abs(static_cast<double>(points.y[i])) < reach;
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!within(i)) continue;
    const auto x = static_cast<double>(points.x[i]), y = static_cast<double>(points.y[i]);
    low_x = std::min(low_x, x);
    low_y = std::min(low_y, y);
    high_x = std::max(high_x, x);
    high_y = std::max(high_y, y);
  }
  if (low_x > high_x) {
    for (Grid& grid : grids_) grid.cols = grid.rows = 0;
    return;
  }
  std::vector<CellSums> sums;
  for (int g = 0; g < 4; ++g) {
    Grid& grid = grids_[g];
    grid.left = (std::floor(low_x * per_cell_) - (g % 2 == 0 ? 0.0 : 0.5)) * cell_m;
    grid.low = (std::floor(low_y * per_cell_) - (g / 2 == 0 ? 0.0 : 0.5)) * cell_m;
    grid.cols = static_cast<int>((high_x - grid.left) * per_cell_) + 1;
    grid.rows = static_cast<int>((high_y - grid.low) * per_cell_) + 1;
    grid.cell.assign(static_cast<std::size_t>(grid.cols) * static_cast<std::size_t>(grid.rows), -1);
    sums.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!within(i)) continue;
      const auto x = static_cast<double>(points.x[i]), y = static_cast<double>(points.y[i]);
      const int col = static_cast<int>((x - grid.left) * per_cell_), row = static_cast<int>((y - grid.low) * per_cell_);
      std::int32_t& at = grid.cell[static_cast<std::size_t>(row * grid.cols + col)];
      if (at < 0) {
        at = static_cast<std::int32_t>(sums.size());
        sums.push_back({});
      }
      CellSums& s = sums[static_cast<std::size_t>(at)];
      s.n += 1.0;
      s.x += x;
      s.y += y;
      s.xx += x * x;
      s.xy += x * y;
      s.yy += y * y;
    }
    for (std::int32_t& at : grid.cell) {
      if (at < 0) continue;
      const CellSums& s = sums[static_cast<std::size_t>(at)];
      at = -1;
      if (s.n < options.min_cell_points) continue;
      const double mx = s.x / s.n, my = s.y / s.n;
      const double xx = s.xx / s.n - mx * mx, xy = s.xy / s.n - mx * my, yy = s.yy / s.n - my * my;
      // Eigenvalues of the covariance, kept from being singular ([Biber03] Sec. III: at least 0.001 of the larger).
      const double mid = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
      const double least = options.min_sigma_m * options.min_sigma_m;
      const double large = std::max(mid + spread, least), small = std::max({mid - spread, 0.001 * large, least});
      const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy), c = std::cos(angle), sn = std::sin(angle);
      const double il = 1.0 / large, is = 1.0 / small;
      at = static_cast<std::int32_t>(cells_.size());
      cells_.push_back({mx, my, il * c * c + is * sn * sn, (il - is) * c * sn, il * sn * sn + is * c * c});
    }
  }
}

NdtScore NdtMap::evaluate(const ScanPoints& scan, const Pose2& T_ref_scan) const {
  NdtScore out;
  const double c = std::cos(T_ref_scan.theta), s = std::sin(T_ref_scan.theta);
  double g0 = 0.0, g1 = 0.0, g2 = 0.0, h00 = 0.0, h01 = 0.0, h02 = 0.0, h11 = 0.0, h12 = 0.0, h22 = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const auto px = static_cast<double>(scan.x[i]), py = static_cast<double>(scan.y[i]);
    const double rx = c * px - s * py, ry = s * px + c * py;
    const double x = rx + T_ref_scan.x, y = ry + T_ref_scan.y;
    bool inside = false;
    for (const Grid& grid : grids_) {
      const double u = (x - grid.left) * per_cell_, v = (y - grid.low) * per_cell_;
      if (!(u >= 0.0 && v >= 0.0 && u < grid.cols && v < grid.rows)) continue;
      const std::int32_t at =
          grid.cell[static_cast<std::size_t>(static_cast<int>(v) * grid.cols + static_cast<int>(u))];
      if (at < 0) continue;
      const Cell& cell = cells_[static_cast<std::size_t>(at)];
      const double qx = x - cell.mean_x, qy = y - cell.mean_y;
      const double bx = cell.b_xx * qx + cell.b_xy * qy, by = cell.b_xy * qx + cell.b_yy * qy;
      const double squared = qx * bx + qy * by;
      if (squared > 40.0) continue;  // exp(-20): nothing
      inside = inside || squared < 9.0;
      const double e = std::exp(-0.5 * squared);
      out.value -= e;
      // dq/dtheta = (-ry, rx), d2q/dtheta2 = (-rx, -ry); q^T B dq/dp_k:
      const double j0 = bx, j1 = by, j2 = -bx * ry + by * rx;
      g0 += e * j0;
      g1 += e * j1;
      g2 += e * j2;
      const double tx = -cell.b_xx * ry + cell.b_xy * rx, ty = -cell.b_xy * ry + cell.b_yy * rx;  // B dq/dtheta
      h00 += e * (cell.b_xx - j0 * j0);
      h01 += e * (cell.b_xy - j0 * j1);
      h11 += e * (cell.b_yy - j1 * j1);
      h02 += e * (tx - j0 * j2);
      h12 += e * (ty - j1 * j2);
      h22 += e * (-ry * tx + rx * ty - bx * rx - by * ry - j2 * j2);
    }
    out.inside += inside;
  }
  out.gradient << g0, g1, g2;
  out.hessian << h00, h01, h02, h01, h11, h12, h02, h12, h22;
  return out;
}

void build_ndt(const ScanPoints& points, const NdtOptions& options, NdtLevels& out) {
  out.resize(static_cast<std::size_t>(options.levels));
  double cell = options.cell_m;
  for (NdtMap& map : out) {
    map.build(points, cell, options);
    cell *= 0.5;
  }
}

namespace {

/// Newton step -H^-1 g with H made positive definite.
Eigen::Vector3d newton_step(const NdtScore& score) {
  double lift = 0.0;
  const double size = std::max(1e-9, score.hessian.cwiseAbs().maxCoeff());
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Eigen::LLT<Eigen::Matrix3d> factor(score.hessian + lift * Eigen::Matrix3d::Identity());
    if (factor.info() == Eigen::Success) return factor.solve(-score.gradient);
    lift = lift == 0.0 ? 1e-3 * size : 4.0 * lift;
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace

NdtResult align_ndt(const NdtLevels& reference, const ScanPoints& scan, const Pose2& guess, const NdtOptions& options) {
  NdtResult result;
  result.T_ref_scan = guess;
  if (scan.size() == 0 || reference.empty()) return result;
  const double turn_tolerance = deg_to_rad(options.tolerance_deg);
  double cell = options.cell_m;
  for (std::size_t level = 0; level < reference.size(); ++level, cell *= 0.5) {
    NdtScore score = reference[level].evaluate(scan, result.T_ref_scan);
    result.converged = false;
    while (result.iterations < options.max_iterations) {
      ++result.iterations;
      Eigen::Vector3d step = newton_step(score);
      // A Newton step far from the optimum can be wild: no farther than a cell, no more than 20 degrees.
      const double length = std::max(std::hypot(step.x(), step.y()) / cell, std::abs(step.z()) / deg_to_rad(20.0));
      if (length > 1.0) step /= length;
      Pose2 next;
      NdtScore better;
      bool improved = false;
      for (int halving = 0; halving < 6 && !improved; ++halving) {
        next = {result.T_ref_scan.x + step.x(), result.T_ref_scan.y + step.y(),
                wrap_angle(result.T_ref_scan.theta + step.z())};
        better = reference[level].evaluate(scan, next);
        improved = better.value < score.value;
        if (!improved) step *= 0.5;
      }
      if (improved) {
        result.T_ref_scan = next;
        score = better;
      }
      if (!improved ||
          (std::hypot(step.x(), step.y()) <= options.tolerance_m && std::abs(step.z()) <= turn_tolerance)) {
        result.converged = score.inside > 0;
        break;
      }
    }
    result.score = score;
  }
  result.overlap = static_cast<double>(result.score.inside) / static_cast<double>(scan.size());
  return result;
}

}  // namespace phasescan
