/// Maps as files: map_server's pgm + yaml, and PNG to look at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "phasescan/map/trinary_map.hpp"

namespace phasescan {

/// P5 image, row 0 on top: 254 free, 0 occupied, 205 unknown.
std::string format_pgm(const TrinaryMap& map);
/// The yaml beside it: image, resolution, origin, negate 0, occupied_thresh 0.65, free_thresh 0.196, mode trinary.
std::string format_map_yaml(const TrinaryMap& map, const std::string& image_name);
/// Cells that a picture of a map shows in a colour of their own.
struct MapPaint {
  std::vector<std::size_t> cells;  ///< indices into TrinaryMap::cells
  std::array<std::uint8_t, 3> rgb{};
};
/// The same picture as an 8-bit PNG: grey, or RGB where something is painted on it.
std::string format_png(const TrinaryMap& map, std::span<const MapPaint> paints = {});

/// Reads a yaml of map_server and its image (pgm, P5 or P2, or PNG); modes trinary, scale and raw.
///
/// p = (255 - g) / 255, or g / 255 with negate; occupied from occupied_thresh on, free up to free_thresh, unknown
/// between. In scale, transparent pixels are unknown; in raw, a pixel is the occupancy in percent, and unknown above
/// 100. An unknown pixel of 205 has p = 0.196078: with a free_thresh of 0.25 it reads as free. That is what the yaml
/// asks for, and what is returned; `unknown_reads_as_free` says so.
/// @throws InputError (missing keys, an image that is none or has more pixels than any map, nonsense values),
/// SystemError
TrinaryMap read_map(const std::string& yaml_path, bool* unknown_reads_as_free = nullptr);

}  // namespace phasescan
