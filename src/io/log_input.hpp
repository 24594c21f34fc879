/// A log's bytes, opened once and looked at from the front: what a pipe has given it does not give again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "io/byte_source.hpp"

namespace phasescan {

class LogInput {
 public:
  /// How much of the beginning is looked at to tell the format [bytes].
  static constexpr std::size_t kPrefixBytes = std::size_t{1} << 16;

  /// Opens a file, a pipe or a folder; "-" is standard input. @throws InputError (not found, empty, cannot be unpacked
  /// from the first byte on), SystemError
  explicit LogInput(const std::string& path);

  /// The path as the user gave it, "standard input" for "-".
  const std::string& name() const { return name_; }
  /// What to open again, where `is_file`.
  const std::string& path() const { return path_; }
  bool is_folder() const { return folder_; }
  /// A regular file: it can be opened again, and read from any place.
  bool is_file() const { return file_; }
  bool is_packed() const { return packed_; }
  /// Bytes read so far, packed as they lie in the file; goes on counting behind `take`.
  std::shared_ptr<const std::uint64_t> bytes_read() const { return bytes_read_; }

  /// The first bytes, unpacked: kPrefixBytes of them or all. Empty for a folder. Gone with `take`.
  std::string_view prefix() const { return prefix_; }
  /// All bytes from the first on, unpacked. Once.
  ByteStream take() { return std::move(stream_); }

 private:
  std::string path_, name_;
  bool folder_ = false, file_ = false, packed_ = false;
  std::shared_ptr<std::uint64_t> bytes_read_ = std::make_shared<std::uint64_t>(0);
  ByteStream stream_;
  std::string_view prefix_;
};

}  // namespace phasescan
