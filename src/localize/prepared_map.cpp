// Prepared maps as files. What takes time is kept: distances, surfaces and views; the rest is made again.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "localize/map_data.hpp"
#include "localize/map_surface.hpp"
#include "localize/prepared_file.hpp"
#include "state/reader.hpp"
#include "state/writer.hpp"

namespace phasescan {
namespace {

constexpr double kLeastKeptCellM = 0.01, kMostKeptCellM = 1000.0;
// Surfels are found by square tables as wide as the map is long: about so many bytes for each cell of a square, and no
// more of them than for each byte of the file, beside what any map may take.
constexpr double kTableBytes = 1.25, kMostPerByte = 256.0, kAnyMapBytes = 64.0 * (1 << 20);

/// What a file must be asked with.
struct MadeOf {
  MapDigest digest;
  double view_spacing_m = 0.0, view_range_m = 0.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("low", self.digest.low);
    v("high", self.digest.high);
    v("view_spacing_m", self.view_spacing_m);
    v("view_range_m", self.view_range_m);
  }
};

/// A TrinaryMap as bytes: 0 unknown, 1 free, 2 occupied.
struct KeptCells {
  std::int32_t width = 0, height = 0;
  double resolution_m = 0.0;
  Pose2 origin;
  std::vector<std::uint8_t> cells;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("width", self.width);
    v("height", self.height);
    v("resolution_m", self.resolution_m);
    v("origin", self.origin);
    v("cells", self.cells);
  }
};
constexpr std::array kCellStates = {CellState::kUnknown, CellState::kFree, CellState::kOccupied};

struct KeptViews {
  std::vector<float> x, y;
  std::vector<std::uint8_t> bytes;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("x", self.x);
    v("y", self.y);
    v("bytes", self.bytes);
  }
};

KeptCells kept(const TrinaryMap& map) {
  KeptCells out{map.width, map.height, map.resolution_m, map.origin, {}};
  out.cells.reserve(map.cells.size());
  for (const CellState state : map.cells)
    out.cells.push_back(state == CellState::kUnknown ? 0 : state == CellState::kFree ? 1 : 2);
  return out;
}

TrinaryMap drawn_of(const KeptCells& kept) {
  TrinaryMap map{kept.width, kept.height, kept.resolution_m, kept.origin, {}};
  map.cells.reserve(kept.cells.size());
  for (const std::uint8_t cell : kept.cells) {
    if (cell >= kCellStates.size()) throw StateFormatError("cells holds a value that does not exist");
    map.cells.push_back(kCellStates[cell]);
  }
  check_map(map);
  return map;
}

void check_bounds(const MapGrid& grid, std::size_t file_bytes) {
  const double cell = static_cast<double>(grid.cell_m), side = std::max(grid.width, grid.height);
  if (!(cell >= kLeastKeptCellM && cell <= kMostKeptCellM))
    throw StateFormatError("is of a map whose cells are below 1 cm or above 1 km; expected others");
  if (kTableBytes * side * side > kAnyMapBytes + kMostPerByte * static_cast<double>(file_bytes))
    throw StateFormatError("is of a map that is too long and thin to be kept");
}

template <class T>
void add_section(StateSections& file, const char* name, const T& value) {
  StateWriter writer;
  writer.write(value);
  file.sections.push_back({name, std::move(writer.bytes)});
}

template <class T>
T section_of(const StateSections& file, const char* name) {
  try {
    StateReader reader(file.at(name));
    T value{};
    reader.read(value);
    if (!reader.at_end()) throw StateFormatError("more follows than belongs to it");
    return value;
  } catch (const StateFormatError& error) {
    throw StateFormatError("is damaged: section '" + std::string(name) + "': " + error.what());
  }
}

[[noreturn]] void refuse(const char* section, const char* what) {
  throw StateFormatError("is damaged: section '" + std::string(section) + "' holds " + what);
}

template <class Values>
bool within(const Values& values, float least, float most) {
  return std::all_of(values.begin(), values.end(), [&](float v) { return v >= least && v <= most; });
}

void check_surface(const MapPoints& p, float width_m, float height_m) {
  const std::size_t n = p.x.size();
  const bool whole = p.y.size() == n && p.nx.size() == n && p.ny.size() == n && p.variance.size() == n &&
                     p.normal_variance.size() == n && p.free_standing.size() == n && p.with_normal <= n &&
                     n <= static_cast<std::size_t>(NearestGrid::kMaxPoints);
  if (!whole) refuse("surface", "lists of different lengths");
  constexpr float kLeastVariance = 1e-9F, kMostVariance = 1e9F;
  const bool sound = within(p.x, -1.0F, width_m + 1.0F) && within(p.y, -1.0F, height_m + 1.0F) &&
                     within(p.nx, -1.01F, 1.01F) && within(p.ny, -1.01F, 1.01F) &&
                     within(p.variance, kLeastVariance, kMostVariance) &&
                     within(p.normal_variance, 0.0F, kMostVariance) &&
                     std::all_of(p.free_standing.begin(), p.free_standing.end(), [](auto f) { return f == 0; });
  if (!sound) refuse("surface", "a point that no map has");
}

