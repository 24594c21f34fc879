#include "live_ros2.hpp"

#include <stdexcept>

#ifdef PHASESCAN_DDS

#include "dds/live_publisher.hpp"

namespace phasescan::app {

struct LiveRos2::Impl {
  std::shared_ptr<dds::LiveLink> link;
  std::unique_ptr<dds::LivePublisher> publisher;
};

LiveRos2::LiveRos2(bool wanted) : impl_(std::make_unique<Impl>()) {
  if (wanted) impl_->link = std::make_shared<dds::LiveLink>(dds::network_of_environment());
}
LiveRos2::~LiveRos2() = default;

std::unique_ptr<live::LiveSource> LiveRos2::open(const std::string& port) {
  return dds::open_ros2(impl_->link, port);
}
void LiveRos2::publish(const OccupancyOptions& map, bool known_map,
                       std::function<void(const Pose2&, const Eigen::Matrix3d&)> set_pose) {
  impl_->publisher = std::make_unique<dds::LivePublisher>(impl_->link, map, known_map, std::move(set_pose));
}
void LiveRos2::take(const live::LiveUpdate& update) {
  if (impl_->publisher) impl_->publisher->take(update);
}

}  // namespace phasescan::app

#else

namespace phasescan::app {

struct LiveRos2::Impl {};

LiveRos2::LiveRos2(bool wanted) {
  if (wanted)
    throw std::invalid_argument(
        "--ros2, --port ros2:/TOPIC: this build has no DDS; expected one with CycloneDDS (PHASESCAN_DDS=ON)");
}
LiveRos2::~LiveRos2() = default;

std::unique_ptr<live::LiveSource> LiveRos2::open(const std::string&) {
  return nullptr;
}
void LiveRos2::publish(const OccupancyOptions&, bool, std::function<void(const Pose2&, const Eigen::Matrix3d&)>) {}
void LiveRos2::take(const live::LiveUpdate&) {}

}  // namespace phasescan::app

#endif
