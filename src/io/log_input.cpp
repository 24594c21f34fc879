#include "io/log_input.hpp"

#include <filesystem>

#include "io/decompress.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

/// Nothing at all: what a folder has to read.
class NoSource : public ByteSource {
 public:
  std::size_t read(std::uint8_t*, std::size_t) override { return 0; }
};

class CountedSource : public ByteSource {
 public:
  CountedSource(std::unique_ptr<ByteSource> source, std::shared_ptr<std::uint64_t> count)
      : source_(std::move(source)), count_(std::move(count)) {}
  std::size_t read(std::uint8_t* out, std::size_t n) override {
    const std::size_t got = source_->read(out, n);
    *count_ += got;
    return got;
  }

 private:
  std::unique_ptr<ByteSource> source_;
  std::shared_ptr<std::uint64_t> count_;
};

}  // namespace

LogInput::LogInput(const std::string& path)
    : path_(path), name_(path == "-" ? "standard input" : path), stream_(std::make_unique<NoSource>()) {
  std::error_code ignored;
  folder_ = std::filesystem::is_directory(path, ignored);
  if (folder_) return;
  file_ = is_regular_file(path);
  if (path == "-" && file_) path_ = "/dev/stdin";
  stream_ = ByteStream(std::make_unique<CountedSource>(open_file_source(path), bytes_read_));
  const Compression compression = sniff_compression(stream_.peek(4));
  packed_ = compression != Compression::kNone;
  if (packed_) stream_ = ByteStream(decompress(compression, std::make_unique<StreamSource>(std::move(stream_))));
  Bytes first;
  try {
    first = stream_.peek(kPrefixBytes);
  } catch (const DecodeError& error) {
    // Damage behind the first bytes is the reader's to name.
    first = stream_.buffered();
    if (first.empty()) throw InputError(name_, 0, std::string(error.what()) + "; expected a whole packed file");
  }
  prefix_ = {reinterpret_cast<const char*>(first.data()), std::min(first.size(), kPrefixBytes)};
  if (prefix_.empty()) throw InputError(name_, 1, "the file is empty; expected a log");
}

}  // namespace phasescan
