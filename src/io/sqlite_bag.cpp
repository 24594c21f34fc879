// Source: ros2/rosbag2, storage of sqlite3 (schemas 1 to 4).
#include "io/sqlite_bag.hpp"

#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>

#include "io/byte_source.hpp"
#include "io/sqlite_salvage.hpp"
#include "io/sqlite_vfs.hpp"

namespace phasescan {
namespace {

struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, CloseStatement>;

std::string column_text(sqlite3_stmt* statement, int column) {
  const auto* raw = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return raw == nullptr ? std::string() : std::string(raw);
}

constexpr int kMostTopics = 4096;

/// Zeros where the header stands: not even the size of a page is known.
bool is_without_header(const std::string& path) {
  ByteStream stream(open_file_source(path));
  const Bytes header = stream.take(100);
  return header.size() == 100 && std::all_of(header.begin(), header.end(), [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace

struct SqliteBag::Impl {
  sqlite3* db = nullptr;
  Statement rows;
  std::vector<BagTopic> topics;
  std::string cut, head_damage;
  std::string path;
  std::optional<SqliteSalvage> salvage;  ///< from the first damaged place on
  std::int64_t last_id = INT64_MIN;
  bool ended = false;

  ~Impl() {
    rows.reset();
    sqlite3_close(db);
  }

  [[noreturn]] void fail() const { throw DecodeError(std::string("sqlite: ") + sqlite3_errmsg(db)); }

  Statement prepare(const char* sql) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db, sql, -1, &statement, nullptr) != SQLITE_OK) fail();
    return Statement(statement);
  }

  /// A hostile file may define views or virtual tables of the same names, which would run its own queries.
  void expect_plain_table(const char* name) const {
    const Statement statement =
        prepare("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?1 AND rootpage > 0");
    sqlite3_bind_text(statement.get(), 1, name, -1, SQLITE_STATIC);
    const int rc = sqlite3_step(statement.get());
    if (rc != SQLITE_ROW && rc != SQLITE_DONE) fail();
    if (rc == SQLITE_DONE)
      throw DecodeError(std::string("a database without a table '") + name + "': no rosbag2 recording");
  }

  void read_topics() {
    const Statement statement = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    int rc = SQLITE_ROW;
    while (static_cast<int>(topics.size()) < kMostTopics && (rc = sqlite3_step(statement.get())) == SQLITE_ROW) {
      topics.push_back({sqlite3_column_int64(statement.get(), 0), column_text(statement.get(), 1),
                        column_text(statement.get(), 2), column_text(statement.get(), 3)});
    }
    if (rc != SQLITE_DONE && rc != SQLITE_ROW) fail();
  }

  /// Without the first page nothing says where the tables begin: topics and messages are told by what rows of them
  /// hold.
  void salvage_all() {
    head_damage = "the first page is gone: rows are taken from the others as they lie";
    salvage.emplace(path, INT64_MIN);
    topics = salvage->topics();
    if (topics.empty()) throw DecodeError("a database whose first page is gone, and no page that holds topics");
  }

  void start_rows() { rows = prepare("SELECT id, topic_id, timestamp, data FROM messages ORDER BY id"); }

  /// The tree is broken: what is left of the rows behind the last one is taken from the pages as they lie.
  [[noreturn]] void break_off(const std::string& why) {
    salvage.emplace(path, last_id);
    rows.reset();
    throw DecodeError("sqlite: " + why +
                      (last_id == INT64_MIN ? " before any row" : " after row " + std::to_string(last_id)));
  }
};

bool looks_like_sqlite(Bytes first) {
  constexpr std::size_t kMagicBytes = 16;
  if (std::string_view(reinterpret_cast<const char*>(first.data()), first.size()).starts_with("SQLite format 3"))
    return true;
  const Bytes magic = first.first(std::min(first.size(), kMagicBytes));
  return std::all_of(magic.begin(), magic.end(), [](std::uint8_t byte) { return byte == 0; }) &&
         guess_page_bytes(first) > 0;
}

SqliteBag::SqliteBag(const std::string& path) : impl_(std::make_unique<Impl>()) {
  // A recording that was not closed has its last messages in PATH-wal; without one the file never changes.
  struct stat wal {};
  const bool has_wal = ::stat((path + "-wal").c_str(), &wal) == 0 && wal.st_size > 0;
  std::string uri = "file:";
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      static constexpr char kHex[] = "0123456789ABCDEF";
      uri += {'%', kHex[static_cast<unsigned char>(c) >> 4], kHex[c & 15]};
    } else {
      uri += c;
    }
  }
  // A write-ahead log is read by a connection that has the file to itself: no -shm is made beside it for others, and
  // nothing is moved from the log to the file at the end.
  uri += has_wal ? "?mode=ro" : "?mode=ro&immutable=1";
  Impl& bag = *impl_;
  bag.path = path;
  const std::uint64_t bytes = file_size_bytes(path);
  if (!has_wal) {
    const std::uint64_t stated = stated_database_bytes(path);
    if (bytes < stated)
      bag.cut = "the file ends after " + std::to_string(bytes) + " of " + std::to_string(stated) + " bytes";
  }
  if (is_headless_database(path)) bag.head_damage = "the first bytes are not those of a database; the rest is";
  if (is_without_header(path)) {
    bag.salvage_all();
    return;
  }
  if (sqlite3_open_v2(uri.c_str(), &bag.db, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, whole_page_vfs()) != SQLITE_OK)
    bag.fail();
  if (has_wal) {
    sqlite3_db_config(bag.db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    sqlite3_exec(bag.db, "PRAGMA locking_mode=EXCLUSIVE", nullptr, nullptr, nullptr);
  }
  sqlite3_limit(bag.db, SQLITE_LIMIT_LENGTH, static_cast<int>(std::clamp<std::uint64_t>(bytes, 1 << 16, 1 << 26)));
  // writable_schema lets sqlite start on a file that was cut off; the connection stays read-only.
  for (const char* pragma : {"PRAGMA trusted_schema=OFF", "PRAGMA cell_size_check=ON", "PRAGMA mmap_size=0",
                             "PRAGMA writable_schema=ON", "PRAGMA cache_size=-2048"}) {
    sqlite3_exec(bag.db, pragma, nullptr, nullptr, nullptr);
  }
  bag.expect_plain_table("topics");
  bag.expect_plain_table("messages");
  bag.read_topics();
  bag.start_rows();
}

SqliteBag::~SqliteBag() = default;

const std::string& SqliteBag::cut() const {
  return impl_->cut;
}

const std::string& SqliteBag::head_damage() const {
  return impl_->head_damage;
}

const std::vector<BagTopic>& SqliteBag::topics() const {
  return impl_->topics;
}

std::optional<BagRow> SqliteBag::next() {
  Impl& bag = *impl_;
  if (bag.ended) return std::nullopt;
  if (bag.salvage) {
    const std::optional<SqliteSalvage::Row> row = bag.salvage->next();
    if (!row) return std::nullopt;
    return BagRow{row->topic_id, row->time, row->data};
  }
  const int rc = sqlite3_step(bag.rows.get());
  if (rc == SQLITE_DONE) {
    bag.ended = true;
    return std::nullopt;
  }
  if (rc != SQLITE_ROW) bag.break_off(sqlite3_errmsg(bag.db));
  sqlite3_stmt* row = bag.rows.get();
  const std::int64_t id = sqlite3_column_int64(row, 0);
  // A damaged tree can lead back to rows that were read already, and round and round.
  if (id <= bag.last_id) bag.break_off("row " + std::to_string(id) + " stands too late");
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(row, 3));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 3));
  if (data == nullptr && sqlite3_errcode(bag.db) != SQLITE_ROW && sqlite3_column_type(row, 3) != SQLITE_NULL)
    bag.break_off(sqlite3_errmsg(bag.db));
  bag.last_id = id;
  return BagRow{sqlite3_column_int64(row, 1), sqlite3_column_int64(row, 2), Bytes(data, data == nullptr ? 0 : size)};
}

}  // namespace phasescan
