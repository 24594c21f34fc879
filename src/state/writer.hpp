/// Any state with a `visit` as bytes: what is not visited is lost. Little endian, of the same size on every machine.
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
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "state/fields.hpp"

namespace phasescan {

/// Objects that several fields share are written once. One for all parts of a state.
class SharedWritten {
 public:
  /// @return the number of an object that was written, from 1; 0: it was not
  template <class T>
  std::uint32_t number_of(const T* object) const {
    const auto table = numbers_.find(typeid(T));
    if (table == numbers_.end()) return 0;
    const auto entry = table->second.find(object);
    return entry == table->second.end() ? 0 : entry->second;
  }
  template <class T>
  std::uint32_t count() const {
    const auto table = numbers_.find(typeid(T));
    return table == numbers_.end() ? 0 : static_cast<std::uint32_t>(table->second.size());
  }
  template <class T>
  void add(const T* object) {
    auto& table = numbers_[typeid(T)];
    table.emplace(object, static_cast<std::uint32_t>(table.size() + 1));
  }

 private:
  std::map<std::type_index, std::map<const void*, std::uint32_t>> numbers_;
};

class StateWriter {
 public:
  StateWriter() : own_(std::make_unique<SharedWritten>()), shared_(own_.get()) {}
  explicit StateWriter(SharedWritten& shared) : shared_(&shared) {}
  std::string bytes;

  template <class T>
  void operator()(const char*, const T& value) {
    write(value);
  }

  template <class T>
  void write(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      bytes += static_cast<char>(value ? 1 : 0);
    } else if constexpr (std::is_enum_v<T>) {
      bytes += static_cast<char>(value);
    } else if constexpr (std::is_arithmetic_v<T>) {
      put(value);
    } else {
      StateFields<T>::visit(value, *this);
    }
  }
  void write(const std::string& text) {
    write_size(text.size());
    bytes += text;
  }
  template <class T, int R, int C>
  void write(const Eigen::Matrix<T, R, C>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) put(m.data()[i]);
  }
  template <class T>
  void write(const std::vector<T>& values) {
    write_size(values.size());
    if constexpr (std::is_arithmetic_v<T> && std::endian::native == std::endian::little) {
      if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    } else {
      for (const T& value : values) write(value);
    }
  }
  template <class T, std::size_t N>
  void write(const std::array<T, N>& values) {
    for (const T& value : values) write(value);
  }
  template <class A, class B>
  void write(const std::pair<A, B>& value) {
    write(value.first), write(value.second);
  }
  template <class K, class T>
  void write(const std::map<K, T>& values) {
    write_size(values.size());
    for (const auto& [key, value] : values) write(key), write(value);
  }
  template <class T>
  void write(const std::optional<T>& value) {
    write(value.has_value());
    if (value) write(*value);
  }
  template <class T>
  void write(const std::shared_ptr<const T>& value) {
    if (!value) return put(std::uint32_t{0});
    if (const std::uint32_t number = shared_->number_of(value.get()); number > 0) return put(number);
    put(shared_->count<T>() + 1);
    write(*value);
    shared_->add(value.get());
  }

 private:
  void write_size(std::size_t n) { put(static_cast<std::uint64_t>(n)); }
  template <class T>
  void put(T value) {
    if constexpr (std::is_same_v<T, std::size_t> || std::is_same_v<T, unsigned long long>) {
      static_assert(sizeof(T) == 8);
    }
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
  }

  std::unique_ptr<SharedWritten> own_;
  SharedWritten* shared_;
};

/// @return of a value in which all that may be empty is
template <class T>
std::size_t least_state_bytes() {
  static const std::size_t least = [] {
    StateWriter writer;
    writer.write(T{});
    return std::max<std::size_t>(1, writer.bytes.size());
  }();
  return least;
}

}  // namespace phasescan
