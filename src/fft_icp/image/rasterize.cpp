#include "fft_icp/image/rasterize.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {

ImageGrid choose_grid(const ScanPoints& reference, const ImageOptions& options, int size, std::vector<float>& scratch) {
  ImageGrid grid{size, options.dmax_m};
  if (options.adaptive_factor > 0.0 && reference.size() > 0) {
    scratch.assign(reference.range.begin(), reference.range.end());
    const auto at = static_cast<std::ptrdiff_t>(static_cast<double>(scratch.size() - 1) * 0.95);
    std::nth_element(scratch.begin(), scratch.begin() + at, scratch.end());
    grid.dmax_m =
        std::max(grid.dmax_m, options.adaptive_factor * static_cast<double>(scratch[static_cast<std::size_t>(at)]));
  }
  return grid;
}

namespace {

constexpr int kPhases = 4;

}  // namespace

Rasterizer::Rasterizer(double blur_px, double connect_m) : connect_m_(static_cast<float>(connect_m)) {
  if (!(blur_px > 0.0)) return;
  reach_ = static_cast<int>(std::ceil(2.0 * blur_px));
  std::vector<double> weights;
  for (int phase = 0; phase < kPhases * kPhases; ++phase) {
    // Middle of the sub-pixel, from the middle of the pixel.
    const double x = (phase % kPhases + 0.5) / kPhases - 0.5, y = (phase / kPhases + 0.5) / kPhases - 0.5;
    weights.clear();
    double sum = 0.0;
    for (int r = -reach_; r <= reach_; ++r) {
      for (int c = -reach_; c <= reach_; ++c) {
        weights.push_back(std::exp(-0.5 * ((r - y) * (r - y) + (c - x) * (c - x)) / (blur_px * blur_px)));
        sum += weights.back();
      }
    }
    for (const double weight : weights) kernels_.push_back(static_cast<float>(weight / sum));
  }
}

void Rasterizer::spread(int row, int col, const float* kernel, Image& image) const {
  const int side = 2 * reach_ + 1, left = col - reach_;
  const int first = std::max(0, -left), last = std::min(side, image.cols() - left);
  for (int r = 0; r < side; ++r) {
    const int y = row - reach_ + r;
    if (y < 0 || y >= image.rows()) continue;
    float* out = image.row(y) + left;
    const float* weight = kernel + r * side;
    for (int c = first; c < last; ++c) out[c] += weight[c];
  }
}

bool Rasterizer::mark(float x, float y, Image& image) {
  // De-skewed points may lie a little outside of the disc of their range.
  if (!(x >= 0.0F && y >= 0.0F)) return false;
  const int col = static_cast<int>(x), row = static_cast<int>(y);
  if (col >= image.cols() || row >= image.rows()) return false;
  std::uint8_t& hit =
      hit_[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.cols()) + static_cast<std::size_t>(col)];
  if (hit != 0) return false;
  hit = 1;
  if (reach_ == 0) {
    image.at(row, col) = 1.0F;
  } else {
    const int px = static_cast<int>((x - static_cast<float>(col)) * kPhases);
    const int py = static_cast<int>((y - static_cast<float>(row)) * kPhases);
    const int side = 2 * reach_ + 1;
    spread(row, col, kernels_.data() + (py * kPhases + px) * side * side, image);
  }
  return true;
}

int Rasterizer::draw(const ScanPoints& points, double theta, const ImageGrid& grid, Image& image) {
  const int size = grid.size;
  image.resize(size, size);
  hit_.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 0);
  const auto mu = static_cast<float>(grid.pixels_per_m()), centre = 0.5F * static_cast<float>(size);
  const float c = mu * static_cast<float>(std::cos(theta)), s = mu * static_cast<float>(std::sin(theta));
  const auto dmax = static_cast<float>(grid.dmax_m);
  const float longest = connect_m_ * mu;
  float last_x = 0.0F, last_y = 0.0F;
  int count = 0, last_beam = -10;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(points.range[i] < dmax)) continue;
    const float x = c * points.x[i] - s * points.y[i] + centre, y = s * points.x[i] + c * points.y[i] + centre;
    count += mark(x, y, image);
    if (longest > 0.0F) {
      const float dx = x - last_x, dy = y - last_y, squared = dx * dx + dy * dy;
      if (std::abs(points.beam[i] - last_beam) <= 2 && squared > 2.0F && squared <= longest * longest) {
        const int steps = static_cast<int>(std::sqrt(squared) * 1.2F) + 1;
        for (int k = 1; k < steps; ++k) {
          const float share = static_cast<float>(k) / static_cast<float>(steps);
          count += mark(last_x + share * dx, last_y + share * dy, image);
        }
      }
      last_x = x;
      last_y = y;
      last_beam = points.beam[i];
    }
  }
  return count;
}

}  // namespace phasescan
