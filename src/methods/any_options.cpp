#include "methods/any_options.hpp"

#include <array>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<MatchMethod>() {
  static constexpr std::array<std::string_view, 6> kNames{"icp", "ndt", "fft", "fft-icp1", "fft-icp2", "global"};
  return kNames;
}

template <>
std::span<const std::string_view> enum_names<RotationsFrom>() {
  static constexpr std::array<std::string_view, 3> kNames{"own", "spectrum", "missing"};
  return kNames;
}

void AnyMatchOptions::validate() const {
  visit_sections(*this, [](std::string_view section, const auto& options) { validate_options(section, options); });
}

MatchOptions AnyMatchOptions::for_global() const {
  return {match.general, global};
}

FftIcpOptions AnyMatchOptions::for_fft_icp(FftIcpMethod method) const {
  return {{method, match.general.min_points, match.min_extent_m},
          image,
          missing,
          spectrum,
          rotation,
          translation,
          icp,
          ndt};
}

}  // namespace phasescan
