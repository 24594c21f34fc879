// A run that goes on for days: its path is kept with fewer poses the longer it gets, so that memory does not grow.
// While it goes on scans and keyframes keep the numbers that they came with; a checkpoint counts those that are kept.
#include <algorithm>
#include <span>
#include <utility>

#include "slam/slam_impl.hpp"
#include "slam/whole_run.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kPiece =
    4096;  // the newest scans, which are kept as they are; older ones are moved so many at once
constexpr std::size_t kMostPieces = 4;  // that wait for a back end at work

void pin(const std::vector<Keyframe>& keyframes, std::vector<ScanId>& pinned) {
  for (const Keyframe& keyframe : keyframes) pinned.push_back(keyframe.scan);
}

}  // namespace

/// Scans that must not be left out: keyframes of the graph and those on their way there, and where drives begin.
std::vector<ScanId> Slam::Impl::pinned_scans(const Backend& backend) const {
  std::vector<ScanId> pinned{0};
  pinned.insert(pinned.end(), state.ledger.sessions.begin(), state.ledger.sessions.end());
  pin(backend.keyframes(), pinned);
  pin(backend.waiting(), pinned);
  pin(state.batch, pinned);
  if (state.first) pinned.push_back(state.first->scan);
  std::sort(pinned.begin(), pinned.end());
  return pinned;
}

void Slam::Impl::thin_path() {
  std::vector<ScanRecord>& records = state.ledger.records;
  const std::size_t piece = std::min(kPiece, path_limit);
  if (records.size() < 2 * piece) return;
  ScanId settled = next_scan() - static_cast<ScanId>(piece);
  if (!state.suspect_ids.empty()) settled = std::min(settled, state.suspect_ids.front());
  if (!state.beginning.empty()) settled = std::min(settled, session_begin());
  if (settled < state.old.end() + static_cast<ScanId>(piece)) return;
  // No scan waits for the back end, which seldom has much to do: the next one may find it at rest.
  if (schedule == Schedule::kLatest && !runner->at_rest() && records.size() < kMostPieces * piece) return;
  runner->wait();
  const std::size_t ready = record_of(settled);
  state.old.add(std::span(records).first(ready));
  records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(ready));
  state.old.thin(path_limit, pinned_scans(runner->idle()));
  forget_keyframes();
}

/// Of the keyframes that became no nodes those are forgotten at which no scan that is kept stands.
void Slam::Impl::forget_keyframes() {
  std::vector<std::int32_t> needed;
  for (const OldScan& old : state.old.scans()) {
    if (old.record.keyframe >= 0) needed.push_back(old.record.keyframe);
  }
  const std::vector<ScanRecord>& records = state.ledger.records;
  const auto next = std::find_if(records.begin(), records.end(), [](const ScanRecord& r) { return r.keyframe >= 0; });
  const std::int32_t recent = next == records.end() ? state.ledger.keyframes : next->keyframe;
  const KeyframeNumbers numbers = runner->idle().keep_keyframes(needed, recent);
  // A break is remembered with the first keyframe after it that is kept.
  for (std::int32_t& keyframe : state.ledger.breaks) keyframe = numbers.next(keyframe);
  auto& breaks = state.ledger.breaks;
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
}

/// All goes on as if no more scans had come than are kept.
void Slam::Impl::count_kept() {
  const std::shared_ptr<SlamState::Data> whole = checkpoint();
  make_whole(*whole);
  runner = std::make_unique<BackendRunner>(options, std::exchange(whole->backend, {}), schedule, executor);
  runner->set_pending(std::exchange(whole->pending, nullptr));
  whole->odometry = {};  // the tracker holds these
  whole->suspects = {};
  state = std::move(*whole);
  kept = {-1, nullptr, nullptr};
}

void Slam::set_path_limit(std::size_t scans) {
  impl_->path_limit = scans;
  impl_->state.ledger.records = impl_->all_records();
  impl_->packed.clear();
}

}  // namespace phasescan
