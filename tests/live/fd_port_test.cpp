// What is written to a port arrives, also where signals come meanwhile.
#include "live/fd_port.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>
#include <vector>

namespace phasescan::live::fd_port_test {
namespace {

TEST(FdPort, ASignalWhileItWaitsForRoomCostsNoBytes) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
  const int small = 4096;
  ::setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
  struct sigaction interrupts {};
  interrupts.sa_handler = [](int) {};
  struct sigaction before {};
  ASSERT_EQ(::sigaction(SIGUSR1, &interrupts, &before), 0);
  const pthread_t writer = ::pthread_self();
  std::vector<std::uint8_t> sent(100'000), come;
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  std::thread reader([&] {
    // The other end takes nothing at first: the writer waits, and is interrupted.
    for (int i = 0; i < 3; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      ::pthread_kill(writer, SIGUSR1);
    }
    std::vector<std::uint8_t> piece(8192);
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (come.size() < sent.size() && std::chrono::steady_clock::now() < until) {
      const ssize_t n = ::read(ends[1], piece.data(), piece.size());
      if (n > 0) come.insert(come.end(), piece.begin(), piece.begin() + n);
      if (n == 0) break;
      if (n < 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  {
    FdPort port(ends[0]);
    port.write(sent);
    // Closing it tells the reader that no more comes.
  }
  reader.join();
  ::close(ends[1]);
  ::sigaction(SIGUSR1, &before, nullptr);
  EXPECT_TRUE(come == sent) << come.size() << " bytes of " << sent.size();
}

}  // namespace
}  // namespace phasescan::live::fd_port_test
