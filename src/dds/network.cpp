#include "dds/network.hpp"

#include <cstdlib>
#include <stdexcept>
#include <string_view>

namespace phasescan::dds {
namespace {

constexpr int kMostDomain = 232;  // beyond, the ports of RTPS would pass 65535

int domain_of(std::string_view text) {
  const std::string all(text);
  char* end = nullptr;
  const long value = std::strtol(all.c_str(), &end, 10);
  if (all.empty() || *end != '\0' || value < 0 || value > kMostDomain)
    throw std::invalid_argument("ROS_DOMAIN_ID: '" + all + "'; expected a whole number from 0 to 232");
  return static_cast<int>(value);
}

Reach reach_of(std::string_view text) {
  if (text == "SUBNET" || text.empty()) return Reach::kSubnet;
  if (text == "LOCALHOST") return Reach::kLocalhost;
  if (text == "OFF") return Reach::kOff;
  if (text == "SYSTEM_DEFAULT") return Reach::kSystem;
  throw std::invalid_argument("ROS_AUTOMATIC_DISCOVERY_RANGE: '" + std::string(text) +
                              "'; expected SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
}

/// An address stands in a piece of XML.
std::string checked_peer(const std::string& peer) {
  if (peer.find_first_of("<>&\"' \t") != std::string::npos)
    throw std::invalid_argument("ROS_STATIC_PEERS: '" + peer + "'; expected addresses separated by ;");
  return peer;
}

}  // namespace

Network network_of(const std::function<const char*(const char*)>& variable) {
  const auto value = [&](const char* name) {
    const char* text = variable(name);
    return std::string(text != nullptr ? text : "");
  };
  Network out;
  if (const std::string domain = value("ROS_DOMAIN_ID"); !domain.empty()) out.domain = domain_of(domain);
  out.reach = reach_of(value("ROS_AUTOMATIC_DISCOVERY_RANGE"));
  if (const std::string only = value("ROS_LOCALHOST_ONLY"); only == "1") {
    out.reach = Reach::kLocalhost;
  } else if (!only.empty() && only != "0") {
    throw std::invalid_argument("ROS_LOCALHOST_ONLY: '" + only + "'; expected 0 or 1");
  }
  std::string peers = value("ROS_STATIC_PEERS");
  while (!peers.empty()) {
    const std::size_t end = peers.find(';');
    if (const std::string peer = peers.substr(0, end); !peer.empty()) out.peers.push_back(checked_peer(peer));
    peers.erase(0, end == std::string::npos ? end : end + 1);
  }
  return out;
}

Network network_of_environment() {
  return network_of([](const char* name) -> const char* { return std::getenv(name); });
}

std::string cyclone_configuration(const Network& network, const std::string& cyclonedds_uri) {
  std::string peers;
  for (const std::string& peer : network.peers) peers += "<Peer address=\"" + peer + "\"/>";
  std::string general, discovery;
  // Without multicast each host is asked at the ports that its participants' numbers give, once a second: one that
  // comes later is found at once.
  const std::string by_number =
      "<SPDPInterval>1s</SPDPInterval>"
      "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>";
  if (network.reach == Reach::kLocalhost) {
    general =
        "<Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces><AllowMulticast>false</AllowMulticast>";
    discovery = by_number;
    peers += "<Peer address=\"127.0.0.1\"/>";
  } else if (network.reach == Reach::kOff) {
    general = "<AllowMulticast>false</AllowMulticast>";
    discovery = by_number;
  }
  if (!peers.empty()) discovery += "<Peers>" + peers + "</Peers>";
  std::string out = "<CycloneDDS><Domain Id=\"any\">";
  if (!general.empty()) out += "<General>" + general + "</General>";
  if (!discovery.empty()) out += "<Discovery>" + discovery + "</Discovery>";
  out += "</Domain></CycloneDDS>";
  return cyclonedds_uri.empty() ? out : cyclonedds_uri + "," + out;
}

}  // namespace phasescan::dds
