#include "state/container.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "state/fields.hpp"

namespace phasescan {
namespace {

// Layout, all numbers little endian:
//   magic 8, version u32, sections u32, of each: name 16, packing u32, checksum u32, bytes in the file u64, bytes
//   unpacked u64; checksum u32 of all before it; the sections one after the other, up to the end of the file.
// Checksums are CRC-32 of the bytes in the file.
constexpr std::size_t kNameBytes = 16, kEntryBytes = kNameBytes + 4 + 4 + 8 + 8, kHeadBytes = 8 + 4 + 4;
constexpr std::uint32_t kMostSections = 64;
constexpr std::uint32_t kPlain = 0, kZstd = 1;
constexpr std::uint64_t kMostRatio = 256;  // of unpacked to packed bytes: what packs better is written as it is
constexpr int kLevel = 3;                  // of zstd

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

template <class T>
void put(std::string& out, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) out += static_cast<char>(value >> (8 * i) & 0xFFU);
}

template <class T>
T get(std::string_view bytes, std::size_t at) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    value |= static_cast<T>(static_cast<T>(static_cast<std::uint8_t>(bytes[at + i])) << (8 * i));
  return value;
}

std::string packed(const std::string& content, std::uint32_t& packing) {
  packing = kPlain;
  std::string out(ZSTD_compressBound(content.size()), '\0');
  const std::size_t n = ZSTD_compress(out.data(), out.size(), content.data(), content.size(), kLevel);
  if (ZSTD_isError(n) != 0 || n >= content.size() || content.size() > kMostRatio * n) return content;
  packing = kZstd;
  out.resize(n);
  return out;
}

struct Entry {
  std::string name;
  std::uint32_t packing = 0, crc = 0;
  std::uint64_t bytes = 0, unpacked = 0;
};

Entry entry_at(std::string_view bytes, std::size_t at) {
  Entry entry;
  entry.name.assign(bytes.substr(at, kNameBytes));
  entry.name.resize(std::min(entry.name.size(), entry.name.find('\0')));
  entry.packing = get<std::uint32_t>(bytes, at + kNameBytes);
  entry.crc = get<std::uint32_t>(bytes, at + kNameBytes + 4);
  entry.bytes = get<std::uint64_t>(bytes, at + kNameBytes + 8);
  entry.unpacked = get<std::uint64_t>(bytes, at + kNameBytes + 16);
  return entry;
}

std::string unpacked(const Entry& entry, std::string_view stored) {
  const std::string damaged = "is damaged: section '" + entry.name + "' ";
  if (checksum(stored) != entry.crc) throw StateFormatError(damaged + "does not match its checksum");
  if (entry.packing == kPlain && entry.unpacked == entry.bytes) return std::string(stored);
  if (entry.packing != kZstd || entry.unpacked > kMostRatio * entry.bytes)
    throw StateFormatError(damaged + "is packed in no way that is known");
  std::string content(static_cast<std::size_t>(entry.unpacked), '\0');
  if (ZSTD_decompress(content.data(), content.size(), stored.data(), stored.size()) != content.size())
    throw StateFormatError(damaged + "cannot be unpacked");
  return content;
}

[[noreturn]] void refuse_cut_off(std::size_t bytes, std::uint64_t expected) {
  throw StateFormatError("is cut off: it has " + std::to_string(bytes) + " bytes; expected " +
                         std::to_string(expected));
}

}  // namespace

const std::string* StateSections::find(std::string_view name) const {
  const auto found = std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.name == name; });
  return found == sections.end() ? nullptr : &found->content;
}

const std::string& StateSections::at(std::string_view name) const {
  if (const std::string* content = find(name)) return *content;
  throw StateFormatError("has no section '" + std::string(name) + "'; expected one");
}

bool looks_like_state(std::string_view bytes, const StateFileKind& kind) {
  return bytes.starts_with(kind.magic);
}

std::string pack_state(const StateSections& sections, const StateFileKind& kind) {
  std::string out(kind.magic);
  put(out, sections.version);
  put(out, static_cast<std::uint32_t>(sections.sections.size()));
  std::vector<std::string> contents;
  for (const StateSection& section : sections.sections) {
    std::uint32_t packing = 0;
    contents.push_back(packed(section.content, packing));
    std::string name = section.name;
    name.resize(kNameBytes, '\0');
    out += name;
    put(out, packing);
    put(out, checksum(contents.back()));
    put(out, static_cast<std::uint64_t>(contents.back().size()));
    put(out, static_cast<std::uint64_t>(section.content.size()));
  }
  put(out, checksum(out));
  for (const std::string& content : contents) out += content;
  return out;
}

StateSections unpack_state(std::string_view bytes, const StateFileKind& kind) {
  const std::string noun = kind.noun;
  if (!looks_like_state(bytes, kind)) {
    if (!bytes.empty() && kind.magic.starts_with(bytes)) refuse_cut_off(bytes.size(), kHeadBytes);
    throw StateFormatError("is no " + noun + "; expected " + kind.expected);
  }
  if (bytes.size() < kHeadBytes) refuse_cut_off(bytes.size(), kHeadBytes);
  StateSections out;
  out.version = get<std::uint32_t>(bytes, 8);
  if (out.version < kind.oldest || out.version > kind.newest) {
    throw StateFormatError("is a " + noun + " of version " + std::to_string(out.version) +
                           "; this build reads versions " + std::to_string(kind.oldest) + " to " +
                           std::to_string(kind.newest));
  }
  const auto count = get<std::uint32_t>(bytes, 12);
  if (count > kMostSections) throw StateFormatError("is damaged: its head does not match its checksum");
  std::size_t at = kHeadBytes + count * kEntryBytes;
  if (bytes.size() < at + 4) refuse_cut_off(bytes.size(), at + 4);
  if (checksum(bytes.substr(0, at)) != get<std::uint32_t>(bytes, at))
    throw StateFormatError("is damaged: its head does not match its checksum");
  at += 4;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Entry entry = entry_at(bytes, kHeadBytes + i * kEntryBytes);
    if (entry.bytes > bytes.size() - at) refuse_cut_off(bytes.size(), at + entry.bytes);
    const std::string_view stored = bytes.substr(at, static_cast<std::size_t>(entry.bytes));
    out.sections.push_back({entry.name, unpacked(entry, stored), stored.size()});
    at += stored.size();
  }
  if (at != bytes.size()) {
    throw StateFormatError("is damaged: " + std::to_string(bytes.size() - at) + " bytes follow its end; expected none");
  }
  return out;
}

}  // namespace phasescan
