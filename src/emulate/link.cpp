#include "emulate/link.hpp"

#include <arpa/inet.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include "phasescan/io/error.hpp"

namespace phasescan::emulate {
namespace {

std::vector<std::uint8_t> read_from(int fd, int wait_ms) {
  pollfd waiting{fd, POLLIN, 0};
  if (::poll(&waiting, 1, wait_ms) <= 0 || !(waiting.revents & POLLIN)) return {};
  std::array<std::uint8_t, 4096> bytes;
  const ssize_t n = ::read(fd, bytes.data(), bytes.size());
  return n > 0 ? std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + n) : std::vector<std::uint8_t>();
}

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

class PtyLink final : public Link {
 public:
  explicit PtyLink(const std::string& alias) : alias_(alias) {
    fd_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
    if (fd_ < 0 || ::grantpt(fd_) != 0 || ::unlockpt(fd_) != 0)
      throw SystemError("pseudo-terminal", std::string("cannot be made: ") + std::strerror(errno));
    path_ = ::ptsname(fd_);
    // Opened and closed once, it is in the state in which the end of its client shows.
    const int client = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios2 settings{};
    if (client >= 0 && ::ioctl(client, TCGETS2, &settings) == 0) {
      settings.c_lflag = 0;  // without an echo: the sensor does not hear itself
      settings.c_oflag = 0;
      settings.c_iflag = 0;
      ::ioctl(client, TCSETS2, &settings);
    }
    if (client >= 0) ::close(client);
    if (alias_.empty()) return;
    std::error_code error;
    if (std::filesystem::is_symlink(alias_, error)) std::filesystem::remove(alias_, error);
    std::filesystem::create_symlink(path_, alias_, error);
    if (error) throw SystemError(alias_, error.message());
  }
  ~PtyLink() override {
    std::error_code ignored;
    if (!alias_.empty()) std::filesystem::remove(alias_, ignored);
    ::close(fd_);
  }
  PtyLink(const PtyLink&) = delete;
  PtyLink& operator=(const PtyLink&) = delete;

  std::string name() const override { return alias_.empty() ? path_ : alias_; }
  bool connected() override {
    pollfd waiting{fd_, POLLIN, 0};
    ::poll(&waiting, 1, 0);
    return !(waiting.revents & POLLHUP);
  }
  std::vector<std::uint8_t> read(int wait_ms) override {
    if (connected()) return read_from(fd_, wait_ms);
    ::usleep(static_cast<useconds_t>(1000 * wait_ms));
    return {};
  }
  void write(std::span<const std::uint8_t> bytes) override {
    // A client that does not read loses what the line's buffer does not hold.
    if (::write(fd_, bytes.data(), bytes.size()) < 0 && errno != EAGAIN && errno != EIO) return;
  }
  int baud() override {
    termios2 settings{};
    return ::ioctl(fd_, TCGETS2, &settings) == 0 ? static_cast<int>(settings.c_ispeed) : 0;
  }

 private:
  std::string alias_, path_;
  int fd_ = -1;
};

class TcpLink final : public Link {
 public:
  explicit TcpLink(int port) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const int on = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address = loopback(port);
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener_, 1) != 0)
      throw SystemError("tcp:127.0.0.1:" + std::to_string(port), std::strerror(errno));
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~TcpLink() override {
    drop();
    ::close(listener_);
  }
  TcpLink(const TcpLink&) = delete;
  TcpLink& operator=(const TcpLink&) = delete;

  std::string name() const override { return "tcp:127.0.0.1:" + std::to_string(port_); }
  bool connected() override {
    if (client_ < 0) {
      client_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
      const int on = 1;
      if (client_ >= 0) ::setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
    return client_ >= 0;
  }
  std::vector<std::uint8_t> read(int wait_ms) override {
    if (!connected()) {
      ::usleep(static_cast<useconds_t>(1000 * wait_ms));
      return {};
    }
    pollfd waiting{client_, POLLIN, 0};
    if (::poll(&waiting, 1, wait_ms) <= 0) return {};
    std::vector<std::uint8_t> bytes = read_from(client_, 0);
    if (bytes.empty()) drop();
    return bytes;
  }
  void write(std::span<const std::uint8_t> bytes) override {
    if (client_ >= 0 && ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0 && errno != EAGAIN) drop();
  }
  int baud() override { return 0; }

 private:
  void drop() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }
  int listener_ = -1, client_ = -1, port_ = 0;
};

/// Datagrams to whoever spoke last.
class UdpLink final : public Link {
 public:
  explicit UdpLink(int port) {
    fd_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const int on = 1;
    ::setsockopt(fd_, IPPROTO_IP, IP_RECVERR, &on, sizeof on);  // else nobody says that the client is gone
    sockaddr_in address = loopback(port);
    socklen_t size = sizeof address;
    if (::bind(fd_, reinterpret_cast<sockaddr*>(&address), size) != 0)
      throw SystemError("udp:127.0.0.1:" + std::to_string(port), std::strerror(errno));
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~UdpLink() override { ::close(fd_); }
  UdpLink(const UdpLink&) = delete;
  UdpLink& operator=(const UdpLink&) = delete;

  std::string name() const override { return "udp:127.0.0.1:" + std::to_string(port_); }
  bool connected() override { return client_.has_value(); }
  std::vector<std::uint8_t> read(int wait_ms) override {
    pollfd waiting{fd_, POLLIN, 0};
    if (::poll(&waiting, 1, wait_ms) <= 0) return {};
    std::array<std::uint8_t, 4096> bytes;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t n = ::recvfrom(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (n < 0) forget_gone();
    if (n <= 0) return {};
    client_ = from;
    return {bytes.begin(), bytes.begin() + n};
  }
  void write(std::span<const std::uint8_t> bytes) override {
    constexpr std::size_t kDatagram = 1400;  // what a network takes in one piece
    while (client_ && !bytes.empty()) {
      const auto piece = bytes.first(std::min(kDatagram, bytes.size()));
      bytes = bytes.subspan(piece.size());
      if (::sendto(fd_, piece.data(), piece.size(), 0, reinterpret_cast<const sockaddr*>(&*client_), sizeof *client_) <
          0)
        forget_gone();
    }
  }
  int baud() override { return 0; }

 private:
  void forget_gone() {
    if (errno == ECONNREFUSED) client_.reset();
  }
  int fd_ = -1, port_ = 0;
  std::optional<sockaddr_in> client_;
};

}  // namespace

std::unique_ptr<Link> open_pty(const std::string& alias) {
  return std::make_unique<PtyLink>(alias);
}
std::unique_ptr<Link> open_tcp_port(int port) {
  return std::make_unique<TcpLink>(port);
}
std::unique_ptr<Link> open_udp_port(int port) {
  return std::make_unique<UdpLink>(port);
}

}  // namespace phasescan::emulate
