// Several runs as one: each is numbered on from those before it, and their back ends are joined.
#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "odometry/information.hpp"
#include "phasescan/slam/state.hpp"
#include "slam/slam_state.hpp"
#include "slam/state_check.hpp"
#include "slam/state_types.hpp"
#include "state/writer.hpp"

namespace phasescan {
namespace {

/// What comes before a run in the merged one.
struct Before {
  ScanId scans = 0;
  std::int32_t keyframes = 0;
  std::int32_t sessions = 0;
};

Before before_next(const SlamState::Data& merged) {
  return {static_cast<ScanId>(merged.ledger.records.size()), merged.ledger.keyframes,
          static_cast<std::int32_t>(merged.ledger.sessions.size())};
}

void renumber(std::vector<Keyframe>& keyframes, const Before& before) {
  for (Keyframe& keyframe : keyframes) {
    keyframe.scan += before.scans;
    keyframe.session += before.sessions;
  }
}

void renumber(ScanLedger& ledger, const Before& before) {
  for (ScanRecord& record : ledger.records) {
    if (record.keyframe >= 0) record.keyframe += before.keyframes;
  }
  for (std::int32_t& keyframe : ledger.breaks) keyframe += before.keyframes;
  for (std::int64_t& scan : ledger.sessions) scan += before.scans;
  if (ledger.wheels_off >= 0) ledger.wheels_off += before.scans;
}

/// All numbers of a run but those of nodes, which the back end gives.
void renumber(SlamState::Data& data, const Before& before) {
  renumber(data.backend.session.keyframes, before);
  renumber(data.backend.admission.waiting, before);
  renumber(data.batch, before);
  renumber(data.ledger, before);
  data.backend.session.last_session += before.sessions;
  for (ScanId& id : data.suspect_ids) id += before.scans;
  if (data.first) data.first->scan += before.scans;
  data.last.scan += before.scans;
  if (data.last.keyframe) *data.last.keyframe += before.keyframes;
  for (auto& [kind, oddity] : data.input.oddities) oddity.first += before.scans;
  data.session_keyframe += before.keyframes;
}

void append(ScanLedger& ledger, const ScanLedger& next) {
  ledger.records.insert(ledger.records.end(), next.records.begin(), next.records.end());
  ledger.covariances.insert(ledger.covariances.end(), next.covariances.begin(), next.covariances.end());
  // Nothing leads from the keyframes before to the first one that comes.
  if (next.breaks.empty() || next.breaks.front() != ledger.keyframes) ledger.breaks.push_back(ledger.keyframes);
  ledger.breaks.insert(ledger.breaks.end(), next.breaks.begin(), next.breaks.end());
  ledger.sessions.insert(ledger.sessions.end(), next.sessions.begin(), next.sessions.end());
  ledger.keyframes += next.keyframes;
  if (ledger.wheels_off < 0) ledger.wheels_off = next.wheels_off;
}

void count_oddities(InputCheckState& input, const InputCheckState& earlier) {
  for (const auto& [kind, oddity] : earlier.oddities) {
    const std::size_t count = input.oddities[kind].count + oddity.count;
    input.oddities[kind] = oddity;
    input.oddities[kind].count = count;
  }
}

/// The scans of a run, after those of `merged`; the back end aside. What is tracked goes on as in the run that comes.
void append(SlamState::Data& merged, SlamState::Data next) {
  append(merged.ledger, next.ledger);
  merged.store.append(next.store);
  next.ledger = std::move(merged.ledger);
  next.store = std::move(merged.store);
  count_oddities(next.input, merged.input);
  EarlierSessions earlier = merged.earlier;
  earlier.add(next.earlier);
  next.earlier = earlier;
  merged = std::move(next);
}

/// A run as a value that may be changed: it cannot begin anew, and no result waits for its time.
SlamState::Data opened(const SlamState& run) {
  SlamState::Data data = run.data();
  data.beginning = {};
  data.session_start.reset();
  data.entered.reset();
  data.pending.reset();
  return data;
}

/// A run to which no scan comes any more: all its keyframes stand on its map.
SlamState::Data closed(const SlamState& run, const SlamOptions& options) {
  Slam slam(run, options);
  slam.begin_session();
  SlamState::Data data = opened(slam.checkpoint());
  Backend backend(options, std::move(data.backend));
  if (!data.batch.empty()) backend.add_batch(std::exchange(data.batch, {}));
  backend.close_admission();
  data.backend = backend.state();
  return data;
}

/// Nothing but loops ties a run's first keyframe to those of the run before; where it still waits, it has to say so.
void begin_anew(SlamState::Data& next) {
  if (!next.backend.session.keyframes.empty()) return;
  std::vector<Keyframe>& waiting = next.backend.admission.waiting.empty() ? next.batch : next.backend.admission.waiting;
  if (!waiting.empty()) waiting.front().new_segment = true;
}

/// By time; runs that began at one moment by what is in them.
std::vector<std::size_t> in_order_of_time(const std::vector<SlamState>& runs) {
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto content = [&](std::size_t i) {
    StateWriter writer;
    writer.write(runs[i].data().ledger);
    return std::move(writer.bytes);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto begin = [&](std::size_t i) { return runs[i].data().ledger.records.front().stamp; };
    return begin(a) != begin(b) ? begin(a) < begin(b) : content(a) < content(b);
  });
  return order;
}

void check(const std::vector<SlamState>& runs, const SlamOptions& options) {
  options.validate();
  if (runs.empty()) throw std::invalid_argument("merge_states: runs: none");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].scans() == 0)
      throw std::invalid_argument("merge_states: runs[" + std::to_string(i) + "] holds no scan");
    try {
      check_options(runs[i].data(), options);
    } catch (const StateFormatError&) {
      throw std::invalid_argument("merge_states: runs[" + std::to_string(i) +
                                  "]: its scans are not kept as options.slam asks for");
    }
  }
}

