/// Topics and frames for lasers that are not named like topics.
#pragma once

#include <map>
#include <string>
#include <utility>

namespace phasescan {

/// The first laser is /scan in the frame laser; a topic keeps its name.
class LaserNames {
 public:
  struct Laser {
    std::string topic, frame;
  };
  /// The names of a log's laser, and whether it is asked for the first time.
  std::pair<const Laser&, bool> of(const std::string& laser);

 private:
  std::map<std::string, Laser> lasers_;
};

}  // namespace phasescan
