// phasescan bench prepared: how long it takes to prepare a map to be localised in, and to read it as it was kept.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "command_list.hpp"
#include "commands.hpp"
#include "output/map_file.hpp"
#include "phasescan/localize/localizer.hpp"
#include "saved_run.hpp"

namespace phasescan::app {
namespace {

struct PreparedFlags {
  std::string map;
  int runs = 5;
};

/// The median of `runs` times [ms].
double median_of(int runs, const std::function<void()>& work) {
  std::vector<double> times;
  for (int k = 0; k < runs; ++k) {
    const auto before = std::chrono::steady_clock::now();
    work();
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count());
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

/// How a map becomes cells, and what a kept one is asked with: what `localize --keep-prepared` does of either.
TrinaryMap drawn_of(const std::string& file, bool is_run) {
  if (!is_run) return read_map(file);
  const LoadedRun loaded = load_run(file);
  return Slam(loaded.saved.state, loaded.saved.options).map()->draw();
}

MapDigest asked_with(const std::string& file, bool is_run) {
  return is_run ? digest_of(read_state_bytes(file)) : digest_of(read_map(file));
}

int run_prepared(const PreparedFlags& flags) {
  const bool is_run = is_state_file(flags.map);
  TrinaryMap drawn = drawn_of(flags.map, is_run);
  const LocalizationMap map = LocalizationMap::from_grid(drawn);
  const PreparedMap prepared{std::move(drawn), map};
  const MapDigest made_of = asked_with(flags.map, is_run);
  const std::string bytes = encode_prepared(prepared, made_of);
  const double anew_ms = median_of(flags.runs, [&] { LocalizationMap::from_grid(drawn_of(flags.map, is_run)); });
  const double pack_ms = median_of(flags.runs, [&] { encode_prepared(prepared, made_of); });
  const double decode_ms = median_of(flags.runs, [&] { decode_prepared(bytes, made_of); });
  const double kept_ms = median_of(flags.runs, [&] { decode_prepared(bytes, asked_with(flags.map, is_run)); });
  print(
      fmt::format("{{\"free_m2\": {:.0f}, \"views\": {}, \"map_mib\": {:.1f}, \"kept_bytes\": {}, \"anew_ms\": {:.1f}, "
                  "\"pack_ms\": {:.1f}, \"kept_ms\": {:.1f}, \"of_it_decoding_ms\": {:.1f}}}\n",
                  map.free_area_m2(), map.views(), static_cast<double>(map.memory_bytes()) / (1 << 20), bytes.size(),
                  anew_ms, pack_ms, kept_ms, decode_ms));
  return kDone;
}

}  // namespace

void add_prepared_bench_command(CLI::App& app, CommandBody& body) {
  auto* command = app.get_subcommand("bench")->add_subcommand(
      "prepared",
      "how long it takes to read a map and prepare it, and to read it and what localize --keep-prepared keeps");
  auto flags = std::make_shared<PreparedFlags>();
  command->add_option("MAP", flags->map, "a map of map_server (yaml), or a saved run")->required();
  command->add_option("--runs", flags->runs, "of each; medians are printed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->footer("Example:\n  phasescan bench prepared map.yaml");
  command->callback([flags, &body] { body = [flags] { return run_prepared(*flags); }; });
}

}  // namespace phasescan::app
