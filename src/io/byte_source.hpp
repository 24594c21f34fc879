/// Sequential binary input in bounded memory: files, parts of files and what a decompressor makes of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "io/bytes.hpp"

namespace phasescan {

/// Where bytes come from.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Up to n bytes into `out`; 0 only at the end. @throws DecodeError where compressed data are damaged, SystemError.
  virtual std::size_t read(std::uint8_t* out, std::size_t n) = 0;
};

/// A file from its first byte, or from byte `from` (nothing where the file ends before it); "-" is standard input.
/// @throws InputError where there is no such file, SystemError where it may not be read.
std::unique_ptr<ByteSource> open_file_source(const std::string& path, std::uint64_t from = 0);

/// Whether a path can be opened a second time and gives the same bytes: a regular file, no pipe and no terminal.
bool is_regular_file(const std::string& path);

/// Size of a file [bytes].
std::uint64_t file_size_bytes(const std::string& path);

/// Bytes that were read already, and then the rest of what they were read from: a pipe cannot go back.
class PrefixedSource : public ByteSource {
 public:
  PrefixedSource(Bytes first, std::unique_ptr<ByteSource> rest)
      : first_(first.begin(), first.end()), rest_(std::move(rest)) {}
  std::size_t read(std::uint8_t* out, std::size_t n) override;

 private:
  std::vector<std::uint8_t> first_;
  std::unique_ptr<ByteSource> rest_;
  std::size_t at_ = 0;
};

/// A source with a buffer, so that records can be looked at in place.
class ByteStream {
 public:
  explicit ByteStream(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}

  /// The next n bytes, fewer where the input ends; valid until the next call. The buffer grows only as bytes arrive, so
  /// a stated length never costs more memory than there are bytes.
  Bytes take(std::uint64_t n);
  /// As `take`, without moving on.
  Bytes peek(std::uint64_t n);
  /// What is in the buffer already: no look at the source, so no failure.
  Bytes buffered() const { return {buffer_.data() + begin_, end_ - begin_}; }
  /// Moves on by n bytes; returns how many there were.
  std::uint64_t skip(std::uint64_t n);
  /// Bytes taken so far.
  std::uint64_t position() const { return position_; }
  bool at_end() { return peek(1).empty(); }
  /// Copies up to n bytes into `out`, at most what one look at the source gives.
  std::size_t read_some(std::uint8_t* out, std::size_t n);

 private:
  void fill(std::size_t n);

  std::unique_ptr<ByteSource> source_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t position_ = 0;
  bool ended_ = false;
};

/// The rest of a stream as a source.
class StreamSource : public ByteSource {
 public:
  explicit StreamSource(ByteStream stream) : stream_(std::move(stream)) {}
  std::size_t read(std::uint8_t* out, std::size_t n) override { return stream_.read_some(out, n); }

 private:
  ByteStream stream_;
};

/// The next `length` bytes of a stream as a source of their own. The stream must outlive it.
class SliceSource : public ByteSource {
 public:
  SliceSource(ByteStream& stream, std::uint64_t length) : stream_(stream), left_(length) {}
  std::size_t read(std::uint8_t* out, std::size_t n) override;

 private:
  ByteStream& stream_;
  std::uint64_t left_;
};

}  // namespace phasescan
