#include "live_health.hpp"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "io/file.hpp"
#include "io/number.hpp"
#include "live/port.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::app {
namespace {

constexpr std::chrono::seconds kPatience{3};
constexpr std::size_t kMostBytes = 1 << 20;

struct Address {
  std::string host, query;
  int port = 80;
};

/// "http://127.0.0.1:8080/?token=...", with or without what stands before and behind the address.
Address parse_url(const std::string& url) {
  std::string text = url;
  if (text.starts_with("http://")) text.erase(0, 7);
  Address address;
  if (const std::size_t query = text.find('?'); query != std::string::npos) {
    address.query = text.substr(query);
    text.resize(query);
  }
  text.resize(std::min(text.find('/'), text.size()));
  const std::size_t colon = text.rfind(':');
  const auto port =
      colon == std::string::npos ? std::optional<int>(80) : parse_number<int>(std::string_view(text).substr(colon + 1));
  address.host = text.substr(0, colon);
  if (address.host.starts_with('[') && address.host.ends_with(']'))
    address.host = address.host.substr(1, address.host.size() - 2);
  const bool plain = address.query.find_first_of(" \r\n") == std::string::npos;
  if (address.host.empty() || !port || *port < 1 || *port > 65535 || !plain)
    throw std::invalid_argument("--health: " + quote_text(url) + " is no address; expected http://HOST:PORT");
  address.port = *port;
  return address;
}

/// Head and body of the answer.
std::string ask(const Address& address, const std::string& url) {
  const std::unique_ptr<live::Port> port = live::open_network(address.host, address.port, false);
  const std::string request = fmt::format("GET /api/status{} HTTP/1.1\r\nHost: {}:{}\r\nConnection: close\r\n\r\n",
                                          address.query, address.host, address.port);
  std::string answer;
  const auto until = std::chrono::steady_clock::now() + kPatience;
  try {
    port->write({reinterpret_cast<const std::uint8_t*>(request.data()), request.size()});
    std::uint8_t bytes[4096];
    while (answer.size() < kMostBytes) {
      const std::size_t n = port->read(bytes, 100);
      answer.append(reinterpret_cast<const char*>(bytes), n);
      if (std::chrono::steady_clock::now() > until) throw SystemError(url, "does not answer within 3 s");
    }
  } catch (const live::PortGone&) {  // the end of the answer
  }
  return answer;
}

}  // namespace

int run_health(const std::string& url) {
  const std::string answer = ask(parse_url(url), url);
  const std::size_t body = answer.find("\r\n\r\n");
  const nlohmann::json status =
      body == std::string::npos ? nlohmann::json() : nlohmann::json::parse(answer.substr(body + 4), nullptr, false);
  if (!answer.starts_with("HTTP/1.1 200") || !status.is_object() || !status.contains("state") ||
      !status["state"].is_string()) {
    throw SystemError(url, "gives no status: " + quote_text(answer.substr(0, answer.find('\r'))));
  }
  const std::string state = status["state"];
  const bool well = state != "lost" && state != "stalled" && state != "waiting";
  print(fmt::format("{}: {:.1f} scans/s, {} scans, latency p99 {:.1f} ms\n", state, status.value("rate_hz", 0.0),
                    status.value("scans", 0ULL), status.value("latency_p99_ms", 0.0)));
  return well ? kDone : kAnswerIsNo;
}

}  // namespace phasescan::app
