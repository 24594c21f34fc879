// Ports: datagrams, recorded bytes at their pace, and what is said where the system says no.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "live/clocks.hpp"
#include "live/find_sensor.hpp"
#include "live/port.hpp"
#include "live/raw_file.hpp"
#include "live/streams.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/live/live.hpp"
#include "support/command.hpp"
#include "support/nobody.hpp"

namespace phasescan::live::ports_test {
namespace {

using namespace testing;
using test::TempFolder;
using ::testing::HasSubstr;

Form form_of(const std::string& sensor) {
  for (const Form& form : forms())
    if (form.sensor == sensor) return form;
  throw std::invalid_argument(sensor);
}

/// A sensor that sends datagrams to whoever has spoken to it, as a bridge does.
class UdpSensor {
 public:
  UdpSensor() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ::bind(socket_, reinterpret_cast<sockaddr*>(&address), size);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { work(); });
  }
  ~UdpSensor() {
    ends_ = true;
    thread_.join();
    ::close(socket_);
  }
  std::string name() const { return "udp:127.0.0.1:" + std::to_string(port_); }
  std::string heard() const { return {heard_.data(), heard_.size()}; }

 private:
  void work() {
    const timeval patience{0, 100'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in client{};
    socklen_t size = sizeof client;
    char first[64];
    ssize_t n = -1;
    while (!ends_ && n <= 0)
      n = ::recvfrom(socket_, first, sizeof first, 0, reinterpret_cast<sockaddr*>(&client), &size);
    if (n > 0) heard_.assign(first, first + n);
    const auto send = [&](const void* data, std::size_t bytes) {
      ::sendto(socket_, data, bytes, 0, reinterpret_cast<sockaddr*>(&client), size);
    };
    send("", 0);  // an empty datagram is no end
    for (const WirePacket& packet : packets_of(form_of("lds-01"), 5)) {
      if (ends_) return;
      send(packet.bytes.data(), packet.bytes.size());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  int socket_ = -1, port_ = 0;
  std::atomic<bool> ends_ = false;
  std::vector<char> heard_;
  std::thread thread_;
};

/// An LDS-01 on a pseudo-terminal whose head stands until it is told to begin, and takes a while to turn.
class StandingSensor {
 public:
  StandingSensor() : fd_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
    ::grantpt(fd_);
    ::unlockpt(fd_);
    name_ = ::ptsname(fd_);
    thread_ = std::thread([this] { work(); });
  }
  ~StandingSensor() {
    ends_ = true;
    thread_.join();
    ::close(fd_);
  }
  const std::string& name() const { return name_; }

 private:
  void work() {
    char heard = 0;
    while (!ends_ && heard != 'b')
      if (::read(fd_, &heard, 1) <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    for (const WirePacket& packet : packets_of(form_of("lds-01"), 5)) {
      if (ends_) return;
      if (::write(fd_, packet.bytes.data(), packet.bytes.size()) < 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
  }

  int fd_;
  std::string name_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

TEST(Ports, AHeadThatStoodIsWaitedFor) {
  const StandingSensor sensor;
  std::size_t heard = 0;
  const SensorModel* found = find_sensor_at(
      sensor.name(), [] { return false; }, heard);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->name, "lds-01");
}

TEST(Ports, DatagramsAreAStream) {
  UdpSensor sensor;
  const auto source = open_sensor(sensor.name(), "lds-01", "");
  std::vector<Scan> scans;
  std::vector<std::string> told;
  const std::int64_t begin = steady_ns();
  source->run([&] { return scans.size() >= 3 || steady_ns() - begin > 10'000'000'000; },
              [&](LiveScan scan) { scans.push_back(std::move(scan.measurement.scan)); },
              [&](const std::string& text) { told.push_back(text); });
  EXPECT_EQ(sensor.heard(), "b");
  ASSERT_GE(scans.size(), 3U);
  EXPECT_EQ(scans[1].size(), 360U);
  EXPECT_EQ(scans[1].hit_count(), 360U);
  EXPECT_EQ(told.size(), 1U) << told.back();  // no word of a port that is gone
}

TEST(Ports, AnAddressThatIsNoneIsAMistakeOfTheCaller) {
  for (const char* name : {"udp:", "udp:host", "udp:host:0", "udp:host:99999", "udp::8089", "tcp:host:x"})
    EXPECT_THROW(open_port(name, 0), std::invalid_argument) << name;
  EXPECT_THROW(open_port("udp:no.such.host.invalid:8089", 0), SystemError);
}

TEST(Ports, RecordedBytesComeAtTheirPace) {
  const TempFolder folder;
  const std::string path = folder / "a.raw";
  const std::vector<std::string> pieces = {"first", "second, later", "third"};
  const Stamp times[] = {5'000'000'000, 5'150'000'000, 5'300'000'000};
  {
    RawWriter writer(path, "ld06");
    for (std::size_t i = 0; i < pieces.size(); ++i)
      writer.write({reinterpret_cast<const std::uint8_t*>(pieces[i].data()), pieces[i].size()}, times[i]);
    writer.commit();
  }
  EXPECT_EQ(raw_sensor(path), "ld06");
  const auto port = open_raw(path, 0.0);
  std::vector<std::string> got;
  std::vector<std::int64_t> at;
  std::uint8_t bytes[64];
  try {
    for (;;) {
      const std::size_t n = port->read(bytes, 20);
      if (n == 0) continue;
      got.emplace_back(bytes, bytes + n);
      at.push_back(steady_ns());
    }
  } catch (const PortGone&) {
  }
  EXPECT_EQ(got, pieces);
  ASSERT_EQ(at.size(), 3U);
  EXPECT_GE(at[1] - at[0], 149'000'000);
  EXPECT_GE(at[2] - at[0], 299'000'000);
}

TEST(Ports, ADamagedFileOfBytesEndsWhereItIsDamaged) {
  const TempFolder folder;
  const std::string path = folder / "a.raw";
  std::string head(12, '\0');
  head[8] = 3;
  std::ofstream(path) << "phasescan raw 1 ld06\n" << head << "abc" << std::string(12, '\xff') << "more";
  const auto port = open_raw(path, 0.0);
  std::uint8_t bytes[64];
  EXPECT_EQ(port->read(bytes, 20), 3U);
  EXPECT_THROW(port->read(bytes, 20), PortGone);
}

/// A pseudo-terminal whose client's end a test opens by name.
struct Terminal {
  int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::string name;
  Terminal() {
    ::grantpt(master);
    ::unlockpt(master);
    name = ::ptsname(master);
  }
  ~Terminal() { ::close(master); }
};

TEST(Ports, WhoMayNotIsToldTheGroup) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to become another user";
  const Terminal terminal;
  ::chmod(terminal.name.c_str(), 0600);
  const std::string told = test::told_to_nobody([&] { open_serial(terminal.name, 115200); });
  EXPECT_THAT(told, HasSubstr(terminal.name + ": permission denied"));
  EXPECT_THAT(told, HasSubstr("sudo usermod -aG "));
}

TEST(Ports, APortThatIsTakenIsSaidToBe) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to become another user";
  const Terminal terminal;
  ::chmod(terminal.name.c_str(), 0666);
  const int holder = ::open(terminal.name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_EQ(::ioctl(holder, TIOCEXCL), 0);
  const std::string told = test::told_to_nobody([&] { open_serial(terminal.name, 115200); });
  EXPECT_THAT(told, HasSubstr("holds it"));
  ::close(holder);
}

TEST(Ports, AFileThatIsNoPortIsSaidToBeNone) {
  const TempFolder folder;
  std::ofstream(folder / "plain") << "text";
  EXPECT_THROW(open_serial(folder / "plain", 115200), SystemError);
  EXPECT_THROW(open_serial("/dev/ttyNOTHING", 115200), SystemError);
}

}  // namespace
}  // namespace phasescan::live::ports_test
