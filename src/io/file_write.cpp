#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"
#include "io/leftovers.hpp"

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

// Names of temporary files, where a signal handler can read them: no lock, no memory from the heap. A file that finds
// no free slot, or whose name is too long for one, is merely not tidied up after a signal.
class UnfinishedFiles {
 public:
  /// @return its slot, -1 where there is none
  int add(const std::string& path) {
    if (path.size() >= kPathBytes) return -1;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      int expected = kFree;
      if (!slots_[i].state.compare_exchange_strong(expected, kClaimed)) continue;
      std::memcpy(slots_[i].path, path.c_str(), path.size() + 1);
      slots_[i].state = kNamed;
      return static_cast<int>(i);
    }
    return -1;
  }
  void remove(int slot) {
    if (slot >= 0) slots_[static_cast<std::size_t>(slot)].state = kFree;
  }
  void drop() const {
    for (const Slot& slot : slots_) {
      if (slot.state == kNamed) ::unlink(slot.path);
    }
  }

 private:
  enum State { kFree, kClaimed, kNamed };
  static constexpr std::size_t kPathBytes = 4096;
  struct Slot {
    std::atomic<int> state{kFree};
    char path[kPathBytes]{};
  };
  static_assert(std::atomic<int>::is_always_lock_free);
  std::array<Slot, 256> slots_;
};
constinit UnfinishedFiles unfinished{};

/// How the temporary files of a target begin; the process and a number follow.
std::string temporary_prefix(const std::string& target) {
  return "." + std::filesystem::path(target).filename().string().substr(0, 200) + ".tmp";
}

}  // namespace

void drop_unfinished_files() noexcept {
  unfinished.drop();
}

void drop_leftovers(const std::string& path) noexcept {
  try {
    const std::string prefix = temporary_prefix(path);
    for (const auto& entry : std::filesystem::directory_iterator(folder_of(path))) {
      const std::string name = entry.path().filename().string();
      int process = 0, number = 0, end = 0;
      if (!name.starts_with(prefix)) continue;
      const char* rest = name.c_str() + prefix.size();
      if (std::sscanf(rest, "%d-%d%n", &process, &number, &end) != 2 || rest[end] != '\0' || process <= 0) continue;
      if (::kill(process, 0) != 0 && errno == ESRCH) ::unlink(entry.path().c_str());
    }
  } catch (const std::exception&) {
    return;
  }
}

struct AtomicFile::Handle {
  std::string path;       // as the caller named it
  std::string target;     // what is renamed onto: `path` with links followed
  std::string temporary;  // empty: written in place (no regular file)
  int slot = -1;          // of the temporary among the unfinished files
  int fd = -1;
  gzFile gzip = nullptr;

  ~Handle() {
    if (gzip != nullptr) gzclose_w(gzip);
    if (fd >= 0) ::close(fd);
    if (!temporary.empty()) ::unlink(temporary.c_str());
    unfinished.remove(slot);
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
    const std::string temporary = folder_of(h.target) + "/" + temporary_prefix(h.target) + std::to_string(::getpid()) +
                                  "-" + std::to_string(counter++);
    h.slot = unfinished.add(temporary);
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

void AtomicFile::seal() {
  Handle& h = *handle_;
  if (h.gzip != nullptr) {
    const int code = gzclose_w(h.gzip);
    h.gzip = nullptr;
    if (code != Z_OK) refuse(h.path, "cannot be written", code == Z_ERRNO ? errno : EIO);
  }
  if (h.temporary.empty() || h.fd < 0) return;
  if (::fsync(h.fd) != 0) refuse(h.path, "cannot be written", errno);
  ::close(std::exchange(h.fd, -1));
}

void AtomicFile::commit() {
  seal();
  Handle& h = *handle_;
  if (h.temporary.empty()) return;
  if (::rename(h.temporary.c_str(), h.target.c_str()) != 0) refuse(h.path, "cannot be written", errno);
  h.temporary.clear();
  unfinished.remove(std::exchange(h.slot, -1));
  sync_folder(folder_of(h.target));
}

void FileSet::add(const std::string& name, std::string_view content) {
  AtomicFile& file = files_.emplace_back(folder_ + "/" + name);
  file.write(content);
  file.seal();
}

void FileSet::commit() {
  for (const std::string& name : left_out_) {
    const std::string path = folder_ + "/" + name;
    struct stat info {};
    if (::lstat(path.c_str(), &info) != 0 || S_ISDIR(info.st_mode)) continue;
    if (::unlink(path.c_str()) != 0) refuse(path, "is of an earlier run and cannot be removed", errno);
  }
  for (AtomicFile& file : files_) file.commit();
  files_.clear();
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
