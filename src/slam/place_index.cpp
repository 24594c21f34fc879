#include "slam/place_index.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/place_index.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Inner products of the query with each of `count` rows of `size` numbers, a multiple of 32.
void InnerProducts(const std::int16_t* HWY_RESTRICT query, const std::int8_t* HWY_RESTRICT rows, std::size_t count,
                   std::size_t size, std::int32_t* HWY_RESTRICT out) {
  const hn::CappedTag<std::int16_t, 32> d16;
  const hn::Rebind<std::int8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  for (std::size_t k = 0; k < count; ++k, rows += size) {
    auto even = hn::Zero(d32), odd = hn::Zero(d32);
    for (std::size_t i = 0; i < size; i += hn::Lanes(d16)) {
      const auto row = hn::PromoteTo(d16, hn::LoadU(d8, rows + i));
      even = hn::ReorderWidenMulAccumulate(d32, hn::LoadU(d16, query + i), row, even, odd);
    }
    out[k] = hn::GetLane(hn::SumOfLanes(d32, hn::Add(even, odd)));
  }
}

// Of each harmonic the real parts of conj(row) x query summed, then the imaginary parts of each: places' numbers in
// four bits each, the query's as `re` and `im`.
void HarmonicSums(const std::uint8_t* HWY_RESTRICT row, const std::int16_t* HWY_RESTRICT re,
                  const std::int16_t* HWY_RESTRICT im, std::size_t harmonics, std::size_t numbers,
                  float* HWY_RESTRICT sums) {
  const hn::CappedTag<std::int16_t, 16> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  for (std::size_t h = 0; h < harmonics; ++h, row += numbers, re += numbers, im += numbers) {
    auto real = hn::Zero(d32), real_odd = real, imag = real, imag_odd = real;
    for (std::size_t i = 0; i < numbers; i += hn::Lanes(d16)) {
      const auto both = hn::PromoteTo(d16, hn::LoadU(d8, row + i));
      const auto row_re = hn::ShiftRight<12>(hn::ShiftLeft<12>(both)),
                 row_im = hn::ShiftRight<12>(hn::ShiftLeft<8>(both));
      const auto query_re = hn::LoadU(d16, re + i), query_im = hn::LoadU(d16, im + i);
      real = hn::ReorderWidenMulAccumulate(d32, row_re, query_re, real, real_odd);
      real = hn::ReorderWidenMulAccumulate(d32, row_im, query_im, real, real_odd);
      imag = hn::ReorderWidenMulAccumulate(d32, row_re, query_im, imag, imag_odd);
      imag = hn::ReorderWidenMulAccumulate(d32, hn::Neg(row_im), query_re, imag, imag_odd);
    }
    sums[h] = static_cast<float>(hn::GetLane(hn::SumOfLanes(d32, hn::Add(real, real_odd))));
    sums[harmonics + h] = static_cast<float>(hn::GetLane(hn::SumOfLanes(d32, hn::Add(imag, imag_odd))));
  }
}

