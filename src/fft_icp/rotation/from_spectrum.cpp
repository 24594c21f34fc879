#include "fft_icp/rotation/from_spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

SpectralRotation::SpectralRotation(int size, const SpectrumOptions& spectrum, const RotationOptions& rotation)
    : size_(size),
      scale_(spectrum.magnitude),
      options_(rotation),
      sampler_(size, spectrum),
      rings_(rotation.mode == RotationMode::kPerRadius ? sampler_.radii() : 1),
      ring_fft_(RealFft::rows(rings_, sampler_.angle_bins())),
      correlation_fft_(RealFft::rows(1, sampler_.angle_bins())) {}

void SpectralRotation::describe(const ComplexBuffer& half_spectrum, PolarDescriptor& out) {
  magnitude(half_spectrum, size_, scale_, magnitude_);
  sampler_.sample(magnitude_, rings_buffer_);
  const auto bins = static_cast<std::size_t>(sampler_.angle_bins());
  if (options_.mode == RotationMode::kRadiusSum) {
    summed_.assign(bins, 0.0F);
    for (std::size_t i = 0; i < rings_buffer_.size(); ++i) summed_[i % bins] += rings_buffer_[i];
    ring_fft_.forward(summed_, out);
  } else {
    ring_fft_.forward(rings_buffer_, out);
  }
  const std::size_t half = bins / 2 + 1;
  for (std::size_t ring = 0; ring < static_cast<std::size_t>(rings_); ++ring) {
    std::complex<float>* row = out.data() + ring * half;
    row[0] = 0.0F;  // the mean says nothing of the direction
    if (!options_.normalise && rings_ > 1) continue;
    float energy = 0.0F;
    for (std::size_t k = 1; k < half; ++k) energy += std::norm(row[k]);
    const float scale = energy > 0.0F ? 1.0F / std::sqrt(energy) : 0.0F;
    for (std::size_t k = 1; k < half; ++k) row[k] *= scale;
  }
}

void SpectralRotation::candidates(const PolarDescriptor& reference, const PolarDescriptor& scan,
                                  std::vector<RotationCandidate>& out) {
  out.clear();
  const int bins = sampler_.angle_bins();
  const std::size_t half = static_cast<std::size_t>(bins) / 2 + 1;
  product_.assign(half, std::complex<float>(0.0F, 0.0F));
  // Sum over rings of A(k) B*(k): its inverse FFT c(s) = sum_t A(t + s) B(t) peaks at the rotation of B onto A.
  float energy = 0.0F;
  auto* sum = reinterpret_cast<float*>(product_.data());
  for (std::size_t ring = 0; ring < static_cast<std::size_t>(rings_); ++ring) {
    const auto* a = reinterpret_cast<const float*>(reference.data() + ring * half);
    const auto* b = reinterpret_cast<const float*>(scan.data() + ring * half);
    float energy_a = 0.0F, energy_b = 0.0F;
    for (std::size_t k = 0; k < half; ++k) {
      const float ar = a[2 * k], ai = a[2 * k + 1], br = b[2 * k], bi = b[2 * k + 1];
      sum[2 * k] += ar * br + ai * bi;
      sum[2 * k + 1] += ai * br - ar * bi;
      energy_a += ar * ar + ai * ai;
      energy_b += br * br + bi * bi;
    }
    energy += std::sqrt(energy_a * energy_b);
  }
  if (!(energy > 0.0F)) return;
  double scale = 0.5 * bins / static_cast<double>(energy);
  if (options_.whiten) {
    // Phase correlation ([Jiang19] Eq. 10-12): only the phase of the cross spectrum is kept.
    for (auto& value : product_) {
      const float length = std::abs(value);
      value = length > 0.0F ? value / length : std::complex<float>(0.0F, 0.0F);
    }
    scale = 1.0;
  }
  correlation_fft_.inverse(product_, correlation_);

  const auto at = [&](int i) { return correlation_[static_cast<std::size_t>((i + bins) % bins)]; };
  const double separation = std::max(deg_to_rad(options_.separation_deg), 1e-9);
  // Repeatedly the best local maximum that is far enough from those taken: few candidates, few bins.
  while (static_cast<int>(out.size()) < options_.candidates) {
    int best = -1;
    for (int i = 0; i < bins; ++i) {
      if (at(i) < at(i - 1) || at(i) < at(i + 1) || (best >= 0 && at(i) <= at(best))) continue;
      const double theta = kPi * i / bins;
      const bool taken = std::any_of(out.begin(), out.end(), [&](const RotationCandidate& c) {
        return 0.5 * angle_distance(2.0 * theta, 2.0 * c.theta) < separation;
      });
      if (!taken) best = i;
    }
    if (best < 0) break;
    double offset = 0.0;
    const float left = at(best - 1), centre = at(best), right = at(best + 1);
    const float curvature = left - 2.0F * centre + right;
    if (options_.subbin && curvature < 0.0F) offset = 0.5 * static_cast<double>((left - right) / curvature);
    const double theta = 0.5 * wrap_angle(2.0 * kPi * (best + offset) / bins);
    out.push_back({theta, static_cast<double>(centre) * scale});
  }
}

}  // namespace phasescan
