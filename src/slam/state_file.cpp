#include <algorithm>
#include <cmath>
#include <set>

#include "phasescan/slam/state.hpp"
#include "slam/connectivity.hpp"
#include "slam/option_text.hpp"
#include "slam/state_check.hpp"
#include "slam/state_types.hpp"
#include "state/container.hpp"
#include "state/reader.hpp"

namespace phasescan {
namespace {

constexpr std::string_view kOptions = "options", kNotePrefix = "+";

template <class Work>
auto as_state_error(Work work) {
  try {
    return work();
  } catch (const StateFormatError& error) {
    throw StateError(error.what());
  }
}

SlamState read_run(const StateSections& file) {
  auto data = std::make_shared<SlamState::Data>();
  SharedRead shared;
  SlamState::Data::visit_sections(*data, [&](const char* name, const auto& fields) {
    const std::string what = "is damaged: section '" + std::string(name) + "': ";
    try {
      StateReader reader(file.at(name), static_cast<int>(file.version), shared);
      fields(reader);
      if (!reader.at_end()) throw StateFormatError("more follows than belongs to it");
    } catch (const StateFormatError& error) {
      throw StateFormatError(what + error.what());
    }
  });
  complete_state(*data);
  return SlamState(std::move(data));
}

/// From keyframe to keyframe, but for breaks of tracking.
double way_of(const SlamState::Data& data) {
  const std::vector<SubmittedKeyframe>& keyframes = data.backend.session.submitted;
  double way = 0.0;
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    if (!std::binary_search(data.ledger.breaks.begin(), data.ledger.breaks.end(), static_cast<std::int32_t>(k)))
      way += translation_distance(keyframes[k - 1].T_odom_base(), keyframes[k].T_odom_base());
  }
  return way;
}

}  // namespace

std::string encode_state(const SavedRun& run) {
  StateSections file;
  SharedWritten shared;
  SlamState::Data::visit_sections(run.state.data(), [&](const char* name, const auto& fields) {
    StateWriter writer(shared);
    fields(writer);
    file.sections.push_back({name, std::move(writer.bytes)});
  });
  file.sections.push_back({std::string(kOptions), format_options(run.options)});
  for (const auto& [name, note] : run.notes) file.sections.push_back({std::string(kNotePrefix) + name, note});
  return pack_state(file);
}

SavedRun decode_state(std::string_view bytes) {
  return as_state_error([&] {
    const StateSections file = unpack_state(bytes);
    SavedRun run{read_run(file), parse_options(file.at(kOptions))};
    run.version = file.version;
    for (const StateSection& section : file.sections) {
      run.sections.push_back({section.name, section.packed_bytes, section.content.size()});
      if (section.name.starts_with(kNotePrefix)) run.notes[section.name.substr(1)] = section.content;
    }
    check_options(run.state.data(), run.options);
    return run;
  });
}

void write_state(const std::string& path, const SavedRun& run) {
  replace_file(path, encode_state(run));
}

SavedRun read_state(const std::string& path) {
  try {
    return decode_state(read_bytes(path));
  } catch (const StateError& error) {
    throw StateError(path + ": " + error.what());
  }
}

bool is_saved_state(std::string_view first_bytes) {
  return looks_like_state(first_bytes);
}

StateSummary summarize(const SlamState& state) {
  const SlamState::Data& data = state.data();
  const GraphSessionState& session = data.backend.session;
  StateSummary out;
  out.scans = data.ledger.records.size();
  out.keyframes = static_cast<std::size_t>(data.ledger.keyframes);
  out.nodes = session.keyframes.size();
  for (const PoseEdge& e : session.graph.edges()) out.loops += e.robust && e.enabled;
  out.places = data.backend.places.index.size();
  out.drives = 1 + static_cast<int>(data.ledger.sessions.size());
  Connectivity connectivity;
  connectivity.rebuild(session.keyframes, session.graph);
  out.pieces = connectivity.pieces().count;
  if (out.scans > 0) {
    out.first_stamp = data.ledger.records.front().stamp;
    out.last_stamp = data.ledger.records.back().stamp;
  }
  out.path_length_m = way_of(data);
  std::set<std::string> lasers;
  for (const Keyframe& keyframe : session.keyframes) lasers.insert(keyframe.laser);
  for (const auto& [laser, input] : data.input.lasers) lasers.insert(laser);
  out.lasers.assign(lasers.begin(), lasers.end());
  return out;
}

}  // namespace phasescan
