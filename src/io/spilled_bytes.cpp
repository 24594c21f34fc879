#include "io/spilled_bytes.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kHeld = std::size_t{1} << 16;

[[noreturn]] void fail(const char* what) {
  throw SystemError("a temporary file", std::string(what) + std::strerror(errno));
}

}  // namespace

SpilledBytes::SpilledBytes(const std::string& folder) {
  if (!folder.empty()) fd_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
}

SpilledBytes::~SpilledBytes() {
  if (fd_ >= 0) ::close(fd_);
}

SpilledBytes::SpilledBytes(SpilledBytes&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), on_disk_(other.on_disk_), held_(std::move(other.held_)) {}

void SpilledBytes::add(Bytes bytes) {
  held_.insert(held_.end(), bytes.begin(), bytes.end());
  if (fd_ >= 0 && held_.size() >= kHeld) flush();
}

void SpilledBytes::flush() {
  std::size_t done = 0;
  while (done < held_.size()) {
    const ssize_t n = ::pwrite(fd_, held_.data() + done, held_.size() - done, static_cast<off_t>(on_disk_ + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot be written: ");
    done += static_cast<std::size_t>(n);
  }
  on_disk_ += held_.size();
  held_.clear();
}

void SpilledBytes::read(const std::function<void(Bytes)>& take) {
  std::vector<std::uint8_t> piece(std::min<std::uint64_t>(kHeld, on_disk_));
  for (std::uint64_t at = 0; at < on_disk_;) {
    const std::size_t wanted = std::min<std::uint64_t>(piece.size(), on_disk_ - at);
    const ssize_t n = ::pread(fd_, piece.data(), wanted, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("cannot be read: ");
    take(Bytes(piece.data(), static_cast<std::size_t>(n)));
    at += static_cast<std::uint64_t>(n);
  }
  if (!held_.empty()) take(held_);
}

}  // namespace phasescan
