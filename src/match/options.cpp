#include "phasescan/match/options.hpp"

#include <array>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<RotationSearch>() {
  static constexpr std::array<std::string_view, 3> kNames{"auto", "sweep", "normals"};
  return kNames;
}

void MatchOptions::validate() const {
  visit_sections(*this, [](std::string_view section, const auto& options) { validate_options(section, options); });
}

}  // namespace phasescan
