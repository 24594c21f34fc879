/// Who is let in: names of hosts and origins against DNS rebinding and foreign pages, a token where strangers can reach
/// the port.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace phasescan::serve {

struct AccessRules {
  /// Without it nobody from elsewhere is let in at all, since the port is on the loopback. Empty: none is needed.
  std::string token;
  std::vector<std::string> names;  ///< of this computer that a browser may call it by; addresses always may
};

/// What a request says of where it comes from.
struct Credentials {
  std::string_view host;                ///< header Host
  std::string_view origin;              ///< header Origin; empty: none, as from programs
  std::string_view token;               ///< of the query
  std::string_view authorization;       ///< header: "Bearer TOKEN"
  bool foreign_origin_allowed = false;  ///< the endpoint lets this origin in
};

enum class Access { kGranted, kWrongHost, kWrongOrigin, kNoToken };

/// Order: host, origin, token. A foreign page is let in where its origin is allowed, or where it knows the token.
Access check_access(const AccessRules& rules, const Credentials& who);
/// What a person reads who is not let in.
const char* to_string(Access access);

/// Whether two texts are the same; takes as long wherever they differ.
bool same_secret(std::string_view a, std::string_view b);
/// 128 random bits of the system's, in hex.
std::string random_token();
/// "127.0.0.1", "::1", "localhost", ...: reached from this computer alone.
bool is_loopback(std::string_view address);
/// localhost and the computer's name, with and without ".local".
std::vector<std::string> names_of_this_computer();
/// By which others reach this computer: the first address of a network that is up, its name where there is none.
std::string address_of_this_computer();

}  // namespace phasescan::serve
