#include "match/mh_options.hpp"

#include <array>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<RotationSearch>() {
  static constexpr std::array<std::string_view, 5> kNames{"auto", "sweep", "normals", "spectrum", "missing"};
  return kNames;
}

}  // namespace phasescan
