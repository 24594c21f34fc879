// The Point Cloud Library's registration classes, used as their documentation shows, in the plane z = 0.
#include <fmt/format.h>
#include <pcl/console/print.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt_2d.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>

#include "contender.hpp"
#include "scan/points.hpp"

namespace phasescan::rivals {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Gicp = pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;
using Ndt2d = pcl::NormalDistributionsTransform2D<pcl::PointXYZ, pcl::PointXYZ>;

// As IcpOptions has them; PCL wants a squared length and the cosine of an angle.
constexpr double kTolerance_m = 1e-4;
const double kToleranceCosine = std::cos(deg_to_rad(0.005));
constexpr std::size_t kFewestPoints = 10;

Cloud::Ptr cloud_of(const Scan& scan) {
  ScanPoints points;
  scan_to_points(scan, points);
  auto cloud = std::make_shared<Cloud>();
  cloud->reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) cloud->push_back({points.x[i], points.y[i], 0.0F});
  return cloud;
}

Pose2 pose_of(const Eigen::Matrix4f& m) {
  return {static_cast<double>(m(0, 3)), static_cast<double>(m(1, 3)),
          std::atan2(static_cast<double>(m(1, 0)), static_cast<double>(m(0, 0)))};
}

template <class Registration>
Pose2 register_scans(Registration& registration, const Scan& reference, const Scan& scan) {
  const Cloud::Ptr target = cloud_of(reference), source = cloud_of(scan);
  if (target->size() < kFewestPoints || source->size() < kFewestPoints) return {};
  registration.setInputTarget(target);
  registration.setInputSource(source);
  Cloud aligned;
  registration.align(aligned);
  return pose_of(registration.getFinalTransformation());
}

Contender icp() {
  auto engine = std::make_shared<pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>();
  engine->setMaxCorrespondenceDistance(kDuelGate_m);
  engine->setMaximumIterations(kIterations);
  engine->setTransformationEpsilon(kTolerance_m * kTolerance_m);
  engine->setTransformationRotationEpsilon(kToleranceCosine);
  return {"PCL ICP",
          fmt::format("IterativeClosestPoint of PCL {}: correspondences up to {} m, {} iterations at most, done below "
                      "{} m and 0.005 deg",
                      PCL_VERSION_PRETTY, kDuelGate_m, kIterations, kTolerance_m),
          [engine](const Scan& reference, const Scan& scan) { return register_scans(*engine, reference, scan); }};
}

/// Covariances of a flat cloud as GICP means them, 1 along the wall and 0.001 across. PCL's own are fitted in space,
/// where the flattest direction of any plane scan is z, and would leave plain point-to-point ICP.
Gicp::MatricesVectorPtr wall_covariances(const Cloud::ConstPtr& cloud, int neighbours) {
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(cloud);
  auto all = std::make_shared<Gicp::MatricesVector>();
  all->reserve(cloud->size());
  pcl::Indices near;
  std::vector<float> squared;
  for (const pcl::PointXYZ& p : *cloud) {
    tree.nearestKSearch(p, neighbours, near, squared);
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
    for (const int i : near) {
      const Eigen::Vector2d q = (*cloud)[static_cast<std::size_t>(i)].getVector3fMap().head<2>().cast<double>();
      mean += q;
      moment += q * q.transpose();
    }
    mean /= static_cast<double>(near.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(moment / static_cast<double>(near.size()) -
                                                                mean * mean.transpose());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    covariance.topLeftCorner<2, 2>() =
        solver.eigenvectors() * Eigen::Vector2d(1e-3, 1.0).asDiagonal() * solver.eigenvectors().transpose();
    all->push_back(covariance);
  }
  return all;
}

Contender gicp() {
  constexpr int kNeighbours = 10;
  constexpr double kGate_m = 1.0;
  auto engine = std::make_shared<Gicp>();
  engine->setMaxCorrespondenceDistance(kGate_m);
  engine->setMaximumIterations(kIterations);
  return {"PCL GICP",
          fmt::format("GeneralizedIterativeClosestPoint of PCL {}: correspondences up to {} m, {} iterations at most, "
                      "covariances in the plane from {} neighbours",
                      PCL_VERSION_PRETTY, kGate_m, kIterations, kNeighbours),
          [engine](const Scan& reference, const Scan& scan) {
            const Cloud::Ptr target = cloud_of(reference), source = cloud_of(scan);
            if (target->size() < kFewestPoints || source->size() < kFewestPoints) return Pose2{};
            engine->setInputTarget(target);
            engine->setInputSource(source);
            engine->setTargetCovariances(wall_covariances(target, kNeighbours));
            engine->setSourceCovariances(wall_covariances(source, kNeighbours));
            Cloud aligned;
            engine->align(aligned);
            return pose_of(engine->getFinalTransformation());
          }};
}

/// @param step  share of each Newton step that is taken: whole steps fail nearly always, PCL's own tool takes 0.1
/// @param cells_m  grids one after the other, each started at the result of the one before
Contender ndt2d(const std::string& label, const std::vector<float>& cells_m, double step) {
  return {"PCL NDT2D, " + label,
          fmt::format("NormalDistributionsTransform2D of PCL {}: cell size x setOptimizationStepSize {}, {} iterations "
                      "at most for each grid",
                      PCL_VERSION_PRETTY, label, kIterations),
          [cells_m, step](const Scan& reference, const Scan& scan) {
            const Cloud::Ptr target = cloud_of(reference), source = cloud_of(scan);
            if (target->size() < kFewestPoints || source->size() < kFewestPoints) return Pose2{};
            float reach = 0.0F;
            for (const pcl::PointXYZ& p : *target) reach = std::max({reach, std::fabs(p.x), std::fabs(p.y)});
            Eigen::Matrix4f pose = Eigen::Matrix4f::Identity();
            for (const float cell : cells_m) {
              Ndt2d engine;
              engine.setGridCentre(Eigen::Vector2f::Zero());
              engine.setGridExtent(Eigen::Vector2f::Constant(reach + cell));
              engine.setGridStep(Eigen::Vector2f::Constant(cell));
              engine.setOptimizationStepSize(step);
              engine.setMaximumIterations(kIterations);
              engine.setTransformationEpsilon(kTolerance_m * kTolerance_m);
              engine.setTransformationRotationEpsilon(kToleranceCosine);
              engine.setInputTarget(target);
              engine.setInputSource(source);
              Cloud aligned;
              engine.align(aligned, pose);
              pose = engine.getFinalTransformation();
            }
            return pose_of(pose);
          }};
}

}  // namespace

std::vector<Contender> pcl_contenders() {
  // Without an overlap PCL writes to stderr for every pair.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  return {icp(),
          gicp(),
          ndt2d("0.5 m x 0.05", {0.5F}, 0.05),
          ndt2d("1 m x 0.05", {1.0F}, 0.05),
          ndt2d("2 m x 0.02", {2.0F}, 0.02),
          ndt2d("2 m x 0.1", {2.0F}, 0.1),
          ndt2d("2-1-0.5 m x 0.05", {2.0F, 1.0F, 0.5F}, 0.05)};
}

}  // namespace phasescan::rivals
