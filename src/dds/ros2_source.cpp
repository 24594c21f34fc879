// Scans of ROS 2 topics for a live run.
#include <fmt/format.h>

#include <array>
#include <optional>
#include <vector>

#include "dds/live_link.hpp"
#include "live/clocks.hpp"
#include "ros2/scan_intake.hpp"

namespace phasescan::dds {
namespace {

using ros2::Direction;
using ros2::Role;
using ros2::Trouble;

constexpr double kWait_s = 0.02, kTellAgain_s = 10.0;
// Scans whose laser no transform leads to, until it is taken to sit at the base: two seconds of a usual one. Longer
// where somebody publishes /tf_static: Fast DDS repeats every 3 s what a reader missed, and that may be lost once.
constexpr std::uint64_t kGiveUpMounting = 20;
constexpr double kGiveUpPublished_s = 7.0;

const ros2::Qos& qos_of(std::string_view topic) {
  return ros2::endpoint(Role::kSlam, Direction::kIn, topic).qos;
}

struct ScanTopic {
  std::string name;
  Reader<ros2::LaserScan> reader;
  std::size_t writers = 0;
};

std::vector<std::string> topics_of(const std::string& port) {
  std::vector<std::string> out;
  std::string names = port.substr(port.find(':') + 1);
  while (!names.empty()) {
    const std::size_t end = names.find(',');
    out.push_back(names.substr(0, end));
    names.erase(0, end == std::string::npos ? end : end + 1);
  }
  if (out.empty()) throw std::invalid_argument("--port: expected a topic behind ros2:, such as ros2:/scan");
  return out;
}

class Ros2Source final : public live::LiveSource {
 public:
  Ros2Source(std::shared_ptr<LiveLink> link, const std::vector<std::string>& topics)
      : link_(std::move(link)),
        static_tf_(link_->participant.reader<ros2::TFMessage>("/tf_static", qos_of("/tf_static"), false)),
        tf_(link_->participant.reader<ros2::TFMessage>("/tf", qos_of("/tf"), false)),  // odom -> base may be ours
        intake_({}, link_->told) {
    for (const std::string& topic : topics)
      scans_.push_back({topic, link_->participant.reader<ros2::LaserScan>(topic, qos_of("scan"))});
    link_->scans_from_ros = true;
    ros2::IntakeOptions options;
    options.base_frame = link_->base_frame;
    options.odom_frame = link_->odom_frame;
    intake_.set_options(options);
  }

  void run(const std::function<bool()>& stop, const std::function<void(live::LiveScan)>& hand,
           const std::function<void(const std::string&)>& tell) override {
    while (!stop()) {
      link_->participant.wait(kWait_s);
      const std::int64_t arrived = live::steady_ns();
      std::vector<ros2::ReadyScan> ready;
      {
        const std::lock_guard lock(link_->mutex);
        const Stamp now = live::system_ns();
        meet_static_writers(now);
        take_transforms(static_tf_, true, now);
        take_transforms(tf_, false, now);
        for (ScanTopic& topic : scans_) take_scans(topic, now);
        choose_frames(now, tell);
        ready = intake_.take_ready(now);
        for (ScanTopic& topic : scans_) tell_writers(topic, now, tell);
        tell_troubles(now, tell);
      }
      for (ros2::ReadyScan& scan : ready) hand({std::move(scan.measurement), arrived});
    }
  }

 private:
  /// What a reader has. Messages that are none are told and passed over.
  template <class M, class Use>
  void take_all(Reader<M>& reader, const std::string& topic, Stamp now, Use&& use) {
    for (;;) {
      try {
        const std::optional<M> message = reader.take();
        if (!message) return;
        use(*message);
      } catch (const DecodeError& error) {
        link_->told.note(Trouble::kBadScan, now, topic + ": " + error.what());
      }
    }
  }

  void take_transforms(Reader<ros2::TFMessage>& reader, bool is_static, Stamp now) {
    take_all(reader, is_static ? "/tf_static" : "/tf", now,
             [&](const ros2::TFMessage& message) { intake_.add_transforms(message, is_static, now); });
  }

  /// A writer of Fast DDS says what it keeps as soon as it knows of a reader, which may not know the writer yet and
  /// drops that, and again 3 s later. A reader that comes once the writer is known is told at once.
  void meet_static_writers(Stamp now) {
    const std::size_t writers = static_tf_.writers();
    if (writers > static_writers_) {
      take_transforms(static_tf_, true, now);
      link_->participant.renew(static_tf_, "/tf_static", qos_of("/tf_static"), false);
      met_static_ = now;
    }
    static_writers_ = writers;
  }

  void take_scans(ScanTopic& topic, Stamp now) {
    take_all(topic.reader, topic.name, now, [&](const ros2::LaserScan& message) {
      intake_.add_scan(topic.name, message, now);
      ++scans_seen_;
    });
  }

  void choose_frames(Stamp now, const std::function<void(const std::string&)>& tell) {
    ros2::IntakeOptions options = intake_.options();
    const ros2::TransformBuffer& known = intake_.transforms();
    if (options.base_frame == "base_link" && !known.is_known("base_link") && known.is_known("base_footprint")) {
      options.base_frame = link_->base_frame = "base_footprint";
      intake_.set_options(options);
    }
    if (!options.mounting_from_tf || intake_.took_any() || scans_seen_ < kGiveUpMounting) return;
    if (link_->told.count(Trouble::kScanBeforeTransform) == 0) return;
    if (static_writers_ > 0 && stamp_to_seconds(now - met_static_) < kGiveUpPublished_s) return;
    options.mounting_from_tf = false;
    intake_.set_options(options);
    tell("no transform leads from the laser to base_link: it is taken to sit at the robot's origin, looking ahead");
  }

  void tell_writers(ScanTopic& topic, Stamp now, const std::function<void(const std::string&)>& tell) {
    const std::size_t writers = topic.reader.writers();
    if (writers > 1)
      link_->told.note(Trouble::kTwoPublishers, now, fmt::format("{}: {} publishers", topic.name, writers));
    if (writers == topic.writers) return;
    tell(writers == 0 ? topic.name + ": its publisher is gone; waiting until it is back"
                      : fmt::format("{}: {} publisher{}", topic.name, writers, writers > 1 ? "s, expected one" : ""));
    topic.writers = writers;
  }

  void tell_troubles(Stamp now, const std::function<void(const std::string&)>& tell) {
    for (std::size_t i = 0; i < told_.size(); ++i) {
      const auto kind = static_cast<Trouble>(i);
      const std::uint64_t count = link_->told.count(kind);
      Told& told = told_[i];
      if (count == told.count || (told.count > 0 && stamp_to_seconds(now - told.when) < kTellAgain_s)) continue;
      tell(fmt::format("{}: {}", ros2::name_of(kind), link_->told.what(kind)));
      told = {count, now};
    }
  }

  struct Told {
    std::uint64_t count = 0;
    Stamp when = 0;
  };
  std::shared_ptr<LiveLink> link_;
  Reader<ros2::TFMessage> static_tf_, tf_;
  std::vector<ScanTopic> scans_;
  ros2::ScanIntake intake_;
  std::uint64_t scans_seen_ = 0;
  std::size_t static_writers_ = 0;
  Stamp met_static_ = 0;
  std::array<Told, static_cast<std::size_t>(Trouble::kCount)> told_;
};

}  // namespace

std::unique_ptr<live::LiveSource> open_ros2(std::shared_ptr<LiveLink> link, const std::string& port) {
  return std::make_unique<Ros2Source>(std::move(link), topics_of(port));
}

}  // namespace phasescan::dds
