// Says the scans of a log, spoiled where that is asked for.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "dds/fast_peer/peer.hpp"

namespace fast_peer {

struct Options {
  std::map<std::string, std::string> values;
  bool has(const std::string& name) const { return values.contains(name); }
  double number(const std::string& name, double otherwise) const {
    return has(name) ? std::stod(values.at(name)) : otherwise;
  }
};

class Talker {
 public:
  Talker(Peer& peer, const Options& options);
  bool done() const { return next_ >= lines_.size(); }
  std::size_t said() const { return next_; }
  void say();

 private:
  Bytes scan_message(const json& line, std::int64_t stamp) const;

  Peer& peer_;
  const Options& options_;
  std::vector<fdds::DataWriter*> scans_;
  fdds::DataWriter* tf_ = nullptr;
  fdds::DataWriter* static_ = nullptr;
  std::vector<json> lines_;
  std::size_t next_ = 0;
};

/// @param text  X,Y,THETA on the map
void say_pose(Peer& peer, const std::string& text);

}  // namespace fast_peer
