/// Files of named sections, each packed and with a checksum of its own: saved states, and what else is kept this way.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

inline constexpr std::uint32_t kStateFileVersion = 4;  ///< written; files of this one and all before are read

/// What a file is of: files of another kind are refused.
struct StateFileKind {
  std::string_view magic;            ///< 8 bytes that it begins with
  std::uint32_t oldest = 1, newest;  ///< versions that are read
  const char* noun;                  ///< for people
  const char* expected;
};
inline constexpr StateFileKind kSavedState{std::string_view("\x89PSSTATE", 8), 1, kStateFileVersion, "saved state",
                                           "a file written by --save"};

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
bool looks_like_state(std::string_view bytes, const StateFileKind& kind = kSavedState);

/// @return the file's bytes. @cost zstd at its fastest levels: 300 MB/s
std::string pack_state(const StateSections& sections, const StateFileKind& kind = kSavedState);

/// Takes no more memory than 256 times the bytes. @throws StateFormatError saying what is wrong and what was expected
StateSections unpack_state(std::string_view bytes, const StateFileKind& kind = kSavedState);

/// Writes a file whole or not at all: beside its place, synced and renamed. A device or a pipe is written to. @throws
/// std::system_error
void replace_file(const std::string& path, std::string_view bytes);
/// @throws std::system_error
std::string read_bytes(const std::string& path);

}  // namespace phasescan
