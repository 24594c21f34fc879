// A map_server yaml and its image, as map_server reads them.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "io/yaml.hpp"
#include "output/grey_picture.hpp"
#include "output/map_file.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::uint8_t kUsualUnknownPixel = 205;
constexpr double kMostOriginM = 1e6, kMostResolutionM = 100.0;

enum class MapMode { kTrinary, kScale, kRaw };

/// What a yaml says of its image.
struct MapYaml {
  double resolution_m = 0.05, occupied = 0.65, free = 0.196;
  Pose2 origin;
  bool negate = false;
  MapMode mode = MapMode::kTrinary;
  std::string image;
};

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

Pose2 origin_of(const YAML::Node& yaml, const std::string& path) {
  const auto origin = yaml_value<std::vector<double>>(yaml, "origin", path);
  const auto bad = [](double v) { return !std::isfinite(v) || std::abs(v) > kMostOriginM; };
  if (origin.size() < 2 || bad(origin[0]) || bad(origin[1]) || (origin.size() > 2 && bad(origin[2]))) {
    throw InputError(path, yaml["origin"].Mark().line + 1, "`origin` is not [x, y, yaw] of numbers up to 1e6");
  }
  return {origin[0], origin[1], origin.size() > 2 ? wrap_angle(origin[2]) : 0.0};
}

MapMode mode_of(const YAML::Node& yaml, const std::string& path) {
  if (!yaml["mode"]) return MapMode::kTrinary;
  const auto word = yaml_value<std::string>(yaml, "mode", path);
  if (word == "trinary") return MapMode::kTrinary;
  if (word == "scale") return MapMode::kScale;
  if (word == "raw") return MapMode::kRaw;
  throw InputError(path, yaml["mode"].Mark().line + 1, "`mode` is not one of trinary, scale, raw");
}

MapYaml parse_map_yaml(const std::string& path) {
  const YAML::Node yaml = read_yaml(path);
  if (!yaml.IsMap()) throw InputError(path, 0, "expected a map_server yaml with image, resolution, origin");
  MapYaml map;
  map.image = yaml_value<std::string>(yaml, "image", path);
  map.resolution_m = yaml_value<double>(yaml, "resolution", path);
  if (!(map.resolution_m > 0.0) || !(map.resolution_m <= kMostResolutionM))
    throw InputError(path, yaml["resolution"].Mark().line + 1, "`resolution` is not above 0 and up to 100 m");
  map.origin = origin_of(yaml, path);
  map.mode = mode_of(yaml, path);
  map.occupied = yaml_value<double>(yaml, "occupied_thresh", path);
  map.free = yaml_value<double>(yaml, "free_thresh", path);
  if (!(map.free < map.occupied)) throw InputError(path, 0, "`free_thresh` is not below `occupied_thresh`");
  if (yaml["negate"]) {
    const auto word = yaml_value<std::string>(yaml, "negate", path);
    map.negate = word == "1" || word == "true" || word == "True" || word == "yes";
  }
  return map;
}

/// What a pixel says.
CellState state_of(std::uint8_t grey, bool opaque, const MapYaml& map) {
  double probability = map.negate ? grey / 255.0 : (255.0 - grey) / 255.0;
  if (map.mode == MapMode::kScale && !opaque) return CellState::kUnknown;
  if (map.mode == MapMode::kRaw) {
    // The pixel is the occupancy itself, in percent; all above is unknown.
    const int percent = map.negate ? 255 - grey : grey;
    if (percent > 100) return CellState::kUnknown;
    probability = percent / 100.0;
  }
  if (probability >= map.occupied) return CellState::kOccupied;
  return probability <= map.free ? CellState::kFree : CellState::kUnknown;
}

}  // namespace

TrinaryMap read_map(const std::string& yaml_path, bool* unknown_reads_as_free) {
  const MapYaml yaml = parse_map_yaml(yaml_path);
  const std::filesystem::path image(yaml.image);
  const std::string image_path =
      image.is_absolute() ? image.string() : (std::filesystem::path(yaml_path).parent_path() / image).string();
  const GreyPicture p = read_grey_picture(image_path);
  TrinaryMap map;
  map.resolution_m = yaml.resolution_m;
  map.origin = yaml.origin;
  map.width = p.width;
  map.height = p.height;
  map.cells.resize(p.grey.size());
  bool trap = false;
  for (int row = 0; row < p.height; ++row) {
    for (int i = 0; i < p.width; ++i) {
      const auto from = static_cast<std::size_t>(row) * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(i);
      const auto to = static_cast<std::size_t>(p.height - 1 - row) * static_cast<std::size_t>(p.width) +
                      static_cast<std::size_t>(i);
      map.cells[to] = state_of(p.grey[from], p.alpha.empty() || p.alpha[from] == 255, yaml);
      trap = trap || (yaml.mode == MapMode::kTrinary && p.grey[from] == kUsualUnknownPixel &&
                      map.cells[to] == CellState::kFree);
    }
  }
  if (unknown_reads_as_free) *unknown_reads_as_free = trap;
  return map;
}

}  // namespace phasescan
