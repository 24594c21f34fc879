// A port behind a file descriptor.
#pragma once

#include "live/port.hpp"

namespace phasescan::live {

class FdPort : public Port {
 public:
  explicit FdPort(int fd) : fd_(fd) {}
  ~FdPort() override;
  FdPort(const FdPort&) = delete;
  FdPort& operator=(const FdPort&) = delete;
  std::size_t read(std::span<std::uint8_t> out, int wait_ms) override;
  void write(std::span<const std::uint8_t> bytes) override;

 protected:
  int fd_ = -1;
};

}  // namespace phasescan::live
