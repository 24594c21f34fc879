#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "phasescan/io/error.hpp"
#include "phasescan/io/file.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 16;

int open_for_reading(const std::string& path) {
  if (path.empty()) throw InputError("''", 0, "the file name is empty; expected a file");
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    const int error = errno;
    if (error == ENOENT || error == ENOTDIR) throw InputError(path, 0, "no such file; expected an existing file");
    throw SystemError(path, std::string("cannot be read: ") + std::strerror(error));
  }
  struct stat info {};
  if (::fstat(fd, &info) == 0 && S_ISDIR(info.st_mode)) {
    ::close(fd);
    throw InputError(path, 0, "is a folder; expected a file");
  }
  return fd;
}

}  // namespace

struct InputStream::Handle {
  gzFile file = nullptr;
  ~Handle() {
    if (file != nullptr) gzclose_r(file);
  }
};

InputStream::InputStream(const std::string& path) : path_(path), handle_(std::make_unique<Handle>()) {
  const int fd = open_for_reading(path);
  handle_->file = gzdopen(fd, "rb");
  if (handle_->file == nullptr) {
    ::close(fd);
    throw SystemError(path, "cannot be read: out of memory");
  }
  gzbuffer(handle_->file, static_cast<unsigned>(kBlockBytes));
}
InputStream::~InputStream() = default;
InputStream::InputStream(InputStream&&) noexcept = default;
InputStream& InputStream::operator=(InputStream&&) noexcept = default;

std::size_t InputStream::read(std::span<char> out) {
  std::size_t filled = 0;
  while (filled < out.size()) {
    const auto want = static_cast<unsigned>(std::min(out.size() - filled, std::size_t{1} << 30));
    const int got = gzread(handle_->file, out.data() + filled, want);
    if (got > 0) {
      filled += static_cast<std::size_t>(got);
      continue;
    }
    int code = Z_OK;
    const char* message = gzerror(handle_->file, &code);
    if (code == Z_ERRNO) throw SystemError(path_, std::string("cannot be read: ") + std::strerror(errno));
    if (code != Z_OK && code != Z_STREAM_END) {
      if (filled > 0) break;  // hand out what there is; the next call comes back here
      const std::string_view text = message == nullptr ? "" : message;
      const bool cut = code == Z_BUF_ERROR || text.find("unexpected end") != std::string_view::npos;
      throw InputError(path_, 0,
                       cut ? "the gzip data is cut off; expected a whole .gz file"
                           : "the gzip data is broken; expected a whole .gz file");
    }
    break;
  }
  return filled;
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
      buffer_.resize(stream_.read(buffer_));
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

std::string read_prefix(const std::string& path, std::size_t count) {
  InputStream stream(path);
  std::string text(count, '\0');
  text.resize(stream.read(text));
  return text;
}

std::string read_file(const std::string& path, std::size_t max_bytes) {
  InputStream stream(path);
  std::string text;
  for (;;) {
    const std::size_t before = text.size();
    text.resize(before + kBlockBytes);
    text.resize(before + stream.read(std::span(text).subspan(before)));
    if (text.size() == before) return text;
    if (text.size() > max_bytes) {
      throw InputError(path, 0, "holds more than " + std::to_string(max_bytes) + " bytes; expected fewer");
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
