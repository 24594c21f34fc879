// A participant of Fast DDS, its writers and what its readers hear.
#pragma once

#include <chrono>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <string>
#include <vector>

#include "dds/fast_peer/cdr_messages.hpp"

namespace fast_peer {

namespace fdds = eprosima::fastdds::dds;

class Peer {
 public:
  /// @param address  of the interface that is used, alone
  Peer(int domain, const std::string& address);
  ~Peer();
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  fdds::DataWriter* writer(const std::string& topic, const std::string& type, bool reliable, bool keeps);
  void listen(const std::string& name, const std::string& topic, const std::string& type, bool reliable, bool keeps,
              Read read);
  /// The topics that phasescan publishes.
  void listen_to_all();
  void said(std::int64_t stamp) { said_[stamp] = std::chrono::steady_clock::now(); }
  /// Prints what has come from others, a line for each message.
  void print();

 private:
  struct Heard {
    std::string name;
    fdds::DataReader* reader;
    Read read;
  };
  fdds::Topic* topic_of(const std::string& topic, const std::string& type);
  void add_latency(json& line) const;

  fdds::DomainParticipant* participant_;
  fdds::Publisher* publisher_;
  fdds::Subscriber* subscriber_;
  std::map<std::string, fdds::Topic*> topics_;
  std::vector<Heard> heard_;
  std::map<std::int64_t, std::chrono::steady_clock::time_point> said_;
};

}  // namespace fast_peer
