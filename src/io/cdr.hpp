/// CDR, the form in which DDS and ROS 2 lay out messages: values aligned to their own size behind 4 bytes that say the
/// byte order. What writes is XCDR1, little-endian; what reads takes both byte orders and both versions.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "io/bytes.hpp"

namespace phasescan::ros {

/// Appends to a buffer that must be empty.
class CdrOutput {
 public:
  explicit CdrOutput(ByteWriter& out) : out_(out) { out_.put(std::uint32_t{0x00000100}); }
  template <class T>
  void put(T value) {
    align(sizeof(T));
    out_.put(value);
  }
  void text(std::string_view value) {
    put(static_cast<std::uint32_t>(value.size() + 1));
    out_.raw(value);
    out_.put(std::uint8_t{0});
  }
  /// A count and the values.
  template <class T>
  void sequence(std::span<const T> values) {
    put(static_cast<std::uint32_t>(values.size()));
    array(values);
  }
  /// The values alone.
  template <class T>
  void array(std::span<const T> values) {
    if (values.empty()) return;
    align(sizeof(T));
    out_.raw(Bytes(reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()));
  }
  void zero_doubles(std::size_t n) {
    align(sizeof(double));
    out_.fill(n * sizeof(double));
  }

 private:
  void align(std::size_t size) {
    const std::size_t over = (out_.size() - 4) % size;
    if (over != 0) out_.fill(size - over);
  }
  ByteWriter& out_;
};

/// Reads plain CDR. Every call throws DecodeError where the bytes end too early.
class CdrInput {
 public:
  explicit CdrInput(Bytes data) : reader_(data) {
    const Bytes head = reader_.bytes(4);
    const int kind = head[0] << 8 | head[1];
    if (kind != 0 && kind != 1 && kind != 6 && kind != 7) throw DecodeError("not plain CDR");
    big_endian_ = (kind & 1) == 0;
    if (kind >= 6) largest_alignment_ = 4;
  }

  template <class T>
  T get() {
    align(sizeof(T));
    return in_order(reader_.get<T>());
  }
  /// Without the NUL at its end.
  std::string_view text() {
    const auto n = get<std::uint32_t>();
    std::string_view value = reader_.text(n);
    if (!value.empty() && value.back() == '\0') value.remove_suffix(1);
    return value;
  }
  /// A count and as many numbers.
  template <class T>
  void sequence(std::vector<T>& out) {
    const auto n = get<std::uint32_t>();
    if (n > 0) align(sizeof(T));
    const Bytes raw = reader_.bytes(std::uint64_t{n} * sizeof(T));
    out.resize(n);
    if (n > 0) std::memcpy(out.data(), raw.data(), raw.size());
    if (big_endian_) std::transform(out.begin(), out.end(), out.begin(), [this](T value) { return in_order(value); });
  }
  void skip_doubles(int n) {
    align(sizeof(double));
    reader_.bytes(static_cast<std::uint64_t>(n) * sizeof(double));
  }
  std::size_t remaining() const { return reader_.remaining(); }

 private:
  void align(std::size_t size) {
    const std::size_t to = std::min(size, largest_alignment_);
    const std::size_t over = (reader_.position() - 4) % to;
    if (over != 0) reader_.bytes(to - over);
  }
  template <class T>
  T in_order(T value) const {
    if (!big_endian_) return value;
    auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
    std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  ByteReader reader_;
  bool big_endian_ = false;
  std::size_t largest_alignment_ = 8;
};

}  // namespace phasescan::ros
