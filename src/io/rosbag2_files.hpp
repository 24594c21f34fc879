/// Which files a rosbag2 folder is made of.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

namespace phasescan {

struct Rosbag2Files {
  std::deque<std::string> files;             ///< in the order of recording
  std::map<std::string, std::string> about;  ///< facts for `info`
  bool whole = true;  ///< the metadata reach as far as their count of messages, which stands behind the files
  struct Damage {
    std::string kind, place, why;
  };
  std::vector<Damage> damages;
};

/// By its metadata.yaml; where that is missing, broken or cut off, by the files that are there.
/// @throws InputError where neither tells, SystemError.
Rosbag2Files find_rosbag2_files(const std::string& folder);

}  // namespace phasescan
