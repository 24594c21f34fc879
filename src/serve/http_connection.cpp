#include <chrono>
#include <utility>

#include "serve/connections.hpp"

namespace phasescan::serve {
namespace {

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

std::chrono::steady_clock::duration as_duration(double s) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(s));
}

class HttpConnection final : public Connection, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(tcp::socket socket, ServerState& state)
      : state_(state),
        stream_(std::move(socket)),
        buffer_(state.options.limits.header_bytes + state.options.limits.body_bytes),
        rate_(state.options.limits.requests_per_s, state.options.limits.burst) {
    ++state_.open;
  }
  ~HttpConnection() override { --state_.open; }

  void read() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(state_.options.limits.header_bytes));
    parser_->body_limit(state_.options.limits.body_bytes);
    stream_.expires_after(as_duration(state_.options.limits.request_timeout_s));
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_read(error); });
  }

  void tick(TokenBucket::Clock::time_point) override {}  // the stream has its own timeout
  void drop() override { stream_.close(); }
  bool is_web_socket() const override { return false; }

 private:
  void on_read(beast::error_code error) {
    if (error == http::error::end_of_stream || error == asio::error::operation_aborted ||
        error == beast::error::timeout)
      return finish();
    if (error == http::error::header_limit || error == http::error::buffer_overflow)
      return refuse(http::status::request_header_fields_too_large, "the request's head is too long\n");
    if (error == http::error::body_limit) return refuse(http::status::payload_too_large, "a request needs no body\n");
    if (error && error.category() == http::make_error_code(http::error::bad_method).category())
      return refuse(http::status::bad_request, "this is no HTTP request\n");
    if (error) return finish();
    ++state_.requests;
    if (!rate_.take()) return refuse(http::status::too_many_requests, "too many requests at once\n");
    const HttpRequest request = parser_->release();
    Target target;
    if (!parse_target(view(request.target()), target)) return refuse(http::status::bad_request, "this is no path\n");
    const std::shared_ptr<WebSocketEndpoint> endpoint = state_.router.endpoint(target.path);
    const Access access = check_access(state_.rules, credentials(request, target, endpoint.get()));
    if (access != Access::kGranted) return refuse(http::status::forbidden, std::string(to_string(access)) + "\n");
    if (websocket::is_upgrade(request)) return upgrade(request, endpoint);
    Answer answer = serve::answer(state_.router, view(request.method_string()), target);
    write(answer, request.keep_alive(), request.method() == http::verb::head);
  }

  static Credentials credentials(const HttpRequest& request, const Target& target, const WebSocketEndpoint* endpoint) {
    Credentials who;
    // Two Host lines are one too many: which of them a proxy goes by nobody knows.
    if (request.count(http::field::host) == 1) who.host = view(request[http::field::host]);
    who.origin = view(request[http::field::origin]);
    who.authorization = view(request[http::field::authorization]);
    const auto token = target.query.find("token");
    if (token != target.query.end()) who.token = token->second;
    who.foreign_origin_allowed =
        endpoint != nullptr && websocket::is_upgrade(request) && endpoint->allows_origin(who.origin);
    return who;
  }

  void upgrade(const HttpRequest& request, const std::shared_ptr<WebSocketEndpoint>& endpoint) {
    if (!endpoint) return refuse(http::status::not_found, "there is no WebSocket at this path\n");
    const std::vector<std::string> spoken = endpoint->subprotocols();
    std::string chosen = choose_subprotocol(view(request[http::field::sec_websocket_protocol]), spoken);
    if (!spoken.empty() && chosen.empty())
      return refuse(http::status::bad_request, "none of the subprotocols is known here\n");
    stream_.expires_never();
    state_.connections.push_back(begin_web_socket(std::move(stream_), request, state_, endpoint, std::move(chosen)));
  }

  void refuse(http::status status, std::string text) {
    ++state_.refused;
    write({static_cast<int>(status), "text/plain; charset=utf-8", std::move(text), {}}, false, false);
  }

  void write(const Answer& answer, bool keep_alive, bool head_only) {
    response_ = std::make_unique<http::response<http::string_body>>(static_cast<http::status>(answer.status), 11);
    http::response<http::string_body>& response = *response_;
    response.set(http::field::content_type, answer.type);
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set("X-Frame-Options", "DENY");
    for (const auto& [name, value] : answer.headers) response.set(name, value);
    response.keep_alive(keep_alive);
    response.body() = answer.body;
    response.prepare_payload();
    if (head_only) response.body().clear();  // Content-Length stays that of GET
    stream_.expires_after(as_duration(state_.options.limits.write_timeout_s));
    http::async_write(stream_, response, [self = shared_from_this(), keep_alive](beast::error_code error, std::size_t) {
      if (error || !keep_alive) return self->finish();
      self->read();
    });
  }

  void finish() {
    beast::error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  ServerState& state_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::unique_ptr<http::response<http::string_body>> response_;
  TokenBucket rate_;
};

}  // namespace

std::shared_ptr<Connection> begin_http(tcp::socket socket, ServerState& state) {
  auto connection = std::make_shared<HttpConnection>(std::move(socket), state);
  connection->read();
  return connection;
}

std::string choose_subprotocol(std::string_view header, const std::vector<std::string>& spoken) {
  std::vector<std::string_view> offered;
  while (!header.empty()) {
    std::string_view word = header.substr(0, header.find(','));
    header.remove_prefix(std::min(header.size(), word.size() + 1));
    while (!word.empty() && (word.front() == ' ' || word.front() == '\t')) word.remove_prefix(1);
    while (!word.empty() && (word.back() == ' ' || word.back() == '\t')) word.remove_suffix(1);
    offered.push_back(word);
  }
  for (const std::string& name : spoken)
    for (const std::string_view word : offered)
      if (word == name) return name;
  return {};
}

}  // namespace phasescan::serve
