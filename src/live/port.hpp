// Where bytes of a sensor come from: a serial line, a network, a file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace phasescan::live {

/// The other end is gone: unplugged, closed, at its end.
struct PortGone {
  std::string why;
};

class Port {
 public:
  virtual ~Port() = default;
  /// What came, at most as much as fits; 0 where nothing does within `wait_ms`. @throws PortGone
  virtual std::size_t read(std::span<std::uint8_t> out, int wait_ms) = 0;
  /// Tries for a short while; what is not taken then is left out. @throws PortGone
  virtual void write(std::span<const std::uint8_t> bytes) = 0;
  virtual void set_dtr(bool /*on*/) {}
};

/// @throws SystemError saying what is wrong and what to do
std::unique_ptr<Port> open_serial(const std::string& path, int baud);
std::unique_ptr<Port> open_network(const std::string& host, int port, bool udp);

/// "tcp:HOST:PORT", "udp:HOST:PORT", else a device. `baud` is that of a device.
/// @throws SystemError, std::invalid_argument for an address that is none
std::unique_ptr<Port> open_port(const std::string& name, int baud);

/// The serial ports that may have a sensor: those in $PHASESCAN_PORTS, separated by commas or blanks, or what the
/// system lists.
struct ListedPort {
  std::string path, about;
};
std::vector<ListedPort> list_ports();

}  // namespace phasescan::live
