#include "phasescan/fft_icp/options.hpp"

#include <array>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<FftIcpMethod>() {
  static constexpr std::array<std::string_view, 5> kNames{"icp", "ndt", "fft", "fft-icp1", "fft-icp2"};
  return kNames;
}

template <>
std::span<const std::string_view> enum_names<ImageWindow>() {
  static constexpr std::array<std::string_view, 2> kNames{"none", "hann"};
  return kNames;
}

template <>
std::span<const std::string_view> enum_names<MagnitudeScale>() {
  static constexpr std::array<std::string_view, 3> kNames{"linear", "sqrt", "log"};
  return kNames;
}

template <>
std::span<const std::string_view> enum_names<RotationMode>() {
  static constexpr std::array<std::string_view, 2> kNames{"per-radius", "radius-sum"};
  return kNames;
}

template <>
std::span<const std::string_view> enum_names<TranslationMode>() {
  static constexpr std::array<std::string_view, 2> kNames{"image", "projections"};
  return kNames;
}

void FftIcpOptions::validate() const {
  visit_sections(*this, [](std::string_view section, const auto& options) { validate_options(section, options); });
}

}  // namespace phasescan
