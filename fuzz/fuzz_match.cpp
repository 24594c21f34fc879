// Two arbitrary scans matched: an answer for any ranges, limits and angles, never a NaN and never a crash.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "phasescan/match/scan_matcher.hpp"

namespace {

/// Values out of the input; zeros where it has ended.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  template <class T>
  T get() {
    T value{};
    const std::size_t n = std::min(sizeof value, size_);
    if (n > 0) std::memcpy(&value, data_, n);
    data_ += n;
    size_ -= n;
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

phasescan::Scan scan_of(Input& input) {
  phasescan::ScanGeometry geometry;
  geometry.angle_min = input.get<float>();
  geometry.angle_increment = input.get<float>();
  geometry.range_min = input.get<float>();
  geometry.range_max = input.get<float>();
  const std::size_t beams = input.get<std::uint16_t>() % 512;
  const bool plain = (input.get<std::uint8_t>() & 1) != 0;
  std::vector<float> ranges(beams);
  // Plain ranges are centimetres, so that most inputs are scans a matcher has something to do with.
  for (float& range : ranges)
    range = plain ? static_cast<float>(input.get<std::uint16_t>() % 1200) * 0.01F : input.get<float>();
  return phasescan::make_scan(ranges, geometry);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  static phasescan::ScanMatcher matcher;
  try {
    const phasescan::Scan reference = scan_of(input);
    const phasescan::Scan scan = scan_of(input);
    const phasescan::MatchResult result = matcher.match(reference, scan);
    if (!result.T_ref_scan.is_finite() || !result.covariance.allFinite() || !std::isfinite(result.overlap))
      __builtin_trap();
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
