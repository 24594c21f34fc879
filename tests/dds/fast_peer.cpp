// Another host on the network, by other hands: Fast DDS and Fast CDR with the types of ROS 2 written out once more.
// Says scans of a log and listens to what phasescan says; prints a JSON line for each message that came.
//
//   fast_peer --domain N --seconds S [--scans LOG.jsonl --rate HZ [--odometry] [--no-mounting] [--first K] [--count N]]
//             [--mangle KIND] [--pose X,Y,THETA] [--publishers N]
//
// KIND: nan, empty, beams, jump, noframe; each spoils every tenth scan.
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace fdds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using nlohmann::json;

namespace {

using Bytes = std::vector<char>;
constexpr std::uint32_t kMost = 64U << 20;
constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000;  // added to the stamps of a log, which begin at 0

/// Samples are bytes; Fast CDR makes and reads them below.
class BytesType : public fdds::TopicDataType {
 public:
  explicit BytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kMost;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(payload->data, bytes.data(), bytes.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    const char* first = reinterpret_cast<const char*>(payload->data);
    static_cast<Bytes*>(data)->assign(first, first + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

struct Planar {
  double x = 0, y = 0, theta = 0;
};

Bytes made(const std::function<void(Cdr&)>& fill) {
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  fill(cdr);
  return Bytes(buffer.getBuffer(), buffer.getBuffer() + cdr.getSerializedDataLength());
}

void put_header(Cdr& cdr, std::int64_t stamp, const std::string& frame) {
  cdr << static_cast<std::int32_t>(stamp / 1'000'000'000) << static_cast<std::uint32_t>(stamp % 1'000'000'000) << frame;
}
void put_pose(Cdr& cdr, const Planar& pose) {
  cdr << pose.x << pose.y << 0.0 << 0.0 << 0.0 << std::sin(pose.theta / 2) << std::cos(pose.theta / 2);
}
Bytes tf_message(std::int64_t stamp, const std::string& parent, const std::string& child, const Planar& pose) {
  return made([&](Cdr& cdr) {
    cdr << std::uint32_t{1};
    put_header(cdr, stamp, parent);
    cdr << child;
    put_pose(cdr, pose);
  });
}

/// Reads what stands in a message, in the order of its type.
class Taken {
 public:
  explicit Taken(Bytes& bytes)
      : buffer_(bytes.data(), bytes.size()), cdr_(buffer_, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR) {
    cdr_.read_encapsulation();
  }
  template <class T>
  T get() {
    T value{};
    cdr_ >> value;
    return value;
  }
  std::int64_t stamp() {
    const auto seconds = get<std::int32_t>();
    return std::int64_t{seconds} * 1'000'000'000 + get<std::uint32_t>();
  }
  Planar pose() {
    const std::array<double, 7> v = get<std::array<double, 7>>();
    return {v[0], v[1], 2.0 * std::atan2(v[5], v[6])};
  }

 private:
  FastBuffer buffer_;
  Cdr cdr_;
};

json of(const Planar& pose) {
  return {pose.x, pose.y, std::remainder(pose.theta, 2.0 * 3.14159265358979323846)};
}

json read_pose(Taken& in) {
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  out["pose"] = of(in.pose());
  const auto covariance = in.get<std::array<double, 36>>();
  out["covariance"] = {covariance[0], covariance[1], covariance[6], covariance[7], covariance[35]};
  return out;
}
json read_map(Taken& in) {
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  in.stamp();
  out["resolution"] = in.get<float>();
  out["width"] = in.get<std::uint32_t>();
  out["height"] = in.get<std::uint32_t>();
  out["origin"] = of(in.pose());
  const auto cells = in.get<std::vector<std::int8_t>>();
  std::uint32_t occupied = 0, free = 0, other = 0;
  for (const std::int8_t cell : cells) (cell == 100 ? occupied : cell == 0 ? free : other) += 1;
  out["cells"] = cells.size();
  out["occupied"] = occupied;
  out["free"] = free;
  return out;
}
json read_transforms(Taken& in) {
  json out = json::array();
  for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
    json one = {{"stamp", in.stamp()}, {"parent", in.get<std::string>()}};
    one["child"] = in.get<std::string>();
    one["pose"] = of(in.pose());
    out.push_back(one);
  }
  return {{"transforms", out}};
}
json read_scan(Taken& in) {
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  for (int i = 0; i < 7; ++i) in.get<float>();
  out["beams"] = in.get<std::vector<float>>().size();
  return out;
}
json read_path(Taken& in) {
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  out["poses"] = in.get<std::uint32_t>();
  return out;
}
json read_text(Taken& in) {
  return {{"data", in.get<std::string>()}};
}
json read_diagnostics(Taken& in) {
  json out = {{"stamp", in.stamp()}, {"frame", in.get<std::string>()}};
  in.get<std::uint32_t>();
  out["level"] = in.get<std::uint8_t>();
  out["name"] = in.get<std::string>();
  out["message"] = in.get<std::string>();
  in.get<std::string>();
  json values = json::object();
  for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
    const auto key = in.get<std::string>();
    values[key] = in.get<std::string>();
  }
  out["values"] = values;
  return out;
}

struct Options {
  std::map<std::string, std::string> values;
  bool has(const std::string& name) const { return values.contains(name); }
  double number(const std::string& name, double otherwise) const {
    return has(name) ? std::stod(values.at(name)) : otherwise;
  }
};

class Peer {
 public:
  explicit Peer(int domain) {
    fdds::DomainParticipantQos qos = fdds::PARTICIPANT_QOS_DEFAULT;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    participant_ =
        fdds::DomainParticipantFactory::get_instance()->create_participant(static_cast<std::uint32_t>(domain), qos);
    publisher_ = participant_->create_publisher(fdds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(fdds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Peer() {
    participant_->delete_contained_entities();
    fdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  fdds::DataWriter* writer(const std::string& topic, const std::string& type, bool reliable, bool keeps) {
    fdds::DataWriterQos qos = fdds::DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = reliable ? fdds::RELIABLE_RELIABILITY_QOS : fdds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = keeps ? fdds::TRANSIENT_LOCAL_DURABILITY_QOS : fdds::VOLATILE_DURABILITY_QOS;
    qos.history().depth = 10;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    return publisher_->create_datawriter(topic_of(topic, type), qos);
  }
  void listen(const std::string& name, const std::string& topic, const std::string& type, bool reliable, bool keeps,
              json (*read)(Taken&)) {
    fdds::DataReaderQos qos = fdds::DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = reliable ? fdds::RELIABLE_RELIABILITY_QOS : fdds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = keeps ? fdds::TRANSIENT_LOCAL_DURABILITY_QOS : fdds::VOLATILE_DURABILITY_QOS;
    qos.history().depth = 100;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    heard_.push_back({name, subscriber_->create_datareader(topic_of(topic, type), qos), read});
  }
  void said(std::int64_t stamp) { said_[stamp] = std::chrono::steady_clock::now(); }

  /// Prints what has come.
  void print() {
    for (const Heard& heard : heard_) {
      Bytes bytes;
      fdds::SampleInfo info;
      while (heard.reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
        if (!info.valid_data) continue;
        json line = {{"topic", heard.name}};
        try {
          Taken in(bytes);
          line.update(heard.read(in));
        } catch (const std::exception& error) {
          line["error"] = error.what();
        }
        if (heard.name == "/tf") add_latency(line);
        std::cout << line.dump() << '\n';
      }
    }
    std::cout.flush();
  }

 private:
  struct Heard {
    std::string name;
    fdds::DataReader* reader;
    json (*read)(Taken&);
  };
  fdds::Topic* topic_of(const std::string& topic, const std::string& type) {
    if (topics_.contains(topic)) return topics_[topic];
    fdds::TypeSupport support(new BytesType(type));
    support.register_type(participant_);
    return topics_[topic] = participant_->create_topic(topic, type, fdds::TOPIC_QOS_DEFAULT);
  }
  /// From saying a scan to hearing the transform of its stamp.
  void add_latency(json& line) const {
    for (json& one : line["transforms"]) {
      const auto stamp = one["stamp"].get<std::int64_t>() - (one["child"] == "odom" ? 200'000'000 : 0);
      const auto said = said_.find(stamp);
      if (said == said_.end()) continue;
      one["latency_ms"] =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - said->second).count();
    }
  }
  fdds::DomainParticipant* participant_;
  fdds::Publisher* publisher_;
  fdds::Subscriber* subscriber_;
  std::map<std::string, fdds::Topic*> topics_;
  std::vector<Heard> heard_;
  std::map<std::int64_t, std::chrono::steady_clock::time_point> said_;
};

void listen_to_all(Peer& peer) {
  const std::string nav = "nav_msgs::msg::dds_::", geometry = "geometry_msgs::msg::dds_::";
  peer.listen("/tf", "rt/tf", "tf2_msgs::msg::dds_::TFMessage_", true, false, read_transforms);
  peer.listen("/tf_static", "rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", true, true, read_transforms);
  peer.listen("/map", "rt/map", nav + "OccupancyGrid_", true, true, read_map);
  peer.listen("/path", "rt/path", nav + "Path_", true, true, read_path);
  peer.listen("/pose", "rt/pose", geometry + "PoseWithCovarianceStamped_", true, false, read_pose);
  peer.listen("/status", "rt/status", "std_msgs::msg::dds_::String_", true, true, read_text);
  peer.listen("/diagnostics", "rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", true, false,
              read_diagnostics);
}

/// A scan of a log as a message, spoiled where that is asked for.
class Talker {
 public:
  Talker(Peer& peer, const Options& options) : peer_(peer), options_(options) {
    for (int i = 0; i < static_cast<int>(options.number("--publishers", 1)); ++i)
      scans_.push_back(peer.writer("rt/scan", "sensor_msgs::msg::dds_::LaserScan_", false, false));
    tf_ = peer.writer("rt/tf", "tf2_msgs::msg::dds_::TFMessage_", true, false);
    static_ = peer.writer("rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", true, true);
    if (!options.has("--no-mounting")) {
      Bytes bytes = tf_message(0, "base_link", "laser", {});
      static_->write(&bytes);
    }
    std::ifstream log(options.values.at("--scans"));
    for (std::string line; std::getline(log, line);) lines_.push_back(json::parse(line));
    const auto first = static_cast<std::size_t>(options.number("--first", 0));
    lines_.erase(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(std::min(first, lines_.size())));
    if (const auto n = static_cast<std::size_t>(options.number("--count", 1e9)); n < lines_.size()) lines_.resize(n);
  }

  bool done() const { return next_ >= lines_.size(); }
  void say() {
    const json& line = lines_[next_];
    const auto stamp = static_cast<std::int64_t>(std::llround(line.value("stamp", 0.0) * 1e6)) * 1000 + kEpoch;
    if (options_.has("--odometry") && line.contains("odometry")) {
      const json& o = line["odometry"];
      Bytes bytes = tf_message(stamp, "odom", "base_link", {o["x"], o["y"], o["theta"]});
      tf_->write(&bytes);
    }
    for (fdds::DataWriter* writer : scans_) {
      Bytes bytes = scan_message(line, stamp);
      peer_.said(stamp);
      writer->write(&bytes);
    }
    ++next_;
  }

 private:
  Bytes scan_message(const json& line, std::int64_t stamp) const {
    std::vector<float> ranges;
    for (const json& range : line["ranges"]) ranges.push_back(range.is_number() ? range.get<float>() : std::nanf(""));
    const std::size_t beams = ranges.size();
    std::string frame = "laser";
    if (options_.has("--mangle") && next_ % 10 == 9) {
      const std::string& kind = options_.values.at("--mangle");
      if (kind == "nan") ranges.assign(beams, std::nanf(""));
      if (kind == "empty") ranges.clear();
      if (kind == "beams") ranges.resize(beams / 2);
      if (kind == "noframe") frame.clear();
      if (kind == "jump") stamp -= 60'000'000'000;
    }
    const auto first = line["angle_min"].get<float>(), step = line["angle_increment"].get<float>();
    return made([&](Cdr& cdr) {
      put_header(cdr, stamp, frame);
      cdr << first << first + step * static_cast<float>(beams - 1) << step << line.value("time_increment", 0.0F) << 0.0F
          << line.value("range_min", 0.0F) << line.value("range_max", 0.0F) << ranges << std::vector<float>{};
    });
  }
  Peer& peer_;
  const Options& options_;
  std::vector<fdds::DataWriter*> scans_;
  fdds::DataWriter* tf_ = nullptr;
  fdds::DataWriter* static_ = nullptr;
  std::vector<json> lines_;
  std::size_t next_ = 0;
};

void say_pose(Peer& peer, const std::string& text) {
  Planar pose;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf", &pose.x, &pose.y, &pose.theta) != 3) return;
  fdds::DataWriter* writer =
      peer.writer("rt/initialpose", "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_", true, false);
  std::this_thread::sleep_for(std::chrono::seconds(1));  // volatile: who listens must be there
  Bytes bytes = made([&](Cdr& cdr) {
    put_header(cdr, 0, "map");
    put_pose(cdr, pose);
    std::array<double, 36> covariance{};
    covariance[0] = covariance[7] = covariance[35] = 0.1;
    cdr << covariance;
  });
  writer->write(&bytes);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const bool value = i + 1 < argc && std::strncmp(argv[i + 1], "--", 2) != 0;
    options.values[name] = value ? argv[++i] : "";
  }
  Peer peer(static_cast<int>(options.number("--domain", 0)));
  if (options.has("--hear-scans"))
    peer.listen("/scan", "rt/scan", "sensor_msgs::msg::dds_::LaserScan_", false, false, read_scan);
  listen_to_all(peer);
  std::unique_ptr<Talker> talker;
  if (options.has("--scans")) talker = std::make_unique<Talker>(peer, options);
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const double until = options.number("--seconds", 10.0), period = 1.0 / options.number("--rate", 10.0);
  double next = options.number("--after", 1.5);  // best effort and volatile: who is to listen must be there
  if (options.has("--pose")) say_pose(peer, options.values.at("--pose"));
  while (seconds() < until) {
    if (talker && !talker->done() && seconds() >= next) {
      talker->say();
      next += period;
    }
    peer.print();
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
  return 0;
}
