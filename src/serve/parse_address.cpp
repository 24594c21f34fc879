#include <charconv>
#include <stdexcept>

#include "serve/server.hpp"

namespace phasescan::serve {

std::pair<std::string, std::uint16_t> parse_address(const std::string& text) {
  const ServeOptions defaults;
  std::string address = text, port;
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t bracket = text.find(']'), colon = text.rfind(':');
  if (digits) {
    address.clear();
    port = text;
  } else if (!text.empty() && text.front() == '[' && bracket != std::string::npos) {
    address = text.substr(1, bracket - 1);
    if (bracket + 1 < text.size()) port = text.substr(bracket + 1);
    if (!port.empty() && port.front() != ':') address.clear();
    if (!port.empty()) port.erase(0, 1);
  } else if (colon != std::string::npos) {
    address = text.substr(0, colon);
    port = text.substr(colon + 1);
  }
  unsigned number = defaults.port;
  if (!port.empty()) {
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (error != std::errc{} || end != port.data() + port.size() || number > 65535) number = 65536;
  }
  if (text.empty() || number > 65535)
    throw std::invalid_argument("--serve: '" + text +
                                "': expected ADDR:PORT such as 127.0.0.1:8080, the port from 0 to 65535");
  return {address.empty() ? defaults.address : address, static_cast<std::uint16_t>(number)};
}

}  // namespace phasescan::serve
