/// Streaming decompressors: bounded memory whatever the input claims to hold.
#pragma once

#include <memory>
#include <string_view>

#include "io/byte_source.hpp"

namespace phasescan {

enum class Compression { kNone, kGzip, kBzip2, kLz4, kZstd };

/// By the first bytes of a stream (lz4: the frame format).
Compression sniff_compression(Bytes first);

/// What `source` holds, unpacked. Several members, frames or streams in a row are read as one, as the tools of each
/// format do. Its read() throws DecodeError "zstd: ..." at damage, after all that lies before it was delivered, and
/// also where the data end before their own end mark.
std::unique_ptr<ByteSource> decompress(Compression compression, std::unique_ptr<ByteSource> source);

/// A zstd frame that states its size, unpacked in memory, at most `limit` bytes. @throws DecodeError.
std::vector<std::uint8_t> zstd_unpack(Bytes packed, std::size_t limit);

}  // namespace phasescan
