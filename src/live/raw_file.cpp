#include "live/clocks.hpp"
#include "live/raw_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "io/bytes.hpp"

namespace phasescan::live {
namespace {

constexpr std::string_view kHead = "phasescan raw 1 ";
constexpr std::size_t kMostPiece = 1 << 20;
constexpr std::size_t kMostHead = 64;

class RawPort final : public Port {
 public:
  RawPort(const std::string& path, double bytes_per_s) : stream_(path), bytes_per_s_(bytes_per_s) {
    timed_ = !raw_sensor(path).empty();
    if (!timed_) return;
    char c = 0;
    while (stream_.read({&c, 1}) == 1 && c != '\n') {
    }
  }

  std::size_t read(std::span<std::uint8_t> out, int wait_ms) override {
    if (left_.empty() && !next_piece()) throw PortGone{"the file ends"};
    const std::int64_t now = steady_ns();
    if (began_ns_ == 0) began_ns_ = now - due_ns_;
    const std::int64_t wait = began_ns_ + due_ns_ - now;
    if (wait > std::int64_t{1'000'000} * wait_ms) {
      std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
      return 0;
    }
    if (wait > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(wait));
    const std::size_t n = std::min(out.size(), left_.size());
    std::copy_n(left_.begin(), n, out.begin());
    left_.erase(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(n));
    return n;
  }
  void write(std::span<const std::uint8_t>) override {}

 private:
  bool next_piece() {
    if (!timed_) {
      constexpr std::size_t kPiece = 64;
      left_.resize(kPiece);
      left_.resize(stream_.read({reinterpret_cast<char*>(left_.data()), kPiece}));
      if (bytes_per_s_ > 0.0)
        due_ns_ += static_cast<std::int64_t>(1e9 * static_cast<double>(left_.size()) / bytes_per_s_);
      return !left_.empty();
    }
    char head[12];
    if (stream_.read(head) != sizeof head) return false;
    std::uint64_t at = 0;
    std::uint32_t size = 0;
    std::memcpy(&at, head, 8);
    std::memcpy(&size, head + 8, 4);
    if (size == 0 || size > kMostPiece || at > 1'000'000'000'000'000'000ULL) return false;
    due_ns_ = static_cast<std::int64_t>(at);
    left_.resize(size);
    left_.resize(stream_.read({reinterpret_cast<char*>(left_.data()), size}));
    return !left_.empty();
  }

  InputStream stream_;
  double bytes_per_s_;
  bool timed_ = false;
  std::vector<std::uint8_t> left_;
  std::int64_t began_ns_ = 0, due_ns_ = 0;
};

}  // namespace

RawWriter::RawWriter(const std::string& path, std::string_view sensor) : file_(path) {
  file_.write(std::string(kHead) + std::string(sensor) + "\n");
}

void RawWriter::write(std::span<const std::uint8_t> bytes, Stamp now) {
  if (!first_) first_ = now;
  ByteWriter piece;
  piece.put(static_cast<std::uint64_t>(std::max<Stamp>(0, now - *first_)));
  piece.put(static_cast<std::uint32_t>(bytes.size()));
  piece.raw(bytes);
  file_.write({reinterpret_cast<const char*>(piece.bytes().data()), piece.size()});
}

std::string raw_sensor(const std::string& path) {
  InputStream stream(path);
  char head[kMostHead] = {};
  const std::string_view text(head, stream.read(head));
  const std::size_t end = text.find('\n');
  if (!text.starts_with(kHead) || end == std::string_view::npos) return {};
  return std::string(text.substr(kHead.size(), end - kHead.size()));
}

std::unique_ptr<Port> open_raw(const std::string& path, double bytes_per_s) {
  return std::make_unique<RawPort>(path, bytes_per_s);
}

}  // namespace phasescan::live
