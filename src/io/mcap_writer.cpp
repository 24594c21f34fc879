// Source: foxglove/mcap, specification of the format.
#include "phasescan/io/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "io/mcap_records.hpp"
#include "io/ros_encode.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/file.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr int kZstdLevel = 3;

using mcap::Op;

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string topic;
  std::uint64_t messages = 0;
};

struct ChunkIndex {
  std::uint64_t start_time = 0, end_time = 0, offset = 0, length = 0;
  std::map<std::uint16_t, std::uint64_t> message_indexes;
  std::uint64_t message_index_length = 0, packed_bytes = 0, unpacked_bytes = 0;
};

std::string_view as_text(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint32_t checksum(const std::vector<std::uint8_t>& bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

}  // namespace

struct McapWriter::Impl {
  explicit Impl(const std::string& path) : file(path) {
    ByteWriter header;
    header.raw(mcap::kMagic);
    mcap::put_record(header, Op::kHeader, [](ByteWriter& out) {
      out.prefixed_text("ros2");
      out.prefixed_text("phasescan");
    });
    write(header);
  }

  void write(const ByteWriter& bytes) {
    file.write(as_text(bytes.bytes()));
    position += bytes.size();
  }

  Channel& channel(const std::string& topic, const std::string& type) {
    const auto found = channels.find(topic);
    if (found != channels.end()) return found->second;
    auto schema = schemas.find(type);
    if (schema == schemas.end()) {
      schema = schemas.emplace(type, static_cast<std::uint16_t>(schemas.size() + 1)).first;
      put_schema(chunk, schema->first, schema->second);
    }
    Channel made{static_cast<std::uint16_t>(channels.size() + 1), schema->second, topic, 0};
    put_channel(chunk, made);
    return channels.emplace(topic, std::move(made)).first->second;
  }

  static void put_schema(ByteWriter& out, const std::string& type, std::uint16_t id) {
    mcap::put_record(out, Op::kSchema, [&](ByteWriter& record) {
      record.put(id);
      record.prefixed_text(type);
      record.prefixed_text("ros2msg");
      record.prefixed_text(ros::message_definition(type));
    });
  }

  static void put_channel(ByteWriter& out, const Channel& channel) {
    mcap::put_record(out, Op::kChannel, [&](ByteWriter& record) {
      record.put(channel.id);
      record.put(channel.schema);
      record.prefixed_text(channel.topic);
      record.prefixed_text("cdr");
      record.put(std::uint32_t{0});  // no metadata
    });
  }

  template <class Message>
  void add(const std::string& topic, const std::string& type, Stamp stamp, const Message& message) {
    body.clear();
    ros::encode(message, body);
    Channel& to = channel(topic, type);
    const auto time = static_cast<std::uint64_t>(std::max<Stamp>(stamp, 0));
    index[to.id].emplace_back(time, chunk.size());
    mcap::put_record(chunk, Op::kMessage, [&](ByteWriter& record) {
      record.put(to.id);
      record.put(static_cast<std::uint32_t>(to.messages));
      record.put(time);
      record.put(time);
      record.raw(Bytes(body.bytes()));
    });
    chunk_start = chunk_messages == 0 ? time : std::min(chunk_start, time);
    chunk_end = chunk_messages == 0 ? time : std::max(chunk_end, time);
    ++chunk_messages;
    ++to.messages;
    if (chunk.size() >= kChunkBytes) finish_chunk();
  }

  void finish_chunk() {
    if (chunk.size() == 0) return;
    packed.resize(ZSTD_compressBound(chunk.size()));
    const std::size_t made =
        ZSTD_compress(packed.data(), packed.size(), chunk.bytes().data(), chunk.size(), kZstdLevel);
    if (ZSTD_isError(made)) throw SystemError("zstd", ZSTD_getErrorName(made));
    ChunkIndex entry;
    entry.start_time = chunk_start;
    entry.end_time = chunk_end;
    entry.offset = position;
    entry.packed_bytes = made;
    entry.unpacked_bytes = chunk.size();
    ByteWriter out;
    mcap::put_record(out, Op::kChunk, [&](ByteWriter& record) {
      record.put(chunk_start);
      record.put(chunk_end);
      record.put(std::uint64_t{chunk.size()});
      record.put(checksum(chunk.bytes()));
      record.prefixed_text("zstd");
      record.put(std::uint64_t{made});
      record.raw(Bytes(packed.data(), made));
    });
    entry.length = out.size();
    for (const auto& [id, messages] : index) {
      entry.message_indexes[id] = position + out.size();
      mcap::put_record(out, Op::kMessageIndex, [&, &id = id, &messages = messages](ByteWriter& record) {
        record.put(id);
        record.put(static_cast<std::uint32_t>(messages.size() * 16));
        for (const auto& [time, offset] : messages) {
          record.put(time);
          record.put(offset);
        }
      });
    }
    entry.message_index_length = out.size() - entry.length;
    write(out);
    chunks.push_back(std::move(entry));
    chunk.clear();
    index.clear();
    start = count == 0 ? chunk_start : std::min(start, chunk_start);
    end = count == 0 ? chunk_end : std::max(end, chunk_end);
    count += chunk_messages;
    chunk_messages = 0;
  }

  void put_statistics(ByteWriter& out) const {
    mcap::put_record(out, Op::kStatistics, [&](ByteWriter& record) {
      record.put(count);
      record.put(static_cast<std::uint16_t>(schemas.size()));
      record.put(static_cast<std::uint32_t>(channels.size()));
      record.put(std::uint32_t{0});  // attachments
      record.put(std::uint32_t{0});  // metadata
      record.put(static_cast<std::uint32_t>(chunks.size()));
      record.put(start);
      record.put(end);
      record.put(static_cast<std::uint32_t>(channels.size() * 10));
      for (const Channel* channel : in_order()) {
        record.put(channel->id);
        record.put(channel->messages);
      }
    });
  }

  static void put_chunk_index(ByteWriter& out, const ChunkIndex& chunk) {
    mcap::put_record(out, Op::kChunkIndex, [&](ByteWriter& record) {
      for (const std::uint64_t value : {chunk.start_time, chunk.end_time, chunk.offset, chunk.length})
        record.put(value);
      record.put(static_cast<std::uint32_t>(chunk.message_indexes.size() * 10));
      for (const auto& [id, offset] : chunk.message_indexes) {
        record.put(id);
        record.put(offset);
      }
      record.put(chunk.message_index_length);
      record.prefixed_text("zstd");
      record.put(chunk.packed_bytes);
      record.put(chunk.unpacked_bytes);
    });
  }

  std::vector<const Channel*> in_order() const {
    std::vector<const Channel*> out;
    for (const auto& [topic, channel] : channels) out.push_back(&channel);
    std::sort(out.begin(), out.end(), [](const Channel* a, const Channel* b) { return a->id < b->id; });
    return out;
  }

  void finish() {
    finish_chunk();
    ByteWriter data_end;
    mcap::put_record(data_end, Op::kDataEnd, [](ByteWriter& record) { record.put(std::uint32_t{0}); });
    write(data_end);
    ByteWriter out;
    ByteWriter offsets;
    const auto group = [&](Op op, auto put_all) {
      const std::size_t before = out.size();
      put_all();
      if (out.size() == before) return;
      mcap::put_record(offsets, Op::kSummaryOffset, [&](ByteWriter& record) {
        record.put(static_cast<std::uint8_t>(op));
        record.put(position + before);
        record.put(std::uint64_t{out.size() - before});
      });
    };
    group(Op::kSchema, [&] {
      for (const auto& [type, id] : schemas) put_schema(out, type, id);
    });
    group(Op::kChannel, [&] {
      for (const Channel* channel : in_order()) put_channel(out, *channel);
    });
    group(Op::kStatistics, [&] { put_statistics(out); });
    group(Op::kChunkIndex, [&] {
      for (const ChunkIndex& entry : chunks) put_chunk_index(out, entry);
    });
    const std::uint64_t offsets_start = position + out.size();
    out.raw(Bytes(offsets.bytes()));
    // The checksum covers the summary and the footer up to itself.
    out.put(static_cast<std::uint8_t>(Op::kFooter));
    out.put(std::uint64_t{8 + 8 + 4});
    out.put(position);
    out.put(offsets_start);
    out.put(checksum(out.bytes()));
    out.raw(mcap::kMagic);
    write(out);
    file.commit();
  }

  AtomicFile file;
  std::uint64_t position = 0;
  std::map<std::string, std::uint16_t> schemas;
  std::map<std::string, Channel> channels;
  ByteWriter chunk;
  ByteWriter body;
  std::vector<std::uint8_t> packed;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index;
  std::uint64_t chunk_start = 0, chunk_end = 0, chunk_messages = 0;
  std::vector<ChunkIndex> chunks;
  std::uint64_t start = 0, end = 0, count = 0;
};

McapWriter::McapWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
McapWriter::~McapWriter() = default;
McapWriter::McapWriter(McapWriter&&) noexcept = default;
McapWriter& McapWriter::operator=(McapWriter&&) noexcept = default;

void McapWriter::scan(const std::string& topic, const std::string& frame, const Scan& scan, double scan_seconds) {
  impl_->add(topic, "sensor_msgs/msg/LaserScan", scan.stamp, ros::from_scan(scan, frame, scan_seconds));
}

void McapWriter::odometry(const std::string& topic, Stamp stamp, const std::string& frame, const std::string& child,
                          const Pose2& pose) {
  impl_->add(topic, "nav_msgs/msg/Odometry", stamp, ros::Odometry{{stamp, frame}, child, ros::spatial(pose)});
}

void McapWriter::transform(Stamp stamp, const std::string& frame, const std::string& child, const Pose2& pose,
                           bool flipped) {
  impl_->add("/tf", "tf2_msgs/msg/TFMessage", stamp,
             std::vector<ros::Transform>{{{stamp, frame}, child, ros::spatial(pose, flipped)}});
}

void McapWriter::static_transform(Stamp stamp, const std::string& frame, const std::string& child, const Pose2& pose,
                                  bool flipped) {
  impl_->add("/tf_static", "tf2_msgs/msg/TFMessage", stamp,
             std::vector<ros::Transform>{{{stamp, frame}, child, ros::spatial(pose, flipped)}});
}

void McapWriter::path(const std::string& topic, Stamp stamp, const std::string& frame,
                      std::span<const std::pair<Stamp, Pose2>> poses) {
  std::vector<ros::PathPoint> points;
  points.reserve(poses.size());
  for (const auto& [at, pose] : poses) points.push_back({at, pose});
  impl_->add(topic, "nav_msgs/msg/Path", stamp, ros::Path{{stamp, frame}, points});
}

void McapWriter::grid(const std::string& topic, Stamp stamp, const std::string& frame, const McapGrid& grid) {
  impl_->add(topic, "nav_msgs/msg/OccupancyGrid", stamp,
             ros::OccupancyGrid{{stamp, frame},
                                static_cast<float>(grid.resolution_m),
                                grid.width,
                                grid.height,
                                grid.T_map_origin,
                                grid.cells});
}

void McapWriter::close() {
  impl_->finish();
}

}  // namespace phasescan
