/// ROS recordings made by hand, byte for byte, so that the readers are judged by another hand than the writers'.
#pragma once

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace phasescan::test {

/// A buffer with the primitives of both wire forms.
struct Wire {
  std::string bytes;
  bool ros1 = false;

  template <class T>
  void put(T value) {
    if (!ros1) {
      while ((bytes.size() - 4) % sizeof(T) != 0) bytes += '\0';
    }
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + (ros1 ? 0 : 1)));
    bytes += value;
    if (!ros1) bytes += '\0';
  }
  void header(std::int64_t stamp_ns, const std::string& frame) {
    if (ros1) put(std::uint32_t{7});
    put(static_cast<std::int32_t>(stamp_ns / 1'000'000'000));
    put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    text(frame);
  }
  static Wire make(bool ros1) {
    Wire wire;
    wire.ros1 = ros1;
    if (!ros1) wire.bytes.assign("\0\1\0\0", 4);
    return wire;
  }
};

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};

inline std::string laser_scan(bool ros1, std::int64_t stamp, const std::vector<float>& ranges,
                              const std::string& frame = "laser", float range_max = 12.0F,
                              float time_increment = 0.0F) {
  Wire wire = Wire::make(ros1);
  wire.header(stamp, frame);
  for (const float value :
       {-1.5F, 1.5F, 3.0F / static_cast<float>(ranges.size() - 1), time_increment, 0.1F, 0.1F, range_max}) {
    wire.put(value);
  }
  wire.put(static_cast<std::uint32_t>(ranges.size()));
  for (const float value : ranges) wire.put(value);
  wire.put(std::uint32_t{0});
  return wire.bytes;
}

inline void put_pose(Wire& wire, double x, double y, Quaternion q) {
  for (const double value : {x, y, 0.0, q.x, q.y, q.z, q.w}) wire.put(value);
}

inline std::string odometry(bool ros1, std::int64_t stamp, double x, double y, double theta,
                            const std::string& child = "base_link") {
  Wire wire = Wire::make(ros1);
  wire.header(stamp, "odom");
  wire.text(child);
  put_pose(wire, x, y, {0, 0, std::sin(theta / 2), std::cos(theta / 2)});
  for (int i = 0; i < 36 + 6 + 36; ++i) wire.put(0.0);
  return wire.bytes;
}

struct TransformFixture {
  std::int64_t stamp = 0;
  std::string parent, child;
  double x = 0, y = 0;
  Quaternion q;
};

inline std::string transforms(bool ros1, const std::vector<TransformFixture>& all) {
  Wire wire = Wire::make(ros1);
  wire.put(static_cast<std::uint32_t>(all.size()));
  for (const auto& t : all) {
    wire.header(t.stamp, t.parent);
    wire.text(t.child);
    put_pose(wire, t.x, t.y, t.q);
  }
  return wire.bytes;
}

/// A message with where it belongs.
struct Message {
  std::string topic, type;
  std::int64_t stamp = 0;
  std::string data;
};

inline std::string u32(std::size_t value) {
  const auto raw = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&raw), 4};
}
inline std::string u64(std::uint64_t value) {
  return {reinterpret_cast<const char*>(&value), 8};
}
inline std::string u16(std::size_t value) {
  const auto raw = static_cast<std::uint16_t>(value);
  return {reinterpret_cast<const char*>(&raw), 2};
}
inline std::string prefixed(const std::string& text) {
  return u32(text.size()) + text;
}

inline std::string pack_bz2(const std::string& in) {
  std::string out(in.size() + in.size() / 50 + 1000, '\0');
  auto size = static_cast<unsigned>(out.size());
  BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(in.data()), static_cast<unsigned>(in.size()), 9, 0, 0);
  out.resize(size);
  return out;
}
inline std::string pack_lz4(const std::string& in) {
  std::string out(LZ4F_compressFrameBound(in.size(), nullptr), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), in.data(), in.size(), nullptr));
  return out;
}
inline std::string pack_zstd(const std::string& in) {
  std::string out(ZSTD_compressBound(in.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), in.data(), in.size(), 3));
  return out;
}

