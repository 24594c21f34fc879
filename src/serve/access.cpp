#include "serve/access.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <system_error>

namespace phasescan::serve {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "name:port", "[v6]:port" without the port and the brackets; empty for what is none.
std::string host_name(std::string_view authority) {
  if (authority.empty() || authority.size() > 255) return {};
  if (authority.front() == '[') {
    const std::size_t end = authority.find(']');
    if (end == std::string_view::npos) return {};
    const std::string_view rest = authority.substr(end + 1);
    if (!rest.empty() && (rest.front() != ':' || !is_port(rest.substr(1)))) return {};
    return lower(authority.substr(1, end - 1));
  }
  const std::size_t colon = authority.find(':');
  if (colon != std::string_view::npos && !is_port(authority.substr(colon + 1))) return {};
  return lower(authority.substr(0, colon));
}

bool is_address(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return ::inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

/// The page that asks was given out by this server.
bool is_own_origin(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return lower(origin.substr(scheme.size())) == lower(host);
  return false;
}

}  // namespace

bool same_secret(std::string_view a, std::string_view b) {
  unsigned char differ = a.size() == b.size() ? 0 : 1;
  // The length of the right one is no secret.
  for (std::size_t i = 0; i < a.size(); ++i)
    differ |= static_cast<unsigned char>(a[i] ^ (b.empty() ? '\xFF' : b[i % b.size()]));
  return differ == 0;
}

Access check_access(const AccessRules& rules, const Credentials& who) {
  const std::string name = host_name(who.host);
  if (name.empty()) return Access::kWrongHost;
  if (!is_address(name) && std::find(rules.names.begin(), rules.names.end(), name) == rules.names.end())
    return Access::kWrongHost;
  std::string_view token = who.token;
  if (constexpr std::string_view kBearer = "Bearer "; who.authorization.starts_with(kBearer))
    token = who.authorization.substr(kBearer.size());
  const bool knows_token = !rules.token.empty() && same_secret(rules.token, token);
  const bool own = who.origin.empty() || is_own_origin(who.origin, who.host);
  if (!own && !who.foreign_origin_allowed && !knows_token) return Access::kWrongOrigin;
  if (!rules.token.empty() && !knows_token) return Access::kNoToken;
  return Access::kGranted;
}

const char* to_string(Access access) {
  switch (access) {
    case Access::kGranted:
      return "let in";
    case Access::kWrongHost:
      return "this computer is not known by the name that was asked for; use its address";
    case Access::kWrongOrigin:
      return "a page of another server asks; only this server's own page may";
    case Access::kNoToken:
      return "the token is missing or wrong; open the address that phasescan printed";
  }
  return "";
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  std::size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t got = ::getrandom(bytes.data() + have, bytes.size() - have, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw std::system_error(errno, std::generic_category(), "random numbers of the system");
    have += static_cast<std::size_t>(got);
  }
  std::string text;
  for (const unsigned char byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

bool is_loopback(std::string_view address) {
  const std::string name = lower(address);
  in_addr v4{};
  if (::inet_pton(AF_INET, name.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  return name == "localhost" || name == "::1";
}

std::vector<std::string> names_of_this_computer() {
  std::vector<std::string> names{"localhost"};
  std::array<char, 256> text{};
  if (::gethostname(text.data(), text.size() - 1) == 0 && text[0] != 0) {
    const std::string name = lower(text.data());
    names.push_back(name);
    names.push_back(name + ".local");
  }
  return names;
}

std::string address_of_this_computer() {
  ifaddrs* all = nullptr;
  std::string found;
  if (::getifaddrs(&all) == 0) {
    for (const ifaddrs* one = all; one != nullptr && found.empty(); one = one->ifa_next) {
      if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
      if ((one->ifa_flags & IFF_UP) == 0 || (one->ifa_flags & IFF_LOOPBACK) != 0) continue;
      std::array<char, INET_ADDRSTRLEN> text{};
      const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
      if (::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) != nullptr) found = text.data();
    }
    ::freeifaddrs(all);
  }
  return found.empty() ? names_of_this_computer().back() : found;
}

}  // namespace phasescan::serve
