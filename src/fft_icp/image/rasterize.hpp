/// Scan to image ([Jiang19] Sec. 2.2).
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/fft_icp/options.hpp"
#include "fft_icp/image/image.hpp"
#include "scan/points.hpp"

namespace phasescan {

/// What a square scan image covers: the sensor is its centre, at pixel coordinate size / 2 on both axes.
struct ImageGrid {
  int size = 0;         ///< [px]
  double dmax_m = 0.0;  ///< half the side

  /// mu of [Jiang19] Sec. 2.2 [px/m].
  double pixels_per_m() const { return size / (2.0 * dmax_m); }
};

/// The grid for a reference scan: fixed, or as wide as the 95th percentile of its ranges asks for.
/// @param scratch  buffer for the percentile, kept by the caller
ImageGrid choose_grid(const ScanPoints& reference, const ImageOptions& options, int size, std::vector<float>& scratch);

/// Draws scan points into an image. One object per thread; allocates nothing once its buffers have their size.
class Rasterizer {
 public:
  explicit Rasterizer(double blur_px = 0.0, double connect_m = 0.0);

  /// Draws the points turned by `theta` about the sensor: points are turned and drawn again, never the image.
  ///
  /// A point with 0 < d < dmax is in the pixel (row, column) = floor(mu (y, x) + size / 2) ([Jiang19] Sec. 2.2); each
  /// pixel hit counts once, however many points fall into it. With a blur each such pixel becomes a Gaussian of sum 1.
  /// @return number of pixels hit
  int draw(const ScanPoints& points, double theta, const ImageGrid& grid, Image& image);

 private:
  /// Marks the pixel at (x, y) [px]; true if it was not marked before.
  bool mark(float x, float y, Image& image);
  void spread(int row, int col, const float* kernel, Image& image) const;

  float connect_m_;
  int reach_ = 0;               ///< half width of a kernel [px]
  std::vector<float> kernels_;  ///< one of (2 reach + 1)^2, sum 1, for each of kPhases^2 places within the pixel
  std::vector<std::uint8_t> hit_;
};

}  // namespace phasescan
