/// A door between sqlite and a database file that may have been cut off.
#pragma once

#include <cstdint>
#include <string>

namespace phasescan {

/// Name of a sqlite VFS for reading files that may have been cut off. sqlite itself takes what lies beyond a file's end
/// for zeros, and would hand over rows that are half zeros; through this door a page that is not there whole is damage.
/// Knows no write-ahead log.
const char* whole_page_vfs();

/// How many bytes a database file should have by its own header; 0 where the header does not say.
std::uint64_t stated_database_bytes(const std::string& path);

}  // namespace phasescan
