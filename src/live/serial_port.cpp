// Serial ports: named and opened by libserialport; pseudo-terminals, which it does not know, by the system's own calls.
#include <asm/termbits.h>
#include <dirent.h>
#include <fcntl.h>
#include <grp.h>
#include <libserialport.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "live/fd_port.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::live {
namespace {

namespace fs = std::filesystem;

/// "12 (minicom)" where another process has the device open, as far as this user may see.
std::string holder_of(const std::string& device) {
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    const std::string id = process.path().filename();
    if (id.find_first_not_of("0123456789") != std::string::npos || id == std::to_string(::getpid())) continue;
    for (const auto& open : fs::directory_iterator(process.path() / "fd", ignored)) {
      if (fs::read_symlink(open.path(), ignored) != device) continue;
      std::string name;
      std::getline(std::ifstream(process.path() / "comm"), name);
      return id + " (" + name + ")";
    }
  }
  return {};
}

std::string group_of(const std::string& device) {
  struct stat about {};
  if (::stat(device.c_str(), &about) != 0) return "dialout";
  const group* found = ::getgrgid(about.st_gid);
  return found != nullptr ? found->gr_name : "dialout";
}

[[noreturn]] void refuse(const std::string& path, int error) {
  if (error == EACCES || error == EPERM) {
    const std::string group = group_of(path);
    throw SystemError(path, "permission denied; it is of the group " + group + ": `sudo usermod -aG " + group +
                                " $USER`, then log in again");
  }
  if (error == EBUSY) {
    const std::string holder = holder_of(path);
    throw SystemError(path, holder.empty() ? "another process holds it; stop that one (often brltty or ModemManager)"
                                           : "process " + holder + " holds it; stop that one");
  }
  if (error == ENOENT || error == ENODEV || error == ENXIO)
    throw SystemError(path, "is not there; is the sensor plugged in? `phasescan live --list` shows the ports");
  throw SystemError(path, std::string("cannot be opened: ") + std::strerror(error));
}

/// Bytes as they are, 8N1, any baud.
void set_raw(int fd, int baud) {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0) return;
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | (baud > 0 ? static_cast<tcflag_t>(BOTHER) : settings.c_cflag & CBAUD);
  settings.c_ispeed = settings.c_ospeed = baud > 0 ? static_cast<speed_t>(baud) : settings.c_ospeed;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ::ioctl(fd, TCSETS2, &settings);
}

class PtyPort final : public FdPort {
 public:
  using FdPort::FdPort;
};

class SerialPort final : public FdPort {
 public:
  SerialPort(sp_port* port, int fd) : FdPort(fd), port_(port) {}
  ~SerialPort() override {
    fd_ = -1;  // the library closes it
    sp_close(port_);
    sp_free_port(port_);
  }
  void set_dtr(bool on) override { sp_set_dtr(port_, on ? SP_DTR_ON : SP_DTR_OFF); }

 private:
  sp_port* port_;
};

}  // namespace

std::unique_ptr<Port> open_serial(const std::string& path, int baud) {
  std::error_code ignored;
  const fs::path resolved = fs::canonical(path, ignored);  // names such as /dev/serial/by-id/... are links
  const std::string device = resolved.empty() ? path : resolved.string();
  sp_port* port = nullptr;
  if (sp_get_port_by_name(device.c_str(), &port) != SP_OK) {
    const int fd = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) refuse(path, errno);
    auto pty = std::make_unique<PtyPort>(fd);
    if (::isatty(fd) == 0) throw SystemError(path, "is no serial port");
    set_raw(fd, baud);
    return pty;
  }
  if (sp_open(port, SP_MODE_READ_WRITE) != SP_OK) {
    const int error = sp_last_error_code();
    sp_free_port(port);
    refuse(device, error);
  }
  int fd = -1;
  sp_get_port_handle(port, &fd);
  auto serial = std::make_unique<SerialPort>(port, fd);
  const bool set = (baud <= 0 || sp_set_baudrate(port, baud) == SP_OK) && sp_set_bits(port, 8) == SP_OK &&
                   sp_set_parity(port, SP_PARITY_NONE) == SP_OK && sp_set_stopbits(port, 1) == SP_OK &&
                   sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE) == SP_OK;
  if (!set) throw SystemError(path, "does not take " + std::to_string(baud) + " baud; another USB adapter may");
  return serial;
}

std::vector<ListedPort> list_ports() {
  std::vector<ListedPort> found;
  if (const char* given = std::getenv("PHASESCAN_PORTS")) {
    const std::string text = given;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find_first_of(", ;", at), text.size());
      if (end > at) found.push_back({text.substr(at, end - at), "from $PHASESCAN_PORTS"});
      at = end + 1;
    }
    return found;
  }
  sp_port** ports = nullptr;
  if (sp_list_ports(&ports) != SP_OK) return found;
  for (sp_port** at = ports; *at != nullptr; ++at) {
    // Ports on the board answer for nobody; a lidar comes by USB, or is named by hand.
    const sp_transport transport = sp_get_port_transport(*at);
    if (transport != SP_TRANSPORT_USB) continue;
    const char* about = sp_get_port_description(*at);
    found.push_back({sp_get_port_name(*at), about != nullptr ? about : "USB"});
  }
  sp_free_port_list(ports);
  return found;
}

}  // namespace phasescan::live
