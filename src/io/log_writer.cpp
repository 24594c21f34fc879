#include "phasescan/io/log.hpp"

#include <algorithm>

#include "io/log_writers.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kMostLosses = 20;

struct Ending {
  std::string_view ending;
  LogTarget target;
};
constexpr Ending kEndings[] = {{".mcap", LogTarget::kMcap},        {".log", LogTarget::kCarmen},
                               {".log.gz", LogTarget::kCarmen},    {".carmen", LogTarget::kCarmen},
                               {".clf", LogTarget::kCarmen},       {".jsonl", LogTarget::kScanLog},
                               {".jsonl.gz", LogTarget::kScanLog}, {".tum", LogTarget::kTum}};

}  // namespace

const std::vector<std::string>& log_target_names() {
  static const std::vector<std::string> kNames{"mcap", "carmen", "jsonl", "tum"};
  return kNames;
}

std::optional<LogTarget> find_log_target(std::string_view path) {
  const auto* found = std::find_if(std::begin(kEndings), std::end(kEndings),
                                   [&](const Ending& ending) { return path.ends_with(ending.ending); });
  return found == std::end(kEndings) ? std::nullopt : std::optional(found->target);
}

std::string log_endings() {
  std::string known;
  for (const Ending& ending : kEndings) known += (known.empty() ? "" : ", ") + std::string(ending.ending);
  return known;
}

LogTarget log_target_for(const std::string& path) {
  if (const auto target = find_log_target(path)) return *target;
  throw InputError(path, 0, "the name does not tell the format; expected one ending in " + log_endings());
}

void LogWriter::add_loss(const std::string& text) {
  if (losses_.size() < kMostLosses && std::find(losses_.begin(), losses_.end(), text) == losses_.end())
    losses_.push_back(text);
}

std::unique_ptr<LogWriter> make_log_writer(LogTarget target, const std::string& path) {
  switch (target) {
    case LogTarget::kMcap:
      return make_mcap_writer(path);
    case LogTarget::kCarmen:
      return make_carmen_writer(path);
    case LogTarget::kScanLog:
      return make_scan_log_writer(path);
    case LogTarget::kTum:
      break;
  }
  return make_tum_writer(path);
}

}  // namespace phasescan
