/// A door between sqlite and a database file that may have been cut off.
#pragma once

#include <cstdint>
#include <string>

namespace phasescan {

/// Name of a sqlite VFS for reading files that may have been cut off. sqlite itself takes what lies beyond a file's end
/// for zeros, and would hand over rows that are half zeros; through this door a page that is not there whole is damage.
/// Writes nothing and shares nothing: a write-ahead log is read in exclusive locking mode, and stays as it is.
const char* whole_page_vfs();

/// How many bytes a database file should have by its own header; 0 where the header does not say.
std::uint64_t stated_database_bytes(const std::string& path);

/// Whether the first 16 bytes are not "SQLite format 3" and the rest of the header is one: they are put back on
/// reading.
bool is_headless_database(const std::string& path);

}  // namespace phasescan
