// A drive through a simulated world as the packets of a sensor.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "live/packer.hpp"
#include "sim/drive.hpp"

namespace phasescan::emulate {

/// The simulated lidar that stands for a model: reach and noise of the nearest that there is a description of, with the
/// model's beams. @param rplidar_type  form of an RPLIDAR's beams, which decides how many there are
sim::LidarOptions lidar_of(const live::SensorModel& model, int rplidar_type);

class WorldFeed {
 public:
  WorldFeed(const live::SensorModel& model, sim::Drive drive, const sim::LidarOptions& lidar, int rplidar_type,
            const std::string& echo);

  /// The next packet; nothing at the end of the drive. Times from the drive's beginning.
  std::optional<live::WirePacket> next();
  /// Where the laser stood, of the turns that packets were made of so far.
  const std::vector<std::pair<double, Pose2>>& truth() const { return truth_; }

 private:
  void take_turn(const sim::DriveScan& turn);
  live::SensorModel model_;
  sim::Drive drive_;
  int rplidar_type_;
  live::Packer packer_;
  std::deque<live::WirePacket> ready_;
  std::vector<std::pair<double, Pose2>> truth_;
};

}  // namespace phasescan::emulate
