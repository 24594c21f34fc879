// Source: sqlite.org, "Database file format": b-tree pages, cell payload overflow pages, record format.
#include "io/sqlite_salvage.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "io/byte_source.hpp"
#include "io/sqlite_bag.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::uint8_t kTableLeaf = 0x0D;
constexpr std::size_t kLeafHeaderBytes = 8;
constexpr std::uint64_t kMostRowBytes = std::uint64_t{1} << 26;

std::uint32_t big_endian(const std::vector<std::uint8_t>& page, std::size_t at, std::size_t n) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < n; ++i) value = value << 8U | page[at + i];
  return value;
}

/// sqlite's integers of 1 to 9 bytes; moves `at`. False where the bytes end.
bool take_varint(Bytes bytes, std::size_t& at, std::uint64_t& out) {
  out = 0;
  for (int i = 0; i < 9; ++i) {
    if (at >= bytes.size()) return false;
    const std::uint8_t byte = bytes[at++];
    if (i == 8) {
      out = out << 8U | byte;
      return true;
    }
    out = out << 7U | (byte & 0x7FU);
    if ((byte & 0x80U) == 0) return true;
  }
  return false;
}

/// Bytes of a value of a serial type; no more than there can be in a row.
std::uint64_t value_bytes(std::uint64_t type) {
  constexpr std::array<std::uint8_t, 12> kFixed{0, 1, 2, 3, 4, 6, 8, 8, 0, 0, 0, 0};
  return type < kFixed.size() ? kFixed[type] : (type - 12) / 2;
}

bool is_integer(std::uint64_t type) {
  return (type >= 1 && type <= 6) || type == 8 || type == 9;
}

std::int64_t integer(std::uint64_t type, Bytes raw) {
  if (type >= 8) return type == 9 ? 1 : 0;
  std::uint64_t value = (raw[0] & 0x80U) != 0 ? ~std::uint64_t{0} : 0;
  for (const std::uint8_t byte : raw) value = value << 8U | byte;
  return static_cast<std::int64_t>(value);
}

}  // namespace

SqliteSalvage::SqliteSalvage(const std::string& path, std::int64_t after)
    : file_bytes_(file_size_bytes(path)), last_id_(after) {
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) throw SystemError(path, "cannot be read");
  read_page_size();
}

void SqliteSalvage::read_page_size() {
  page_bytes_ = 512;
  std::vector<std::uint8_t> header;
  if (!read_page(1, header)) return;
  page_bytes_ = big_endian(header, 16, 2) == 1 ? 65536 : big_endian(header, 16, 2);
  usable_bytes_ = page_bytes_ - std::min<std::size_t>(page_bytes_, header[20]);
  if (page_bytes_ == 0) {
    std::vector<std::uint8_t> beginning(std::min<std::uint64_t>(file_bytes_, std::uint64_t{1} << 20));
    const ssize_t got = ::pread(fd_, beginning.data(), beginning.size(), 0);
    beginning.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    usable_bytes_ = page_bytes_ = guess_page_bytes(beginning);
  }
  if (page_bytes_ < 512 || (page_bytes_ & (page_bytes_ - 1)) != 0 || usable_bytes_ < 480) file_bytes_ = 0;
}

std::size_t guess_page_bytes(Bytes beginning) {
  std::size_t best = 0, most = 0;
  for (std::size_t bytes = 65536; bytes >= 512; bytes /= 2) {
    std::size_t trees = 0, others = 0;
    for (std::size_t at = bytes; at + 8 <= beginning.size(); at += bytes) {
      const std::uint8_t kind = beginning[at];
      // A tree's page has a cell count and the place of the first cell within its page.
      const std::size_t cells = static_cast<std::size_t>(beginning[at + 3]) << 8 | beginning[at + 4];
      const bool tree = (kind == 2 || kind == 5 || kind == 10 || kind == 13) && cells <= bytes / 4;
      trees += tree;
      others += !tree && kind != 0;
    }
    if (others == 0 && trees > most) {
      best = bytes;
      most = trees;
    }
  }
  return best;
}

SqliteSalvage::~SqliteSalvage() {
  if (fd_ >= 0) ::close(fd_);
}

/// Only whole pages count.
bool SqliteSalvage::read_page(std::uint64_t number, std::vector<std::uint8_t>& out) const {
  if (number == 0 || number > file_bytes_ / page_bytes_) return false;
  out.resize(page_bytes_);
  const auto at = static_cast<off_t>((number - 1) * page_bytes_);
  return ::pread(fd_, out.data(), page_bytes_, at) == static_cast<ssize_t>(page_bytes_);
}

bool SqliteSalvage::next_leaf() {
  // The first page holds the schema.
  for (page_ = std::max<std::uint64_t>(page_, 1) + 1; read_page(page_, leaf_); ++page_) {
    if (leaf_[0] != kTableLeaf) continue;
    cell_ = 0;
    cells_ = std::min<std::size_t>(big_endian(leaf_, 3, 2), (usable_bytes_ - kLeafHeaderBytes) / 2);
    return true;
  }
  file_bytes_ = 0;
  return false;
}

std::optional<SqliteSalvage::Row> SqliteSalvage::next() {
  while (file_bytes_ > 0) {
    while (cell_ < cells_) {
      const std::size_t offset = big_endian(leaf_, kLeafHeaderBytes + 2 * cell_++, 2);
      const std::optional<Row> row = row_at(offset);
      if (!row || row->id <= last_id_) continue;
      last_id_ = row->id;
      return row;
    }
    if (!next_leaf()) break;
  }
  return std::nullopt;
}

