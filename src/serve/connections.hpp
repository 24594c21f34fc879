// The two kinds of connections, on Boost.Beast. All run in the server's one thread.
#pragma once

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "serve/access.hpp"
#include "serve/server.hpp"
#include "serve/token_bucket.hpp"

namespace phasescan::serve {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;

/// A connection as the server's list has it.
class Connection {
 public:
  virtual ~Connection() = default;
  /// Once a second: what takes too long is dropped.
  virtual void tick(TokenBucket::Clock::time_point now) = 0;
  virtual void drop() = 0;
  virtual bool is_web_socket() const = 0;
};

/// What all connections share.
struct ServerState {
  ServeOptions options;
  AccessRules rules;
  Router router;
  std::list<std::weak_ptr<Connection>> connections;  // in the order in which they came
  std::atomic<std::uint64_t> requests{0}, refused{0}, dropped{0};
  std::atomic<std::size_t> open{0}, web_sockets{0};
};

using HttpRequest = http::request<http::string_body>;

/// Answers requests until one becomes a WebSocket or the client has done.
std::shared_ptr<Connection> begin_http(tcp::socket socket, ServerState& state);

/// @param request  asks for an upgrade and was let in. @param subprotocol  empty: none
std::shared_ptr<Connection> begin_web_socket(beast::tcp_stream stream, const HttpRequest& request, ServerState& state,
                                             std::shared_ptr<WebSocketEndpoint> endpoint, std::string subprotocol);

/// Of those a client offers in `header`, the one that comes first in `spoken`; empty: none.
std::string choose_subprotocol(std::string_view header, const std::vector<std::string>& spoken);

}  // namespace phasescan::serve
