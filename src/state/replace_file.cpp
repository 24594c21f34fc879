// Files for users of the libraries alone: component io, which has the like for the command, is none of theirs.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "state/container.hpp"

namespace phasescan {
namespace {

class Descriptor {
 public:
  /// @param name  of the file for people
  Descriptor(const std::string& path, int flags, const std::string& name)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (fd_ < 0) refuse(name);
  }
  ~Descriptor() { ::close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  [[noreturn]] static void refuse(const std::string& path) {
    throw std::system_error(errno, std::generic_category(), path);
  }

 private:
  int fd_;
};

void write_all(int fd, const std::string& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(fd, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) Descriptor::refuse(path);
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
}

/// What a name leads to: a link stays a link.
std::string target_of(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_symlink(path, error)) return path;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, error);
  return error ? path : target.string();
}

/// Whether a name is of a device, a pipe or the like: it is written to, and never replaced by a file.
bool is_device(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

}  // namespace

void replace_file(const std::string& path, std::string_view bytes) {
  const std::string target = target_of(path);
  if (is_device(target)) return write_all(Descriptor(path, O_WRONLY, path).get(), path, bytes);
  static std::atomic<unsigned> counter{0};  // threads may write the same file
  const std::string temporary = target + ".tmp" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  try {
    const Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC, path);
    write_all(file.get(), path, bytes);
    if (::fsync(file.get()) != 0 || ::rename(temporary.c_str(), target.c_str()) != 0) Descriptor::refuse(path);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  const std::string folder = std::filesystem::path(target).parent_path().string();
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;  // the file itself is safe
  ::fsync(fd);
  ::close(fd);
}

std::string read_bytes(const std::string& path) {
  const Descriptor file(path, O_RDONLY, path);
  std::string bytes;
  struct stat info {};
  if (::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode)) bytes.reserve(static_cast<std::size_t>(info.st_size));
  std::string block(std::size_t{1} << 20, '\0');
  for (;;) {
    const ssize_t n = ::read(file.get(), block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) Descriptor::refuse(path);
    if (n == 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace phasescan
