#include "serve/server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <thread>
#include <utility>

#include "live/priority.hpp"
#include "phasescan/io/error.hpp"
#include "serve/connections.hpp"

namespace phasescan::serve {
namespace {

constexpr int kNicer = 5;  // a third of the time of who tracks, where both want a core

asio::ip::address address_of(const std::string& text) {
  if (text == "localhost") return asio::ip::make_address("127.0.0.1");
  boost::system::error_code error;
  const asio::ip::address address = asio::ip::make_address(text, error);
  if (error)
    throw std::invalid_argument("--serve: '" + text + "' is no address; expected ADDR:PORT such as 127.0.0.1:8080");
  return address;
}

}  // namespace

bool has_server() {
  return true;
}

struct Server::Impl {
  Impl(const ServeOptions& options, Router router) : acceptor(context), timer(context) {
    state.options = options;
    state.router = std::move(router);
    const tcp::endpoint at(address_of(options.address), options.port);
    if (!at.address().is_loopback() && state.options.token.empty()) state.options.token = random_token();
    state.rules = {state.options.token, names_of_this_computer()};
    boost::system::error_code error;
    acceptor.open(at.protocol(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(at, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error)
      throw SystemError(
          "--serve " + options.address + ":" + std::to_string(options.port),
          error.message() +
              (error == asio::error::address_in_use ? "; another program listens there: choose another port" : ""));
    accept();
    tick();
    thread = std::thread([this] {
      live::be_nicer(kNicer);
      context.run();
    });
  }

  ~Impl() {
    asio::post(context, [this] {
      boost::system::error_code ignored;
      acceptor.close(ignored);
      timer.cancel(ignored);
      for (const auto& weak : state.connections)
        if (const auto connection = weak.lock()) connection->drop();
      context.stop();
    });
    thread.join();
  }

  void accept() {
    acceptor.async_accept([this](boost::system::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted || !acceptor.is_open()) return;
      if (!error) {
        make_room();
        boost::system::error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        state.connections.push_back(begin_http(std::move(socket), state));
        return accept();
      }
      // Out of descriptors: try again a little later.
      retry.expires_after(std::chrono::milliseconds(100));
      retry.async_wait([this](boost::system::error_code stopped) {
        if (!stopped) accept();
      });
    });
  }

  /// Where all places are taken the oldest connection that is no WebSocket gives up its own.
  void make_room() {
    forget_gone();
    if (state.open < state.options.limits.connections) return;
    ++state.refused;
    for (const auto& weak : state.connections) {
      const auto connection = weak.lock();
      if (!connection || connection->is_web_socket()) continue;
      connection->drop();
      return;
    }
    if (const auto oldest = state.connections.front().lock()) oldest->drop();
  }

  void forget_gone() {
    state.connections.remove_if([](const auto& weak) { return weak.expired(); });
  }

  void tick() {
    timer.expires_after(std::chrono::seconds(1));
    timer.async_wait([this](boost::system::error_code error) {
      if (error || !acceptor.is_open()) return;
      const auto now = TokenBucket::Clock::now();
      const auto connections = state.connections;
      for (const auto& weak : connections)
        if (const auto connection = weak.lock()) connection->tick(now);
      for (const auto& [path, endpoint] : state.router.endpoints()) endpoint->on_tick();
      forget_gone();
      tick();
    });
  }

  ServerState state;  // outlives what the context holds
  asio::io_context context{1};
  tcp::acceptor acceptor;
  asio::steady_timer timer, retry{context};
  std::thread thread;
};

Server::Server(const ServeOptions& options, Router router)
    : impl_(std::make_unique<Impl>(options, std::move(router))) {}
Server::~Server() = default;

std::uint16_t Server::port() const {
  return impl_->acceptor.local_endpoint().port();
}

std::string Server::url() const {
  const tcp::endpoint at = impl_->acceptor.local_endpoint();
  std::string host = at.address().is_unspecified() ? address_of_this_computer() : at.address().to_string();
  if (at.address().is_v6() && !at.address().is_unspecified()) host = "[" + host + "]";
  const std::string& token = impl_->state.options.token;
  return "http://" + host + ":" + std::to_string(at.port()) + "/" + (token.empty() ? "" : "?token=" + token);
}

ServeCounts Server::counts() const {
  const ServerState& state = impl_->state;
  return {state.requests, state.refused, state.dropped, state.open, state.web_sockets};
}

}  // namespace phasescan::serve
