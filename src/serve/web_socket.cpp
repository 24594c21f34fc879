#include <chrono>
#include <utility>

#include "serve/connections.hpp"

namespace phasescan::serve {
namespace {

class WebSocketConnection final : public Connection,
                                  public Peer,
                                  public std::enable_shared_from_this<WebSocketConnection> {
 public:
  using Clock = TokenBucket::Clock;

  WebSocketConnection(beast::tcp_stream stream, ServerState& state, std::shared_ptr<WebSocketEndpoint> endpoint,
                      std::string subprotocol)
      : state_(state),
        socket_(std::move(stream)),
        executor_(socket_.get_executor()),
        endpoint_(std::move(endpoint)),
        subprotocol_(std::move(subprotocol)),
        rate_(state.options.limits.requests_per_s, state.options.limits.burst) {
    ++state_.open;
    ++state_.web_sockets;
  }
  ~WebSocketConnection() override {
    --state_.open;
    --state_.web_sockets;
  }

  void accept(const HttpRequest& request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = std::chrono::seconds(10);
    timeout.idle_timeout = std::chrono::seconds(20);
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(endpoint_->most_message_bytes());
    socket_.auto_fragment(false);
    socket_.write_buffer_bytes(16384);
    if (!subprotocol_.empty())
      socket_.set_option(websocket::stream_base::decorator([name = subprotocol_](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol, name);
      }));
    socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->open_ = true;
      self->endpoint_->on_open(self, self->subprotocol_);
      self->endpoint_->on_drained(self);
      self->read();
    });
  }

  // Peer, from any thread.
  void send(SharedBytes message, bool binary) override {
    const std::size_t size = message->size();
    if (queued_.fetch_add(size) + size > state_.options.limits.queue_bytes) too_slow_ = true;
    asio::post(executor_, [self = shared_from_this(), message = std::move(message), binary]() mutable {
      self->enqueue(std::move(message), binary);
    });
  }
  std::size_t queued_bytes() const override { return queued_; }
  void close(int code, const std::string& reason) override {
    asio::post(executor_, [self = shared_from_this(), code, reason] {
      self->closing_ = websocket::close_reason(static_cast<websocket::close_code>(code), reason.substr(0, 120));
      if (self->queue_.empty()) self->say_goodbye();
    });
  }

  // Connection.
  void tick(Clock::time_point now) override {
    const std::chrono::duration<double> longest(state_.options.limits.write_timeout_s);
    if (!queue_.empty() && now - write_began_ > longest) too_slow_ = true;
    if (too_slow_ && open_) {
      ++state_.dropped;
      drop();
    }
  }
  void drop() override {
    close_socket();
    gone();
  }
  bool is_web_socket() const override { return true; }

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->gone();
      if (!self->rate_.take()) {
        ++self->state_.refused;
        return self->close(1008, "too many messages");
      }
      const asio::const_buffer bytes = self->buffer_.cdata();
      self->endpoint_->on_message(self, {static_cast<const char*>(bytes.data()), bytes.size()},
                                  self->socket_.got_binary());
      self->buffer_.clear();
      if (self->open_) self->read();
    });
  }

  void enqueue(SharedBytes message, bool binary) {
    if (!open_) {
      queued_ -= message->size();
      return;
    }
    if (too_slow_) {
      ++state_.dropped;
      return drop();
    }
    queue_.push_back({std::move(message), binary});
    if (queue_.size() == 1) write();
  }

  void write() {
    write_began_ = Clock::now();
    socket_.binary(queue_.front().binary);
    socket_.async_write(asio::buffer(*queue_.front().bytes),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          if (error) return self->gone();
                          self->queued_ -= self->queue_.front().bytes->size();
                          self->queue_.pop_front();
                          if (!self->open_) return;
                          if (!self->queue_.empty()) return self->write();
                          if (self->closing_) return self->say_goodbye();
                          self->endpoint_->on_drained(self);
                        });
  }

  void say_goodbye() {
    if (!open_ || std::exchange(said_goodbye_, true)) return;
    socket_.async_close(*closing_, [self = shared_from_this()](beast::error_code) { self->gone(); });
  }

  /// A message that the client does not take is given up with the rest: it would hold the connection for ever.
  void gone() {
    if (!std::exchange(open_, false)) return;
    close_socket();
    endpoint_->on_close(shared_from_this());
  }

  void close_socket() {
    beast::error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

  struct Message {
    SharedBytes bytes;
    bool binary = false;
  };

  ServerState& state_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::tcp_stream::executor_type executor_;
  std::shared_ptr<WebSocketEndpoint> endpoint_;
  const std::string subprotocol_;
  TokenBucket rate_;
  beast::flat_buffer buffer_;
  std::deque<Message> queue_;  // the first one is on its way
  Clock::time_point write_began_;
  std::optional<websocket::close_reason> closing_;
  bool open_ = false, said_goodbye_ = false;
  std::atomic<bool> too_slow_{false};
  std::atomic<std::size_t> queued_{0};
};

}  // namespace

std::shared_ptr<Connection> begin_web_socket(beast::tcp_stream stream, const HttpRequest& request, ServerState& state,
                                             std::shared_ptr<WebSocketEndpoint> endpoint, std::string subprotocol) {
  auto connection =
      std::make_shared<WebSocketConnection>(std::move(stream), state, std::move(endpoint), std::move(subprotocol));
  connection->accept(request);
  return connection;
}

}  // namespace phasescan::serve
