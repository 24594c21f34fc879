// Source: ros_comm, rosbag bag format 2.0.
#include "io/rosbag1_log.hpp"

#include <array>
#include <map>

#include "io/decompress.hpp"
#include "io/ros_log.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::uint64_t kMostHeaderBytes = std::uint64_t{1} << 20;
constexpr std::uint64_t kMostMessageBytes = std::uint64_t{1} << 26;

enum Op : std::uint8_t { kMessage = 2, kFileHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

/// A record's header: named fields. The views point into the stream's buffer.
class Fields {
 public:
  explicit Fields(Bytes header) {
    ByteReader reader(header);
    while (reader.remaining() > 0) {
      const std::string_view field = reader.prefixed_text();
      const auto equals = field.find('=');
      if (equals == std::string_view::npos) throw DecodeError("a header field without a name");
      if (count_ < fields_.size()) fields_[count_++] = {field.substr(0, equals), field.substr(equals + 1)};
    }
  }
  std::string_view text(std::string_view name) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (fields_[i].first == name) return fields_[i].second;
    }
    return {};
  }
  template <class T>
  T number(std::string_view name) const {
    const std::string_view raw = text(name);
    if (raw.size() != sizeof(T)) throw DecodeError("no header field " + std::string(name));
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }

 private:
  std::array<std::pair<std::string_view, std::string_view>, 16> fields_;
  std::size_t count_ = 0;
};

class Rosbag1Container final : public ros::Container {
 public:
  /// `index_file`: where to look for the index; empty where it cannot be looked up.
  Rosbag1Container(std::string path, std::string index_file, ByteStream stream, ros::RosLogReader& log)
      : path_(std::move(path)), index_file_(std::move(index_file)), file_(std::move(stream)), log_(log) {}

  std::string format() const override { return "rosbag1"; }

  void add_facts(std::map<std::string, std::string>& out) const override {
    for (const auto& [name, count] : chunks_) out["chunks, " + name] = std::to_string(count);
  }

  bool read_more() override {
    if (ended_) return false;
    try {
      return chunk_ ? read_in_chunk() : read_record(file_, false);
    } catch (const DecodeError& error) {
      damaged(error.what());
      return leave_chunk();
    }
  }

 private:
  void damaged(const std::string& why) {
    const char* kind = chunk_ ? "bad chunk" : "bad record";
    log_.damage(kind, path_ + ": byte " + std::to_string(file_.position()), why);
  }

  bool read_in_chunk() {
    if (chunk_->at_end()) return leave_chunk();
    return read_record(*chunk_, true);
  }

  /// Goes to the end of the chunk in the file. false = the file ends there, too, or nothing can be trusted any more.
  bool leave_chunk() {
    if (!chunk_) {
      ended_ = true;
      return false;
    }
    chunk_.reset();
    const std::uint64_t left = chunk_end_ - file_.position();
    if (file_.skip(left) == left) return true;
    if (!cut_reported_) damaged("the file ends inside a chunk");
    ended_ = true;
    return false;
  }

  /// Exactly n bytes; where they end early the damage is the file's, and named once.
  Bytes take_all(ByteStream& stream, std::uint64_t n) {
    const Bytes got = stream.take(n);
    if (got.size() < n) {
      cut_reported_ = true;
      throw DecodeError("the record ends after " + std::to_string(got.size()) + " of " + std::to_string(n) + " bytes");
    }
    return got;
  }

  std::uint32_t take_length(ByteStream& stream) { return ByteReader(take_all(stream, 4)).get<std::uint32_t>(); }

  bool read_record(ByteStream& stream, bool in_chunk) {
    if (stream.at_end()) {
      if (file_.position() < index_position_)
        damaged("the file ends before its index at byte " + std::to_string(index_position_));
      if (!has_file_header_) damaged("the file ends before its header");
      ended_ = true;
      return false;
    }
    const std::uint32_t header_bytes = take_length(stream);
    if (header_bytes > kMostHeaderBytes) {
      throw DecodeError("a record header of " + std::to_string(header_bytes) + " bytes");
    }
    const Bytes raw = take_all(stream, header_bytes);
    header_.assign(raw.begin(), raw.end());
    const Fields fields{Bytes(header_)};
    std::uint64_t data_bytes = take_length(stream);
    switch (fields.number<std::uint8_t>("op")) {
      case kMessage:
        read_message(stream, fields, data_bytes);
        return true;
      case kConnection:
        read_connection(fields, take_data(stream, data_bytes));
        return true;
      case kChunk:
        if (in_chunk) throw DecodeError("a chunk inside a chunk");
        enter_chunk(fields, data_bytes);
        return true;
      case kIndex:
        // Bags of 2010 state 20 bytes for each entry of 12.
        data_bytes = std::uint64_t{12} * fields.number<std::uint32_t>("count");
        break;
      case kFileHeader:
        has_file_header_ = true;
        index_position_ = fields.number<std::uint64_t>("index_pos");
        break;
      case kChunkInfo:
        break;
      default:
        throw DecodeError("a record of unknown kind " + std::to_string(fields.number<std::uint8_t>("op")));
    }
    if (stream.skip(data_bytes) < data_bytes) {
      cut_reported_ = true;
      throw DecodeError("the file ends inside a record");
    }
    return true;
  }

