#include "saved_run.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "commands.hpp"
#include "io/file.hpp"
#include "io/leftovers.hpp"
#include "phasescan/io/error.hpp"
#include "state/reader.hpp"
#include "state/writer.hpp"

namespace phasescan::app {
namespace {

constexpr const char* kNote = "slam";
constexpr std::size_t kMostBytes = std::size_t{8} << 30;  // of a file, unpacked where its name ends in .gz

/// A state that a program saved which is not this command.
SlamRun run_of_nobody(const std::string& path, std::size_t scans) {
  SlamRun run;
  run.log = path;
  run.format = "saved state";
  run.source = {true, "not known: the state is of another program"};
  run.overlap.assign(scans, 0.0F);
  SlamInput input;
  input.log = path;
  input.scans = static_cast<std::int64_t>(scans);
  input.lines.assign(scans, 0);
  run.inputs.push_back(std::move(input));
  return run;
}

void check(const SlamRun& run, const SlamState& state) {
  std::int64_t next = 0;
  bool sound = !run.inputs.empty() && run.overlap.size() == state.scans() && run.shown.every() > 0;
  for (const SlamInput& input : run.inputs) {
    sound = sound && input.first_scan == next && input.scans >= 0 && input.session >= 0 &&
            input.lines.size() == static_cast<std::size_t>(input.scans);
    if (!sound) break;
    next += input.scans;
  }
  for (const ShownScan& shown : run.shown.scans())
    sound = sound && shown.scan < state.scans() && shown.points_cm.size() % 2 == 0;
  if (!sound || next != static_cast<std::int64_t>(state.scans()))
    throw StateFormatError("is damaged: section '+slam' is of another run");
}

SlamRun run_of(const std::string& note, const SlamState& state) {
  SlamRun run;
  StateReader reader(note);
  int version = 0;
  reader.read(version);
  if (version < 1 || version > SlamRun::kVersion)
    throw StateFormatError("was saved by a later command; expected one up to this build");
  StateReader fields(std::string_view(note).substr(sizeof(version)), version);
  fields.read(run);
  check(run, state);
  return run;
}

std::string note_of(const SlamRun& run) {
  StateWriter writer;
  writer.write(SlamRun::kVersion);
  writer.write(run);
  return std::move(writer.bytes);
}

}  // namespace

std::string read_state_bytes(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(path, 0, "does not exist; expected a saved state");
  if (std::filesystem::is_directory(path, ignored)) throw InputError(path, 0, "is a folder; expected a saved state");
  return read_file(path, kMostBytes);
}

bool is_state_file(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;  // a pipe is read once, by its reader
  try {
    InputStream file(path);
    std::string begin(8, '\0');
    begin.resize(file.read(begin));
    return is_saved_state(begin);
  } catch (const std::runtime_error&) {
    return false;
  }
}

LoadedRun load_run(const std::string& path) {
  return load_run(path, read_state_bytes(path));
}

LoadedRun load_run(const std::string& path, std::string_view bytes) {
  try {
    LoadedRun loaded{decode_state(bytes), {}};
    const auto note = loaded.saved.notes.find(kNote);
    loaded.run = note == loaded.saved.notes.end() ? run_of_nobody(path, loaded.saved.state.scans())
                                                  : run_of(note->second, loaded.saved.state);
    return loaded;
  } catch (const StateError& error) {
    throw InputError(path, 0, error.what());
  } catch (const StateFormatError& error) {
    throw InputError(path, 0, error.what());
  }
}

SlamOptions options_to_go_on(const SavedRun& saved, const std::string& file, const SlamOptions& given) {
  if (file.empty()) return saved.options;
  const OptionDifferences differences = compare_options(given, saved.options);
  const auto list = [](const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items) text += (text.empty() ? "" : "; ") + item;
    return text;
  };
  if (!differences.fatal.empty()) {
    throw InputError(file, 0,
                     "has options that the state cannot go on with: " + list(differences.fatal) +
                         "; expected those it was made with");
  }
  if (!differences.harmless.empty())
    warn(file + ": options are others than the state was made with: " + list(differences.harmless));
  return given;
}

void save_run(const std::string& path, const SlamState& state, const SlamOptions& options, const SlamRun& run) {
  write_file(path, encode_state({state, options, {{kNote, note_of(run)}}}));
}

StateSaver::StateSaver(std::string path, double every_s) : path_(std::move(path)), every_s_(every_s) {
  if (!path_.empty()) drop_leftovers(path_);
}

void StateSaver::scan_added(Slam& slam, const SlamRun& run) {
  if (path_.empty() || every_s_ <= 0.0) return;
  const auto now = std::chrono::steady_clock::now();
  if (last_ && std::chrono::duration<double>(now - *last_).count() < every_s_) return;
  save(slam, run);
}

void StateSaver::save(Slam& slam, const SlamRun& run) {
  if (path_.empty()) return;
  save_run(path_, slam.checkpoint(), slam.options(), run);
  last_ = std::chrono::steady_clock::now();
}

}  // namespace phasescan::app
