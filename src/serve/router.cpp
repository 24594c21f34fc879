#include "serve/router.hpp"

#include <cctype>

namespace phasescan::serve {
namespace {

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool decode(std::string_view text, std::string& out) {
  out.clear();
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      if (i + 2 >= text.size()) return false;
      const int high = hex_value(text[i + 1]), low = hex_value(text[i + 2]);
      if (high < 0 || low < 0) return false;
      c = static_cast<char>(16 * high + low);
      i += 2;
    }
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) return false;
    out += c;
  }
  return true;
}

}  // namespace

bool parse_target(std::string_view text, Target& target) {
  target = {};
  if (text.empty() || text.front() != '/') return false;
  text = text.substr(0, text.find('#'));
  const std::size_t mark = text.find('?');
  if (!decode(text.substr(0, mark), target.path)) return false;
  std::string_view query = mark == std::string_view::npos ? std::string_view{} : text.substr(mark + 1);
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    std::string name, value;
    if (!decode(pair.substr(0, equals), name)) return false;
    if (equals != std::string_view::npos && !decode(pair.substr(equals + 1), value)) return false;
    target.query.emplace(std::move(name), std::move(value));  // the first one counts
  }
  return true;
}

const Router::Page* Router::page(const std::string& path) const {
  const auto found = pages_.find(path);
  return found == pages_.end() ? nullptr : &found->second;
}

std::shared_ptr<WebSocketEndpoint> Router::endpoint(const std::string& path) const {
  const auto found = endpoints_.find(path);
  return found == endpoints_.end() ? nullptr : found->second;
}

Answer answer(const Router& router, std::string_view method, const Target& target) {
  const Router::Page* page = router.page(target.path);
  if (page == nullptr && router.endpoint(target.path))
    return {426, "text/plain; charset=utf-8", "this path is for WebSocket\n", {{"Upgrade", "websocket"}}};
  if (page == nullptr) return {404, "text/plain; charset=utf-8", "there is nothing at this path\n", {}};
  if (method != "GET" && method != "HEAD")
    return {405, "text/plain; charset=utf-8", "only GET\n", {{"Allow", "GET, HEAD"}}};
  return (*page)(target);
}

}  // namespace phasescan::serve