ViewTable views_of(KeptViews kept, float width_m, float height_m) {
  const std::size_t n = kept.x.size();
  if (n == 0 || kept.y.size() != n || kept.bytes.size() != n * kViewDirections)
    refuse("views", "lists of different lengths");
  if (!within(kept.x, 0.0F, width_m) || !within(kept.y, 0.0F, height_m)) refuse("views", "a place off the map");
  return {std::move(kept.x), std::move(kept.y), std::move(kept.bytes)};
}

void check_made_of(const MadeOf& kept, const MapDigest& digest, const LocalizeOptions& options) {
  if (kept.digest != digest) throw StateFormatError("is of another map");
  if (kept.view_spacing_m != options.view_spacing_m || kept.view_range_m != options.view_range_m)
    throw StateFormatError("was prepared with other options (localize.view_spacing_m, localize.view_range_m)");
}

PreparedMap read_prepared(std::string_view bytes, const MapDigest& made_of, const LocalizeOptions& options) {
  const StateSections file = unpack_state(bytes, kPreparedMap);
  check_made_of(section_of<MadeOf>(file, "made-of"), made_of, options);
  TrinaryMap drawn = drawn_of(section_of<KeptCells>(file, "cells"));
  const auto data = std::make_shared<LocalizationMap::Data>();
  data->T_map_grid = drawn.origin;
  data->grid = make_map_cells(drawn);
  check_bounds(data->grid, bytes.size());
  data->grid.distance = section_of<std::vector<std::uint8_t>>(file, "distances");
  if (data->grid.distance.size() != data->grid.free.size()) refuse("distances", "another number than there are cells");
  const float width_m = static_cast<float>(data->grid.width) * data->grid.cell_m,
              height_m = static_cast<float>(data->grid.height) * data->grid.cell_m;
  const auto surface = section_of<MapPoints>(file, "surface");
  check_surface(surface, width_m, height_m);
  add_surfels(*data, surface);
  data->views = views_of(section_of<KeptViews>(file, "views"), width_m, height_m);
  data->view_spacing_m = options.view_spacing_m;
  data->view_range_m = options.view_range_m;
  return {std::move(drawn), LocalizationMap(data)};
}

template <class Work>
auto as_prepared_map_error(Work work) {
  try {
    return work();
  } catch (const StateFormatError& error) {
    throw PreparedMapError(error.what());
  }
}

}  // namespace

std::string encode_prepared(const PreparedMap& prepared, const MapDigest& made_of) {
  const LocalizationMap::Data& data = prepared.map.data();
  check_map(prepared.drawn);
  const MapGrid cells = make_map_cells(prepared.drawn);
  if (cells.free != data.grid.free || cells.occupied != data.grid.occupied || cells.width != data.grid.width)
    throw std::invalid_argument("map: it was not made of the cells beside it");
  StateSections file;
  file.version = kPreparedVersion;
  add_section(file, "made-of", MadeOf{made_of, data.view_spacing_m, data.view_range_m});
  add_section(file, "cells", kept(prepared.drawn));
  add_section(file, "distances", data.grid.distance);
  add_section(file, "surface", map_surface(data.grid));
  add_section(file, "views", KeptViews{data.views.x, data.views.y, data.views.bytes});
  std::string bytes = pack_state(file, kPreparedMap);
  as_prepared_map_error([&] { check_bounds(data.grid, bytes.size()); });
  return bytes;
}

PreparedMap decode_prepared(std::string_view bytes, const MapDigest& made_of, const LocalizeOptions& options) {
  return as_prepared_map_error([&] {
    try {
      return read_prepared(bytes, made_of, options);
    } catch (const std::invalid_argument& problem) {
      throw StateFormatError(std::string("is damaged: ") + problem.what());
    }
  });
}

void save_prepared(const std::string& path, const PreparedMap& prepared, const MapDigest& made_of) {
  replace_file(path, encode_prepared(prepared, made_of));
}

PreparedMap load_prepared(const std::string& path, const MapDigest& made_of, const LocalizeOptions& options) {
  try {
    // What is no such file is not read to its end, which a device or a pipe may not have.
    if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
      throw PreparedMapError(std::string("is no file; expected ") + kPreparedMap.expected);
    std::string head(kPreparedMap.magic.size(), '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    if (file && !looks_like_state(head, kPreparedMap)) static_cast<void>(unpack_state(head, kPreparedMap));
    file.close();
    return decode_prepared(read_bytes(path), made_of, options);
  } catch (const StateFormatError& error) {
    throw PreparedMapError(path + ": " + error.what());
  } catch (const PreparedMapError& error) {
    throw PreparedMapError(path + ": " + error.what());
  }
}

}  // namespace phasescan