/// The payload of a cell, from its page and those it overflows to; false where one of them is not there.
bool SqliteSalvage::gather_payload(std::uint64_t length, std::size_t at) {
  const std::size_t most = usable_bytes_ - 35;
  const std::size_t least = (usable_bytes_ - 12) * 32 / 255 - 23;
  std::size_t local = static_cast<std::size_t>(length);
  if (length > most) {
    local = least + static_cast<std::size_t>((length - least) % (usable_bytes_ - 4));
    if (local > most) local = least;
  }
  const bool overflows = local < length;
  if (at + local + (overflows ? 4 : 0) > usable_bytes_) return false;
  payload_.assign(leaf_.begin() + static_cast<std::ptrdiff_t>(at),
                  leaf_.begin() + static_cast<std::ptrdiff_t>(at + local));
  std::uint32_t page = overflows ? big_endian(leaf_, at + local, 4) : 0;
  while (payload_.size() < length) {
    if (!read_page(page, overflow_)) return false;
    page = big_endian(overflow_, 0, 4);
    const auto part = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(length - payload_.size(), usable_bytes_ - 4));
    payload_.insert(payload_.end(), overflow_.begin() + 4, overflow_.begin() + 4 + part);
  }
  return page == 0;
}

/// The row id and the payload of the cell at a place of the leaf.
bool SqliteSalvage::read_cell(std::size_t offset, std::uint64_t& id) {
  const Bytes leaf(leaf_.data(), usable_bytes_);
  std::uint64_t length = 0;
  return take_varint(leaf, offset, length) && take_varint(leaf, offset, id) &&
         length <= std::min(file_bytes_, kMostRowBytes) && gather_payload(length, offset);
}

std::vector<BagTopic> SqliteSalvage::topics() {
  constexpr std::size_t kMost = 4096;
  std::vector<BagTopic> out;
  const std::uint64_t bytes = file_bytes_;
  while (file_bytes_ > 0 && out.size() < kMost && next_leaf()) {
    for (std::size_t cell = 0; cell < cells_ && out.size() < kMost; ++cell) {
      const auto topic = topic_at(big_endian(leaf_, kLeafHeaderBytes + 2 * cell, 2));
      const auto known = [&](const BagTopic& other) { return other.id == topic->id; };
      if (topic && std::none_of(out.begin(), out.end(), known)) out.push_back(*topic);
    }
  }
  file_bytes_ = bytes;
  page_ = 0;
  cell_ = cells_ = 0;
  return out;
}

std::optional<BagTopic> SqliteSalvage::topic_at(std::size_t offset) {
  std::uint64_t id = 0, head_bytes = 0;
  std::size_t at = 0;
  if (!read_cell(offset, id)) return std::nullopt;
  const Bytes record(payload_);
  if (!take_varint(record, at, head_bytes) || head_bytes > record.size()) return std::nullopt;
  std::vector<std::uint64_t> types;
  while (at < head_bytes && types.size() < 8) {
    types.emplace_back();
    if (!take_varint(record.first(static_cast<std::size_t>(head_bytes)), at, types.back())) return std::nullopt;
  }
  // NULL in the place of the id, which is the row's; then texts.
  if (at != head_bytes || types.size() < 4 || types[0] != 0) return std::nullopt;
  std::vector<std::string> texts;
  for (std::size_t i = 1; i < 4; ++i) {
    const std::uint64_t bytes = value_bytes(types[i]);
    if (types[i] < 13 || types[i] % 2 == 0 || bytes > record.size() - at) return std::nullopt;
    texts.emplace_back(reinterpret_cast<const char*>(record.data()) + at, static_cast<std::size_t>(bytes));
    at += static_cast<std::size_t>(bytes);
  }
  if (!texts[0].starts_with('/') || texts[1].find('/') == std::string::npos) return std::nullopt;
  return BagTopic{static_cast<std::int64_t>(id), texts[0], texts[1], texts[2]};
}

std::optional<SqliteSalvage::Row> SqliteSalvage::row_at(std::size_t offset) {
  std::uint64_t id = 0;
  if (!read_cell(offset, id)) return std::nullopt;
  const Bytes record(payload_);
  std::size_t at = 0;
  std::uint64_t head_bytes = 0;
  if (!take_varint(record, at, head_bytes) || head_bytes > record.size()) return std::nullopt;
  std::array<std::uint64_t, 4> types{};
  for (std::uint64_t& type : types) {
    if (!take_varint(record.first(static_cast<std::size_t>(head_bytes)), at, type)) return std::nullopt;
  }
  const bool is_blob = types[3] >= 12 && types[3] % 2 == 0;
  if (at != head_bytes || types[0] != 0 || !is_integer(types[1]) || !is_integer(types[2]) || !is_blob)
    return std::nullopt;
  if (value_bytes(types[3]) > record.size() ||
      at + value_bytes(types[1]) + value_bytes(types[2]) + value_bytes(types[3]) != record.size())
    return std::nullopt;
  const auto take = [&](std::uint64_t type) {
    const Bytes raw = record.subspan(at, static_cast<std::size_t>(value_bytes(type)));
    at += raw.size();
    return raw;
  };
  Row row;
  row.id = static_cast<std::int64_t>(id);
  row.topic_id = integer(types[1], take(types[1]));
  row.time = integer(types[2], take(types[2]));
  row.data = take(types[3]);
  return row;
}

}  // namespace phasescan
