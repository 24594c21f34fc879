// Source: foxglove/mcap, specification of the format.
#include "io/mcap_file.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <filesystem>

#include "io/mcap_records.hpp"
#include "io/ros_encode.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr int kZstdLevel = 3;

using mcap::Op;

std::string_view as_text(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint32_t checksum(const std::vector<std::uint8_t>& bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

void put_schema(ByteWriter& out, const std::string& type, std::uint16_t id) {
  mcap::put_record(out, Op::kSchema, [&](ByteWriter& record) {
    record.put(id);
    record.prefixed_text(type);
    record.prefixed_text("ros2msg");
    record.prefixed_text(ros::message_definition(type));
  });
}

void put_channel(ByteWriter& out, const McapFile::Channel& channel) {
  mcap::put_record(out, Op::kChannel, [&](ByteWriter& record) {
    record.put(channel.id);
    record.put(channel.schema);
    record.prefixed_text(channel.topic);
    record.prefixed_text("cdr");
    record.put(std::uint32_t{0});  // no metadata
  });
}

void put_chunk_index(ByteWriter& out, const McapFile::ChunkIndex& chunk) {
  mcap::put_record(out, Op::kChunkIndex, [&](ByteWriter& record) {
    for (const std::uint64_t value : {chunk.start_time, chunk.end_time, chunk.offset, chunk.length}) record.put(value);
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

}  // namespace

McapFile::McapFile(const std::string& path) : whole_(path), chunk_indexes_("") {
  begin();
}

McapFile::McapFile(GrowingFile file) : growing_(std::move(file)), chunk_indexes_(folder_of(growing_->path())) {
  begin();
}

void McapFile::begin() {
  ByteWriter header;
  header.raw(mcap::kMagic);
  mcap::put_record(header, Op::kHeader, [](ByteWriter& record) {
    record.prefixed_text("ros2");
    record.prefixed_text("phasescan");
  });
  write(header);
}

void McapFile::write(const ByteWriter& bytes) {
  if (growing_) {
    growing_->write(as_text(bytes.bytes()));
  } else {
    whole_->write(as_text(bytes.bytes()));
  }
  position_ += bytes.size();
}

McapFile::Channel& McapFile::channel(const std::string& topic, const std::string& type) {
  const auto found = channels_.find(topic);
  if (found != channels_.end()) return found->second;
  auto schema = schemas_.find(type);
  if (schema == schemas_.end()) {
    schema = schemas_.emplace(type, static_cast<std::uint16_t>(schemas_.size() + 1)).first;
    put_schema(chunk_, schema->first, schema->second);
  }
  Channel made{static_cast<std::uint16_t>(channels_.size() + 1), schema->second, topic, 0};
  put_channel(chunk_, made);
  return channels_.emplace(topic, std::move(made)).first->second;
}

void McapFile::add(const std::string& topic, const std::string& type, Stamp stamp, Bytes message) {
  Channel& to = channel(topic, type);
  const auto time = static_cast<std::uint64_t>(std::max<Stamp>(stamp, 0));
  index_[to.id].emplace_back(time, chunk_.size());
  mcap::put_record(chunk_, Op::kMessage, [&](ByteWriter& record) {
    record.put(to.id);
    record.put(static_cast<std::uint32_t>(to.messages));
    record.put(time);
    record.put(time);
    record.raw(message);
  });
  chunk_start_ = chunk_messages_ == 0 ? time : std::min(chunk_start_, time);
  chunk_end_ = chunk_messages_ == 0 ? time : std::max(chunk_end_, time);
  ++chunk_messages_;
  ++to.messages;
  if (chunk_.size() >= kChunkBytes) finish_chunk();
}

void McapFile::finish_chunk() {
  if (chunk_.size() == 0) return;
  packed_.resize(ZSTD_compressBound(chunk_.size()));
  const std::size_t made =
      ZSTD_compress(packed_.data(), packed_.size(), chunk_.bytes().data(), chunk_.size(), kZstdLevel);
  if (ZSTD_isError(made)) throw SystemError("zstd", ZSTD_getErrorName(made));
  ChunkIndex entry;
  entry.start_time = chunk_start_;
  entry.end_time = chunk_end_;
  entry.offset = position_;
  entry.packed_bytes = made;
  entry.unpacked_bytes = chunk_.size();
  ByteWriter out;
  mcap::put_record(out, Op::kChunk, [&](ByteWriter& record) {
    record.put(chunk_start_);
    record.put(chunk_end_);
    record.put(std::uint64_t{chunk_.size()});
    record.put(checksum(chunk_.bytes()));
    record.prefixed_text("zstd");
    record.put(std::uint64_t{made});
    record.raw(Bytes(packed_.data(), made));
  });
  entry.length = out.size();
  entry.message_indexes.reserve(index_.size());
  for (const auto& [id, messages] : index_) {
    entry.message_indexes.emplace_back(id, position_ + out.size());
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
  ByteWriter record;
  put_chunk_index(record, entry);
  chunk_indexes_.add(record.bytes());
  ++chunks_;
  chunk_.clear();
  index_.clear();
  start_ = count_ == 0 ? chunk_start_ : std::min(start_, chunk_start_);
  end_ = count_ == 0 ? chunk_end_ : std::max(end_, chunk_end_);
  count_ += chunk_messages_;
  chunk_messages_ = 0;
}

void McapFile::put_statistics(ByteWriter& out) const {
  mcap::put_record(out, Op::kStatistics, [&](ByteWriter& record) {
    record.put(count_);
    record.put(static_cast<std::uint16_t>(schemas_.size()));
    record.put(static_cast<std::uint32_t>(channels_.size()));
    record.put(std::uint32_t{0});  // attachments
    record.put(std::uint32_t{0});  // metadata
    record.put(chunks_);
    record.put(start_);
    record.put(end_);
    record.put(static_cast<std::uint32_t>(channels_.size() * 10));
    for (const Channel* channel : in_order()) {
      record.put(channel->id);
      record.put(channel->messages);
    }
  });
}

std::vector<const McapFile::Channel*> McapFile::in_order() const {
  std::vector<const Channel*> out;
  for (const auto& [topic, channel] : channels_) out.push_back(&channel);
  std::sort(out.begin(), out.end(), [](const Channel* a, const Channel* b) { return a->id < b->id; });
  return out;
}

/// The checksum covers the summary and the footer up to itself.
void McapFile::write_summary() {
  ByteWriter offsets;
  const std::uint64_t begin = position_;
  uLong sum = crc32_z(0, nullptr, 0);
  const auto put = [&](const ByteWriter& bytes) {
    sum = crc32_z(sum, bytes.bytes().data(), bytes.size());
    write(bytes);
  };
  const auto group = [&](Op op, const auto& put_all) {
    const std::uint64_t before = position_;
    put_all();
    if (position_ == before) return;
    mcap::put_record(offsets, Op::kSummaryOffset, [&](ByteWriter& record) {
      record.put(static_cast<std::uint8_t>(op));
      record.put(before);
      record.put(position_ - before);
    });
  };
  const auto put_made = [&](const auto& make) {
    ByteWriter out;
    make(out);
    put(out);
  };
  group(Op::kSchema, [&] {
    for (const auto& [type, id] : schemas_)
      put_made([&, &type = type, &id = id](ByteWriter& out) { put_schema(out, type, id); });
  });
  group(Op::kChannel, [&] {
    for (const Channel* channel : in_order()) put_made([&](ByteWriter& out) { put_channel(out, *channel); });
  });
  group(Op::kStatistics, [&] { put_made([&](ByteWriter& out) { put_statistics(out); }); });
  group(Op::kChunkIndex,
        [&] { chunk_indexes_.read([&](Bytes piece) { put_made([&](ByteWriter& out) { out.raw(piece); }); }); });
  const std::uint64_t offsets_start = position_;
  put(offsets);
  ByteWriter footer;
  footer.put(static_cast<std::uint8_t>(Op::kFooter));
  footer.put(std::uint64_t{8 + 8 + 4});
  footer.put(begin);
  footer.put(offsets_start);
  sum = crc32_z(sum, footer.bytes().data(), footer.size());
  footer.put(static_cast<std::uint32_t>(sum));
  footer.raw(mcap::kMagic);
  write(footer);
}

void McapFile::finish() {
  finish_chunk();
  ByteWriter data_end;
  mcap::put_record(data_end, Op::kDataEnd, [](ByteWriter& record) { record.put(std::uint32_t{0}); });
  write(data_end);
  write_summary();
  if (growing_) {
    growing_->close();
  } else {
    whole_->commit();
  }
}

}  // namespace phasescan