  Bytes take_data(ByteStream& stream, std::uint64_t data_bytes) {
    if (data_bytes > kMostMessageBytes) throw DecodeError("a record of " + std::to_string(data_bytes) + " bytes");
    return take_all(stream, data_bytes);
  }

  void read_connection(const Fields& fields, Bytes data) {
    const Fields about(data);
    const std::string type(about.text("type"));
    const std::string topic(fields.text("topic"));
    if (type.empty() || topic.empty()) throw DecodeError("a connection without topic or type");
    connections_[fields.number<std::uint32_t>("conn")] = log_.channel(topic, type, ros::Wire::kRos1);
  }

  /// A connection whose description was lost with its chunk may stand in the index at the end of the file, too.
  void ask_index() {
    index_asked_ = true;
    if (index_position_ == 0 || index_file_.empty()) return;
    ByteStream index(open_file_source(index_file_, index_position_));
    try {
      std::vector<std::uint8_t> header;
      while (!index.at_end()) {
        const Bytes raw = index.take(std::min<std::uint64_t>(take_u32(index), kMostHeaderBytes));
        header.assign(raw.begin(), raw.end());
        const Fields fields{Bytes(header)};
        const Bytes data = index.take(std::min<std::uint64_t>(take_u32(index), kMostMessageBytes));
        if (fields.number<std::uint8_t>("op") != kConnection) return;
        if (!connections_.contains(fields.number<std::uint32_t>("conn"))) read_connection(fields, data);
      }
    } catch (const DecodeError&) {
      return;  // the index is a help, not a witness
    }
  }

  static std::uint32_t take_u32(ByteStream& stream) { return ByteReader(stream.take(4)).get<std::uint32_t>(); }

  void read_message(ByteStream& stream, const Fields& fields, std::uint64_t data_bytes) {
    const auto id = fields.number<std::uint32_t>("conn");
    const auto time = fields.number<std::uint64_t>("time");
    const Stamp log_time = static_cast<Stamp>(time & 0xFFFFFFFFU) * 1'000'000'000 + static_cast<Stamp>(time >> 32U);
    auto found = connections_.find(id);
    if (found == connections_.end() && !index_asked_) {
      ask_index();
      found = connections_.find(id);
    }
    if (found != connections_.end() && ros::RosLogReader::wanted(*found->second)) {
      log_.message(*found->second, log_time, take_data(stream, data_bytes));
      return;
    }
    if (stream.skip(data_bytes) < data_bytes) {
      cut_reported_ = true;
      throw DecodeError("the file ends inside a message");
    }
    if (found == connections_.end()) {
      log_.bad_message("connection " + std::to_string(id), "the connection was never described");
    } else {
      log_.message(*found->second, log_time, {});
    }
  }

  void enter_chunk(const Fields& fields, std::uint64_t data_bytes) {
    const std::string name(fields.text("compression"));
    static const std::map<std::string, Compression, std::less<>> kKnown{
        {"none", Compression::kNone}, {"bz2", Compression::kBzip2}, {"lz4", Compression::kLz4}};
    const auto known = kKnown.find(name);
    ++chunks_[name.substr(0, 16)];
    chunk_end_ = file_.position() + data_bytes;
    // A recorder that died leaves its last chunk with length 0: its records follow and are read as they come.
    if (data_bytes == 0) return;
    auto slice = std::make_unique<SliceSource>(file_, data_bytes);
    if (known == kKnown.end()) {
      chunk_ = std::make_unique<ByteStream>(std::move(slice));
      throw DecodeError("compression '" + name + "' is not known; expected none, bz2 or lz4");
    }
    chunk_ = std::make_unique<ByteStream>(decompress(known->second, std::move(slice)));
  }

  std::string path_, index_file_;
  ByteStream file_;
  ros::RosLogReader& log_;
  std::unique_ptr<ByteStream> chunk_;
  std::uint64_t chunk_end_ = 0;
  std::vector<std::uint8_t> header_;
  std::map<std::uint32_t, ros::Channel*> connections_;
  std::map<std::string, std::size_t> chunks_;
  std::uint64_t index_position_ = 0;
  bool has_file_header_ = false;
  bool index_asked_ = false;
  bool ended_ = false;
  bool cut_reported_ = false;
};

}  // namespace

bool looks_like_rosbag1(Bytes first) {
  const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  return text.starts_with("#ROSBAG V") || text.starts_with("#ROSRECORD V");
}

std::unique_ptr<LogReader> open_rosbag1(LogInput& input, const LogOptions& options) {
  const std::string& name = input.name();
  ByteStream stream = input.take();
  const Bytes first = stream.peek(32);
  const std::string_view magic(reinterpret_cast<const char*>(first.data()), first.size());
  if (!magic.starts_with(kMagic)) {
    const std::string named(magic.substr(1, magic.find_first_of("\n\r") - 1));
    throw InputError(name, 0,
                     "a bag of the format '" + named + "'; expected 'ROSBAG V2.0' (`rosbag fix` of ROS 1 converts it)");
  }
  stream.skip(kMagic.size());
  auto log = std::make_unique<ros::RosLogReader>(name, options);
  const std::string file = input.is_file() && !input.is_packed() ? input.path() : std::string();
  log->read_from(std::make_unique<Rosbag1Container>(name, file, std::move(stream), *log));
  return log;
}

}  // namespace phasescan
