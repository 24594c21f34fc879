#include "output/map_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/yaml.hpp"

namespace phasescan {
namespace {

constexpr unsigned char kFreePixel = 254, kOccupiedPixel = 0, kUnknownPixel = 205;
constexpr long kMaxSide = 65536;
constexpr std::size_t kMaxPixels = std::size_t{1} << 30;

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

/// The next number of a pgm header or a P2 body; comments run from # to the end of the line.
long pgm_number(const std::string& data, std::size_t& at, const std::string& path) {
  while (at < data.size()) {
    if (data[at] == '#') {
      while (at < data.size() && data[at] != '\n') ++at;
    } else if (std::isspace(static_cast<unsigned char>(data[at]))) {
      ++at;
    } else {
      break;
    }
  }
  long value = 0;
  std::size_t digits = 0;
  for (; at < data.size() && data[at] >= '0' && data[at] <= '9' && digits < 9; ++at, ++digits)
    value = 10 * value + (data[at] - '0');
  if (digits == 0) throw InputError(path, 0, "the pgm image ends too early or holds something that is no number");
  return value;
}

Picture read_pgm(const std::string& data, const std::string& path) {
  const bool binary = data[1] == '5';
  std::size_t at = 2;
  const long width = pgm_number(data, at, path), height = pgm_number(data, at, path), most = pgm_number(data, at, path);
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide || most < 1 || most > 255) {
    throw InputError(path, 0,
                     fmt::format("a pgm of {} x {} with {} grey levels; expected 1..{} a side and up to 255 levels",
                                 width, height, most, kMaxSide));
  }
  Picture p{static_cast<int>(width), static_cast<int>(height), {}};
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (binary && data.size() < at + 1 + count)
    throw InputError(path, 0,
                     fmt::format("the pgm has {} of {} pixels", data.size() - std::min(data.size(), at + 1), count));
  if (!binary && count > data.size()) throw InputError(path, 0, "the pgm ends before its last pixel");
  p.grey.resize(count);
  ++at;
  for (std::size_t i = 0; i < count; ++i) {
    const long value = binary ? static_cast<unsigned char>(data[at + i]) : pgm_number(data, at, path);
    p.grey[i] = static_cast<unsigned char>(std::min(255L, value * 255 / most));
  }
  return p;
}

Picture read_png(const std::string& data, const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, data.data(), data.size())) {
    throw InputError(path, 0, std::string("not a readable PNG: ") + image.message);
  }
  image.format = PNG_FORMAT_GRAY;
  if (image.width > kMaxSide || image.height > kMaxSide ||
      static_cast<std::size_t>(image.width) * image.height > kMaxPixels) {
    png_image_free(&image);
    throw InputError(path, 0, "the PNG is larger than any map");
  }
  Picture p{static_cast<int>(image.width), static_cast<int>(image.height),
            std::vector<unsigned char>(PNG_IMAGE_SIZE(image))};
  const png_color white{255, 255, 255};
  if (!png_image_finish_read(&image, &white, p.grey.data(), 0, nullptr))
    throw InputError(path, 0, std::string("not a readable PNG: ") + image.message);
  return p;
}

template <class T>
T yaml_value(const YAML::Node& node, const char* key, const std::string& path) {
  const YAML::Node value = node[key];
  if (!value) throw InputError(path, 0, fmt::format("no `{}`: expected a map_server yaml", key));
  try {
    return value.as<T>();
  } catch (const YAML::Exception&) {
    throw InputError(path, value.Mark().line + 1, fmt::format("`{}` is not of the expected type", key));
  }
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

TrinaryMap read_map(const std::string& yaml_path, bool* unknown_reads_as_free) {
  const YAML::Node yaml = read_yaml(yaml_path);
  if (!yaml.IsMap()) throw InputError(yaml_path, 0, "expected a map_server yaml with image, resolution, origin");
  TrinaryMap map;
  map.resolution_m = yaml_value<double>(yaml, "resolution", yaml_path);
  const auto origin = yaml_value<std::vector<double>>(yaml, "origin", yaml_path);
  const double occupied = yaml_value<double>(yaml, "occupied_thresh", yaml_path),
               free = yaml_value<double>(yaml, "free_thresh", yaml_path);
  if (!(map.resolution_m > 0.0) || !std::isfinite(map.resolution_m))
    throw InputError(yaml_path, 0, "`resolution` is not above 0");
  if (origin.size() < 2 || !std::isfinite(origin[0]) || !std::isfinite(origin[1]))
    throw InputError(yaml_path, 0, "`origin` is not [x, y, yaw]");
  map.origin = {origin[0], origin[1], origin.size() > 2 && std::isfinite(origin[2]) ? wrap_angle(origin[2]) : 0.0};
  if (!(free < occupied)) throw InputError(yaml_path, 0, "`free_thresh` is not below `occupied_thresh`");
  bool negate = false;
  if (yaml["negate"]) {
    const auto word = yaml_value<std::string>(yaml, "negate", yaml_path);
    negate = word == "1" || word == "true" || word == "True" || word == "yes";
  }
  if (yaml["mode"] && yaml_value<std::string>(yaml, "mode", yaml_path) != "trinary") {
    throw InputError(yaml_path, yaml["mode"].Mark().line + 1, "`mode` is not trinary, the only one that can be read");
  }
  const std::filesystem::path image(yaml_value<std::string>(yaml, "image", yaml_path));
  const std::string image_path =
      image.is_absolute() ? image.string() : (std::filesystem::path(yaml_path).parent_path() / image).string();
  const std::string data = read_file(image_path);
  const bool pgm = data.size() > 2 && data[0] == 'P' && (data[1] == '5' || data[1] == '2');
  const bool png = data.size() > 8 && data.compare(1, 3, "PNG") == 0;
  if (!pgm && !png) throw InputError(image_path, 0, "neither pgm (P5, P2) nor PNG");
  const Picture p = pgm ? read_pgm(data, image_path) : read_png(data, image_path);
  map.width = p.width;
  map.height = p.height;
  map.cells.resize(p.grey.size());
  bool trap = false;
  for (int row = 0; row < p.height; ++row) {
    for (int i = 0; i < p.width; ++i) {
      const auto from = static_cast<std::size_t>(row) * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(i);
      const auto to = static_cast<std::size_t>(p.height - 1 - row) * static_cast<std::size_t>(p.width) +
                      static_cast<std::size_t>(i);
      const double g = p.grey[from], probability = negate ? g / 255.0 : (255.0 - g) / 255.0;
      map.cells[to] = probability >= occupied ? CellState::kOccupied
                      : probability <= free   ? CellState::kFree
                                              : CellState::kUnknown;
      trap = trap || (p.grey[from] == kUnknownPixel && map.cells[to] == CellState::kFree);
    }
  }
  if (unknown_reads_as_free) *unknown_reads_as_free = trap;
  return map;
}

}  // namespace phasescan
