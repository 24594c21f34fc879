// What a map was made of, in 128 bits: MurmurHash3 x64 (A. Appleby, public domain), whose answers are the same on every
// machine. It tells maps apart; it keeps nobody from making two that look alike.
#include <bit>
#include <cstring>

#include "phasescan/localize/localizer.hpp"
#include "state/writer.hpp"

namespace phasescan {
namespace {

constexpr std::uint64_t kFirst = 0x87c37b91114253d5ULL, kSecond = 0x4cf5ad432745937fULL;

std::uint64_t number_at(const char* bytes) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes, sizeof(value));
  if constexpr (std::endian::native == std::endian::big) {
    std::uint64_t turned = 0;
    for (int i = 0; i < 8; ++i) turned = turned << 8 | (value >> (8 * i) & 0xFFU);
    value = turned;
  }
  return value;
}

std::uint64_t spread_first(std::uint64_t k) {
  return std::rotl(k * kFirst, 31) * kSecond;
}

std::uint64_t spread_second(std::uint64_t k) {
  return std::rotl(k * kSecond, 33) * kFirst;
}

std::uint64_t mixed(std::uint64_t k) {
  k = (k ^ k >> 33) * 0xff51afd7ed558ccdULL;
  k = (k ^ k >> 33) * 0xc4ceb9fe1a85ec53ULL;
  return k ^ k >> 33;
}

MapDigest digest_from(MapDigest h, std::string_view bytes) {
  std::string_view rest = bytes;
  for (; rest.size() >= 16; rest.remove_prefix(16)) {
    h.low ^= spread_first(number_at(rest.data()));
    h.low = (std::rotl(h.low, 27) + h.high) * 5 + 0x52dce729;
    h.high ^= spread_second(number_at(rest.data() + 8));
    h.high = (std::rotl(h.high, 31) + h.low) * 5 + 0x38495ab5;
  }
  char tail[16] = {};
  if (!rest.empty()) std::memcpy(tail, rest.data(), rest.size());
  h.high ^= spread_second(number_at(tail + 8));
  h.low ^= spread_first(number_at(tail));
  h.low ^= bytes.size(), h.high ^= bytes.size();
  h.low += h.high, h.high += h.low;
  h.low = mixed(h.low), h.high = mixed(h.high);
  h.low += h.high, h.high += h.low;
  return h;
}

}  // namespace

MapDigest digest_of(std::string_view bytes) {
  return digest_from({}, bytes);
}

MapDigest digest_of(const TrinaryMap& map) {
  StateWriter place;
  place.write(map.width), place.write(map.height), place.write(map.resolution_m), place.write(map.origin);
  static_assert(sizeof(CellState) == 1);
  const std::string_view cells(reinterpret_cast<const char*>(map.cells.data()), map.cells.size());
  return digest_from(digest_of(place.bytes), cells);
}

}  // namespace phasescan
