/// The way back from bytes to a state. Bytes may be anything: what is read is no larger than they justify, and values
/// that nothing can work with are refused.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "state/fields.hpp"
#include "state/writer.hpp"

namespace phasescan {

/// Objects that were read, in the order in which they were written. One for all parts of a state.
class SharedRead {
 public:
  template <class T>
  std::vector<std::shared_ptr<const T>>& of() {
    auto& table = tables_[typeid(T)];
    if (!table) table = std::make_shared<std::vector<std::shared_ptr<const T>>>();
    return *static_cast<std::vector<std::shared_ptr<const T>>*>(table.get());
  }

 private:
  std::map<std::type_index, std::shared_ptr<void>> tables_;
};

class StateReader {
 public:
  explicit StateReader(std::string_view bytes, int version = 1)
      : bytes_(bytes), version_(version), own_(std::make_unique<SharedRead>()), shared_(own_.get()) {}
  StateReader(std::string_view bytes, int version, SharedRead& shared)
      : bytes_(bytes), version_(version), shared_(&shared) {}

  /// Of the state that is read.
  int version() const { return version_; }
  bool at_end() const { return bytes_.empty(); }

  /// @throws StateFormatError
  template <class T>
  void operator()(const char* name, T& value) {
    const char* before = std::exchange(field_, name);
    read(value);
    field_ = before;
  }

  template <class T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const auto byte = get<std::uint8_t>();
      if (byte > 1) refuse("neither true nor false");
      value = byte == 1;
    } else if constexpr (std::is_enum_v<T>) {
      static_assert(kStateEnumCount<T> > 0, "how many values has it?");
      const auto byte = get<std::uint8_t>();
      if (byte >= kStateEnumCount<T>) refuse("a value that does not exist");
      value = static_cast<T>(byte);
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = get<T>();
    } else {
      StateFields<T>::visit(value, *this);
      if (const char* problem = state_problem(value)) refuse(problem);
    }
  }
  void read(std::string& text) {
    const std::size_t n = size(1);
    text.assign(bytes_.substr(0, n));
    bytes_.remove_prefix(n);
  }
  template <class T, int R, int C>
  void read(Eigen::Matrix<T, R, C>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = get<T>();
  }
  template <class T>
  void read(std::vector<T>& values) {
    values.clear();
    if constexpr (std::is_arithmetic_v<T> && std::endian::native == std::endian::little) {
      values.resize(size(sizeof(T)));
      const std::size_t n = values.size() * sizeof(T);
      if (n > 0) std::memcpy(values.data(), bytes_.data(), n);
      bytes_.remove_prefix(n);
    } else {
      values.resize(size(least_state_bytes<T>()));
      for (T& value : values) read(value);
    }
  }
  template <class T, std::size_t N>
  void read(std::array<T, N>& values) {
    for (T& value : values) read(value);
  }
  template <class A, class B>
  void read(std::pair<A, B>& value) {
    read(value.first), read(value.second);
  }
  template <class K, class T>
  void read(std::map<K, T>& values) {
    values.clear();
    for (std::size_t n = size(least_state_bytes<K>() + least_state_bytes<T>()); n > 0; --n) {
      K key{};
      read(key);
      read(values[std::move(key)]);
    }
  }
  template <class T>
  void read(std::optional<T>& value) {
    value.reset();
    bool set = false;
    read(set);
    if (set) read(value.emplace());
  }
  template <class T>
  void read(std::shared_ptr<const T>& value) {
    value.reset();
    const auto number = get<std::uint32_t>();
    if (number == 0) return;
    auto& known = shared_->of<T>();
    if (number <= known.size()) {
      value = known[number - 1];
      return;
    }
    if (number != known.size() + 1) refuse("an object that is not there");
    if (++depth_ > kMostDepth) refuse("objects within objects without end");
    auto made = std::make_shared<T>();
    read(*made);
    --depth_;
    value = std::move(made);
    known.push_back(value);
  }

 private:
  static constexpr int kMostDepth = 16;

  [[noreturn]] void refuse(const char* what) const {
    throw StateFormatError(std::string(field_ == nullptr ? "it" : field_) + " holds " + what);
  }
  /// Of something whose parts have at least so many bytes each.
  std::size_t size(std::size_t least) {
    const auto n = get<std::uint64_t>();
    if (n > bytes_.size() / least) refuse("more than there are bytes");
    return static_cast<std::size_t>(n);
  }
  template <class T>
  T get() {
    if (bytes_.size() < sizeof(T)) refuse("fewer bytes than it takes");
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data(), sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    return value;
  }

  std::string_view bytes_;
  int version_;
  const char* field_ = nullptr;
  std::unique_ptr<SharedRead> own_;
  SharedRead* shared_;
  int depth_ = 0;
};

}  // namespace phasescan
