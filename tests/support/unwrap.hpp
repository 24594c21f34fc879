/// Recordings taken apart by another hand than the readers': their messages, and where records begin.
#pragma once

#include <bzlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "support/ros_fixture.hpp"

namespace phasescan::test {

struct Unwrapped {
  std::vector<Message> messages;
  std::vector<std::size_t> ends;  ///< where in the file each message has ended: behind its record or its packed chunk
  std::vector<std::size_t> borders;  ///< where records begin

  /// How many scans lie within the first n bytes of the file.
  std::size_t scans_before(std::size_t n) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < messages.size() && ends[i] <= n; ++i)
      count += messages[i].type.ends_with("LaserScan") ? 1 : 0;
    return count;
  }
};

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
inline std::string prefixed_at(const std::string& bytes, std::size_t at) {
  return bytes.substr(at + 4, value_at<std::uint32_t>(bytes, at));
}

/// An MCAP with chunks that are not compressed, or without chunks.
class McapUnwrapper {
 public:
  static Unwrapped unwrap(const std::string& bytes) {
    McapUnwrapper self;
    self.walk(bytes, 8, bytes.size());
    return std::move(self.out_);
  }

 private:
  void walk(const std::string& bytes, std::size_t at, std::size_t end) {
    while (at + 9 <= end) {
      const int op = bytes[at];
      const std::size_t body = at + 9, next = body + value_at<std::uint64_t>(bytes, at + 1);
      out_.borders.push_back(at);
      if (op == 3) schemas_[value_at<std::uint16_t>(bytes, body)] = prefixed_at(bytes, body + 2);
      if (op == 4) {
        channels_[value_at<std::uint16_t>(bytes, body)] = {prefixed_at(bytes, body + 4),
                                                           schemas_[value_at<std::uint16_t>(bytes, body + 2)], 0, ""};
      }
      if (op == 5) {
        Message message = channels_[value_at<std::uint16_t>(bytes, body)];
        message.stamp = value_at<std::int64_t>(bytes, body + 6);
        message.data = bytes.substr(body + 22, next - body - 22);
        out_.messages.push_back(std::move(message));
        out_.ends.push_back(next);
      }
      if (op == 6) walk(bytes, body + 32 + 8, next);
      if (op == 15) return;
      at = next;
    }
  }

  Unwrapped out_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Message> channels_;
};

/// A rosbag 2.0 with chunks that are not compressed, or by bz2.
class BagUnwrapper {
 public:
  static Unwrapped unwrap(const std::string& bytes) {
    BagUnwrapper self;
    self.walk(bytes, 13, bytes.size(), true);
    return std::move(self.out_);
  }

 private:
  static std::map<std::string, std::string> fields(const std::string& raw) {
    std::map<std::string, std::string> out;
    for (std::size_t at = 0; at + 4 <= raw.size(); at += 4 + value_at<std::uint32_t>(raw, at)) {
      const std::string field = prefixed_at(raw, at);
      out[field.substr(0, field.find('='))] = field.substr(field.find('=') + 1);
    }
    return out;
  }

  void walk(const std::string& bytes, std::size_t at, std::size_t end, bool is_file) {
    while (at + 8 <= end) {
      if (is_file) out_.borders.push_back(at);
      const std::size_t header_end = at + 4 + value_at<std::uint32_t>(bytes, at), body = header_end + 4;
      auto header = fields(bytes.substr(at + 4, header_end - at - 4));
      std::size_t data = value_at<std::uint32_t>(bytes, header_end);
      switch (header["op"][0]) {
        case 2: {
          Message message = connections_[header["conn"]];
          message.stamp = std::int64_t{value_at<std::uint32_t>(header["time"], 0)} * 1'000'000'000 +
                          value_at<std::uint32_t>(header["time"], 4);
          message.data = bytes.substr(body, data);
          out_.messages.push_back(std::move(message));
          if (is_file) out_.ends.push_back(body + data);
          break;
        }
        case 4:  // bags of 2010 state 20 bytes for an entry of 12
          data = 12 * std::size_t{value_at<std::uint32_t>(header["count"], 0)};
          break;
        case 5: {
          std::string chunk = bytes.substr(body, data);
          if (header["compression"] == "bz2") {
            const std::string packed = chunk;
            auto size = value_at<std::uint32_t>(header["size"], 0);
            chunk.resize(size);
            BZ2_bzBuffToBuffDecompress(chunk.data(), &size, const_cast<char*>(packed.data()),
                                       static_cast<unsigned>(packed.size()), 0, 0);
          }
          walk(chunk, 0, chunk.size(), false);
          out_.ends.resize(out_.messages.size(), body + data);
          break;
        }
        case 7:
          connections_[header["conn"]] = {header["topic"], fields(bytes.substr(body, data))["type"], 0, ""};
          break;
        default:
          break;
      }
      at = body + data;
    }
  }

  Unwrapped out_;
  std::map<std::string, Message> connections_;
};

}  // namespace phasescan::test
