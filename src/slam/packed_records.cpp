#include "slam/packed_records.hpp"

#include <cstring>

namespace phasescan {
namespace {

// A record: status and flags, the step of its keyframe and the change of the step of its stamp as variable-length
// numbers, then the pose. Scans come at an even pace and mostly at one keyframe: both numbers are short.
constexpr int kStatusBits = 3;
constexpr std::uint8_t kRepeated = 1U << kStatusBits, kLeftOut = kRepeated << 1;

/// Wraps round where a step is out of range; so does the way back.
std::uint64_t minus(std::int64_t a, std::int64_t b) {
  return static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b);
}
std::int64_t plus(std::int64_t a, std::uint64_t step) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + step);
}

/// Small numbers of either sign in few bytes.
void put(std::uint64_t step, std::vector<std::uint8_t>& out) {
  std::uint64_t left = step << 1 ^ (step >> 63 ? ~std::uint64_t{0} : 0);
  for (; left >= 128; left >>= 7) out.push_back(static_cast<std::uint8_t>(left | 128));
  out.push_back(static_cast<std::uint8_t>(left));
}

std::uint64_t take(const std::uint8_t*& at) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const std::uint8_t byte = *at++;
    value |= static_cast<std::uint64_t>(byte & 127) << shift;
    if (byte < 128) break;
  }
  return value >> 1 ^ (value & 1 ? ~std::uint64_t{0} : 0);
}

/// What the next record is told relative to.
struct LastRecord {
  std::int64_t stamp = 0, keyframe = 0;
  std::uint64_t step = 0;  // of the stamp
};

void pack(const ScanRecord& record, LastRecord& before, std::vector<std::uint8_t>& out) {
  const auto status = static_cast<std::uint8_t>(record.status);
  out.push_back(
      static_cast<std::uint8_t>(status | (record.repeated ? kRepeated : 0) | (record.left_out ? kLeftOut : 0)));
  put(minus(record.keyframe, before.keyframe), out);
  const std::uint64_t step = minus(record.stamp, before.stamp);
  put(step - before.step, out);
  for (const float value : {record.x, record.y, record.theta}) {
    std::uint8_t bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.insert(out.end(), bytes, bytes + sizeof value);
  }
  before = {record.stamp, record.keyframe, step};
}

ScanRecord unpack(const std::uint8_t*& at, LastRecord& before) {
  ScanRecord record;
  const std::uint8_t flags = *at++;
  record.status = static_cast<TrackingStatus>(flags & (kRepeated - 1));
  record.repeated = (flags & kRepeated) != 0;
  record.left_out = (flags & kLeftOut) != 0;
  record.keyframe = static_cast<std::int32_t>(plus(before.keyframe, take(at)));
  const std::uint64_t step = before.step + take(at);
  record.stamp = plus(before.stamp, step);
  for (float* value : {&record.x, &record.y, &record.theta}) {
    std::memcpy(value, at, sizeof *value);
    at += sizeof *value;
  }
  before = {record.stamp, record.keyframe, step};
  return record;
}

}  // namespace

void PackedRecords::add(std::span<const ScanRecord> records) {
  std::vector<std::uint8_t> chunk;
  LastRecord before;
  for (const ScanRecord& record : records) pack(record, before, chunk);
  chunk.shrink_to_fit();
  chunks_.push_back(std::move(chunk));
  size_ += records.size();
}

void PackedRecords::clear() {
  chunks_.clear();
  size_ = 0;
}

std::vector<ScanRecord> PackedRecords::records() const {
  std::vector<ScanRecord> out;
  out.reserve(size_);
  for (const std::vector<std::uint8_t>& chunk : chunks_) {
    LastRecord before;
    for (const std::uint8_t* at = chunk.data(); at != chunk.data() + chunk.size();) out.push_back(unpack(at, before));
  }
  return out;
}

}  // namespace phasescan
