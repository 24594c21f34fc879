// Source: sqlite.org, "The OS interface" and "Database file format" (header offsets 16, 24, 28, 92).
#include "io/sqlite_vfs.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <optional>
#include <string_view>

#include "io/byte_source.hpp"

namespace phasescan {
namespace {

constexpr int kHeaderBytes = 100;
using Header = std::array<std::uint8_t, kHeaderBytes>;

std::uint64_t stated_bytes(const Header& header) {
  const auto big_endian = [&header](std::size_t at, std::size_t n) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < n; ++i) value = value * 256 + header[at + i];
    return value;
  };
  // The count of pages holds only where the file was last written by a sqlite that keeps it.
  if (big_endian(24, 4) != big_endian(92, 4)) return 0;
  const std::uint64_t page = big_endian(16, 2) == 1 ? 65536 : big_endian(16, 2);
  return page * big_endian(28, 4);
}

/// A file of sqlite's own VFS, whose object stands right behind this one, with the size that its header states.
struct WholePageFile {
  sqlite3_file base;
  sqlite3_int64 stated;
  bool headless;  ///< its first 16 bytes are not what they were: they are put back on reading
};

constexpr std::string_view kFirstBytes{"SQLite format 3\0", 16};

bool is_headless(const Header& header) {
  const std::size_t page = static_cast<std::size_t>(header[16]) << 8 | header[17];
  const bool page_size = page == 1 || (page >= 512 && (page & (page - 1)) == 0);
  const bool fractions = header[21] == 64 && header[22] == 32 && header[23] == 32;
  return page_size && fractions && std::memcmp(header.data(), kFirstBytes.data(), kFirstBytes.size()) != 0;
}

sqlite3_file* real(sqlite3_file* file) {
  return reinterpret_cast<sqlite3_file*>(reinterpret_cast<WholePageFile*>(file) + 1);
}
sqlite3_vfs* real(sqlite3_vfs* vfs) {
  return static_cast<sqlite3_vfs*>(vfs->pAppData);
}

int close_file(sqlite3_file* file) {
  return real(file)->pMethods->xClose(real(file));
}
int read_file(sqlite3_file* file, void* out, int n, sqlite3_int64 at) {
  const int rc = real(file)->pMethods->xRead(real(file), out, n, at);
  const auto begin = static_cast<std::size_t>(std::max<sqlite3_int64>(at, 0));
  if (reinterpret_cast<WholePageFile*>(file)->headless && begin < kFirstBytes.size()) {
    const auto count = std::min(kFirstBytes.size() - begin, static_cast<std::size_t>(n));
    std::memcpy(out, kFirstBytes.data() + begin, count);
  }
  return rc == SQLITE_IOERR_SHORT_READ ? SQLITE_CORRUPT : rc;
}
int file_size(sqlite3_file* file, sqlite3_int64* size) {
  const int rc = real(file)->pMethods->xFileSize(real(file), size);
  // With the stated size sqlite asks for the pages that are missing, instead of taking them for empty.
  *size = std::max(*size, reinterpret_cast<WholePageFile*>(file)->stated);
  return rc;
}
int refuse_write(sqlite3_file*, const void*, int, sqlite3_int64) {
  return SQLITE_READONLY;
}
int refuse_truncate(sqlite3_file*, sqlite3_int64) {
  return SQLITE_READONLY;
}
int do_nothing(sqlite3_file*, int) {
  return SQLITE_OK;
}
int no_lock(sqlite3_file*, int* locked) {
  *locked = 0;
  return SQLITE_OK;
}
int file_control(sqlite3_file* file, int op, void* argument) {
  return real(file)->pMethods->xFileControl(real(file), op, argument);
}
int sector_size(sqlite3_file* file) {
  return real(file)->pMethods->xSectorSize(real(file));
}
int characteristics(sqlite3_file* file) {
  return real(file)->pMethods->xDeviceCharacteristics(real(file));
}

const sqlite3_io_methods kMethods = {
    1,          close_file, read_file, refuse_write, refuse_truncate, do_nothing,      file_size,
    do_nothing, do_nothing, no_lock,   file_control, sector_size,     characteristics, nullptr,
    nullptr,    nullptr,    nullptr,   nullptr,      nullptr};

int open_file(sqlite3_vfs* vfs, sqlite3_filename name, sqlite3_file* file, int flags, int* out_flags) {
  auto* whole = ::new (file) WholePageFile{};
  // Files with names are the recording and what its recorder left beside it: none of them is ever written.
  if (name != nullptr) flags = (flags & ~(SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE)) | SQLITE_OPEN_READONLY;
  const int rc = real(vfs)->xOpen(real(vfs), name, real(file), flags, out_flags);
  if (rc != SQLITE_OK) return rc;
  whole->base.pMethods = &kMethods;
  Header header{};
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0 &&
      real(file)->pMethods->xRead(real(file), header.data(), kHeaderBytes, 0) == SQLITE_OK) {
    whole->headless = is_headless(header);
    // Beside a write-ahead log the header is of the time before it.
    if (sqlite3_uri_boolean(name, "immutable", 0) != 0)
      whole->stated = static_cast<sqlite3_int64>(stated_bytes(header));
  }
  return SQLITE_OK;
}
int keep_file(sqlite3_vfs*, const char*, int) {
  return SQLITE_OK;
}

sqlite3_vfs make_vfs() {
  sqlite3_vfs* system = sqlite3_vfs_find(nullptr);
  sqlite3_vfs vfs = *system;
  vfs.szOsFile = static_cast<int>(sizeof(WholePageFile)) + system->szOsFile;
  vfs.zName = "phasescan-whole-pages";
  vfs.pNext = nullptr;
  vfs.pAppData = system;
  vfs.xOpen = open_file;
  vfs.xDelete = keep_file;
  return vfs;
}

}  // namespace

const char* whole_page_vfs() {
  static sqlite3_vfs vfs = make_vfs();
  static const int registered = sqlite3_vfs_register(&vfs, 0);
  return registered == SQLITE_OK ? vfs.zName : nullptr;
}

namespace {

std::optional<Header> header_of(const std::string& path) {
  ByteStream stream(open_file_source(path));
  const Bytes first = stream.take(kHeaderBytes);
  if (first.size() < kHeaderBytes) return std::nullopt;
  Header header{};
  std::copy(first.begin(), first.end(), header.begin());
  return header;
}

}  // namespace

std::uint64_t stated_database_bytes(const std::string& path) {
  const auto header = header_of(path);
  return header ? stated_bytes(*header) : 0;
}

bool is_headless_database(const std::string& path) {
  const auto header = header_of(path);
  return header && is_headless(*header);
}

}  // namespace phasescan
