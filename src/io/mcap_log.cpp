// Source: foxglove/mcap, specification of the format.
#include "io/mcap_log.hpp"

#include <zlib.h>

#include <map>

#include "io/decompress.hpp"
#include "io/mcap_records.hpp"
#include "io/ros_log.hpp"

namespace phasescan {
namespace {

constexpr std::uint64_t kMostRecordBytes = std::uint64_t{1} << 26;
constexpr std::size_t kMessageHeadBytes = 2 + 4 + 8 + 8;

using mcap::Op;

/// Counts the CRC of all that passes.
class CrcSource : public ByteSource {
 public:
  CrcSource(std::unique_ptr<ByteSource> source, std::uint32_t& crc) : source_(std::move(source)), crc_(crc) {}
  std::size_t read(std::uint8_t* out, std::size_t n) override {
    const std::size_t got = source_->read(out, n);
    crc_ = static_cast<std::uint32_t>(crc32_z(crc_, out, got));
    return got;
  }

 private:
  std::unique_ptr<ByteSource> source_;
  std::uint32_t& crc_;
};

class McapContainer final : public ros::Container {
 public:
  McapContainer(std::string path, ByteStream stream, ros::RosLogReader& log)
      : path_(std::move(path)), file_(std::move(stream)), log_(log) {
    file_.skip(mcap::kMagic.size());
  }

  std::string format() const override { return "mcap"; }

  void add_facts(std::map<std::string, std::string>& out) const override {
    if (!profile_.empty()) out["profile"] = profile_;
    for (const auto& [name, count] : chunks_) out["chunks, " + (name.empty() ? "none" : name)] = std::to_string(count);
  }

  bool read_more() override {
    if (ended_) return false;
    try {
      return chunk_ ? read_in_chunk() : read_record(file_, false);
    } catch (const DecodeError& error) {
      damaged(error.what());
      if (chunk_) return leave_chunk();
      ended_ = true;
      return false;
    }
  }

 private:
  void damaged(const std::string& why) {
    log_.damage(chunk_ ? "bad chunk" : "bad record", path_ + ": byte " + std::to_string(file_.position()), why);
  }

  bool read_in_chunk() {
    if (!chunk_->at_end()) return read_record(*chunk_, true);
    if (stated_crc_ != 0 && stated_crc_ != crc_) {
      damaged("the chunk's checksum does not fit: what was read from it may be wrong");
    } else if (chunk_->position() != stated_bytes_ && file_.position() == chunk_end_) {
      damaged("the chunk holds " + std::to_string(chunk_->position()) + " bytes and states " +
              std::to_string(stated_bytes_));
    }
    return leave_chunk();
  }

  bool leave_chunk() {
    chunk_.reset();
    const std::uint64_t left = chunk_end_ - file_.position();
    if (file_.skip(left) == left) return true;
    if (!cut_reported_) damaged("the file ends inside a chunk");
    ended_ = true;
    return false;
  }

  /// Exactly n bytes. Where they end early the damage is named here and the rest of the file is lost.
  Bytes take_all(ByteStream& stream, std::uint64_t n) {
    if (n > kMostRecordBytes) throw DecodeError("a record of " + std::to_string(n) + " bytes");
    const Bytes got = stream.take(n);
    if (got.size() < n) {
      cut_reported_ = true;
      throw DecodeError("the record ends after " + std::to_string(got.size()) + " of " + std::to_string(n) + " bytes");
    }
    return got;
  }

  bool read_record(ByteStream& stream, bool in_chunk) {
    if (stream.at_end()) {
      damaged("the file ends without its end record");
      ended_ = true;
      return false;
    }
    ByteReader head(take_all(stream, 9));
    const auto op = static_cast<Op>(head.get<std::uint8_t>());
    const auto length = head.get<std::uint64_t>();
    switch (op) {
      case Op::kMessage:
        read_message(stream, length);
        return true;
      case Op::kSchema:
        read_schema(ByteReader(take_all(stream, length)));
        return true;
      case Op::kChannel:
        read_channel(ByteReader(take_all(stream, length)));
        return true;
      case Op::kHeader:
        profile_ = ByteReader(take_all(stream, length)).prefixed_text().substr(0, 64);
        return true;
      case Op::kChunk:
        if (in_chunk) throw DecodeError("a chunk inside a chunk");
        enter_chunk(length);
        return true;
      case Op::kDataEnd:
      case Op::kFooter:
        if (in_chunk) throw DecodeError("an end record inside a chunk");
        ended_ = true;  // what follows are summaries and indexes
        return false;
      case Op::kInvalid:
        throw DecodeError("a record of kind 0");
      default:
        break;
    }
    if (stream.skip(length) < length) {
      cut_reported_ = true;
      throw DecodeError("the file ends inside a record");
    }
    return true;
  }

  void read_schema(ByteReader record) {
    const auto id = record.get<std::uint16_t>();
    schemas_[id] = record.prefixed_text();
  }

