#include "output/map_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>

#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr unsigned char kFreePixel = 254, kOccupiedPixel = 0, kUnknownPixel = 205;

/// Grey picture, row 0 on top.
struct Picture {
  int width = 0, height = 0;
  std::vector<unsigned char> grey;
};

Picture picture_of(const TrinaryMap& map) {
  Picture p{map.width, map.height, std::vector<unsigned char>(map.cells.size())};
  std::size_t to = 0;
  for (int k = map.height - 1; k >= 0; --k) {
    for (int i = 0; i < map.width; ++i) {
      const CellState state = map.at(i, k);
      p.grey[to++] = state == CellState::kFree       ? kFreePixel
                     : state == CellState::kOccupied ? kOccupiedPixel
                                                     : kUnknownPixel;
    }
  }
  return p;
}

}  // namespace

std::string format_pgm(const TrinaryMap& map) {
  const Picture p = picture_of(map);
  std::string out = fmt::format("P5\n{} {}\n255\n", p.width, p.height);
  out.append(reinterpret_cast<const char*>(p.grey.data()), p.grey.size());
  return out;
}

std::string format_map_yaml(const TrinaryMap& map, const std::string& image_name) {
  return fmt::format(
      "image: {}\nmode: trinary\nresolution: {}\norigin: [{}, {}, {}]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
      image_name, map.resolution_m, map.origin.x, map.origin.y, map.origin.theta);
}

std::string format_png(const TrinaryMap& map, std::span<const MapPaint> paints) {
  const Picture p = picture_of(map);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(p.width);
  image.height = static_cast<png_uint_32>(p.height);
  image.format = PNG_FORMAT_GRAY;
  std::vector<unsigned char> coloured;
  if (!paints.empty()) {
    image.format = PNG_FORMAT_RGB;
    for (const unsigned char g : p.grey) coloured.insert(coloured.end(), 3, g);
    const auto width = static_cast<std::size_t>(map.width), height = static_cast<std::size_t>(map.height);
    for (const MapPaint& paint : paints) {
      for (const std::size_t cell : paint.cells) {
        const std::size_t pixel = (height - 1 - cell / width) * width + cell % width;
        std::copy(paint.rgb.begin(), paint.rgb.end(), coloured.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
      }
    }
  }
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string out(size, '\0');
  if (!png_image_write_to_memory(&image, out.data(), &size, 0, coloured.empty() ? p.grey.data() : coloured.data(), 0,
                                 nullptr)) {
    throw SystemError("map.png", std::string("cannot be packed: ") + image.message);
  }
  out.resize(size);
  return out;
}

}  // namespace phasescan
