#include "info_state.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/error.hpp"
#include "saved_run.hpp"

namespace phasescan::app {
namespace {

using Json = nlohmann::ordered_json;

Json inputs_of(const SlamRun& run) {
  Json list = Json::array();
  for (const SlamInput& input : run.inputs) {
    list.push_back({{"log", std::filesystem::path(input.log).filename().string()},
                    {"scans", input.scans},
                    {"drive", input.session}});
  }
  return list;
}

Json json_of(const std::string& path, const StateSummary& s, const LoadedRun& loaded) {
  Json sections = Json::array();
  std::size_t bytes = 0;
  for (const StateFileSection& section : loaded.saved.sections) {
    sections.push_back({{"name", section.name}, {"bytes", section.bytes}, {"unpacked_bytes", section.unpacked_bytes}});
    bytes += section.bytes;
  }
  Json options = Json::object();
  const OptionDifferences changed = compare_options(loaded.saved.options, {});
  for (const auto* names : {&changed.fatal, &changed.harmless}) {
    for (const std::string& option : *names)
      options[option.substr(0, option.find(' '))] =
          option.substr(option.find(' ') + 1, option.find(',') - option.find(' ') - 1);
  }
  return {{"file", path},
          {"format", "saved state"},
          {"version", loaded.saved.version},
          {"scans", s.scans},
          {"keyframes", s.keyframes},
          {"nodes", s.nodes},
          {"loops", s.loops},
          {"places", s.places},
          {"drives", s.drives},
          {"pieces", s.pieces},
          {"first_stamp", stamp_to_seconds(s.first_stamp)},
          {"last_stamp", stamp_to_seconds(s.last_stamp)},
          {"path_length_m", s.path_length_m},
          {"lasers", s.lasers},
          {"inputs", inputs_of(loaded.run)},
          {"read_with", loaded.run.reading},
          {"options_changed", options},
          {"bytes", bytes},
          {"sections", sections}};
}

}  // namespace

int info_of_state(const std::string& path, bool json) {
  const LoadedRun loaded = load_run(path);
  const StateSummary summary = summarize(loaded.saved.state);
  const Json all = json_of(path, summary, loaded);
  if (json) {
    print(all.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
    return kDone;
  }
  for (const auto& [name, value] : all.items()) {
    if (!value.is_structured())
      print(fmt::format("{:<24} {}\n", name, value.is_string() ? value.get<std::string>() : value.dump()));
  }
  for (const std::string& laser : summary.lasers) print(fmt::format("{:<24} {}\n", "laser", laser));
  for (const Json& input : all["inputs"])
    print(fmt::format("{:<24} {}, {} scans, drive {}\n", "log", input["log"].get<std::string>(), input["scans"].dump(),
                      input["drive"].dump()));
  for (const auto& [name, value] : all["options_changed"].items())
    print(fmt::format("{:<24} {} {}\n", "option", name, value.get<std::string>()));
  for (const StateFileSection& s : loaded.saved.sections)
    print(fmt::format("{:<24} {:<10} {} bytes, {} unpacked\n", "section", s.name, s.bytes, s.unpacked_bytes));
  return kDone;
}

}  // namespace phasescan::app
