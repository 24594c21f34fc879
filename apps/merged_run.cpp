#include "merged_run.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "commands.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::app {
namespace {

/// @param drives  of the run so far
void append(SlamRun& run, const SlamRun& next, std::int32_t drives) {
  const auto scans = static_cast<std::int64_t>(run.overlap.size());
  for (SlamInput input : next.inputs) {
    input.first_scan += scans;
    input.session += drives;
    run.inputs.push_back(std::move(input));
  }
  run.shown.append(next.shown, static_cast<std::size_t>(scans));
  run.overlap.insert(run.overlap.end(), next.overlap.begin(), next.overlap.end());
  run.tracked += next.tracked;
  run.searched += next.searched;
  run.caught += next.caught;
  run.new_segments += next.new_segments;
  run.usable += next.usable;
  for (const auto& [kind, where] : next.first_seen) run.first_seen.emplace(kind, where);
  // A run that goes on goes on with the last log.
  run.judge = next.judge;
  run.last_stamp = next.last_stamp;
  run.reading = next.reading;
}

std::string joined(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : "; ") + item;
  return text;
}

}  // namespace

SlamRun merge_runs(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded,
                   const std::vector<std::size_t>& order) {
  SlamRun run;
  std::int32_t drives = 0;
  for (const std::size_t i : order) {
    const SlamRun& next = loaded[i].run;
    const std::size_t inputs = run.inputs.size();
    if (drives == 0) {
      run = next;
    } else {
      append(run, next, drives);
    }
    for (std::size_t k = inputs; k < run.inputs.size(); ++k)
      run.inputs[k].state = std::filesystem::path(paths[i]).filename().string();
    drives += summarize(loaded[i].saved.state).drives;
  }
  for (const SlamInput& input : run.inputs) {
    for (const auto& [kind, count] : input.damages) run.damages[kind] += count;
  }
  return run;
}

void refuse_same_drive(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded) {
  std::map<std::uint64_t, std::size_t> known;  // by its first scan: a run may have been saved twice on its way
  for (std::size_t i = 0; i < loaded.size(); ++i) {
    for (const SlamInput& input : loaded[i].run.inputs) {
      if (input.first_print == 0) continue;  // saved by another program: it is not known
      const auto at = known.emplace(input.first_print, i).first;
      if (at->second == i) continue;
      throw InputError(paths[i], 0,
                       "holds the drive " + quote_text(std::filesystem::path(input.log).filename().string()) +
                           " that " + paths[at->second] + " holds too; expected different drives");
    }
  }
}

std::size_t begun_first(const std::vector<LoadedRun>& loaded) {
  const auto begins = [](const LoadedRun& run) { return summarize(run.saved.state).first_stamp; };
  const auto first = std::min_element(loaded.begin(), loaded.end(),
                                      [&](const LoadedRun& a, const LoadedRun& b) { return begins(a) < begins(b); });
  return static_cast<std::size_t>(first - loaded.begin());
}

void refuse_other_keeping(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded) {
  for (std::size_t i = 1; i < loaded.size(); ++i) {
    const OptionDifferences differences = compare_options(loaded[i].saved.options, loaded.front().saved.options);
    if (!differences.fatal.empty())
      throw InputError(paths[i], 0,
                       "was made with other options than " + paths.front() + " (" + joined(differences.fatal) +
                           "); expected states whose scans are kept in one way");
  }
}

SlamOptions common_options(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded) {
  const std::size_t first = begun_first(loaded);
  const SlamOptions& options = loaded[first].saved.options;
  for (std::size_t i = 0; i < loaded.size(); ++i) {
    const OptionDifferences differences = compare_options(options, loaded[i].saved.options);
    if (!differences.harmless.empty())
      warn(paths[i] + ": was made with other options than " + paths[first] +
           ", whose are used: " + joined(differences.harmless));
  }
  return options;
}

}  // namespace phasescan::app
