/// Worlds as YAML files, and worlds by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/core/options.hpp"
#include "sim/world.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim {

/// Parses a world: metres, a right-handed frame.
///
///   walls: a list of {points: [[x, y], ...], closed: false, material: matt | black | glass}; a closed one is solid
///   discs: a list of {center: [x, y], radius: r, material: ...}
///   rooms: a list of outlines [[x, y], ...] of where the sensor may stand; without them, the bounding box of all walls
///   doors: a list of [[x, y], [x, y]], the gaps one can pass
///
/// @throws InputError with the line
World parse_world(const std::string& text, const std::string& name);

/// @throws InputError, SystemError
World read_world(const std::string& path);

/// The kind of a name; none where it is not one ("apartment" is a flat).
std::optional<WorldKind> world_kind(std::string_view name);

/// The world of a kind ("flat", or "flat:7" for the building of seed 7, else that of `seed`), or of a file.
/// @throws InputError naming the kinds, SystemError
World world_by_name(const std::string& kind_or_file, std::uint64_t seed);

/// Points of a YAML file `points: [[x, y], ...]`. @throws InputError, SystemError
std::vector<Eigen::Vector2d> read_points(const std::string& path);

}  // namespace phasescan::sim

namespace phasescan {
template <>
std::span<const std::string_view> enum_names<sim::Material>();
}  // namespace phasescan
