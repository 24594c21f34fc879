// Fourier-Mellin registration without the scale, from OpenCV's parts: dft, warpPolar, matchTemplate, phaseCorrelate;
// then ICP.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "contender.hpp"
#include "eval/statistics.hpp"
#include "fft_icp/icp/icp.hpp"
#include "scan/points.hpp"

namespace phasescan::rivals {
namespace {

constexpr double kBlur_px = 1.0;
constexpr int kAngles = 360;

class FourierMellin {
 public:
  explicit FourierMellin(int size) : size_(size) {}

  Pose2 match(const Scan& reference, const Scan& scan) {
    scan_to_points(reference, reference_points_);
    scan_to_points(scan, scan_points_);
    if (reference_points_.size() < 10 || scan_points_.size() < 10) return {};
    set_scale();
    draw(reference_points_, 0.0, reference_image_);
    draw(scan_points_, 0.0, scan_image_);
    polar_spectrum(reference_image_, reference_polar_);
    polar_spectrum(scan_image_, scan_polar_);
    const double theta = turn_between(scan_polar_, reference_polar_);

    Pose2 best;
    double best_response = -1.0;
    for (const double twin : {theta, theta + std::numbers::pi}) {
      draw(scan_points_, twin, scan_image_);
      double response = 0.0;
      const cv::Point2d shift = cv::phaseCorrelate(scan_image_, reference_image_, cv::noArray(), &response);
      if (response <= best_response) continue;
      best_response = response;
      best = {shift.x * metres_per_px_, shift.y * metres_per_px_, wrap_angle(twin)};
    }
    index_.build(reference_points_);
    return icp_.align(index_, scan_points_, best, icp_options_.gate_guess_m).T_ref_scan;
  }

 private:
  /// Images that hold 1.1 times the range which 95 % of the hits do not exceed.
  void set_scale() {
    std::vector<double> ranges(reference_points_.range.begin(), reference_points_.range.end());
    ranges.insert(ranges.end(), scan_points_.range.begin(), scan_points_.range.end());
    metres_per_px_ = 2.2 * quantile(std::move(ranges), 0.95) / size_;
  }

  void draw(const ScanPoints& points, double theta, cv::Mat& image) {
    image.create(size_, size_, CV_32F);
    image.setTo(0.0F);
    const double c = std::cos(theta) / metres_per_px_, s = std::sin(theta) / metres_per_px_;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double x = points.x[i], y = points.y[i];
      const int column = static_cast<int>(std::lround(c * x - s * y)) + size_ / 2;
      const int row = static_cast<int>(std::lround(s * x + c * y)) + size_ / 2;
      if (column >= 0 && column < size_ && row >= 0 && row < size_) image.at<float>(row, column) = 1.0F;
    }
    cv::GaussianBlur(image, image, {0, 0}, kBlur_px);
  }

  /// log(1 + |DFT|) on a polar grid: a row per angle, a column per radius up to half of the highest frequency, each
  /// radius with its mean taken out, for the mean of all angles says nothing of the rotation.
  void polar_spectrum(const cv::Mat& image, cv::Mat& polar) {
    cv::dft(image, spectrum_, cv::DFT_COMPLEX_OUTPUT);
    cv::split(spectrum_, parts_);
    cv::magnitude(parts_[0], parts_[1], magnitude_);
    magnitude_ += 1.0F;
    cv::log(magnitude_, magnitude_);
    const int half = size_ / 2;
    centred_.create(size_, size_, CV_32F);
    for (const int row : {0, half}) {
      for (const int column : {0, half}) {
        magnitude_({column, row, half, half}).copyTo(centred_({half - column, half - row, half, half}));
      }
    }
    const auto centre = static_cast<float>(half);
    cv::warpPolar(centred_, polar, {half, kAngles}, {centre, centre}, 0.5 * half, cv::INTER_LINEAR);
    cv::reduce(polar, mean_, 0, cv::REDUCE_AVG);
    for (int row = 0; row < polar.rows; ++row) polar.row(row) -= mean_;
  }

  /// Circular correlation along the angle. phaseCorrelate whitens, and what it finds in these is mostly the pixels' own
  /// grid.
  double turn_between(const cv::Mat& scan, const cv::Mat& reference) {
    cv::vconcat(reference, reference, twice_);
    cv::matchTemplate(twice_, scan, score_, cv::TM_CCORR_NORMED);
    cv::Point peak;
    cv::minMaxLoc(score_, nullptr, nullptr, nullptr, &peak);
    return peak.y * 2.0 * std::numbers::pi / kAngles;
  }

  int size_;
  double metres_per_px_ = 0.05;
  ScanPoints reference_points_, scan_points_;
  cv::Mat reference_image_, scan_image_, spectrum_, parts_[2], magnitude_, centred_, mean_, reference_polar_,
      scan_polar_, twice_, score_;
  PointIndex index_;
  IcpOptions icp_options_;
  phasescan::Icp icp_{icp_options_};
};

Contender fourier_mellin(int size) {
  auto engine = std::make_shared<FourierMellin>(size);
  return {fmt::format("OpenCV Fourier-Mellin {}", size),
          fmt::format(
              "OpenCV {}: {} x {} images of 1.1 x the 95th percentile of the ranges, {} px blur; log magnitude of dft, "
              "warpPolar with {} angles, correlated by matchTemplate; translation and twin by phaseCorrelate; then "
              "phasescan's ICP",
              CV_VERSION, size, size, kBlur_px, kAngles),
          [engine](const Scan& reference, const Scan& scan) { return engine->match(reference, scan); }};
}

}  // namespace

std::vector<Contender> opencv_contenders() {
  cv::setNumThreads(1);
  return {fourier_mellin(256), fourier_mellin(512)};
}

}  // namespace phasescan::rivals
