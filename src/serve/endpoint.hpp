/// What stands behind a WebSocket path of the server.
///
/// To attach a protocol: derive from WebSocketEndpoint, then `router.add_endpoint("/path", endpoint)` before the server
/// is made (apps/live_serve.cpp has the list). All `on_...` are called by the server's one thread, one at a time, and
/// must be quick. `Peer::send` may be called from any thread: a sink of the run hands its messages over with it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan::serve {

/// Bytes that several clients are sent without a copy for each.
using SharedBytes = std::shared_ptr<const std::string>;

/// A client of an endpoint. Any thread may use it, also after the client has gone: then nothing happens.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Puts a message at the end of the client's queue; never waits. A client whose queue grows beyond
  /// ServeLimits::queue_bytes is dropped: leave out what can be left out once `queued_bytes` is large.
  virtual void send(SharedBytes message, bool binary) = 0;
  /// What waits for a slow line.
  virtual std::size_t queued_bytes() const = 0;
  /// Says goodbye after what is in the queue. @param code  of RFC 6455, 1000: all is well
  virtual void close(int code, const std::string& reason) = 0;
};

class WebSocketEndpoint {
 public:
  virtual ~WebSocketEndpoint() = default;
  /// Those it speaks, the best first. Where there are any, a client must offer one of them.
  virtual std::vector<std::string> subprotocols() const { return {}; }
  /// Whether pages of another origin ("https://app.example.org") may connect without a token. Those of this server
  /// always may, and programs that name no origin.
  virtual bool allows_origin(std::string_view /*origin*/) const { return false; }
  /// A longer message closes the connection.
  virtual std::size_t most_message_bytes() const { return 4096; }
  /// @param subprotocol  one of `subprotocols`, or empty
  virtual void on_open(const std::shared_ptr<Peer>& peer, const std::string& subprotocol) = 0;
  /// Anything at all may stand in a message.
  virtual void on_message(const std::shared_ptr<Peer>& peer, std::string_view message, bool binary) = 0;
  /// The client's queue is empty: there is room for what could wait.
  virtual void on_drained(const std::shared_ptr<Peer>& /*peer*/) {}
  /// About once a second, whether or not there are clients.
  virtual void on_tick() {}
  virtual void on_close(const std::shared_ptr<Peer>& peer) = 0;
};

}  // namespace phasescan::serve
