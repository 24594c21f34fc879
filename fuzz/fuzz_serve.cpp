// What comes over a connection to the server of a run: the first byte tells whether it is bytes of HTTP, or frames of a
// WebSocket that was opened before. The rest goes through a real socket.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <string>

#include "serve/page.hpp"
#include "serve/server.hpp"
#include "serve/viewer.hpp"

namespace {

using namespace phasescan;

/// Refuses everything but names and poses that are none: those must not arrive here.
class Refusing final : public serve::LiveControl {
 public:
  serve::ControlState state() const override { return {}; }
  void set_pose(const Pose2& pose, serve::CommandDone done) override {
    if (!pose.is_finite()) std::abort();
    done(false, "no");
  }
  void relocalise(serve::CommandDone done) override { done(false, "no"); }
  void start_recording(const std::string& name, serve::CommandDone done) override { check(name, done); }
  void stop_recording(serve::CommandDone done) override { done(false, "no"); }
  void save(const std::string& name, serve::CommandDone done) override { check(name, done); }
  void replay_speed(double speed, serve::CommandDone done) override {
    if (!(speed >= 0.0 && speed <= 100.0)) std::abort();
    done(true, "");
  }
  void replay_seek(double share, serve::CommandDone done) override {
    if (!(share >= 0.0 && share <= 1.0)) std::abort();
    done(true, "");
  }

 private:
  static void check(const std::string& name, const serve::CommandDone& done) {
    std::string why;
    if (!name.empty() && !serve::check_save_name(name, why)) std::abort();
    done(false, "no");
  }
};

struct Target {
  Target() {
    serve::Router router;
    router.add_page("/", [](const serve::Target&) { return serve::page_answer(); });
    router.add_page("/api/status", [](const serve::Target&) {
      return serve::Answer{200, "application/json", "{}", {}};
    });
    router.add_endpoint("/ws", viewer);
    serve::ServeOptions options;
    options.port = 0;
    server = std::make_unique<serve::Server>(options, router);
  }
  Refusing control;
  std::shared_ptr<serve::Viewer> viewer = std::make_shared<serve::Viewer>(SlamOptions{}, control, [] { return "{}"; });
  std::unique_ptr<serve::Server> server;
};

/// Whether the socket is ready (POLLIN: something came, or the end) within 15 s. Soon, but the machine may be busy with
/// other targets; and the timer of libFuzzer interrupts whatever waits, every few seconds.
bool ready(int fd, short what) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(15);
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now()).count();
    pollfd waits{fd, what, 0};
    const int count = ::poll(&waits, 1, static_cast<int>(std::max<long>(0, left)));
    if (count >= 0) return count > 0;
    if (errno != EINTR) std::abort();
  }
}

int connect_to(std::uint16_t port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  const linger at_once{1, 0};
  ::setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  // Interrupted, it goes on by itself.
  int error = ::connect(fd, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0 ? 0 : errno;
  socklen_t size = sizeof error;
  if (error == EINTR && ready(fd, POLLOUT)) ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) std::abort();
  return fd;
}

void send_all(int fd, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = ::send(fd, bytes, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;  // the server has had enough
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

/// What came; 0 or less: the end.
ssize_t receive(int fd, char* buffer, std::size_t size) {
  ssize_t got = 0;
  do {
    got = ::recv(fd, buffer, size, 0);
  } while (got < 0 && errno == EINTR);
  return got;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || !serve::has_server()) return 0;
  static Target target;
  const int fd = connect_to(target.server->port());
  const std::string upgrade =
      "GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
  char buffer[65536];
  if (data[0] % 2 == 1) {
    send_all(fd, upgrade.data(), upgrade.size());
    if (receive(fd, buffer, sizeof buffer) <= 0) std::abort();
  }
  send_all(fd, reinterpret_cast<const char*>(data) + 1, size - 1);
  ::shutdown(fd, SHUT_WR);
  // The end is told, so the server must end as well.
  do {
    if (!ready(fd, POLLIN)) std::abort();
  } while (receive(fd, buffer, sizeof buffer) > 0);
  ::close(fd);
  return 0;
}
