/// HTTP and WebSocket on one port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "serve/router.hpp"

namespace phasescan::serve {

/// What one client may cost.
struct ServeLimits {
  std::size_t connections = 256;      ///< at once; the oldest that is no WebSocket makes room
  std::size_t header_bytes = 8192;    ///< of a request
  std::size_t body_bytes = 4096;      ///< of a request; none is used
  std::size_t queue_bytes = 4 << 20;  ///< that may wait for a WebSocket client
  double requests_per_s = 20.0;       ///< of one connection, messages of a WebSocket as well
  double burst = 60.0;                ///< that may come at once
  double request_timeout_s = 10.0;    ///< from connection, or from the answer before, to a whole request
  double write_timeout_s = 10.0;      ///< in which a client takes one message
};

struct ServeOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;  ///< 0: any free one
  std::string token;          ///< empty: none on the loopback, a random one elsewhere
  ServeLimits limits = {};
};

struct ServeCounts {
  std::uint64_t requests = 0;
  std::uint64_t refused = 0;                     ///< wrong host, origin or token, over a limit, or no HTTP at all
  std::uint64_t dropped = 0;                     ///< WebSocket clients that took too long to take what they were sent
  std::size_t connections = 0, web_sockets = 0;  ///< now
};

/// Whether this build has a server: Boost was there.
bool has_server();

/// Listens, in a thread of its own, until it is destroyed. A client can neither hold up another nor whoever sends.
class Server {
 public:
  /// @throws SystemError where the address cannot be listened at, or this build has no server; std::invalid_argument
  /// for
  ///         an address that is none
  Server(const ServeOptions& options, Router router);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  /// What to open in a browser; with the token where there is one. Bound to all addresses it names this computer's.
  std::string url() const;
  ServeCounts counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "ADDR:PORT", "[V6]:PORT", ":PORT", "PORT" or "ADDR". @throws std::invalid_argument
std::pair<std::string, std::uint16_t> parse_address(const std::string& text);

}  // namespace phasescan::serve
