#include "io/decompress.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <array>
#include <new>

namespace phasescan {
namespace {

/// Keeps a block of packed input; `step` unpacks from it. A damaged place is reported only after the good bytes.
class Unpacker : public ByteSource {
 public:
  explicit Unpacker(std::unique_ptr<ByteSource> source) : source_(std::move(source)), input_(std::size_t{1} << 16) {}

  std::size_t read(std::uint8_t* out, std::size_t n) override {
    while (n > 0) {
      if (at_ == size_ && !ended_) {
        at_ = 0;
        size_ = source_->read(input_.data(), input_.size());
        ended_ = size_ == 0;
      }
      if (ended_ && between_frames_) return 0;
      if (!damage_.empty()) throw DecodeError(damage_);
      const std::size_t before = at_;
      const std::size_t made = step(out, n);
      if (made > 0) return made;
      if (!damage_.empty()) continue;
      if (ended_ && !between_frames_) throw DecodeError(std::string(name()) + ": the data is cut off");
      if (at_ == before && at_ < size_ && ++idle_ > 2) throw DecodeError(std::string(name()) + ": no progress");
      if (at_ != before) idle_ = 0;
    }
    return 0;
  }

 protected:
  virtual const char* name() const = 0;
  /// Unpacks some of input_[at_, size_) into out; moves at_; returns the bytes made.
  virtual std::size_t step(std::uint8_t* out, std::size_t n) = 0;

  /// Ends the stream here: what this step made is still delivered, then the damage is thrown.
  void fail(const std::string& why) { damage_ = std::string(name()) + ": " + why; }

  std::unique_ptr<ByteSource> source_;
  std::vector<std::uint8_t> input_;
  std::size_t at_ = 0;
  std::size_t size_ = 0;
  bool ended_ = false;
  bool between_frames_ = true;  ///< the input may end here
  int idle_ = 0;
  std::string damage_;
};

class GzipSource : public Unpacker {
 public:
  explicit GzipSource(std::unique_ptr<ByteSource> source) : Unpacker(std::move(source)) {
    if (inflateInit2(&state_, 15 + 16) != Z_OK) throw std::bad_alloc();
  }
  ~GzipSource() override { inflateEnd(&state_); }

 protected:
  const char* name() const override { return "gzip"; }
  std::size_t step(std::uint8_t* out, std::size_t n) override {
    if (between_frames_ && at_ < size_) {
      inflateReset(&state_);
      between_frames_ = false;
    }
    state_.next_in = input_.data() + at_;
    state_.avail_in = static_cast<uInt>(size_ - at_);
    state_.next_out = out;
    state_.avail_out = static_cast<uInt>(n);
    const int rc = inflate(&state_, Z_NO_FLUSH);
    at_ = size_ - state_.avail_in;
    const std::size_t made = n - state_.avail_out;
    if (rc == Z_STREAM_END) between_frames_ = true;
    if (rc != Z_OK && rc != Z_STREAM_END && rc != Z_BUF_ERROR) fail("the data is broken");
    return made;
  }

 private:
  z_stream state_{};
};

class Bzip2Source : public Unpacker {
 public:
  explicit Bzip2Source(std::unique_ptr<ByteSource> source) : Unpacker(std::move(source)) { start(); }
  ~Bzip2Source() override { BZ2_bzDecompressEnd(&state_); }

 protected:
  const char* name() const override { return "bz2"; }
  std::size_t step(std::uint8_t* out, std::size_t n) override {
    if (between_frames_ && at_ < size_) {
      BZ2_bzDecompressEnd(&state_);
      start();
      between_frames_ = false;
    }
    state_.next_in = reinterpret_cast<char*>(input_.data() + at_);
    state_.avail_in = static_cast<unsigned>(size_ - at_);
    state_.next_out = reinterpret_cast<char*>(out);
    state_.avail_out = static_cast<unsigned>(n);
    const int rc = BZ2_bzDecompress(&state_);
    at_ = size_ - state_.avail_in;
    const std::size_t made = n - state_.avail_out;
    if (rc == BZ_STREAM_END) between_frames_ = true;
    if (rc != BZ_OK && rc != BZ_STREAM_END) fail("the data is broken");
    return made;
  }

