#include "known_map.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "commands.hpp"
#include "io/file.hpp"
#include "io/leftovers.hpp"
#include "output/map_file.hpp"
#include "phasescan/io/error.hpp"
#include "saved_run.hpp"

namespace phasescan::app {
namespace {

/// A prepared map beside the file that it was made of.
class KeptMap {
 public:
  /// @param file  empty: nothing is kept
  KeptMap(const std::string& file, const MapDigest& made_of)
      : path_(file.empty() ? "" : file + ".prepared"), made_of_(made_of) {
    if (!path_.empty()) drop_leftovers(path_);
  }

  /// Empty where there is none of this map; says why, but for a file that is not there.
  std::optional<KnownMap> read(const LocalizeOptions& options) const {
    std::error_code ignored;
    if (path_.empty() || !std::filesystem::exists(path_, ignored)) return {};
    try {
      return KnownMap{load_prepared(path_, made_of_, options), true};
    } catch (const PreparedMapError& problem) {
      warn(std::string(problem.what()) + "; the map is prepared anew");
    } catch (const std::system_error& problem) {
      warn(std::string(problem.what()) + "; the map is prepared anew");
    }
    return {};
  }

  void write(const KnownMap& known) const {
    if (path_.empty()) return;
    try {
      write_file(path_, encode_prepared(known, made_of_));
    } catch (const PreparedMapError& problem) {
      warn(path_ + ": the prepared map is not kept: it " + problem.what());
    } catch (const InputError& problem) {
      warn(std::string(problem.what()) + "; the prepared map is not kept");
    } catch (const SystemError& problem) {
      warn(std::string(problem.what()) + "; the prepared map is not kept");
    }
  }

 private:
  std::string path_;
  MapDigest made_of_;
};

/// @param file  of the map, for messages
KnownMap prepare(TrinaryMap drawn, const std::string& file, const LocalizeOptions& options) {
  try {
    LocalizationMap made = LocalizationMap::from_grid(drawn, options);
    return {{std::move(drawn), std::move(made)}};
  } catch (const std::invalid_argument& problem) {
    throw InputError(file, 0, problem.what());
  }
}

KnownMap map_of_run(const std::string& state, const LocalizeOptions& options, bool keep) {
  const std::string bytes = read_state_bytes(state);
  const KeptMap kept(keep ? state : "", keep ? digest_of(bytes) : MapDigest{});
  if (std::optional<KnownMap> known = kept.read(options)) return std::move(*known);
  const LoadedRun loaded = load_run(state, bytes);
  KnownMap known = prepare(Slam(loaded.saved.state, loaded.saved.options).map()->draw(), state, options);
  kept.write(known);
  return known;
}

KnownMap map_of_cells(const std::string& map, const LocalizeOptions& options, bool keep) {
  if (is_state_file(map)) throw InputError(map, 0, "is a saved run; expected a map_server yaml (a saved run: --state)");
  bool trap = false;
  TrinaryMap drawn = read_map(map, &trap);
  if (trap)
    warn(map +
         ": pixels of 205, unknown as most tools write them, are free by its free_thresh; 0.196 keeps them apart");
  const KeptMap kept(keep ? map : "", keep ? digest_of(drawn) : MapDigest{});
  if (std::optional<KnownMap> known = kept.read(options)) return std::move(*known);
  KnownMap known = prepare(std::move(drawn), map, options);
  kept.write(known);
  return known;
}

}  // namespace

void add_keep_prepared_flag(CLI::App& command, bool& keep) {
  command.add_flag(
      "--keep-prepared", keep,
      "keep the prepared map beside the map, in FILE.prepared, and read it from there while it is of this map");
}

KnownMap load_known_map(const std::string& map, const std::string& state, const LocalizeOptions& options, bool keep) {
  return map.empty() ? map_of_run(state, options, keep) : map_of_cells(map, options, keep);
}

}  // namespace phasescan::app
