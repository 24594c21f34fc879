#include "live/fd_port.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "io/file.hpp"
#include "io/number.hpp"
#include "live/clocks.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::live {
namespace {

constexpr int kWrite_ms = 200, kConnect_ms = 2000;

/// Until bytes can be written, at most so long; a signal does not end it.
bool wait_for_room(int fd, int wait_ms) {
  const std::int64_t until_ns = steady_ns() + std::int64_t{1'000'000} * wait_ms;
  pollfd waiting{fd, POLLOUT, 0};
  int ready = ::poll(&waiting, 1, wait_ms);
  while (ready < 0 && errno == EINTR) {
    const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - steady_ns());
    ready = ::poll(&waiting, 1, static_cast<int>(left_ns / 1'000'000));
  }
  return ready > 0;
}

}  // namespace

FdPort::~FdPort() {
  if (fd_ >= 0) ::close(fd_);
}

std::size_t FdPort::read(std::span<std::uint8_t> out, int wait_ms) {
  pollfd waiting{fd_, POLLIN, 0};
  const int ready = ::poll(&waiting, 1, wait_ms);
  if (ready < 0 && errno == EINTR) return 0;
  if (ready == 0) return 0;
  const ssize_t n = ::read(fd_, out.data(), out.size());
  if (n > 0 || (n == 0 && datagrams_)) return static_cast<std::size_t>(n);
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  throw PortGone{n == 0 ? "it was closed at the other end" : std::strerror(errno)};
}

void FdPort::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    if (!wait_for_room(fd_, kWrite_ms)) return;
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (n < 0) throw PortGone{std::strerror(errno)};
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

std::unique_ptr<Port> open_network(const std::string& host, int port, bool udp) {
  const std::string name = (udp ? "udp:" : "tcp:") + host + ":" + std::to_string(port);
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = udp ? SOCK_DGRAM : SOCK_STREAM;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0)
    throw SystemError(name, std::string("no such address: ") + ::gai_strerror(error));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> all(found, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* at = found; at != nullptr; at = at->ai_next) {
    const int fd = ::socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, at->ai_protocol);
    if (fd < 0) continue;
    auto opened = std::make_unique<FdPort>(fd, udp);
    if (::connect(fd, at->ai_addr, at->ai_addrlen) != 0 && errno != EINPROGRESS) {
      error = errno;
      continue;
    }
    socklen_t size = sizeof error;
    if (!wait_for_room(fd, kConnect_ms)) {
      error = ETIMEDOUT;
      continue;
    }
    ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) continue;
    const int on = 1;
    if (!udp) ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (!udp) ::setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    return opened;
  }
  throw SystemError(name, std::string("cannot be reached: ") + std::strerror(error) +
                              "; is the sensor on, is this its address, is it in the same network?");
}

std::unique_ptr<Port> open_port(const std::string& name, int baud) {
  const bool tcp = name.starts_with("tcp:"), udp = name.starts_with("udp:");
  if (!tcp && !udp) return open_serial(name, baud);
  const std::string address = name.substr(4);
  const std::size_t colon = address.rfind(':');
  const auto port =
      colon == std::string::npos ? std::nullopt : parse_number<int>(std::string_view(address).substr(colon + 1));
  if (!port || *port < 1 || *port > 65535 || colon == 0)
    throw std::invalid_argument("--port: " + quote_text(name) + " is no address; expected " + name.substr(0, 4) +
                                "HOST:PORT");
  return open_network(address.substr(0, colon), *port, udp);
}

}  // namespace phasescan::live
