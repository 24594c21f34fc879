// The emulated sensor's end of the line: the master of a pseudo-terminal, or a TCP or UDP port with one client.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace phasescan::emulate {

class Link {
 public:
  virtual ~Link() = default;
  /// What a client opens: "/dev/pts/3", "tcp:127.0.0.1:40123", "udp:127.0.0.1:40123".
  virtual std::string name() const = 0;
  /// Whether somebody is there; bytes sent to nobody are gone, as on a real line.
  virtual bool connected() = 0;
  /// What the client said, waiting at most `wait_ms`.
  virtual std::vector<std::uint8_t> read(int wait_ms) = 0;
  virtual void write(std::span<const std::uint8_t> bytes) = 0;
  /// The baud that the client has set; 0: there is none.
  virtual int baud() = 0;
};

/// @param alias  a link to the pseudo-terminal's name, that stays the same when it is plugged in again; may be empty
/// @throws SystemError
std::unique_ptr<Link> open_pty(const std::string& alias);
/// @param port  0: any that is free. Loopback alone.
std::unique_ptr<Link> open_tcp_port(int port);
/// The same by UDP.
std::unique_ptr<Link> open_udp_port(int port);

}  // namespace phasescan::emulate
