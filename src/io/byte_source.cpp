#include "io/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

[[noreturn]] void throw_errno(const std::string& path) {
  if (path.empty()) throw InputError("''", 0, "the file name is empty; expected a file");
  if (errno == ENOENT || errno == ENOTDIR) throw InputError(path, 0, "no such file; expected an existing file");
  if (errno == EISDIR) throw InputError(path, 0, "is a folder; expected a file");
  throw SystemError(path, std::string("cannot be read: ") + std::strerror(errno));
}

class FileSource : public ByteSource {
 public:
  FileSource(std::string path, std::uint64_t from) : path_(std::move(path)), fd_(open_descriptor(path_)) {
    struct stat info {};
    if (fd_ >= 0 && ::fstat(fd_, &info) == 0 && S_ISDIR(info.st_mode)) {
      ::close(fd_);
      fd_ = -1;
      errno = EISDIR;
    }
    if (fd_ < 0) throw_errno(path_);
    if (from == 0) return;
    // Far beyond the end some file systems fail to read and some refuse to go there; there is nothing to read anyway.
    ended_ = from >= static_cast<std::uint64_t>(std::max<off_t>(info.st_size, 0));
    if (ended_ || ::lseek(fd_, static_cast<off_t>(from), SEEK_SET) >= 0) return;
    const int why = errno;
    ::close(fd_);
    errno = why;
    throw_errno(path_);
  }
  ~FileSource() override { ::close(fd_); }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  std::size_t read(std::uint8_t* out, std::size_t n) override {
    while (!ended_) {
      const ssize_t got = ::read(fd_, out, n);
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EINTR) throw_errno(path_);
    }
    return 0;
  }

 private:
  static int open_descriptor(const std::string& path) {
    // Standard input may be a socket, which cannot be opened by its name.
    if (path == "-") return ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
    return ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  }

  std::string path_;
  int fd_;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<ByteSource> open_file_source(const std::string& path, std::uint64_t from) {
  return std::make_unique<FileSource>(path, from);
}

bool is_regular_file(const std::string& path) {
  struct stat info {};
  const int rc = path == "-" ? ::fstat(STDIN_FILENO, &info) : ::stat(path.c_str(), &info);
  return rc == 0 && S_ISREG(info.st_mode);
}

std::uint64_t file_size_bytes(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) throw_errno(path);
  return static_cast<std::uint64_t>(info.st_size);
}

void ByteStream::fill(std::size_t n) {
  while (!ended_ && end_ - begin_ < n) {
    if (begin_ > 0) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      end_ -= begin_;
      begin_ = 0;
    }
    if (end_ == buffer_.size()) buffer_.resize(std::max(kBufferBytes, 2 * buffer_.size()));
    const std::size_t got = source_->read(buffer_.data() + end_, buffer_.size() - end_);
    ended_ = got == 0;
    end_ += got;
  }
}

Bytes ByteStream::peek(std::uint64_t n) {
  const auto wanted = static_cast<std::size_t>(n);
  if (end_ - begin_ < wanted) fill(wanted);
  return {buffer_.data() + begin_, std::min(wanted, end_ - begin_)};
}

Bytes ByteStream::take(std::uint64_t n) {
  const Bytes view = peek(n);
  begin_ += view.size();
  position_ += view.size();
  return view;
}

std::uint64_t ByteStream::skip(std::uint64_t n) {
  std::uint64_t left = n;
  while (left > 0) {
    const Bytes view = take(std::min<std::uint64_t>(left, kBufferBytes));
    if (view.empty()) break;
    left -= view.size();
  }
  return n - left;
}

std::size_t ByteStream::read_some(std::uint8_t* out, std::size_t n) {
  if (end_ == begin_ && n >= kBufferBytes / 4) {
    // Nothing buffered and a large piece wanted: straight from the source, without a copy.
    const std::size_t got = ended_ ? 0 : source_->read(out, n);
    ended_ = ended_ || got == 0;
    position_ += got;
    return got;
  }
  if (peek(1).empty()) return 0;
  const Bytes view = take(std::min(n, end_ - begin_));
  std::memcpy(out, view.data(), view.size());
  return view.size();
}

std::size_t PrefixedSource::read(std::uint8_t* out, std::size_t n) {
  if (at_ == first_.size()) return rest_->read(out, n);
  const std::size_t got = std::min(n, first_.size() - at_);
  std::memcpy(out, first_.data() + at_, got);
  at_ += got;
  return got;
}

std::size_t SliceSource::read(std::uint8_t* out, std::size_t n) {
  const std::size_t got = stream_.read_some(out, static_cast<std::size_t>(std::min<std::uint64_t>(n, left_)));
  left_ -= got;
  return got;
}

}  // namespace phasescan