// The largest of `turns` sums of products with the columns of a table. Whole numbers below 2^24 throughout, which
// floats hold exactly in whatever order they are added.
float LargestSum(const float* HWY_RESTRICT sums, std::size_t count, const float* HWY_RESTRICT table,
                 std::size_t turns) {
  const hn::CappedTag<float, 16> d;
  auto most = hn::Set(d, -16777216.0F);
  for (std::size_t t = 0; t < turns; t += hn::Lanes(d)) {
    auto sum = hn::Zero(d);
    for (std::size_t k = 0; k < count; ++k)
      sum = hn::MulAdd(hn::Set(d, sums[k]), hn::LoadU(d, table + k * turns + t), sum);
    most = hn::Max(most, sum);
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
HWY_EXPORT(InnerProducts);
HWY_EXPORT(HarmonicSums);
HWY_EXPORT(LargestSum);

namespace {

constexpr std::size_t kBlock = 512;  // distances worked out before they are looked at
constexpr std::size_t kTurns = 64;   // of half a turn; 32 cost 0.2 points of recall
constexpr std::size_t kSums = 2 * kTurningHarmonics;
// Of n places sqrt(n) are compared over all turns: 100 of ten thousand. More find a few more and take longer.
constexpr std::size_t kLeastCompared = 32;
// What an inner product of numbers that do not turn counts for. That of a place with itself is 40,000, its turned
// likeness about 500,000; half or twice as much costs 0.2 points of recall at most.
constexpr std::int32_t kNumbersCount = 3;

std::int32_t squares(const PlaceDescriptor& d) {
  std::int32_t sum = 0;
  for (const std::int8_t v : d.numbers) sum += v * v;
  return sum;
}

/// 127 cos(2 h t) for each harmonic h, then -127 sin(2 h t); of each all turns t.
std::array<float, kSums * kTurns> make_turns() {
  std::array<float, kSums * kTurns> out{};
  for (std::size_t h = 0; h < kTurningHarmonics; ++h) {
    for (std::size_t t = 0; t < kTurns; ++t) {
      const double angle = kTwoPi * static_cast<double>((h + 1) * t % kTurns) / kTurns;
      out[h * kTurns + t] = static_cast<float>(std::round(127.0 * std::cos(angle)));
      out[(kTurningHarmonics + h) * kTurns + t] = static_cast<float>(std::round(-127.0 * std::sin(angle)));
    }
  }
  return out;
}

/// A query's turning numbers, unpacked.
struct TurningQuery {
  std::array<std::int16_t, kTurningSize> re{}, im{};

  explicit TurningQuery(const PlaceDescriptor& query) {
    for (std::size_t k = 0; k < kTurningSize; ++k) {
      const int both = query.turning[k];
      re[k] = static_cast<std::int16_t>(((both & 15) ^ 8) - 8);
      im[k] = static_cast<std::int16_t>(((both >> 4) ^ 8) - 8);
    }
  }

  std::int32_t likeness(const std::uint8_t* row) const {
    static const auto kTable = make_turns();
    std::array<float, kSums> sums;
    HWY_DYNAMIC_DISPATCH(HarmonicSums)(row, re.data(), im.data(), kTurningHarmonics, kTurningNumbers, sums.data());
    return static_cast<std::int32_t>(HWY_DYNAMIC_DISPATCH(LargestSum)(sums.data(), kSums, kTable.data(), kTurns));
  }
};

bool nearer(const PlaceHit& a, const PlaceHit& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.place < b.place;
}

/// Leaves `count` hits of as many or more, in no order.
/// @return  the distance of the farthest
std::uint32_t keep_nearest(std::vector<PlaceHit>& hits, std::size_t count) {
  const auto last = hits.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(hits.begin(), last, hits.end(), nearer);
  hits.resize(count);
  return hits.back().distance;
}

bool liker(const PlaceHit& a, const PlaceHit& b) {
  return a.likeness != b.likeness ? a.likeness > b.likeness : nearer(a, b);
}

}  // namespace

std::int32_t turned_likeness(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  return TurningQuery(b).likeness(a.turning.data());
}

std::uint32_t PlaceIndex::add(const PlaceDescriptor& descriptor) {
  numbers_.insert(numbers_.end(), descriptor.numbers.begin(), descriptor.numbers.end());
  turning_.insert(turning_.end(), descriptor.turning.begin(), descriptor.turning.end());
  squares_.push_back(squares(descriptor));
  return static_cast<std::uint32_t>(size() - 1);
}

std::vector<PlaceHit> PlaceIndex::shortlist(const PlaceDescriptor& query, std::size_t count, std::size_t n) const {
  std::vector<PlaceHit> best;
  count = std::min(count, n);
  if (count == 0) return best;
  best.reserve(2 * count);
  std::array<std::int16_t, kDescriptorSize> wide;
  std::copy(query.numbers.begin(), query.numbers.end(), wide.begin());
  const std::int32_t query_squares = squares(query);
  std::array<std::int32_t, kBlock> products;
  auto enough = std::numeric_limits<std::uint32_t>::max();  // of `count` places each is as near
  for (std::size_t from = 0; from < n; from += kBlock) {
    const std::size_t block = std::min(kBlock, n - from);
    HWY_DYNAMIC_DISPATCH(InnerProducts)
    (wide.data(), numbers_.data() + from * kDescriptorSize, block, kDescriptorSize, products.data());
    for (std::size_t k = 0; k < block; ++k) {
      const auto distance = static_cast<std::uint32_t>(query_squares + squares_[from + k] - 2 * products[k]);
      if (distance >= enough) continue;
      best.push_back({static_cast<std::uint32_t>(from + k), distance, 0});
      if (best.size() == 2 * count) enough = keep_nearest(best, count);
    }
  }
  keep_nearest(best, count);
  return best;
}

void PlaceIndex::append(const PlaceIndex& other) {
  numbers_.insert(numbers_.end(), other.numbers_.begin(), other.numbers_.end());
  turning_.insert(turning_.end(), other.turning_.begin(), other.turning_.end());
  squares_.insert(squares_.end(), other.squares_.begin(), other.squares_.end());
}

std::vector<PlaceHit> PlaceIndex::nearest(const PlaceDescriptor& query, std::size_t count, std::size_t limit) const {
  std::vector<PlaceHit> best = shortlist(query, count, limit == 0 ? size() : std::min(limit, size()));
  std::sort(best.begin(), best.end(), nearer);
  return best;
}

std::vector<PlaceHit> PlaceIndex::most_alike(const PlaceDescriptor& query, std::size_t count, std::size_t limit) const {
  const std::size_t n = limit == 0 ? size() : std::min(limit, size());
  const auto compared =
      std::max(kLeastCompared, static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n)))));
  std::vector<PlaceHit> hits = shortlist(query, count == 0 ? 0 : std::max(count, compared), n);
  const std::int32_t query_squares = squares(query);
  const TurningQuery turning(query);
  for (PlaceHit& hit : hits) {
    const std::int32_t product = (query_squares + squares_[hit.place] - static_cast<std::int32_t>(hit.distance)) / 2;
    hit.likeness = kNumbersCount * product + turning.likeness(turning_.data() + hit.place * kTurningSize);
  }
  const auto end = hits.begin() + static_cast<std::ptrdiff_t>(std::min(count, hits.size()));
  std::partial_sort(hits.begin(), end, hits.end(), liker);
  hits.erase(end, hits.end());
  return hits;
}

}  // namespace phasescan
#endif
