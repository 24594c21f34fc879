#include "eval/localize_places_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "io/file.hpp"
#include "output/map_file.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {
bool has_places(const std::string& folder) {
  return std::filesystem::exists(folder + "/truth.txt");
}

void write_places(const std::string& folder, const LocalizePlaces& places) {
  make_folder(folder);
  write_file(folder + "/map.pgm", format_pgm(places.map));
  write_file(folder + "/map.yaml", format_map_yaml(places.map, "map.pgm"));
  const auto log = make_log_writer(LogTarget::kScanLog, folder + "/scans.jsonl.gz");
  std::string truth = places.name + "\n";
  for (std::size_t i = 0; i < places.cases.size(); ++i) {
    LogEntry entry;
    entry.scan = places.cases[i].measurement.scan;
    entry.scan.stamp = static_cast<Stamp>(i) * 1'000'000'000;
    log->add(entry);
    const Pose2& T = places.cases[i].T_map_base;
    truth += fmt::format("{} {} {} {}\n", T.x, T.y, T.theta, places.cases[i].mapped ? 1 : 0);
  }
  log->finish();
  write_file(folder + "/truth.txt", truth);  // last: a folder with it is complete
}

LocalizePlaces read_places(const std::string& folder) {
  LocalizePlaces places;
  places.map = read_map(folder + "/map.yaml");
  const std::string truth = folder + "/truth.txt";
  LineReader lines(truth);
  std::string line;
  lines.next(places.name);
  const auto log = open_log(folder + "/scans.jsonl.gz");
  while (std::optional<LogEntry> entry = log->next()) {
    LocalizeCase one;
    one.measurement = to_measurement(std::move(*entry));
    int mapped = 1;
    if (!lines.next(line)) throw InputError(truth, lines.line_number(), "fewer lines than scans");
    std::istringstream words(line);
    if (!(words >> one.T_map_base.x >> one.T_map_base.y >> one.T_map_base.theta >> mapped))
      throw InputError(truth, lines.line_number(), "expected x y theta mapped");
    one.mapped = mapped != 0;
    places.cases.push_back(std::move(one));
  }
  return places;
}

}  // namespace phasescan
