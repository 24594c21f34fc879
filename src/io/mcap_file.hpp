/// The container of an MCAP file as it is written: chunks, their indexes, and the summary.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes.hpp"
#include "io/growing_file.hpp"
#include "io/spilled_bytes.hpp"
#include "phasescan/core/time.hpp"
#include "io/file.hpp"

namespace phasescan {

/// Holds one chunk in memory. What the index at the end says of each chunk waits on the disk where the file grows for
/// hours, else in memory.
class McapFile {
 public:
  /// The file appears whole with `finish`, or not at all. @throws as AtomicFile.
  explicit McapFile(const std::string& path);
  /// The file is there from now on and can be read up to its last chunk at any moment: for what goes on for hours.
  explicit McapFile(GrowingFile file);

  /// A ROS 2 message as CDR. @param type  as "sensor_msgs/msg/LaserScan"; a topic keeps its first
  void add(const std::string& topic, const std::string& type, Stamp stamp, Bytes message);
  /// Writes what the chunk in memory holds. @throws SystemError, e.g. disk full
  void flush() { finish_chunk(); }
  void finish();
  /// Bytes in the file by now.
  std::uint64_t size() const { return position_; }

  struct Channel {
    std::uint16_t id = 0;
    std::uint16_t schema = 0;
    std::string topic;
    std::uint64_t messages = 0;
  };
  struct ChunkIndex {
    std::uint64_t start_time = 0, end_time = 0, offset = 0, length = 0;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> message_indexes;  ///< channel, offset
    std::uint64_t message_index_length = 0, packed_bytes = 0, unpacked_bytes = 0;
  };

 private:
  void begin();
  void write(const ByteWriter& bytes);
  Channel& channel(const std::string& topic, const std::string& type);
  void finish_chunk();
  void write_summary();
  void put_statistics(ByteWriter& out) const;
  std::vector<const Channel*> in_order() const;

  std::optional<AtomicFile> whole_;  ///< one of the two
  std::optional<GrowingFile> growing_;
  std::uint64_t position_ = 0;
  std::map<std::string, std::uint16_t> schemas_;
  std::map<std::string, Channel> channels_;
  ByteWriter chunk_;
  std::vector<std::uint8_t> packed_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::uint64_t chunk_start_ = 0, chunk_end_ = 0, chunk_messages_ = 0;
  SpilledBytes chunk_indexes_;  ///< records
  std::uint32_t chunks_ = 0;
  std::uint64_t start_ = 0, end_ = 0, count_ = 0;
};

}  // namespace phasescan
