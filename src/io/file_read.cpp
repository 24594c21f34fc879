#include <algorithm>
#include <array>
#include <memory>

#include "io/decompress.hpp"
#include "phasescan/io/error.hpp"
#include "io/file.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

}  // namespace

struct InputStream::Handle {
  std::unique_ptr<ByteSource> bytes;
};

InputStream::InputStream(const std::string& path) : path_(path), handle_(std::make_unique<Handle>()) {
  std::array<std::uint8_t, 4> magic{};
  std::size_t size = 0;
  auto file = open_file_source(path);
  while (size < magic.size()) {
    const std::size_t got = file->read(magic.data() + size, magic.size() - size);
    if (got == 0) break;
    size += got;
  }
  handle_->bytes = decompress(sniff_compression(Bytes(magic.data(), size)),
                              std::make_unique<PrefixedSource>(Bytes(magic.data(), size), std::move(file)));
}
InputStream::InputStream(std::string name, std::unique_ptr<ByteSource> bytes)
    : path_(std::move(name)), handle_(std::make_unique<Handle>()) {
  handle_->bytes = std::move(bytes);
}
InputStream::~InputStream() = default;
InputStream::InputStream(InputStream&&) noexcept = default;
InputStream& InputStream::operator=(InputStream&&) noexcept = default;

std::size_t InputStream::read(std::span<char> out) {
  std::size_t filled = 0;
  try {
    while (filled < out.size()) {
      const std::size_t got =
          handle_->bytes->read(reinterpret_cast<std::uint8_t*>(out.data()) + filled, out.size() - filled);
      if (got == 0) break;
      filled += got;
    }
  } catch (const DecodeError& error) {
    if (filled > 0) return filled;  // hand out what there is; the next call comes back here
    throw InputError(path_, 0, std::string(error.what()) + "; expected a whole packed file");
  }
  return filled;
}

std::size_t InputStream::read_some(std::span<char> out) {
  try {
    return handle_->bytes->read(reinterpret_cast<std::uint8_t*>(out.data()), out.size());
  } catch (const DecodeError& error) {
    throw InputError(path_, 0, std::string(error.what()) + "; expected a whole packed file");
  }
}

LineReader::LineReader(const std::string& path) : stream_(path) {}

bool LineReader::next(std::string& line) {
  line.clear();
  for (;;) {
    const std::size_t end = buffer_.find('\n', position_);
    const std::size_t take = (end == std::string::npos ? buffer_.size() : end) - position_;
    if (line.size() + take > kMaxLineBytes) {
      throw InputError(path(), line_number_ + 1, "the line is longer than 256 MiB; expected a text file with lines");
    }
    line.append(buffer_, position_, take);
    if (end != std::string::npos) {
      position_ = end + 1;
      line_was_ended_ = true;
      break;
    }
    position_ = 0;
    buffer_.resize(kBlockBytes);
    try {
      buffer_.resize(stream_.read_some(buffer_));
    } catch (const InputError& error) {
      buffer_.clear();
      throw InputError(path(), line_number_ + 1, error.reason());
    }
    if (buffer_.empty()) {
      if (line.empty()) return false;
      line_was_ended_ = false;
      break;
    }
  }
  if (++line_number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
  if (line.ends_with('\r')) line.pop_back();
  return true;
}

std::string read_file(const std::string& path, std::size_t max_bytes) {
  InputStream stream(path);
  return read_all(stream, max_bytes);
}

std::string read_all(InputStream& stream, std::size_t max_bytes) {
  std::string text;
  for (;;) {
    const std::size_t before = text.size();
    text.resize(before + kBlockBytes);
    text.resize(before + stream.read(std::span(text).subspan(before)));
    if (text.size() == before) return text;
    if (text.size() > max_bytes) {
      throw InputError(stream.path(), 0, "holds more than " + std::to_string(max_bytes) + " bytes; expected fewer");
    }
  }
}

std::string quote_text(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 40)) out += (c >= ' ' && c <= '~') ? c : '?';
  out += text.size() > 40 ? "...'" : "'";
  return out;
}

}  // namespace phasescan
