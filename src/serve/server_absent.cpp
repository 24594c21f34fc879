// In place of the server where Boost was not there when this was built.
#include "phasescan/io/error.hpp"
#include "serve/server.hpp"

namespace phasescan::serve {

struct Server::Impl {};

bool has_server() {
  return false;
}
Server::Server(const ServeOptions&, Router) {
  throw SystemError("--serve", "this build has no server; install libboost-dev and build again");
}
Server::~Server() = default;
std::uint16_t Server::port() const {
  return 0;
}
std::string Server::url() const {
  return {};
}
ServeCounts Server::counts() const {
  return {};
}

}  // namespace phasescan::serve
