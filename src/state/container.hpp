/// The file of a state: named sections, each packed and with a checksum of its own.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

inline constexpr std::uint32_t kStateFileVersion = 4;  ///< written; files of this one and all before are read

struct StateSection {
  std::string name;              ///< at most 16 letters
  std::string content;           ///< unpacked
  std::size_t packed_bytes = 0;  ///< in the file; filled in by unpack_state
};

struct StateSections {
  std::uint32_t version = kStateFileVersion;
  std::vector<StateSection> sections;

  /// @return null where there is none
  const std::string* find(std::string_view name) const;
  /// @throws StateFormatError
  const std::string& at(std::string_view name) const;
};

/// Whether bytes begin as a state file does.
bool looks_like_state(std::string_view bytes);

/// @return the file's bytes. @cost zstd at its fastest levels: 300 MB/s
std::string pack_state(const StateSections& sections);

/// Takes no more memory than 256 times the bytes. @throws StateFormatError saying what is wrong and what was expected
StateSections unpack_state(std::string_view bytes);

/// Writes a file whole or not at all: beside its place, synced and renamed. A device or a pipe is written to. @throws
/// std::system_error
void replace_file(const std::string& path, std::string_view bytes);
/// @throws std::system_error
std::string read_bytes(const std::string& path);

}  // namespace phasescan
