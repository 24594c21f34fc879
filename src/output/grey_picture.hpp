/// Grey pictures as maps are kept in: pgm and PNG, read within bounds.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

/// Row 0 on top.
struct GreyPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;
  std::vector<std::uint8_t> alpha;  ///< empty: opaque throughout
};

/// Pixels that a map may have: 10,000 x 10,000, which is 0.25 km2 at 5 cm.
inline constexpr std::size_t kMostMapPixels = 100'000'000;

/// A picture in a file: pgm (P5, P2) or PNG; colours become grey. One that is too large is refused by its header,
/// before it is read. @throws InputError, SystemError
GreyPicture read_grey_picture(const std::string& path);
/// The same of bytes; `name` is what errors call them.
GreyPicture decode_grey_picture(const std::string& bytes, const std::string& name);

}  // namespace phasescan
