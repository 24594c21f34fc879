#include "match/from_normals.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace phasescan {
namespace {

constexpr int kBins = NormalHistogram::kBins;
constexpr float kMostLength = 0.25F;  // [share of the extent] one oblique beam must not outweigh a wall

}  // namespace

void fill_normal_histogram(const SurfacePoints& surface, const float* normal_turns, NormalHistogram& out) {
  std::array<float, kBins + 2> raw{};
  const float most = kMostLength * static_cast<float>(surface.extent);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface[i].has_normal()) continue;
    const float at = normal_turns[i] * static_cast<float>(kBins);
    const auto bin = std::min(static_cast<int>(at), kBins - 1);
    const float share = at - static_cast<float>(bin);
    const float weight = std::min(surface[i].length, most);
    raw[static_cast<std::size_t>(bin)] += weight * (1.0F - share);
    raw[static_cast<std::size_t>(bin) + 1] += weight * share;
  }
  raw[0] += raw[kBins];
  for (int k = 0; k < kBins; ++k) {
    const float before = raw[static_cast<std::size_t>(k == 0 ? kBins - 1 : k - 1)];
    const float after = raw[static_cast<std::size_t>(k == kBins - 1 ? 0 : k + 1)];
    // The square root keeps a second wall heard beside a long first one.
    out.weight[static_cast<std::size_t>(k)] =
        std::sqrt(0.25F * before + 0.5F * raw[static_cast<std::size_t>(k)] + 0.25F * after);
  }
}

void correlate_normals(const NormalHistogram& reference, const NormalHistogram& scan, NormalCorrelation& out) {
  std::array<float, 2 * kBins> doubled;
  std::copy(reference.weight.begin(), reference.weight.end(), doubled.begin());
  std::copy(reference.weight.begin(), reference.weight.end(), doubled.begin() + kBins);
  out.fill(0.0F);
  float reference_energy = 0.0F, scan_energy = 0.0F;
  for (int b = 0; b < kBins; ++b) {
    const float w = scan.weight[static_cast<std::size_t>(b)];
    const float* from = doubled.data() + b;
    for (int k = 0; k < kBins; ++k) out[static_cast<std::size_t>(k)] += w * from[k];
    scan_energy += w * w;
    reference_energy += doubled[static_cast<std::size_t>(b)] * doubled[static_cast<std::size_t>(b)];
  }
  const float scale = reference_energy * scan_energy > 0.0F ? 1.0F / std::sqrt(reference_energy * scan_energy) : 0.0F;
  for (auto& value : out) value *= scale;
}

void normal_peaks(const NormalCorrelation& correlation, int count, std::vector<double>& angles) {
  std::array<std::pair<float, int>, kBins> peaks;
  std::size_t found = 0;
  for (int k = 0; k < kBins; ++k) {
    const float here = correlation[static_cast<std::size_t>(k)];
    const float before = correlation[static_cast<std::size_t>((k + kBins - 1) % kBins)];
    const float after = correlation[static_cast<std::size_t>((k + 1) % kBins)];
    if (here > 0.0F && here >= before && here > after) peaks[found++] = {here, k};
  }
  std::sort(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(found), [](const auto& a, const auto& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  });
  angles.reserve(kBins);
  angles.clear();
  for (std::size_t p = 0; p < std::min(found, static_cast<std::size_t>(count)); ++p) {
    const auto [score, k] = peaks[p];
    const double here = static_cast<double>(score);
    const double before = static_cast<double>(correlation[static_cast<std::size_t>((k + kBins - 1) % kBins)]);
    const double after = static_cast<double>(correlation[static_cast<std::size_t>((k + 1) % kBins)]);
    const double bend = before - 2.0 * here + after;
    const double shift = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
    angles.push_back(wrap_angle((static_cast<double>(k) + shift) * kTwoPi / kBins));
  }
}

}  // namespace phasescan
