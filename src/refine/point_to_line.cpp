#include "phasescan/refine/point_to_line.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kModelVariance = 4e-6F;  // [m^2] surfaces are not lines, beams are not points
constexpr int kWalk = 2;                 // neighbours in index looked at around the grid's answer

// The model's point nearest to q, where its normal agrees with that of q and the line is within the gate; else null.
inline const SurfacePoint* find_partner(const SurfaceModel& model, float qx, float qy, float nx, float ny, float gate, float min_cosine,
                                        float& residual) {
  const int near = model.grid.nearest(qx, qy);
  if (near < 0) return nullptr;
  const SurfacePoint* points = model.points.points.data();
  const SurfacePoint* const end = points + std::min(near + kWalk + 1, static_cast<int>(model.points.size()));
  const SurfacePoint* found = points + std::max(near - kWalk, 0);
  float best = 1e30F;
  for (const SurfacePoint* p = found; p != end; ++p) {
    const float dx = qx - p->x, dy = qy - p->y;
    const float d = dx * dx + dy * dy;
    found = d < best ? p : found;
    best = d < best ? d : best;
  }
  if (found->nx * nx + found->ny * ny < min_cosine) return nullptr;  // also where either has no normal
  const float dx = qx - found->line_x, dy = qy - found->line_y;
  residual = dx * found->nx + dy * found->ny;
  const float along = dy * found->nx - dx * found->ny;
  if (std::fabs(residual) > gate || std::fabs(along) > gate + 0.5F * found->length) return nullptr;
  return found;
}

struct Sums {
  // Upper triangle of H (xx, xy, xt, yy, yt, tt), g, and the part of H that noise of the normals makes.
  float h[6] = {}, g[3] = {}, m[6] = {};
  float cost = 0.0F;
  int partners = 0;

  void add(float jx, float jy, float jt, float residual, float weight) {
    const float wx = weight * jx, wy = weight * jy, wt = weight * jt;
    h[0] += wx * jx;
    h[1] += wx * jy;
    h[2] += wx * jt;
    h[3] += wy * jy;
    h[4] += wy * jt;
    h[5] += wt * jt;
    g[0] += wx * residual;
    g[1] += wy * residual;
    g[2] += wt * residual;
    cost += weight * residual * residual;
    ++partners;
  }

  // Along the tangent (-jy, jx), which turns by tt, a noisy normal leaks weight * variance of information.
  void add_leak(float jx, float jy, float tt, float leak) {
    m[0] += leak * jy * jy;
    m[1] -= leak * jx * jy;
    m[2] -= leak * jy * tt;
    m[3] += leak * jx * jx;
    m[4] += leak * jx * tt;
    m[5] += leak * tt * tt;
  }

  void into(NormalEquations& out) const {
    const auto symmetric = [](const float* v) {
      Eigen::Matrix3f full;
      full << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
      return full.cast<double>().eval();
    };
    out.H += symmetric(h);
    out.normal_noise += symmetric(m);
    out.g += Eigen::Vector3f(g[0], g[1], g[2]).cast<double>();
    out.cost += static_cast<double>(cost);
    out.partners += partners;
  }
};

// One over the variance of a residual whose point stands for point.length of surface while the line is seen by beams that
// stand for line.length each, times the kernel (Geman-McClure, squared Cauchy): far residuals count less.
inline float weight_of(const SurfacePoint& point, const SurfacePoint& line, float residual, float soft) {
  const float variance = point.variance + line.variance * line.length / point.length + kModelVariance + soft * soft;
  const float six = 6.0F * variance;
  const float below = six + residual * residual;
  return 6.0F * six / (below * below);
}

}  // namespace

void add_forward(const SurfaceModel& reference, const SurfacePoints& scan, std::span<const int> subset, const Pose2& T_ref_scan,
                 double gate_m, double soft_m, double min_normal_cosine, NormalEquations& sum) {
  const auto c = static_cast<float>(std::cos(T_ref_scan.theta)), s = static_cast<float>(std::sin(T_ref_scan.theta));
  const auto tx = static_cast<float>(T_ref_scan.x), ty = static_cast<float>(T_ref_scan.y);
  const auto gate = static_cast<float>(gate_m), soft = static_cast<float>(soft_m), cosine = static_cast<float>(min_normal_cosine);
  const SurfacePoint* first = reference.points.points.data();
  Sums sums;
  const std::size_t count = subset.empty() ? scan.size() : subset.size();
  for (std::size_t k = 0; k < count; ++k) {
    const SurfacePoint& from = scan[subset.empty() ? k : static_cast<std::size_t>(subset[k])];
    const float rx = c * from.x - s * from.y, ry = s * from.x + c * from.y;
    const float nx = c * from.nx - s * from.ny, ny = s * from.nx + c * from.ny;
    float residual = 0.0F;
    const SurfacePoint* to = find_partner(reference, rx + tx, ry + ty, nx, ny, gate, cosine, residual);
    if (to == nullptr) continue;
    const float weight = weight_of(from, *to, residual, soft);
    sums.add(to->nx, to->ny, rx * to->ny - ry * to->nx, residual, weight);
    if (soft == 0.0F) sums.add_leak(to->nx, to->ny, rx * to->nx + ry * to->ny, weight * reference.points.normal_variance[static_cast<std::size_t>(to - first)]);
  }
  sums.into(sum);
}

