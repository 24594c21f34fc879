/// One sqlite file of a rosbag2 recording, row by row in the order of recording.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "io/bytes.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan {

/// By the magic number, or, where zeros stand in its place, by the pages behind the first one.
bool looks_like_sqlite(Bytes first);

/// A row of the messages table; `data` is valid until the next row.
struct BagRow {
  std::int64_t topic_id = 0;
  Stamp time = 0;
  Bytes data;
};

struct BagTopic {
  std::int64_t id = 0;
  std::string name;
  std::string type;
  std::string serialization;
};

/// Nothing in the file is executed: only plain tables are read, and what a row may hold is bounded by the file's size.
class SqliteBag {
 public:
  /// @throws DecodeError where the file holds no recording, or is damaged so far that sqlite cannot start.
  explicit SqliteBag(const std::string& path);
  ~SqliteBag();
  SqliteBag(const SqliteBag&) = delete;
  SqliteBag& operator=(const SqliteBag&) = delete;

  /// How far the file was cut off; empty where it is whole.
  const std::string& cut() const;
  /// What is wrong with the file's beginning; empty where nothing is.
  const std::string& head_damage() const;
  const std::vector<BagTopic>& topics() const;
  /// The next row, or nothing at the end. @throws DecodeError once, at the first damage; the next calls give what can
  /// be salvaged of the rows behind it.
  std::optional<BagRow> next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
