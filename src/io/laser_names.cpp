#include "io/laser_names.hpp"

#include <cctype>

namespace phasescan {

std::pair<const LaserNames::Laser&, bool> LaserNames::of(const std::string& name) {
  const auto found = lasers_.find(name);
  if (found != lasers_.end()) return {found->second, false};
  Laser laser{name, "laser"};
  if (!name.starts_with('/')) {
    laser.topic = lasers_.empty() ? "/scan" : "/";
    for (const char c : lasers_.empty() ? std::string() : name) {
      const auto byte = static_cast<unsigned char>(c);
      laser.topic += std::isalnum(byte) != 0 ? static_cast<char>(std::tolower(byte)) : '_';
    }
  }
  if (!lasers_.empty()) laser.frame.append("_").append(std::to_string(lasers_.size() + 1));
  return {lasers_.emplace(name, std::move(laser)).first->second, true};
}

}  // namespace phasescan
