// A port behind a file descriptor.
#pragma once

#include "live/port.hpp"

namespace phasescan::live {

class FdPort : public Port {
 public:
  /// @param datagrams  an empty read is an empty datagram, not the other end's good-bye
  explicit FdPort(int fd, bool datagrams = false) : fd_(fd), datagrams_(datagrams) {}
  ~FdPort() override;
  FdPort(const FdPort&) = delete;
  FdPort& operator=(const FdPort&) = delete;
  std::size_t read(std::span<std::uint8_t> out, int wait_ms) override;
  void write(std::span<const std::uint8_t> bytes) override;

 protected:
  int fd_ = -1;

 private:
  bool datagrams_ = false;
};

}  // namespace phasescan::live
