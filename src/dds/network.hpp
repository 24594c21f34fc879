/// Which network a ROS 2 host is told to use: the variables that every ROS 2 node reads.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace phasescan::dds {

enum class Reach {
  kSubnet,     ///< hosts of the network, found by multicast
  kLocalhost,  ///< this host alone
  kOff,        ///< nobody
  kSystem,     ///< as the middleware is configured by itself
};

struct Network {
  int domain = 0;
  Reach reach = Reach::kSubnet;
  std::vector<std::string> peers;  ///< more addresses to ask
};

/// ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY (before what follows), ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS.
/// @param variable  value of an environment variable, null where it is not set
/// @throws std::invalid_argument naming variable and what was expected
Network network_of(const std::function<const char*(const char*)>& variable);
/// Of this process. @throws as network_of
Network network_of_environment();

/// Configuration of CycloneDDS for it, over what the variable CYCLONEDDS_URI says.
std::string cyclone_configuration(const Network& network, const std::string& cyclonedds_uri);

}  // namespace phasescan::dds
