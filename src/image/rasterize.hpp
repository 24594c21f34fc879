/// Scan to image ([Jiang19] Sec. 2.2).
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/options.hpp"
#include "image/image.hpp"
#include "scan/points.hpp"

namespace phasescan {

/// Section `image`. As printed: size 128 (256 for `fft`), dmax 3.5 m, no blur, no adaptive scale.
struct ImageOptions {
  int size = 128;
  int fft_size = 256;
  double dmax_m = 6.0;
  double adaptive_factor = 1.1;
  double blur_px = 0.8;
  double connect_m = 0.5;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("size", self.size, OptionInfo{"px", "side of the scan image of fft-icp1 and fft-icp2", 16, 2048, true});
    v("fft_size", self.fft_size, OptionInfo{"px", "side of the scan image of fft", 16, 2048, true, "size"});
    v("dmax_m", self.dmax_m,
      OptionInfo{"m", "range shown by the image; the least one where the scale adapts", 0.05, 1000});
    v("adaptive_factor", self.adaptive_factor,
      OptionInfo{"",
                 "the image shows this times the reference's 95th percentile range, at least dmax_m; 0: always dmax_m",
                 0, 10});
    v("blur_px", self.blur_px, OptionInfo{"px", "Gaussian blur of the binary image; 0: none", 0, 8});
    v("connect_m", self.connect_m,
      OptionInfo{"m",
                 "neighbouring hits up to this far apart are joined by a line, so that far walls weigh like near ones",
                 0, 100});
  }
};

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