 private:
  void start() {
    state_ = {};
    if (BZ2_bzDecompressInit(&state_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  bz_stream state_{};
};

class Lz4Source : public Unpacker {
 public:
  explicit Lz4Source(std::unique_ptr<ByteSource> source) : Unpacker(std::move(source)) {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&state_, LZ4F_VERSION))) throw std::bad_alloc();
  }
  ~Lz4Source() override { LZ4F_freeDecompressionContext(state_); }

 protected:
  const char* name() const override { return "lz4"; }
  std::size_t step(std::uint8_t* out, std::size_t n) override {
    std::size_t used = size_ - at_;
    std::size_t made = n;
    if (used > 0) between_frames_ = false;
    const std::size_t hint = LZ4F_decompress(state_, out, &made, input_.data() + at_, &used, nullptr);
    if (LZ4F_isError(hint)) {
      fail(LZ4F_getErrorName(hint));
      return 0;
    }
    at_ += used;
    if (hint == 0) between_frames_ = true;
    return made;
  }

 private:
  LZ4F_dctx* state_ = nullptr;
};

class ZstdSource : public Unpacker {
 public:
  explicit ZstdSource(std::unique_ptr<ByteSource> source) : Unpacker(std::move(source)), state_(ZSTD_createDCtx()) {
    if (state_ == nullptr) throw std::bad_alloc();
    // A frame may ask for a window of gigabytes; recorders use 8 MiB at most at their highest levels.
    ZSTD_DCtx_setParameter(state_, ZSTD_d_windowLogMax, 27);
  }
  ~ZstdSource() override { ZSTD_freeDCtx(state_); }

 protected:
  const char* name() const override { return "zstd"; }
  std::size_t step(std::uint8_t* out, std::size_t n) override {
    ZSTD_inBuffer in{input_.data(), size_, at_};
    ZSTD_outBuffer made{out, n, 0};
    if (at_ < size_) between_frames_ = false;
    const std::size_t hint = ZSTD_decompressStream(state_, &made, &in);
    if (ZSTD_isError(hint)) fail(ZSTD_getErrorName(hint));
    at_ = in.pos;
    if (hint == 0) between_frames_ = true;
    return made.pos;
  }

 private:
  ZSTD_DCtx* state_;
};

bool starts_with(Bytes bytes, std::initializer_list<std::uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

}  // namespace

Compression sniff_compression(Bytes first) {
  if (starts_with(first, {0x1F, 0x8B})) return Compression::kGzip;
  if (starts_with(first, {'B', 'Z', 'h'})) return Compression::kBzip2;
  if (starts_with(first, {0x04, 0x22, 0x4D, 0x18})) return Compression::kLz4;
  if (starts_with(first, {0x28, 0xB5, 0x2F, 0xFD})) return Compression::kZstd;
  return Compression::kNone;
}

std::unique_ptr<ByteSource> decompress(Compression compression, std::unique_ptr<ByteSource> source) {
  switch (compression) {
    case Compression::kGzip:
      return std::make_unique<GzipSource>(std::move(source));
    case Compression::kBzip2:
      return std::make_unique<Bzip2Source>(std::move(source));
    case Compression::kLz4:
      return std::make_unique<Lz4Source>(std::move(source));
    case Compression::kZstd:
      return std::make_unique<ZstdSource>(std::move(source));
    case Compression::kNone:
      break;
  }
  return source;
}

std::vector<std::uint8_t> zstd_unpack(Bytes packed, std::size_t limit) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw DecodeError("zstd: no frame of known size");
  if (size > limit) throw DecodeError("zstd: " + std::to_string(size) + " bytes stated for one message");
  std::vector<std::uint8_t> out(static_cast<std::size_t>(size));
  const std::size_t made = ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size());
  if (ZSTD_isError(made)) throw DecodeError(std::string("zstd: ") + ZSTD_getErrorName(made));
  out.resize(made);
  return out;
}

}  // namespace phasescan
