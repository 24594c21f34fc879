#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "phasescan/io/error.hpp"
#include "phasescan/io/file.hpp"

namespace phasescan {
namespace {

[[noreturn]] void refuse(const std::string& path, const char* what, int error) {
  throw SystemError(path, std::string(what) + ": " + std::strerror(error));
}

std::string folder_of(const std::string& path) {
  const auto folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

void sync_folder(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;  // the file itself is safe; some file systems do not let a folder be synced
  ::fsync(fd);
  ::close(fd);
}

}  // namespace

struct AtomicFile::Handle {
  std::string path;       // as the caller named it
  std::string target;     // what is renamed onto: `path` with links followed
  std::string temporary;  // empty: written in place (no regular file)
  int fd = -1;
  gzFile gzip = nullptr;

  ~Handle() {
    if (gzip != nullptr) gzclose_w(gzip);
    if (fd >= 0) ::close(fd);
    if (!temporary.empty()) ::unlink(temporary.c_str());
  }

  void write_plain(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t done = ::write(fd, bytes.data(), bytes.size());
      if (done < 0) {
        if (errno == EINTR) continue;
        refuse(path, "cannot be written", errno);
      }
      bytes.remove_prefix(static_cast<std::size_t>(done));
    }
  }
};

AtomicFile::AtomicFile(const std::string& path) : handle_(std::make_unique<Handle>()) {
  Handle& h = *handle_;
  h.path = path;
  h.target = path;
  if (path.empty()) throw InputError("''", 0, "the file name is empty; expected a file to write");
  std::error_code ignored;
  if (std::filesystem::is_symlink(path, ignored)) {
    const auto followed = std::filesystem::weakly_canonical(path, ignored);
    if (!ignored) h.target = followed.string();
  }
  struct stat info {};
  const bool exists = ::stat(h.target.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) throw InputError(path, 0, "is a folder; expected a file to write");
  if (exists && !S_ISREG(info.st_mode)) {
    h.fd = ::open(h.target.c_str(), O_WRONLY | O_CLOEXEC);
    if (h.fd < 0) refuse(path, "cannot be written", errno);
  } else {
    static std::atomic<unsigned> counter{0};
    const std::string name = std::filesystem::path(h.target).filename().string();
    const std::string temporary = folder_of(h.target) + "/." + name.substr(0, 200) + ".tmp" +
                                  std::to_string(::getpid()) + "-" + std::to_string(counter++);
    h.fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (h.fd < 0) {
      const int error = errno;
      if (error == ENOENT || error == ENOTDIR)
        throw InputError(path, 0, "its folder does not exist; expected an existing folder");
      refuse(path, "cannot be written", error);
    }
    h.temporary = temporary;
  }
  if (path.ends_with(".gz")) {
    const int copy = ::dup(h.fd);
    h.gzip = copy < 0 ? nullptr : gzdopen(copy, "wb6");
    if (h.gzip == nullptr) refuse(path, "cannot be written", errno);
  }
}
AtomicFile::~AtomicFile() = default;
AtomicFile::AtomicFile(AtomicFile&&) noexcept = default;
AtomicFile& AtomicFile::operator=(AtomicFile&&) noexcept = default;

const std::string& AtomicFile::path() const {
  return handle_->path;
}

void AtomicFile::write(std::string_view bytes) {
  Handle& h = *handle_;
  if (h.gzip == nullptr) return h.write_plain(bytes);
  while (!bytes.empty()) {
    const auto part = static_cast<unsigned>(std::min(bytes.size(), std::size_t{1} << 30));
    if (gzwrite(h.gzip, bytes.data(), part) != static_cast<int>(part)) refuse(h.path, "cannot be written", errno);
    bytes.remove_prefix(part);
  }
}

void AtomicFile::commit() {
  Handle& h = *handle_;
  if (h.gzip != nullptr) {
    const int code = gzclose_w(h.gzip);
    h.gzip = nullptr;
    if (code != Z_OK) refuse(h.path, "cannot be written", code == Z_ERRNO ? errno : EIO);
  }
  if (h.temporary.empty()) return;
  if (::fsync(h.fd) != 0) refuse(h.path, "cannot be written", errno);
  if (::rename(h.temporary.c_str(), h.target.c_str()) != 0) refuse(h.path, "cannot be written", errno);
  h.temporary.clear();
  sync_folder(folder_of(h.target));
}

void write_file(const std::string& path, std::string_view content) {
  AtomicFile file(path);
  file.write(content);
  file.commit();
}

void make_folder(const std::string& path) {
  if (path.empty()) throw InputError("''", 0, "the folder name is empty; expected a folder to write to");
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error == std::errc::not_a_directory || (!error && !std::filesystem::is_directory(path)))
    throw InputError(path, 0, "is a file, or lies in one; expected a folder");
  if (error) throw SystemError(path, "the folder cannot be made: " + error.message());
}

}  // namespace phasescan
