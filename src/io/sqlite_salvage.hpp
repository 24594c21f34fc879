/// Rows of a damaged database without its tree: what lies on whole pages is readable whatever became of the pages that
/// led there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/bytes.hpp"

namespace phasescan {

/// The size of a page by where pages begin: none but b-tree pages (their kind) and overflow pages (a page number) lie
/// behind the first one. 0 where no size fits.
std::size_t guess_page_bytes(Bytes beginning);

struct BagTopic;

/// Walks a database page by page and gives what looks like a row of rosbag2's table `messages`
/// (id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB).
class SqliteSalvage {
 public:
  /// Rows with ids up to `after` are left out. @throws InputError, SystemError
  SqliteSalvage(const std::string& path, std::int64_t after);
  ~SqliteSalvage();
  SqliteSalvage(const SqliteSalvage&) = delete;
  SqliteSalvage& operator=(const SqliteSalvage&) = delete;

  struct Row {
    std::int64_t id = 0, topic_id = 0, time = 0;
    Bytes data;  ///< valid until the next row
  };
  /// What looks like rows of the table `topics` (id, name, type, serialization_format, ..), over the whole file.
  std::vector<BagTopic> topics();

  /// The next row; ids only rise. Recorders append, so that the order of the pages is that of the rows.
  std::optional<Row> next();

 private:
  bool read_page(std::uint64_t number, std::vector<std::uint8_t>& out) const;
  bool next_leaf();
  void read_page_size();
  bool read_cell(std::size_t offset, std::uint64_t& id);
  std::optional<Row> row_at(std::size_t offset);
  std::optional<BagTopic> topic_at(std::size_t offset);
  bool gather_payload(std::uint64_t length, std::size_t at);

  int fd_ = -1;
  std::uint64_t file_bytes_ = 0;
  std::size_t page_bytes_ = 0, usable_bytes_ = 0;
  std::uint64_t page_ = 0;  ///< number of the current page, from 1
  std::vector<std::uint8_t> leaf_, overflow_, payload_;
  std::size_t cell_ = 0, cells_ = 0;
  std::int64_t last_id_;
};

}  // namespace phasescan
