#include "dds/fast_peer/peer.hpp"

#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <iostream>

namespace fast_peer {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kMost = 64U << 20;

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

double system_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

template <class Qos>
void set_quality(Qos& qos, bool reliable, bool keeps, int depth) {
  qos.reliability().kind = reliable ? fdds::RELIABLE_RELIABILITY_QOS : fdds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = keeps ? fdds::TRANSIENT_LOCAL_DURABILITY_QOS : fdds::VOLATILE_DURABILITY_QOS;
  qos.history().depth = depth;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

}  // namespace

Peer::Peer(int domain, const std::string& address) {
  fdds::DomainParticipantQos qos = fdds::PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back(address);
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  participant_ =
      fdds::DomainParticipantFactory::get_instance()->create_participant(static_cast<std::uint32_t>(domain), qos);
  publisher_ = participant_->create_publisher(fdds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(fdds::SUBSCRIBER_QOS_DEFAULT);
}

Peer::~Peer() {
  participant_->delete_contained_entities();
  fdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

fdds::DataWriter* Peer::writer(const std::string& topic, const std::string& type, bool reliable, bool keeps) {
  fdds::DataWriterQos qos = fdds::DATAWRITER_QOS_DEFAULT;
  set_quality(qos, reliable, keeps, 10);
  return publisher_->create_datawriter(topic_of(topic, type), qos);
}

void Peer::listen(const std::string& name, const std::string& topic, const std::string& type, bool reliable, bool keeps,
                  Read read) {
  fdds::DataReaderQos qos = fdds::DATAREADER_QOS_DEFAULT;
  set_quality(qos, reliable, keeps, 100);
  heard_.push_back({name, subscriber_->create_datareader(topic_of(topic, type), qos), read});
}

void Peer::listen_to_all() {
  const std::string nav = "nav_msgs::msg::dds_::", geometry = "geometry_msgs::msg::dds_::";
  listen("/tf", "rt/tf", "tf2_msgs::msg::dds_::TFMessage_", true, false, read_transforms);
  listen("/tf_static", "rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", true, true, read_transforms);
  listen("/map", "rt/map", nav + "OccupancyGrid_", true, true, read_map);
  listen("/path", "rt/path", nav + "Path_", true, true, read_path);
  listen("/pose", "rt/pose", geometry + "PoseWithCovarianceStamped_", true, false, read_pose);
  listen("/status", "rt/status", "std_msgs::msg::dds_::String_", true, true, read_text);
  listen("/diagnostics", "rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", true, false,
         read_diagnostics);
}

void Peer::print() {
  for (const Heard& heard : heard_) {
    Bytes bytes;
    fdds::SampleInfo info;
    while (heard.reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      const bool own = info.sample_identity.writer_guid().guidPrefix == participant_->guid().guidPrefix;
      if (!info.valid_data || own) continue;
      json line = {{"topic", heard.name}, {"heard", system_seconds()}};
      try {
        line.update(heard.read(bytes));
      } catch (const std::exception& error) {
        line["error"] = error.what();
      }
      if (heard.name == "/tf") add_latency(line);
      std::cout << line.dump() << '\n';
    }
  }
  std::cout.flush();
}

fdds::Topic* Peer::topic_of(const std::string& topic, const std::string& type) {
  if (topics_.contains(topic)) return topics_[topic];
  fdds::TypeSupport support(new BytesType(type));
  support.register_type(participant_);
  return topics_[topic] = participant_->create_topic(topic, type, fdds::TOPIC_QOS_DEFAULT);
}

/// From saying a scan to hearing the transform of its stamp.
void Peer::add_latency(json& line) const {
  for (json& one : line["transforms"]) {
    const auto stamp = one["stamp"].get<std::int64_t>() - (one["child"] == "odom" ? 200'000'000 : 0);
    const auto said = said_.find(stamp);
    if (said == said_.end()) continue;
    one["latency_ms"] =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - said->second).count();
  }
}

}  // namespace fast_peer
