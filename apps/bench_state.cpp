// phasescan bench state: how large a saved run is, and how long it takes to open and to write it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/slam/state.hpp"
#include "saved_run.hpp"

namespace phasescan::app {
namespace {

struct StateFlags {
  std::string state;
  int runs = 5;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The median of `runs` times [ms].
template <class Work>
double median_ms(int runs, Work work) {
  std::vector<double> times;
  for (int k = 0; k < runs; ++k) {
    const double before = seconds();
    work();
    times.push_back(1e3 * (seconds() - before));
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

int run_state(const StateFlags& flags) {
  const LoadedRun loaded = load_run(flags.state);
  const SavedRun& saved = loaded.saved;
  std::size_t bytes = 0;
  for (const StateFileSection& section : saved.sections) bytes += section.bytes;
  // Ready for the next scan: read, checked, and a run made of it.
  const double open_ms = median_ms(flags.runs, [&] {
    const LoadedRun run = load_run(flags.state);
    const Slam slam(run.saved.state, run.saved.options);
  });
  const double pack_ms = median_ms(flags.runs, [&] { encode_state(saved); });
  const std::size_t scans = saved.state.scans();
  print(
      fmt::format("{{\"scans\": {}, \"keyframes\": {}, \"bytes\": {}, \"bytes_per_scan\": {:.0f}, \"open_ms\": {:.1f}, "
                  "\"pack_ms\": {:.1f}}}\n",
                  scans, summarize(saved.state).keyframes, bytes,
                  static_cast<double>(bytes) / static_cast<double>(std::max<std::size_t>(1, scans)), open_ms, pack_ms));
  return kDone;
}

}  // namespace

void add_state_bench_command(CLI::App& app, CommandBody& body) {
  auto* command = app.get_subcommand("bench")->add_subcommand(
      "state", "size of a saved run, and how long it takes to open it and to pack it again (median)");
  auto flags = std::make_shared<StateFlags>();
  command->add_option("STATE", flags->state, "written by slam --save")->required();
  command->add_option("--runs", flags->runs, "of each")->check(CLI::Range(1, 1000))->capture_default_str();
  command->footer("Example:\n  phasescan bench state drive.state");
  command->callback([flags, &body] { body = [flags] { return run_state(*flags); }; });
}

}  // namespace phasescan::app
