/// Which path leads where.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "serve/endpoint.hpp"

namespace phasescan::serve {

struct Answer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< beside those that every answer has
};

/// Path and query of a request's target, percent signs decoded.
struct Target {
  std::string path;
  std::map<std::string, std::string> query;
};
/// False for a target that is no path ("http://...", "*"), or that holds a broken percent sign or a control character.
bool parse_target(std::string_view text, Target& target);

/// Paths are fixed names: no request reaches the file system.
class Router {
 public:
  /// Called for GET and HEAD by the server's thread; must be quick.
  using Page = std::function<Answer(const Target&)>;
  void add_page(const std::string& path, Page page) { pages_[path] = std::move(page); }
  void add_endpoint(const std::string& path, std::shared_ptr<WebSocketEndpoint> endpoint) {
    endpoints_[path] = std::move(endpoint);
  }
  const std::map<std::string, std::shared_ptr<WebSocketEndpoint>>& endpoints() const { return endpoints_; }
  /// Null: there is none.
  const Page* page(const std::string& path) const;
  std::shared_ptr<WebSocketEndpoint> endpoint(const std::string& path) const;

 private:
  std::map<std::string, Page> pages_;
  std::map<std::string, std::shared_ptr<WebSocketEndpoint>> endpoints_;
};

/// The answer to a request that was let in. @param method  "GET", ...
Answer answer(const Router& router, std::string_view method, const Target& target);

}  // namespace phasescan::serve
