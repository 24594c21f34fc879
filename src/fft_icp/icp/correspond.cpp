#include "fft_icp/icp/correspond.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <vector>

namespace phasescan {
namespace {

/// What nanoflann wants to know of a set of points.
struct PointCloud {
  std::vector<float> x;
  std::vector<float> y;

  std::size_t kdtree_get_point_count() const { return x.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t dimension) const { return dimension == 0 ? x[index] : y[index]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointCloud>, PointCloud, 2, std::uint32_t>;

}  // namespace

struct PointIndex::Impl {
  PointCloud cloud;
  std::unique_ptr<Tree> tree;
};

PointIndex::PointIndex() : impl_(std::make_unique<Impl>()) {}
PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

void PointIndex::build(const ScanPoints& points) {
  impl_->cloud.x.assign(points.x.begin(), points.x.end());
  impl_->cloud.y.assign(points.y.begin(), points.y.end());
  impl_->tree.reset();
  if (points.size() == 0) return;
  impl_->tree = std::make_unique<Tree>(2, impl_->cloud, nanoflann::KDTreeSingleIndexAdaptorParams(8));
}

std::size_t PointIndex::size() const {
  return impl_->cloud.x.size();
}
float PointIndex::x(int index) const {
  return impl_->cloud.x[static_cast<std::size_t>(index)];
}
float PointIndex::y(int index) const {
  return impl_->cloud.y[static_cast<std::size_t>(index)];
}

NearestPair PointIndex::nearest(float x, float y) const {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  if (!impl_->tree) return {-1, kFar, kFar};
  const std::array<float, 2> query{x, y};
  std::array<std::uint32_t, 2> indices{};
  std::array<float, 2> squared{};
  const std::size_t found = impl_->tree->knnSearch(query.data(), 2, indices.data(), squared.data());
  if (found == 0) return {-1, kFar, kFar};
  return {static_cast<int>(indices[0]), std::sqrt(squared[0]), found > 1 ? std::sqrt(squared[1]) : kFar};
}

}  // namespace phasescan
