/// Files: reading plain or packed alike with clear failures, and writing that leaves the whole file or none.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

class ByteSource;

/// Bytes of a file from front to back; gzip, bzip2, lz4 and zstd are recognised by content and unpacked on the way.
class InputStream {
 public:
  /// @throws InputError (not found, a folder), SystemError (permission and whatever else the system refuses).
  explicit InputStream(const std::string& path);
  /// Bytes that are there already, unpacked; `name` is what errors call them.
  InputStream(std::string name, std::unique_ptr<ByteSource> bytes);
  ~InputStream();
  InputStream(InputStream&&) noexcept;
  InputStream& operator=(InputStream&&) noexcept;

  /// Fills as much of `out` as the file still has; fewer bytes only at the end.
  /// @throws InputError for broken or cut-off packed data, after all that could be unpacked has been handed out.
  std::size_t read(std::span<char> out);

  /// As read, but gives what is there by now: of a pipe, what was written into it so far. Nothing only at the end.
  std::size_t read_some(std::span<char> out);

  const std::string& path() const { return path_; }

 private:
  struct Handle;
  std::string path_;
  std::unique_ptr<Handle> handle_;
};

/// Lines of a text file, plain or packed, in bounded memory. Line ends (LF, CRLF) and a UTF-8 byte order mark are taken
/// off.
class LineReader {
 public:
  /// No line of a legal file is longer: 10^7 numbers fit.
  static constexpr std::size_t kMaxLineBytes = std::size_t{256} << 20;

  explicit LineReader(const std::string& path);
  explicit LineReader(InputStream stream) : stream_(std::move(stream)) {}

  /// The next line; false at the end. @throws InputError as InputStream::read, and for a line beyond kMaxLineBytes.
  bool next(std::string& line);

  /// 1-based number of the line that `next` gave last.
  long line_number() const { return line_number_; }
  /// Whether that line ended with a newline: a file cut off in the middle ends without.
  bool line_was_ended() const { return line_was_ended_; }
  const std::string& path() const { return stream_.path(); }

 private:
  InputStream stream_;
  std::string buffer_;
  std::size_t position_ = 0;
  long line_number_ = 0;
  bool line_was_ended_ = true;
};

/// The whole file, unpacked. @throws as InputStream; InputError if it has more than `max_bytes`.
std::string read_file(const std::string& path, std::size_t max_bytes = std::size_t{1} << 30);
std::string read_all(InputStream& stream, std::size_t max_bytes = std::size_t{1} << 30);

/// A file that appears whole or not at all: written beside its place, synced and renamed by `commit`. Without a commit
/// nothing stays. A name ending in .gz is packed (no time stamp inside: same content, same bytes). Something that is no
/// regular file (/dev/stdout, a pipe) is written as it is.
class AtomicFile {
 public:
  /// @throws SystemError if the folder does not take a file; InputError if `path` is a folder or its folder does not
  /// exist.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(AtomicFile&&) noexcept;
  AtomicFile& operator=(AtomicFile&&) noexcept;

  /// @throws SystemError, e.g. disk full.
  void write(std::string_view bytes);
  /// Brings all bytes to the disk: what can fail has failed by then. Nothing may be written after it. @throws
  /// SystemError
  void seal();
  /// Makes the file visible under its name. @throws SystemError
  void commit();

  const std::string& path() const;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

/// Writes one file whole or not at all. @throws as AtomicFile.
void write_file(const std::string& path, std::string_view content);

/// Files of one folder that belong together: none is put in place before all are written, so that a run which fails
/// leaves those of the run before as they were.
class FileSet {
 public:
  explicit FileSet(std::string folder) : folder_(std::move(folder)) {}

  /// Writes a file beside its place. @throws as AtomicFile
  void add(const std::string& name, std::string_view content);
  /// One that an earlier run may have left and this one has not: `commit` removes it.
  void leave_out(const std::string& name) { left_out_.push_back(name); }
  /// Puts the files in place in the order of `add`. @throws SystemError
  void commit();

 private:
  std::string folder_;
  std::vector<AtomicFile> files_;
  std::vector<std::string> left_out_;
};

/// Deletes what every AtomicFile has written beside its place by now. Async-signal-safe: for a signal handler that ends
/// the process.
void drop_unfinished_files() noexcept;

/// Makes a folder and those above it. @throws InputError if a file is in the way, SystemError
void make_folder(const std::string& path);

/// A piece of input as it may stand in a message: in quotes, at most 40 characters, control characters as '?'.
std::string quote_text(std::string_view text);

}  // namespace phasescan
