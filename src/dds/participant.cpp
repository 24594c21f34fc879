#include "dds/participant.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <stdexcept>

#include "dds/raw_type.hpp"
#include "phasescan/io/error.hpp"
#include "ros2/type_hash.hpp"

namespace phasescan::dds {
namespace {

struct QosFree {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};

std::unique_ptr<dds_qos_t, QosFree> dds_qos(const ros2::Qos& qos, std::string_view type) {
  constexpr std::int64_t kLongestWait = DDS_MSECS(100);
  std::unique_ptr<dds_qos_t, QosFree> out(dds_create_qos());
  dds_qset_reliability(out.get(), qos.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, kLongestWait);
  dds_qset_durability(out.get(), qos.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(out.get(), DDS_HISTORY_KEEP_LAST, qos.depth);
  if (qos.transient_local) {
    dds_qset_durability_service(out.get(), 0, DDS_HISTORY_KEEP_LAST, qos.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  const dds_data_representation_id_t xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(out.get(), 1, &xcdr1);
  // Newer distributions look for it there, and warn of a type that has none.
  const std::string hash = "typehash=" + std::string(ros2::type_hash(type)) + ";";
  dds_qset_userdata(out.get(), hash.data(), hash.size());
  return out;
}

int checked(int result, const std::string& what) {
  if (result < 0) throw SystemError(what, dds_strretcode(result));
  return result;
}

}  // namespace

std::string dds_topic(std::string_view topic) {
  const std::string_view plain = topic.starts_with('/') ? topic.substr(1) : topic;
  const bool fits = !plain.empty() && plain.back() != '/' && plain.find("//") == std::string_view::npos &&
                    std::isdigit(static_cast<unsigned char>(plain.front())) == 0 &&
                    std::all_of(plain.begin(), plain.end(),
                                [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '/'; });
  if (!fits)
    throw std::invalid_argument("topic: '" + std::string(topic) + "' is no name of ROS 2; expected one such as /scan");
  return "rt/" + std::string(plain);
}

std::string dds_type(std::string_view type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  return std::string(type.substr(0, first)) + "::msg::dds_::" + std::string(type.substr(last + 1)) + "_";
}

void RawWriter::write(const std::vector<std::uint8_t>& cdr) {
  const RawSample sample(cdr);
  dds_write(entity_, &sample);  // what a slow reader misses is no fault of ours
}

std::size_t RawWriter::readers() const {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(entity_, &status) == DDS_RETCODE_OK ? status.current_count : 0;
}

bool RawReader::take(std::vector<std::uint8_t>& cdr) {
  for (;;) {
    void* sample = &cdr;
    dds_sample_info_t info{};
    if (dds_take(entity_, &sample, &info, 1, 1) <= 0) return false;
    if (info.valid_data) return true;  // else a writer that went
  }
}

std::size_t RawReader::writers() const {
  dds_subscription_matched_status_t status{};
  return dds_get_subscription_matched_status(entity_, &status) == DDS_RETCODE_OK ? status.current_count : 0;
}

Participant::Participant(const Network& network) : name_("ROS 2 domain " + std::to_string(network.domain)) {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  const std::string configuration = cyclone_configuration(network, uri != nullptr ? uri : "");
  const auto id = static_cast<dds_domainid_t>(network.domain);
  domain_ = checked(dds_create_domain(id, configuration.c_str()), name_);
  participant_ = dds_create_participant(id, nullptr, nullptr);
  waitset_ = participant_ < 0 ? participant_ : dds_create_waitset(participant_);
  if (waitset_ < 0) {
    dds_delete(domain_);
    checked(waitset_, name_);
  }
}

Participant::~Participant() {
  dds_delete(domain_);
}

int Participant::topic_entity(std::string_view topic, std::string_view type) {
  ddsi_sertype* raw = new_raw_type(dds_type(type));
  return checked(dds_create_topic_sertype(participant_, dds_topic(topic).c_str(), &raw, nullptr, nullptr, nullptr),
                 name_ + ": topic " + std::string(topic));
}

RawWriter Participant::raw_writer(std::string_view topic, std::string_view type, const ros2::Qos& qos) {
  const int at = topic_entity(topic, type);
  return RawWriter(checked(dds_create_writer(participant_, at, dds_qos(qos, type).get(), nullptr), name_));
}

RawReader Participant::raw_reader(std::string_view topic, std::string_view type, const ros2::Qos& qos, bool own) {
  const int at = topic_entity(topic, type);
  const auto asked = dds_qos(qos, type);
  if (!own) dds_qset_ignorelocal(asked.get(), DDS_IGNORELOCAL_PARTICIPANT);
  const int reader = checked(dds_create_reader(participant_, at, asked.get(), nullptr), name_);
  const int condition = checked(dds_create_readcondition(reader, DDS_ANY_STATE), name_);
  checked(dds_waitset_attach(waitset_, condition, 0), name_);
  return RawReader(reader);
}

void Participant::close(const RawReader& reader) {
  dds_delete(reader.entity_);
}

void Participant::wait(double seconds) {
  dds_waitset_wait(waitset_, nullptr, 0, static_cast<dds_duration_t>(seconds * 1e9));
}

}  // namespace phasescan::dds