  void read_channel(ByteReader record) {
    const auto id = record.get<std::uint16_t>();
    const auto schema = schemas_.find(record.get<std::uint16_t>());
    const std::string topic(record.prefixed_text());
    const std::string_view encoding = record.prefixed_text();
    const std::string type = schema == schemas_.end() ? std::string("no type") : schema->second;
    const ros::Wire wire = wire_of(encoding);
    // ROS messages are read as ROS writes them, Foxglove's as Foxglove does; the others are topics that nobody can
    // read.
    const bool is_ros = wire == ros::Wire::kCdr || wire == ros::Wire::kRos1;
    const bool is_foxglove = wire == ros::Wire::kJson || wire == ros::Wire::kProtobuf;
    const bool readable = type.starts_with("foxglove.") ? is_foxglove : is_ros;
    channels_[id] = log_.channel(topic, readable ? type : type + " as " + std::string(encoding), wire);
  }

  static ros::Wire wire_of(std::string_view encoding) {
    if (encoding == "cdr") return ros::Wire::kCdr;
    if (encoding == "ros1") return ros::Wire::kRos1;
    if (encoding == "json") return ros::Wire::kJson;
    return encoding == "protobuf" ? ros::Wire::kProtobuf : ros::Wire::kUnknown;
  }

  void read_message(ByteStream& stream, std::uint64_t length) {
    if (length < kMessageHeadBytes) throw DecodeError("a message of " + std::to_string(length) + " bytes");
    const Bytes head = stream.peek(kMessageHeadBytes);
    if (head.size() < kMessageHeadBytes) take_all(stream, length);
    ByteReader reader(head);
    const auto found = channels_.find(reader.get<std::uint16_t>());
    reader.get<std::uint32_t>();
    const auto log_time = static_cast<Stamp>(reader.get<std::uint64_t>());
    if (found != channels_.end() && ros::RosLogReader::wanted(*found->second)) {
      log_.maybe_packed_message(*found->second, log_time, take_all(stream, length).subspan(kMessageHeadBytes));
      return;
    }
    if (stream.skip(length) < length) {
      cut_reported_ = true;
      throw DecodeError("the file ends inside a message");
    }
    if (found == channels_.end()) {
      log_.bad_message("a channel", "the channel was never described");
    } else {
      log_.message(*found->second, log_time, {});
    }
  }

  void enter_chunk(std::uint64_t length) {
    const std::uint64_t begin = file_.position();
    const Bytes fixed = file_.peek(8 + 8 + 8 + 4 + 4);
    ByteReader sizes(fixed);
    sizes.bytes(16);
    stated_bytes_ = sizes.get<std::uint64_t>();
    stated_crc_ = sizes.get<std::uint32_t>();
    const auto name_bytes = sizes.get<std::uint32_t>();
    const std::uint64_t head_bytes = fixed.size() + std::uint64_t{name_bytes} + 8;
    if (head_bytes > length || name_bytes > 64) throw DecodeError("a chunk header that does not fit its record");
    ByteReader head(take_all(file_, head_bytes));
    head.bytes(fixed.size());
    const std::string name(head.text(name_bytes));
    const auto packed_bytes = head.get<std::uint64_t>();
    if (packed_bytes > length - head_bytes) throw DecodeError("a chunk whose records do not fit its record");
    chunk_end_ = begin + length;
    ++chunks_[name];
    static const std::map<std::string, Compression> kKnown{
        {"", Compression::kNone}, {"lz4", Compression::kLz4}, {"zstd", Compression::kZstd}};
    const auto known = kKnown.find(name);
    auto slice = std::make_unique<SliceSource>(file_, packed_bytes);
    if (known == kKnown.end()) {
      chunk_ = std::make_unique<ByteStream>(std::move(slice));
      throw DecodeError("compression '" + name + "' is not known; expected none, lz4 or zstd");
    }
    crc_ = 0;
    auto unpacked = decompress(known->second, std::move(slice));
    if (stated_crc_ != 0) unpacked = std::make_unique<CrcSource>(std::move(unpacked), crc_);
    chunk_ = std::make_unique<ByteStream>(std::move(unpacked));
  }

  std::string path_;
  ByteStream file_;
  ros::RosLogReader& log_;
  std::unique_ptr<ByteStream> chunk_;
  std::uint64_t chunk_end_ = 0;
  std::uint64_t stated_bytes_ = 0;
  std::uint32_t stated_crc_ = 0;
  std::uint32_t crc_ = 0;
  std::string profile_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, ros::Channel*> channels_;
  std::map<std::string, std::size_t> chunks_;
  bool ended_ = false;
  bool cut_reported_ = false;
};

}  // namespace

bool looks_like_mcap(Bytes first) {
  return std::string_view(reinterpret_cast<const char*>(first.data()), first.size()).starts_with(mcap::kMagic);
}

std::unique_ptr<ros::Container> mcap_container(const std::string& path, ByteStream stream, ros::RosLogReader& log) {
  return std::make_unique<McapContainer>(path, std::move(stream), log);
}

std::unique_ptr<LogReader> open_mcap(const std::string& path, ByteStream stream, const LogOptions& options) {
  auto log = std::make_unique<ros::RosLogReader>(path, options);
  log->read_from(mcap_container(path, std::move(stream), *log));
  return log;
}

}  // namespace phasescan
