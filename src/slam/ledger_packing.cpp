// The ledger of a run of days: small while it goes on, whole where it is asked for.
#include <algorithm>
#include <span>

#include "slam/slam_impl.hpp"

namespace phasescan {

void Slam::Impl::settle_records() {
  if (!bounded()) return;
  if (path_limit > 0) {
    thin_path();
  } else {
    pack_records();
  }
}

/// Some thousand records at a time.
void Slam::Impl::pack_records() {
  constexpr std::size_t kPiece = 4096;
  std::vector<ScanRecord>& records = state.ledger.records;
  if (records.size() < 2 * kPiece) return;
  ScanId settled = next_scan() - static_cast<ScanId>(kPiece);
  if (!state.suspect_ids.empty()) settled = std::min(settled, state.suspect_ids.front());
  if (state.first) settled = std::min(settled, state.first->scan);
  std::size_t done = 0;
  for (const std::size_t ready = record_of(settled); done + kPiece <= ready; done += kPiece)
    packed.add(std::span(records).subspan(done, kPiece));
  records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(done));
  if (records.capacity() > 8 * kPiece) records.shrink_to_fit();
}

std::vector<ScanRecord> Slam::Impl::all_records() const {
  std::vector<ScanRecord> all = packed.records();
  all.insert(all.end(), state.ledger.records.begin(), state.ledger.records.end());
  return all;
}

}  // namespace phasescan
