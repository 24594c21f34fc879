#include "phasescan/match/result.hpp"

#include <array>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<MatchStatus>() {
  static constexpr std::array<std::string_view, 7> kNames{"converged",   "no points",      "no peak",  "not converged",
                                                          "low overlap", "low confidence", "ambiguous"};
  return kNames;
}

template <>
std::span<const std::string_view> enum_names<RotationSource>() {
  static constexpr std::array<std::string_view, 6> kNames{"none",     "guess",   "missing-data",
                                                          "spectrum", "normals", "sweep"};
  return kNames;
}

}  // namespace phasescan