/// A run in the merged one, and how its map lay before.
struct Member {
  std::size_t first_node = 0, first_scan = 0, scans = 0;
  std::int32_t first_session = 0;
  std::optional<Pose2> T_own_node;  ///< of its first node on its own map; empty where it has none
};

Member member_of(const SlamState::Data& data, const Before& before, std::size_t nodes) {
  Member member;
  member.first_node = nodes;
  member.first_scan = static_cast<std::size_t>(before.scans);
  member.scans = data.ledger.records.size();
  member.first_session = before.sessions;
  const std::vector<Pose2>& poses = data.backend.session.graph.poses();
  if (!poses.empty()) member.T_own_node = poses.front();
  return member;
}

/// Covariances are of poses in the frame that the map has now.
void turn_covariances(const Member& member, const std::vector<Pose2>& poses, ScanLedger& ledger) {
  if (!member.T_own_node || ledger.covariances.empty()) return;
  const double turn = poses[member.first_node].theta - member.T_own_node->theta;
  for (std::size_t i = member.first_scan; i < member.first_scan + member.scans; ++i)
    ledger.covariances[i] = PackedCovariance::of(rotate_information(ledger.covariances[i].matrix(), turn));
}

}  // namespace

MergedStates merge_states(const std::vector<SlamState>& runs, const SlamOptions& options) {
  check(runs, options);
  const std::vector<std::size_t> order = in_order_of_time(runs);
  SlamState::Data merged;
  Backend backend(options);
  std::vector<Member> members(runs.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const SlamState& run = runs[order[k]];
    SlamState::Data next = k + 1 < order.size() ? closed(run, options) : opened(run);
    const Before before = before_next(merged);
    members[order[k]] = member_of(next, before, backend.keyframes().size());
    renumber(next, before);
    if (k > 0) begin_anew(next);
    backend.join(std::exchange(next.backend, {}));
    if (k == 0) {
      merged = std::move(next);
    } else {
      append(merged, std::move(next));
    }
  }
  const Member& first = members.front();
  if (first.T_own_node) backend.move_map(*first.T_own_node * backend.poses()[first.first_node].inverse());
  merged.frame_session = first.first_session + runs.front().data().frame_session;
  for (const Member& member : members) turn_covariances(member, backend.poses(), merged.ledger);
  auto result = std::make_shared<BackendResult>();
  result->snapshot = backend.snapshot();
  result->odom_covariance = merged.keyframe_covariance;
  merged.last.T_map_odom = result->snapshot->T_map_odom;
  merged.last.map_version = result->snapshot->version;
  merged.last.map_covariance.reset();
  merged.entered = std::move(result);
  merged.backend = backend.state();
  return {SlamState(std::make_shared<const SlamState::Data>(std::move(merged))), order};
}

}  // namespace phasescan
