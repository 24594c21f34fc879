// A client that sends what a test says, byte by byte if it wants to.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace phasescan::test {

class RawClient {
 public:
  /// @param receive_bytes  of the system's buffer; 0: the usual
  explicit RawClient(std::uint16_t port, int receive_bytes = 0) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_bytes > 0) ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
  }
  ~RawClient() { ::close(fd_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool connected() const { return connected_; }
  void send(const std::string& bytes) const {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t n = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) return;
      sent += static_cast<std::size_t>(n);
    }
  }
  /// Says that nothing more will come; what the other end sends is still taken.
  void end_sending() const { ::shutdown(fd_, SHUT_WR); }
  /// What comes until `enough` says so, the other end closes, or nothing came for `patience`.
  template <class Enough>
  std::string receive(const Enough& enough, std::chrono::milliseconds patience = std::chrono::milliseconds(5000)) {
    while (!enough(have_)) {
      pollfd waits{fd_, POLLIN, 0};
      if (::poll(&waits, 1, static_cast<int>(patience.count())) <= 0) break;
      char buffer[65536];
      const ssize_t n = ::recv(fd_, buffer, sizeof buffer, 0);
      if (n <= 0) {
        closed_ = true;
        break;
      }
      have_.append(buffer, static_cast<std::size_t>(n));
    }
    return std::exchange(have_, {});
  }
  std::string receive_all() {
    return receive([](const std::string&) { return false; });
  }
  /// Whether the other end has closed.
  bool closed() const { return closed_; }

  /// The head of an answer, and its body as long as the head says.
  std::string answer() {
    return receive([](const std::string& have) {
      const std::size_t end = have.find("\r\n\r\n");
      if (end == std::string::npos) return false;
      const std::size_t at = have.find("Content-Length: ");
      const std::size_t length = at < end ? std::stoul(have.substr(at + 16)) : 0;
      return have.size() >= end + 4 + length;
    });
  }

  /// Status of the answer to a GET.
  int get(const std::string& target, const std::string& host = "127.0.0.1", const std::string& more = "") {
    send("GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" + more + "\r\n");
    last_ = answer();
    return status();
  }
  const std::string& last() const { return last_; }

  /// Asks for a WebSocket; the status of the answer.
  int upgrade(const std::string& target, const std::string& more = "") {
    return get(target, "127.0.0.1",
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                   more);
  }

  /// A frame as clients send it: masked, with a mask of zeros and ones.
  void send_frame(int opcode, const std::string& payload, bool masked = true, bool fin = true) const {
    std::string frame(1, static_cast<char>((fin ? 0x80 : 0) | opcode));
    const int mask_bit = masked ? 0x80 : 0;
    if (payload.size() < 126) {
      frame += static_cast<char>(mask_bit | static_cast<int>(payload.size()));
    } else if (payload.size() < 65536) {
      frame += static_cast<char>(mask_bit | 126);
      frame += static_cast<char>(payload.size() >> 8);
      frame += static_cast<char>(payload.size() & 255);
    } else {
      frame += static_cast<char>(mask_bit | 127);
      for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>((payload.size() >> shift) & 255);
    }
    if (masked) frame += std::string("\x01\x00\x01\x00", 4);
    for (std::size_t i = 0; i < payload.size(); ++i)
      frame += static_cast<char>(masked && i % 2 == 0 ? payload[i] ^ 1 : payload[i]);
    send(frame);
  }

  struct Frame {
    int opcode = 0;
    std::string payload;
  };
  /// The next frame of the server; none: it closed, or nothing came.
  std::optional<Frame> frame() {
    std::size_t begin = 0, size = 0;
    std::string bytes = receive([&](const std::string& have) {
      if (have.size() < 2) return false;
      const auto at = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(have[i])); };
      begin = 2;
      size = at(1) & 127;
      if (size == 126) {
        if (have.size() < 4) return false;
        size = at(2) << 8 | at(3);
        begin = 4;
      } else if (size == 127) {
        if (have.size() < 10) return false;
        size = 0;
        for (std::size_t i = 2; i < 10; ++i) size = size << 8 | at(i);
        begin = 10;
      }
      return have.size() >= begin + size;
    });
    if (bytes.size() < 2 || bytes.size() < begin + size) return std::nullopt;
    have_ = bytes.substr(begin + size);
    return Frame{bytes[0] & 15, bytes.substr(begin, size)};
  }

 private:
  int status() const {
    return last_.size() < 12 || last_.compare(0, 7, "HTTP/1.") != 0 ? 0 : std::stoi(last_.substr(9, 3));
  }

  int fd_;
  bool connected_ = false, closed_ = false;
  std::string have_, last_;
};

}  // namespace phasescan::test
