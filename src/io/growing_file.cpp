#include "io/growing_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "phasescan/io/error.hpp"

namespace phasescan {

GrowingFile::GrowingFile(const std::string& path) : path_(path) {
  if (path.empty()) throw InputError("''", 0, "the file name is empty; expected a file to write");
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  struct stat info {};
  if (fd_ >= 0 && ::fstat(fd_, &info) == 0 && S_ISREG(info.st_mode)) {
    if (info.st_size == 0) return;
    ::close(std::exchange(fd_, -1));
    throw SystemError(path, "is there already; it is not written over");
  }
  if (fd_ >= 0) {
    ::close(std::exchange(fd_, -1));
    throw InputError(path, 0, "is no regular file; expected one that can be read while it grows");
  }
  if (errno == ENOENT || errno == ENOTDIR)
    throw InputError(path, 0, "its folder does not exist; expected an existing folder");
  throw SystemError(path, std::string("cannot be written: ") + std::strerror(errno));
}

GrowingFile::~GrowingFile() {
  if (fd_ >= 0) ::close(fd_);
}

GrowingFile::GrowingFile(GrowingFile&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)), size_(other.size_) {}

void GrowingFile::write(std::string_view bytes) {
  const std::size_t all = bytes.size();
  while (!bytes.empty()) {
    const ssize_t done = ::write(fd_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      const int error = errno;
      // A reader finds whole records; where even this is refused it finds a cut one, as after a kill.
      if (::ftruncate(fd_, static_cast<off_t>(size_)) == 0) ::lseek(fd_, static_cast<off_t>(size_), SEEK_SET);
      throw SystemError(path_, std::string("cannot be written: ") + std::strerror(error));
    }
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  size_ += all;
}

void GrowingFile::close() {
  const bool synced = ::fsync(fd_) == 0;
  const int error = errno;
  ::close(std::exchange(fd_, -1));
  if (!synced) throw SystemError(path_, std::string("cannot be written: ") + std::strerror(error));
}

std::string free_name(const std::string& path) {
  const std::filesystem::path given(path);
  std::string name = path;
  std::error_code ignored;
  const auto taken = [&ignored](const std::string& file) {
    return std::filesystem::is_regular_file(file, ignored) && std::filesystem::file_size(file, ignored) > 0;
  };
  for (int k = 2; taken(name); ++k) {
    std::filesystem::path next = given;
    next.replace_filename(given.stem().string() + "-" + std::to_string(k) + given.extension().string());
    name = next.string();
  }
  return name;
}

}  // namespace phasescan
