#include "slam/state_check.hpp"

#include <algorithm>
#include <string>

#include "state/fields.hpp"

namespace phasescan {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw StateFormatError("is damaged: " + std::string(what));
}

template <class Value>
bool is_index(Value value, std::size_t count) {
  return value >= 0 && static_cast<std::size_t>(value) < count;
}

bool is_kept(const Keyframe& keyframe, std::size_t scans) {
  return is_index(keyframe.scan, scans) && (keyframe.stored || keyframe.own_scan);
}

void check_graph(const GraphSessionState& session, std::size_t scans) {
  const std::size_t nodes = session.keyframes.size();
  require(session.graph.poses().size() == nodes && session.travelled_m.size() == nodes, "its graph lacks nodes");
  require((nodes == 0) == session.submitted.empty(), "its graph lacks nodes");
  require(session.nodes_at_optimize >= 0 && static_cast<std::size_t>(session.nodes_at_optimize) <= nodes,
          "its graph lacks nodes");
  std::int32_t last = 0;
  for (const Keyframe& keyframe : session.keyframes) {
    require(is_kept(keyframe, scans), "a keyframe lacks its scan");
    require(keyframe.session >= last, "its drives are in no order");
    last = keyframe.session;
  }
  for (const SubmittedKeyframe& keyframe : session.submitted)
    require(is_index(keyframe.node, nodes), "a keyframe stands nowhere");
  for (const int edge : session.large_loops)
    require(is_index(edge, session.graph.edges().size()), "a loop is not there");
  for (const PoseEdge& edge : session.graph.edges())
    require(edge.robust || edge.from < edge.to, "a step leads backwards");
}

void check_backend(const BackendState& backend, std::size_t scans) {
  check_graph(backend.session, scans);
  const std::size_t nodes = backend.session.keyframes.size();
  const std::vector<int>& places = backend.places.nodes;
  require(places.size() == backend.places.index.size() && std::is_sorted(places.begin(), places.end()),
          "its places are not where keyframes are");
  require(places.empty() || (places.front() >= 0 && is_index(places.back(), nodes)),
          "its places are not where keyframes are");
  require(backend.loops.consistency.waiting.size() <= 64, "too many loops wait");
  for (const Loop& loop : backend.loops.consistency.waiting)
    require(is_index(loop.from, nodes) && is_index(loop.to, nodes) && loop.from != loop.to,
            "a loop that waits is between no keyframes");
  for (const Keyframe& keyframe : backend.admission.waiting)
    require(is_kept(keyframe, scans), "a keyframe lacks its scan");
  require(backend.admission.sure_nodes <= nodes, "its graph lacks nodes");
  for (const RelocalisationCandidate& candidate : backend.admission.candidates)
    require(is_index(candidate.node, nodes) && candidate.waiting < backend.admission.waiting.size(),
            "a place that was recognised is none");
}

void check_ledger(const SlamState::Data& data) {
  const ScanLedger& ledger = data.ledger;
  const std::size_t scans = ledger.records.size();
  const BackendState& backend = data.backend;
  require(static_cast<std::size_t>(ledger.keyframes) ==
              backend.session.submitted.size() + backend.admission.waiting.size() + data.batch.size(),
          "its keyframes are not as many as it says");
  for (const ScanRecord& record : ledger.records)
    require(record.keyframe >= -1 && record.keyframe < ledger.keyframes, "a scan stands at no keyframe");
  require(ledger.covariances.empty() || ledger.covariances.size() == scans, "it lacks covariances of scans");
  require(scans == 0 || !ledger.records.front().repeated, "its first scan repeats one");
  require(std::is_sorted(ledger.breaks.begin(), ledger.breaks.end()) &&
              std::is_sorted(ledger.sessions.begin(), ledger.sessions.end()),
          "its drives are in no order");
  for (const std::int64_t first : ledger.sessions)
    require(first > 0 && static_cast<std::size_t>(first) <= scans, "a drive has no scans");
  const auto last = static_cast<std::int32_t>(ledger.sessions.size());
  for (const auto* keyframes : {&backend.session.keyframes, &backend.admission.waiting, &data.batch}) {
    for (const Keyframe& keyframe : *keyframes)
      require(keyframe.session >= 0 && keyframe.session <= last, "a keyframe is of no drive");
  }
  require(data.frame_session >= 0 && data.frame_session <= last, "its frame is of no drive");
  require(data.session_keyframe >= 0 && data.session_keyframe <= ledger.keyframes, "its drives are in no order");
}

std::shared_ptr<const BackendResult> completed(const std::shared_ptr<const BackendResult>& result,
                                               const GraphSessionState& session) {
  if (!result) return result;
  require(result->snapshot != nullptr, "a result has no map");
  auto snapshot = std::make_shared<BackendSnapshot>(*result->snapshot);
  const std::size_t nodes = snapshot->poses.size();
  require(nodes <= session.keyframes.size() && snapshot->pieces.of_node.size() == nodes, "a map lacks keyframes");
  for (const int piece : snapshot->pieces.of_node)
    require(piece >= 0 && piece < snapshot->pieces.count, "a map lacks keyframes");
  for (const SnapshotLoop& loop : snapshot->loops)
    require(is_index(loop.from, session.keyframes.size()) && is_index(loop.to, session.keyframes.size()),
            "a map lacks keyframes");
  for (std::size_t i = 0; i < nodes; ++i) snapshot->nodes.push_back(node_of(session.keyframes[i]));
  auto out = std::make_shared<BackendResult>(*result);
  out->snapshot = std::move(snapshot);
  return out;
}

}  // namespace

void complete_state(SlamState::Data& data) {
  const std::size_t scans = data.ledger.records.size();
  require(data.ledger.keyframes >= 0, "its keyframes are not as many as it says");
  check_backend(data.backend, scans);
  check_ledger(data);
  for (const Keyframe& keyframe : data.batch) require(is_kept(keyframe, scans), "a keyframe lacks its scan");
  require(data.suspect_ids.size() == data.suspects.scans.size(), "scans that wait are not as many as it says");
  for (const ScanId id : data.suspect_ids) require(is_index(id, scans), "a scan that waits is not there");
  require(!data.first || (is_index(data.first->scan, scans) && (data.first->stored || data.first->own)),
          "its first keyframe lacks its scan");
  require(!data.odometry.first || data.first, "its first keyframe lacks its scan");
  data.entered = completed(data.entered, data.backend.session);
  data.pending = completed(data.pending, data.backend.session);
  if (!data.session_start) return;
  require(!data.session_start->session_start, "a drive begins within another");
  auto start = std::make_shared<SlamState::Data>(*data.session_start);
  complete_state(*start);
  data.session_start = std::move(start);
}

void check_options(const SlamState::Data& data, const SlamOptions& options) {
  const std::size_t scans = data.ledger.records.size();
  const bool bounded = options.slam.bounded_memory;
  require(bounded == data.ledger.covariances.empty() || scans == 0, "its scans are not kept as its options ask for");
  if (options.slam.polish && !bounded)
    require(data.store.size() == scans, "its scans are not kept as its options ask for");
  if (bounded) return;
  require(data.backend.admission.waiting.empty(), "keyframes wait that should not");
  const auto all_stored = [](const std::vector<Keyframe>& keyframes) {
    return std::all_of(keyframes.begin(), keyframes.end(), [](const Keyframe& k) { return k.stored != nullptr; });
  };
  require(all_stored(data.backend.session.keyframes) && all_stored(data.batch), "a keyframe lacks its scan");
  require(data.backend.session.keyframes.size() == data.backend.session.submitted.size(), "its graph lacks nodes");
}

}  // namespace phasescan
