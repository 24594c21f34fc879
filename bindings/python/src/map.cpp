// Maps as map_server knows them.
#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <cstring>
#include <filesystem>

#include "bind.hpp"
#include "io/file.hpp"
#include "output/map_file.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan::python {
namespace {

using CellArray = py::array_t<std::int8_t, py::array::c_style | py::array::forcecast>;

TrinaryMap map_of_cells(const CellArray& cells, double resolution_m, const py::object& origin) {
  if (cells.ndim() != 2) throw std::invalid_argument("cells: expected an array of shape (height, width)");
  if (!(resolution_m > 0.0)) throw std::invalid_argument("resolution_m: must be above 0");
  TrinaryMap map;
  map.height = static_cast<int>(cells.shape(0));
  map.width = static_cast<int>(cells.shape(1));
  map.resolution_m = resolution_m;
  map.origin = to_pose(origin, "origin");
  map.cells.resize(static_cast<std::size_t>(cells.size()));
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const std::int8_t cell = cells.data()[i];
    if (cell != -1 && cell != 0 && cell != 100)
      throw std::invalid_argument("cells: has a " + std::to_string(cell) +
                                  "; expected -1 unknown, 0 free or 100 occupied");
    map.cells[i] = static_cast<CellState>(cell);
  }
  return map;
}

void save_map(const TrinaryMap& map, const std::filesystem::path& yaml) {
  if (yaml.extension() != ".yaml")
    throw std::invalid_argument("path: is " + yaml.string() + "; expected a name ending in .yaml");
  const std::string image = yaml.stem().string() + ".pgm";
  FileSet files(yaml.has_parent_path() ? yaml.parent_path().string() : ".");
  files.add(image, format_pgm(map));
  files.add(yaml.filename().string(), format_map_yaml(map, image));
  files.commit();
}

}  // namespace

void bind_map(py::module_& module) {
  py::class_<TrinaryMap> type(module, "TrinaryMap", R"(A map of free, occupied and unknown cells, as map_server has it.

Parameters
----------
cells : array_like, shape (height, width), int8
    -1 unknown, 0 free, 100 occupied; row 0 is the lowest y.
resolution_m : float
    Size of a cell [m].
origin : pose
    Of the lower-left corner of cell (0, 0) on the map [m, rad].)");
  type.def(py::init(&map_of_cells), py::arg("cells"), py::arg("resolution_m") = 0.05,
           py::arg("origin") = py::make_tuple(0.0, 0.0, 0.0));
  type.def_static(
      "load", [](const std::filesystem::path& path) { return read_map(path.string()); }, py::arg("path"),
      "TrinaryMap: Of a yaml of map_server and the image beside it.");
  type.def("save", &save_map, py::arg("path"), "Writes NAME.yaml and NAME.pgm for map_server, whole or not at all.");
  type.def(
      "to_png", [](const TrinaryMap& map) { return py::bytes(format_png(map)); }, "bytes: A picture of the map.");
  type.def_property_readonly(
      "cells",
      [](const py::object& self) {
        const auto& map = self.cast<const TrinaryMap&>();
        return view_of(reinterpret_cast<const std::int8_t*>(map.cells.data()), {map.height, map.width}, self);
      },
      "ndarray, shape (height, width), int8: -1 unknown, 0 free, 100 occupied; row 0 is the lowest y; a view, read-only.");
  type.def_property_readonly(
      "width", [](const TrinaryMap& m) { return m.width; }, "int: Cells along x.");
  type.def_property_readonly(
      "height", [](const TrinaryMap& m) { return m.height; }, "int: Cells along y.");
  type.def_property_readonly(
      "resolution_m", [](const TrinaryMap& m) { return m.resolution_m; }, "float: [m].");
  type.def_property_readonly(
      "origin", [](const TrinaryMap& m) { return m.origin; }, "Pose2: Of the lower-left corner of cell (0, 0).");
  type.def("__repr__", [](const TrinaryMap& m) {
    return fmt::format("<TrinaryMap of {} x {} cells of {:.3g} m, {:.1f} m x {:.1f} m>", m.width, m.height,
                       m.resolution_m, m.width * m.resolution_m, m.height * m.resolution_m);
  });
  type.def(py::pickle(
      [](const TrinaryMap& m) {
        return py::make_tuple(m.width, m.height, m.resolution_m, m.origin,
                              py::bytes(reinterpret_cast<const char*>(m.cells.data()), m.cells.size()));
      },
      [](const py::tuple& state) {
        TrinaryMap map;
        map.width = state[0].cast<int>();
        map.height = state[1].cast<int>();
        map.resolution_m = state[2].cast<double>();
        map.origin = state[3].cast<Pose2>();
        const std::string cells = state[4].cast<std::string>();
        if (map.width < 0 || map.height < 0 ||
            cells.size() != static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height))
          throw std::invalid_argument("not the state of a TrinaryMap");
        map.cells.resize(cells.size());
        std::memcpy(map.cells.data(), cells.data(), cells.size());
        return map;
      }));
}

}  // namespace phasescan::python
