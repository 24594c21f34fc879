#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "localize/map_data.hpp"
#include "localize/map_surface.hpp"

namespace phasescan {
namespace {

// Cells of the surfels: partners are found up to three of them away [m].
constexpr double kCoarseCellM = 0.2, kFineCellM = 0.1;
constexpr int kMostSide = 60000;

LocalMap surfels_of(const MapPoints& surface, const MapGrid& grid, double cell_m) {
  const double width = grid.width * static_cast<double>(grid.cell_m),
               height = grid.height * static_cast<double>(grid.cell_m);
  LocalMap map;
  map.reset({0.5 * width, 0.5 * height, 0.0}, 0.5 * std::max(width, height) + 1.0, cell_m);
  map.add(surface, {});
  map.finish();
  return map;
}

}  // namespace

void check_map(const TrinaryMap& map) {
  const auto fail = [](const char* what) { throw std::invalid_argument(std::string("map: ") + what); };
  if (map.width < 1 || map.height < 1 ||
      map.cells.size() != static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height))
    fail("the number of its cells is not width x height");
  if (map.width > kMostSide || map.height > kMostSide) fail("more than 60,000 cells along a side");
  if (!(map.resolution_m > 0.0) || !std::isfinite(map.resolution_m)) fail("its resolution is not above 0");
  if (!map.origin.is_finite()) fail("its origin is not finite");
}

void add_surfels(LocalizationMap::Data& data, const MapPoints& surface) {
  std::size_t free = 0;
  for (const std::uint8_t cell : data.grid.free) free += cell;
  data.free_area_m2 = static_cast<double>(free) * std::pow(static_cast<double>(data.grid.cell_m), 2);
  if (free == 0) throw std::invalid_argument("map: it has no free space");
  if (surface.size() == 0) throw std::invalid_argument("map: it has no occupied cell beside free ones");
  data.surface_points = surface.size();
  const double cell = static_cast<double>(data.grid.cell_m);
  data.coarse = surfels_of(surface, data.grid, std::max(kCoarseCellM, 2.0 * cell));
  data.fine = surfels_of(surface, data.grid, std::max(kFineCellM, 1.5 * cell));
}

LocalizationMap LocalizationMap::from_grid(const TrinaryMap& map, const LocalizeOptions& options) {
  validate_options("localize", options);
  check_map(map);
  const auto data = std::make_shared<Data>();
  data->T_map_grid = map.origin;
  data->grid = make_map_grid(map);
  add_surfels(*data, map_surface(data->grid));
  data->view_spacing_m = options.view_spacing_m;
  data->view_range_m = options.view_range_m;
  data->views = make_views(data->grid, options.view_spacing_m, options.view_range_m);
  if (data->views.size() == 0) throw std::invalid_argument("map: no free place is 0.1 m clear of what is occupied");
  return LocalizationMap(data);
}

LocalizationMap LocalizationMap::from_state(const SlamState& state, const SlamOptions& slam_options,
                                            const LocalizeOptions& options) {
  return from_grid(Slam(state, slam_options).map()->draw(), options);
}

double LocalizationMap::free_area_m2() const {
  return data_->free_area_m2;
}

std::size_t LocalizationMap::views() const {
  return data_->views.size();
}

std::size_t LocalizationMap::memory_bytes() const {
  const auto grid_of = [&](const LocalMap& map) {
    const double side = std::max(data_->grid.width, data_->grid.height) * static_cast<double>(data_->grid.cell_m);
    const double cells = std::pow(side / (map.reach_m() / 3.0), 2);
    return static_cast<std::size_t>(cells) * sizeof(std::uint32_t) * 2 + map.surfels().size() * sizeof(Surfel) * 2;
  };
  return data_->grid.distance.size() * 3 + data_->views.bytes.size() + data_->views.size() * 8 +
         grid_of(data_->coarse) + grid_of(data_->fine);
}

}  // namespace phasescan
