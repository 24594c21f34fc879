#include "slam/whole_run.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "slam/keyframe_numbers.hpp"

namespace phasescan {
namespace {

class Numbers {
 public:
  explicit Numbers(const SlamState::Data& data)
      : old_(data.old.scans()), end_(data.old.end()), keyframes_(data.backend.session.numbers()) {}

  /// The scan, or where it was left out the last one before it that is kept.
  ScanId scan(ScanId scan) const {
    const auto kept = static_cast<ScanId>(old_.size());
    if (scan >= end_) return kept + scan - end_;
    const auto after = std::upper_bound(old_.begin(), old_.end(), scan,
                                        [](ScanId number, const OldScan& old) { return number < old.scan; });
    return after - old_.begin() - 1;
  }
  std::int32_t keyframe(std::int32_t keyframe) const { return keyframes_.before(keyframe); }
  KeyframeId submitted(std::size_t count) const { return keyframes_.before(static_cast<std::int32_t>(count)); }

 private:
  const std::vector<OldScan>& old_;
  ScanId end_ = 0;
  KeyframeNumbers keyframes_;
};

void renumber(std::vector<Keyframe>& keyframes, const Numbers& numbers) {
  for (Keyframe& keyframe : keyframes) keyframe.scan = numbers.scan(keyframe.scan);
}

void renumber(SlamState::Data& data, const Numbers& numbers) {
  ScanLedger& ledger = data.ledger;
  for (ScanRecord& record : ledger.records) {
    if (record.keyframe >= 0) record.keyframe = numbers.keyframe(record.keyframe);
  }
  for (std::int32_t& keyframe : ledger.breaks) keyframe = numbers.keyframe(keyframe);
  for (std::int64_t& first : ledger.sessions) first = numbers.scan(first);
  ledger.keyframes = numbers.keyframe(ledger.keyframes);
  if (ledger.wheels_off >= 0) ledger.wheels_off = numbers.scan(ledger.wheels_off);
  renumber(data.backend.session.keyframes, numbers);
  renumber(data.backend.admission.waiting, numbers);
  renumber(data.batch, numbers);
  for (ScanId& id : data.suspect_ids) id = numbers.scan(id);
  if (data.first) data.first->scan = numbers.scan(data.first->scan);
  data.last.scan = numbers.scan(data.last.scan);
  if (data.last.keyframe) *data.last.keyframe = numbers.keyframe(static_cast<std::int32_t>(*data.last.keyframe));
  for (auto& [kind, oddity] : data.input.oddities) oddity.first = numbers.scan(oddity.first);
  data.session_keyframe = numbers.keyframe(data.session_keyframe);
}

/// The same map, of the nodes as they are numbered now.
std::shared_ptr<const BackendResult> renumbered(const std::shared_ptr<const BackendResult>& result,
                                                const GraphSessionState& session, const Numbers& numbers) {
  if (!result) return result;
  auto snapshot = std::make_shared<BackendSnapshot>(*result->snapshot);
  snapshot->submitted = static_cast<std::size_t>(numbers.submitted(snapshot->submitted));
  snapshot->nodes = {};
  for (std::size_t i = 0; i < snapshot->poses.size(); ++i) snapshot->nodes.push_back(node_of(session.keyframes[i]));
  auto out = std::make_shared<BackendResult>(*result);
  out->snapshot = std::move(snapshot);
  return out;
}

}  // namespace

void make_whole(SlamState::Data& data) {
  if (data.session_start) {
    auto start = std::make_shared<SlamState::Data>(*data.session_start);
    make_whole(*start);
    data.session_start = std::move(start);
  }
  if (data.old.end() == 0) return;
  const Numbers numbers(data);
  std::vector<ScanRecord> records;
  records.reserve(data.old.scans().size() + data.ledger.records.size());
  for (const OldScan& old : data.old.scans()) records.push_back(old.record);
  records.insert(records.end(), data.ledger.records.begin(), data.ledger.records.end());
  data.ledger.records = std::move(records);
  renumber(data, numbers);
  data.entered = renumbered(data.entered, data.backend.session, numbers);
  data.pending = renumbered(data.pending, data.backend.session, numbers);
  data.backend.session.count_kept();
  data.old = {};
}

}  // namespace phasescan
