/// The records an MCAP file is made of, shared by reader and writer.
#pragma once

#include <cstdint>
#include <string_view>

#include "io/bytes.hpp"

namespace phasescan::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum class Op : std::uint8_t {
  kInvalid = 0x00,
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

/// Appends a record: kind, length, and what `fill(ByteWriter&)` appends.
template <class Fill>
void put_record(ByteWriter& out, Op op, Fill fill) {
  out.put(static_cast<std::uint8_t>(op));
  const std::size_t length_at = out.size();
  out.put(std::uint64_t{0});
  fill(out);
  out.put_at(length_at, std::uint64_t{out.size() - length_at - sizeof(std::uint64_t)});
}

}  // namespace phasescan::mcap