void add_backward(const SurfacePoints& reference, const SurfaceModel& scan, std::span<const int> subset, const Pose2& T_ref_scan,
                  double gate_m, double soft_m, double min_normal_cosine, NormalEquations& sum) {
  const auto c = static_cast<float>(std::cos(T_ref_scan.theta)), s = static_cast<float>(std::sin(T_ref_scan.theta));
  const auto tx = static_cast<float>(T_ref_scan.x), ty = static_cast<float>(T_ref_scan.y);
  const auto gate = static_cast<float>(gate_m), soft = static_cast<float>(soft_m), cosine = static_cast<float>(min_normal_cosine);
  const SurfacePoint* first = scan.points.points.data();
  Sums sums;
  const std::size_t count = subset.empty() ? reference.size() : subset.size();
  for (std::size_t k = 0; k < count; ++k) {
    const SurfacePoint& from = reference[subset.empty() ? k : static_cast<std::size_t>(subset[k])];
    const float dx = from.x - tx, dy = from.y - ty;
    const float bx = c * dx + s * dy, by = -s * dx + c * dy;
    const float mx = c * from.nx + s * from.ny, my = -s * from.nx + c * from.ny;
    float residual = 0.0F;
    const SurfacePoint* to = find_partner(scan, bx, by, mx, my, gate, cosine, residual);
    if (to == nullptr) continue;
    const float weight = weight_of(from, *to, residual, soft);
    // With m = R n the residual is m . (a - t) - const: its derivatives are -m for t and n . (by, -bx) for theta.
    const float jx = s * to->ny - c * to->nx, jy = -s * to->nx - c * to->ny;
    sums.add(jx, jy, to->nx * by - to->ny * bx, residual, weight);
    if (soft == 0.0F) sums.add_leak(jx, jy, -(to->nx * bx + to->ny * by), weight * scan.points.normal_variance[static_cast<std::size_t>(to - first)]);
  }
  sums.into(sum);
}

PointToLineResult refine_point_to_line(const SurfaceModel& reference, const SurfaceModel& scan, const Pose2& guess,
                                       const PointToLineOptions& options, std::span<const int> scan_subset,
                                       std::span<const int> ref_subset, bool both_ways) {
  PointToLineResult result;
  result.T_ref_scan = guess;
  double gate = options.gate_start_m;
  NormalEquations equations;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    equations = {};
    const bool last_gate = gate <= options.gate_end_m;
    const double soft = last_gate ? 0.0 : 0.15 * gate;
    add_forward(reference, scan.points, scan_subset, result.T_ref_scan, gate, soft, options.min_normal_cosine, equations);
    result.partners = equations.partners;
    if (both_ways) add_backward(reference.points, scan, ref_subset, result.T_ref_scan, gate, soft, options.min_normal_cosine, equations);
    ++result.iterations;
    if (equations.partners < 3) return result;
    // A little damping holds the pose where the surfaces say nothing.
    Eigen::Matrix3d H = equations.H;
    const double translation_scale = 0.5 * (H(0, 0) + H(1, 1));
    H(0, 0) += 1e-3 * translation_scale;
    H(1, 1) += 1e-3 * translation_scale;
    H(2, 2) += 1e-3 * H(2, 2) + 1e-9;
    const Eigen::Vector3d step = -H.ldlt().solve(equations.g);
    if (!step.allFinite()) return result;
    result.T_ref_scan.x += step.x();
    result.T_ref_scan.y += step.y();
    result.T_ref_scan.theta = wrap_angle(result.T_ref_scan.theta + step.z());
    const double moved = std::hypot(step.x(), step.y());
    if (last_gate && moved < options.stop_m && std::abs(step.z()) < options.stop_rad) {
      result.converged = true;
      break;
    }
    gate = std::max(options.gate_end_m, 0.6 * gate);
  }
  result.information = (both_ways ? 0.5 : 1.0) * (equations.H - equations.normal_noise);
  return result;
}

}  // namespace phasescan
