/// A host without ROS on a network of ROS 2: topics as ROS 2 names them, messages of ros2/messages.hpp.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dds/network.hpp"
#include "ros2/codec.hpp"
#include "ros2/qos.hpp"

namespace phasescan::dds {

/// "/scan" as "rt/scan"; "scan" too. @throws std::invalid_argument for a name that ROS 2 does not allow
std::string dds_topic(std::string_view topic);
/// "sensor_msgs/msg/LaserScan" as "sensor_msgs::msg::dds_::LaserScan_".
std::string dds_type(std::string_view type);

class Participant;

/// Says messages of one topic. Not to be used by two threads at once.
class RawWriter {
 public:
  RawWriter(RawWriter&&) noexcept = default;
  /// Waits up to 0.1 s where a reliable reader does not keep up; then the message is lost for it.
  void write(const std::vector<std::uint8_t>& cdr);
  std::size_t readers() const;  ///< that there are now

 private:
  friend class Participant;
  explicit RawWriter(int entity) : entity_(entity) {}
  int entity_;
};

/// Takes messages of one topic.
class RawReader {
 public:
  RawReader(RawReader&&) noexcept = default;
  RawReader& operator=(RawReader&&) noexcept = default;
  /// The oldest that was not taken; false where there is none.
  bool take(std::vector<std::uint8_t>& cdr);
  std::size_t writers() const;  ///< that there are now

 private:
  friend class Participant;
  explicit RawReader(int entity) : entity_(entity) {}
  int entity_;
};

template <class M>
class Writer {
 public:
  explicit Writer(RawWriter raw) : raw_(std::move(raw)) {}
  void write(const M& message) { raw_.write(ros2::encode(message)); }
  std::size_t readers() const { return raw_.readers(); }

 private:
  RawWriter raw_;
};

template <class M>
class Reader {
 public:
  explicit Reader(RawReader raw) : raw_(std::move(raw)) {}
  /// The next message; nothing where there is none. @throws DecodeError for bytes that are another message
  std::optional<M> take() {
    if (!raw_.take(bytes_)) return std::nullopt;
    return ros2::decode<M>(bytes_);
  }
  std::size_t writers() const { return raw_.writers(); }

 private:
  friend class Participant;
  RawReader raw_;
  std::vector<std::uint8_t> bytes_;
};

/// One per process and domain. Must outlive its readers and writers.
class Participant {
 public:
  /// @throws SystemError where the network cannot be used
  explicit Participant(const Network& network);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  template <class M>
  Writer<M> writer(std::string_view topic, const ros2::Qos& qos) {
    return Writer<M>(raw_writer(topic, ros2::Message<M>::type, qos));
  }
  /// @param own  whether it also takes what this participant says itself
  template <class M>
  Reader<M> reader(std::string_view topic, const ros2::Qos& qos, bool own = true) {
    return Reader<M>(raw_reader(topic, ros2::Message<M>::type, qos, own));
  }
  /// Puts a new reader in the place of one: every writer tells it what it keeps for those that come late. What was not
  /// taken is lost.
  template <class M>
  void renew(Reader<M>& reader, std::string_view topic, const ros2::Qos& qos, bool own = true) {
    close(reader.raw_);
    reader.raw_ = raw_reader(topic, ros2::Message<M>::type, qos, own);
  }
  /// Waits until a reader has something, at most so long [s].
  void wait(double seconds);

 private:
  RawWriter raw_writer(std::string_view topic, std::string_view type, const ros2::Qos& qos);
  RawReader raw_reader(std::string_view topic, std::string_view type, const ros2::Qos& qos, bool own);
  static void close(const RawReader& reader);
  int topic_entity(std::string_view topic, std::string_view type);

  std::string name_;  // for messages
  int domain_ = 0, participant_ = 0, waitset_ = 0;
};

}  // namespace phasescan::dds