// --- rosbag1 ---------------------------------------------------------------------------------------------------------

inline std::string bag_record(const std::map<std::string, std::string>& fields, const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += prefixed(name + "=" + value);
  return prefixed(header) + prefixed(data);
}

struct BagStyle {
  std::string compression = "none";
  bool indexed = true;
  bool index_of_2010 = false;  ///< states 20 bytes an index entry
  std::size_t messages_a_chunk = 4;
};

/// A bag 2.0; record borders of the file are put into `borders` where it is not null.
inline std::string rosbag1(const std::vector<Message>& messages, const BagStyle& style = {},
                           std::vector<std::size_t>* borders = nullptr) {
  std::string bag = "#ROSBAG V2.0\n";
  const auto mark = [&] {
    if (borders != nullptr) borders->push_back(bag.size());
  };
  mark();
  bag += bag_record({{"op", "\3"}, {"index_pos", u64(0)}, {"conn_count", u32(0)}, {"chunk_count", u32(0)}},
                    std::string(3000, ' '));
  std::map<std::string, std::uint32_t> ids;
  std::string connections;
  for (std::size_t begin = 0; begin < messages.size(); begin += style.messages_a_chunk) {
    std::string chunk;
    std::map<std::uint32_t, std::string> index;
    for (std::size_t i = begin; i < std::min(messages.size(), begin + style.messages_a_chunk); ++i) {
      const Message& message = messages[i];
      const auto [id, is_new] = ids.emplace(message.topic, static_cast<std::uint32_t>(ids.size()));
      const std::string time = u32(static_cast<std::size_t>(message.stamp / 1'000'000'000)) +
                               u32(static_cast<std::size_t>(message.stamp % 1'000'000'000));
      if (is_new) {
        const std::string about =
            prefixed("topic=" + message.topic) + prefixed("type=" + message.type) + prefixed("md5sum=*");
        const std::string record =
            bag_record({{"op", "\7"}, {"conn", u32(id->second)}, {"topic", message.topic}}, about);
        chunk += record;
        connections += record;
      }
      index[id->second] += time + u32(chunk.size());
      chunk += bag_record({{"op", "\2"}, {"conn", u32(id->second)}, {"time", time}}, message.data);
    }
    const std::string packed = style.compression == "bz2"   ? pack_bz2(chunk)
                               : style.compression == "lz4" ? pack_lz4(chunk)
                                                            : chunk;
    mark();
    bag += bag_record({{"op", "\5"}, {"compression", style.compression}, {"size", u32(chunk.size())}}, packed);
    for (const auto& [id, entries] : index) {
      if (!style.indexed) continue;
      mark();
      const std::string count = u32(entries.size() / 12);
      std::string record = bag_record({{"op", "\4"}, {"ver", u32(1)}, {"conn", u32(id)}, {"count", count}}, entries);
      if (style.index_of_2010) record.replace(record.size() - entries.size() - 4, 4, u32(entries.size() / 12 * 20));
      bag += record;
    }
  }
  mark();
  if (style.indexed) bag.replace(bag.find("index_pos=") + 10, 8, u64(bag.size()));
  if (style.indexed) bag += connections + bag_record({{"op", "\6"}, {"ver", u32(1)}, {"count", u32(0)}}, "");
  return bag;
}

// --- MCAP ------------------------------------------------------------------------------------------------------------

inline std::string mcap_record(int op, const std::string& body) {
  return std::string(1, static_cast<char>(op)) + u64(body.size()) + body;
}

struct McapStyle {
  std::string compression;  ///< "", lz4, zstd
  bool chunked = true;
  bool end_records = true;
  std::uint32_t crc = 0;             ///< stated for every chunk; 0 = unchecked
  bool message_compression = false;  ///< each message a zstd frame, as rosbag2 does
  std::string encoding = "cdr";
  std::size_t messages_a_chunk = 4;
};

inline std::string mcap(const std::vector<Message>& messages, const McapStyle& style = {},
                        std::vector<std::size_t>* borders = nullptr) {
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string file = magic + mcap_record(1, prefixed("ros2") + prefixed("fixture"));
  const auto mark = [&] {
    if (borders != nullptr) borders->push_back(file.size());
  };
  std::map<std::string, std::size_t> ids;
  for (std::size_t begin = 0; begin < messages.size(); begin += style.messages_a_chunk) {
    std::string chunk;
    for (std::size_t i = begin; i < std::min(messages.size(), begin + style.messages_a_chunk); ++i) {
      const Message& message = messages[i];
      const auto [id, is_new] = ids.emplace(message.topic, ids.size() + 1);
      if (is_new) {
        chunk += mcap_record(3, u16(id->second) + prefixed(message.type) + prefixed("ros2msg") + prefixed("# text"));
        chunk += mcap_record(
            4, u16(id->second) + u16(id->second) + prefixed(message.topic) + prefixed(style.encoding) + u32(0));
      }
      const std::string data = style.message_compression ? pack_zstd(message.data) : message.data;
      chunk += mcap_record(5, u16(id->second) + u32(i) + u64(static_cast<std::uint64_t>(message.stamp)) +
                                  u64(static_cast<std::uint64_t>(message.stamp)) + data);
    }
    mark();
    if (!style.chunked) {
      file += chunk;
      continue;
    }
    const std::string packed = style.compression == "lz4"    ? pack_lz4(chunk)
                               : style.compression == "zstd" ? pack_zstd(chunk)
                                                             : chunk;
    file += mcap_record(6, u64(0) + u64(0) + u64(chunk.size()) + u32(style.crc) + prefixed(style.compression) +
                               u64(packed.size()) + packed);
  }
  mark();
  if (style.end_records) file += mcap_record(0x0F, u32(0)) + mcap_record(2, u64(0) + u64(0) + u32(0)) + magic;
  return file;
}

// --- rosbag2 sqlite --------------------------------------------------------------------------------------------------

inline void run_sql(sqlite3* db, const std::string& sql) {
  char* error = nullptr;
  if (sqlite3_exec(db, sql.c_str(), nullptr, nullptr, &error) != SQLITE_OK) throw std::runtime_error(error);
}

inline void rosbag2_sqlite(const std::string& path, const std::vector<Message>& messages,
                           bool message_compression = false, int page_size = 4096) {
  std::remove(path.c_str());
  sqlite3* db = nullptr;
  if (sqlite3_open(path.c_str(), &db) != SQLITE_OK) throw std::runtime_error("cannot make " + path);
  run_sql(db, "PRAGMA page_size=" + std::to_string(page_size));
  run_sql(
      db,
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN");
  std::map<std::string, std::size_t> ids;
  for (const Message& message : messages) {
    const auto [id, is_new] = ids.emplace(message.topic, ids.size() + 1);
    if (is_new) {
      run_sql(db, "INSERT INTO topics VALUES(" + std::to_string(id->second) + ",'" + message.topic + "','" +
                      message.type + "','cdr','')");
    }
    const std::string data = message_compression ? pack_zstd(message.data) : message.data;
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)", -1, &insert, nullptr);
    sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(id->second));
    sqlite3_bind_int64(insert, 2, message.stamp);
    sqlite3_bind_blob(insert, 3, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    if (sqlite3_step(insert) != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(db));
    sqlite3_finalize(insert);
  }
  run_sql(db, "COMMIT");
  sqlite3_close(db);
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::remove(path.c_str());  // truncating a file in place makes the kernel write the old one out first
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}
inline std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace phasescan::test
