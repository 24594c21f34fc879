/// Bytes of a binary format, never read past their end: every length is checked against what is left.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

static_assert(std::endian::native == std::endian::little, "the binary formats are read and written little-endian");

using Bytes = std::span<const std::uint8_t>;

/// Bytes that do not say what their format promises. Readers turn it into damage; it never leaves the io layer.
class DecodeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Little-endian cursor over bytes in memory. Every call throws DecodeError where the bytes end too early.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(bytes) {}

  std::size_t remaining() const { return bytes_.size() - at_; }
  std::size_t position() const { return at_; }

  /// The next n bytes as a view of the input.
  Bytes bytes(std::uint64_t n) {
    if (n > remaining()) {
      throw DecodeError(std::to_string(n) + " bytes stated where " + std::to_string(remaining()) + " are left");
    }
    const Bytes out = bytes_.subspan(at_, static_cast<std::size_t>(n));
    at_ += static_cast<std::size_t>(n);
    return out;
  }

  template <class T>
  T get() {
    T value;
    std::memcpy(&value, bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }

  std::string_view text(std::uint64_t n) {
    const Bytes raw = bytes(n);
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

  /// A u32 length and as many bytes.
  std::string_view prefixed_text() { return text(get<std::uint32_t>()); }
  Bytes prefixed_bytes() { return bytes(get<std::uint32_t>()); }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

/// Appends little-endian values to a buffer.
class ByteWriter {
 public:
  template <class T>
  void put(T value) {
    append(&value, sizeof(T));
  }
  void raw(Bytes more) { append(more.data(), more.size()); }
  void raw(std::string_view text) { append(text.data(), text.size()); }
  void prefixed_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    raw(text);
  }
  void fill(std::size_t n, std::uint8_t value = 0) { bytes_.insert(bytes_.end(), n, value); }
  /// Overwrites a value written before, e.g. a length known only later.
  template <class T>
  void put_at(std::size_t position, T value) {
    std::memcpy(bytes_.data() + position, &value, sizeof(T));
  }

  std::size_t size() const { return bytes_.size(); }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  void append(const void* more, std::size_t n) {
    if (n == 0) return;
    const std::size_t at = bytes_.size();
    bytes_.resize(at + n);
    std::memcpy(bytes_.data() + at, more, n);
  }
  std::vector<std::uint8_t> bytes_;
};

}  // namespace phasescan
