/// Files with damage at stated places, and what every reader owes its user then: no crash and no hang, all that lies
/// before the damage as it was, and a word about what is lost.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "support/ros_fixture.hpp"
#include "support/temp.hpp"

namespace phasescan::test {

/// What a reader made of a file; a scan is a hash of all that it says.
struct Reading {
  std::vector<std::uint64_t> scans;
  std::vector<long> lines;  ///< LogEntry::line of each
  std::size_t damages = 0;
  std::string refused;  ///< the InputError, if it ended in one

  /// The exit code of a command on such a log (docs: exit codes).
  int exit_code() const {
    if (!refused.empty() || (scans.empty() && damages > 0)) return 2;
    return damages > 0 ? 4 : scans.empty() ? 1 : 0;
  }
};

inline std::uint64_t hash_bytes(const void* data, std::size_t n, std::uint64_t hash = 14695981039346656037ULL) {
  for (std::size_t i = 0; i < n; ++i) hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ULL;
  return hash;
}

/// Stamp, geometry, the ranges with the reason of each missing one, intensities.
inline std::uint64_t hash_scan(const Scan& scan) {
  std::uint64_t hash = hash_bytes(&scan.stamp, sizeof scan.stamp);
  const ScanGeometry& g = scan.geometry;
  for (const double value : {g.angle_min, g.angle_increment, g.range_min, g.range_max, scan.time_increment})
    hash = hash_bytes(&value, sizeof value, hash);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::uint32_t bits = static_cast<std::uint32_t>(scan.states[i]);
    const float range = raw_range(scan, i);
    if (!std::isnan(range)) std::memcpy(&bits, &range, sizeof bits);
    hash = (hash ^ bits) * 1099511628211ULL;
  }
  hash = hash_bytes(scan.angles.data(), scan.angles.size() * sizeof(float), hash);
  return hash_bytes(scan.intensities.data(), scan.intensities.size() * sizeof(float), hash);
}

/// Reads all of a log. A run of more than a minute kills the program: no damage may make a reader hang.
inline Reading read_damaged(const std::string& path, const LogOptions& options = {}) {
  ::alarm(60);
  Reading out;
  try {
    const auto log = open_log(path, options);
    try {
      while (const auto entry = log->next()) {
        EXPECT_EQ(entry->scan.states.size(), entry->scan.size());
        EXPECT_TRUE(entry->T_base_laser.is_finite() && (!entry->odometry || entry->odometry->is_finite()));
        out.scans.push_back(hash_scan(entry->scan));
        out.lines.push_back(entry->line);
      }
    } catch (const InputError& error) {
      out.refused = error.what();
    }
    out.damages = log->damage_count();
  } catch (const InputError& error) {
    out.refused = error.what();
  }
  ::alarm(0);
  return out;
}

/// A file to be damaged, with what can be said of it beforehand.
struct Sample {
  std::string name;   ///< for messages
  std::string bytes;  ///< the whole file
  LogOptions options;
  /// Where a record begins or ends.
  std::vector<std::size_t> borders;
  /// How many scans lie wholly within the first n bytes; at least (a packed block may hold some more).
  std::function<std::size_t(std::size_t)> scans_before = [](std::size_t) { return std::size_t{0}; };
  /// Whether a cut at byte n leaves a file of its format that nobody can tell from a whole one.
  std::function<bool(std::size_t)> looks_whole = [](std::size_t) { return false; };
  /// Whether the last scan of a cut file may differ from what was written: numbers without an end mark.
  bool open_end = false;
  /// Scans that its format is told by: numbers without a header are no format, and a file of fewer may be refused.
  std::size_t recognised_from = 1;
};

/// How many of `part` are `whole`'s, in its order.
inline std::size_t count_in_order(const std::vector<std::uint64_t>& part, const std::vector<std::uint64_t>& whole) {
  std::size_t at = 0, count = 0;
  for (const std::uint64_t scan : part) {
    const auto found = std::find(whole.begin() + static_cast<std::ptrdiff_t>(at), whole.end(), scan);
    if (found == whole.end()) continue;
    ++count;
    at = static_cast<std::size_t>(found - whole.begin()) + 1;
  }
  return count;
}

/// Counts for the line a test prints.
struct DamageTally {
  std::size_t cuts = 0, flips = 0, named = 0, refused = 0, unnamed = 0;
  std::size_t silent = 0;  ///< flips of these that cost scans: what was written is a legal file of fewer
};

inline void expect_beginning(const Sample& sample, const Reading& read, const Reading& whole, std::size_t at) {
  const std::size_t before = sample.scans_before(at);
  if (!read.refused.empty() && before < sample.recognised_from) return;
  ASSERT_GE(read.scans.size(), before) << "scans before the damage are lost";
  ASSERT_TRUE(
      std::equal(read.scans.begin(), read.scans.begin() + static_cast<std::ptrdiff_t>(before), whole.scans.begin()))
      << "a scan before the damage was changed";
}

inline void expect_cut_survived(const Sample& sample, const Reading& read, const Reading& whole, std::size_t at,
                                DamageTally& tally) {
  ++tally.cuts;
  expect_beginning(sample, read, whole, at);
  const std::size_t same = count_in_order(read.scans, whole.scans);
  ASSERT_LE(read.scans.size() - same, sample.open_end ? 1U : 0U) << "a scan that was not in the file";
  const int code = read.exit_code();
  if (read.scans.size() < whole.scans.size() && !sample.looks_whole(at)) {
    ASSERT_TRUE(code == 4 || code == 2) << read.scans.size() << " of " << whole.scans.size() << " scans, exit " << code;
  }
  ++(code == 4 ? tally.named : code == 2 ? tally.refused : tally.unnamed);
}

inline void expect_flip_survived(const Sample& sample, const Reading& read, const Reading& whole, std::size_t at,
                                 DamageTally& tally) {
  ++tally.flips;
  if (read.refused.empty()) expect_beginning(sample, read, whole, at);
  const int code = read.exit_code();
  if (code < 2 && read.scans.size() < whole.scans.size()) ++tally.silent;
  ++(code == 4 ? tally.named : code == 2 ? tally.refused : tally.unnamed);
}

/// Cuts a file evenly at `places` places and beside its borders, and flips a bit at as many.
/// `path`: where the damaged file is put; `log`: what is opened (a folder around it, or the same).
inline DamageTally damage_everywhere(const Sample& sample, std::size_t places, const std::string& path,
                                     const std::string& log) {
  DamageTally tally;
  const auto read = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    return read_damaged(log, sample.options);
  };
  const std::size_t size = sample.bytes.size();
  const Reading whole = read(sample.bytes);
  EXPECT_EQ(whole.exit_code(), 0) << sample.name << ": " << whole.refused;
  EXPECT_EQ(sample.scans_before(size), whole.scans.size()) << sample.name;
  std::vector<std::size_t> cuts;
  for (std::size_t i = 0; i < places; ++i) cuts.push_back(size * i / places);
  // All borders near both ends, the others evenly: as many as there are places.
  const std::size_t borders = sample.borders.size(), step = std::max<std::size_t>(1, 3 * borders / places);
  for (std::size_t i = 0; i < borders; ++i) {
    if (i >= 8 && i + 8 < borders && i % step != 0) continue;
    const std::size_t border = sample.borders[i];
    for (const std::size_t cut : {border - 1, border, border + 1}) {
      if (cut < size) cuts.push_back(cut);
    }
  }
  for (const std::size_t cut : cuts) {
    SCOPED_TRACE(sample.name + " cut at " + std::to_string(cut) + " of " + std::to_string(size));
    expect_cut_survived(sample, read(sample.bytes.substr(0, cut)), whole, cut, tally);
  }
  Random random(20260101);
  for (std::size_t i = 0; i < places; ++i) {
    const std::size_t at = random.below(size);
    const auto bit = static_cast<int>(random.below(8));
    SCOPED_TRACE(sample.name + " bit " + std::to_string(bit) + " of byte " + std::to_string(at) + " flipped");
    std::string bytes = sample.bytes;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    expect_flip_survived(sample, read(bytes), whole, at, tally);
  }
  return tally;
}

/// How much a gzip file's first n bytes unpack to, for any n: unpacked once, in small steps.
class GzipProgress {
 public:
  explicit GzipProgress(const std::string& packed) {
    z_stream state{};
    inflateInit2(&state, 15 + 16);
    std::string out(1 << 16, '\0');
    for (std::size_t at = 0; at < packed.size(); at += kStep) {
      state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + at));
      state.avail_in = static_cast<uInt>(std::min(kStep, packed.size() - at));
      do {
        state.next_out = reinterpret_cast<Bytef*>(out.data());
        state.avail_out = static_cast<uInt>(out.size());
        const int rc = inflate(&state, Z_NO_FLUSH);
        text_.append(out, 0, out.size() - state.avail_out);
        if (rc == Z_STREAM_END) inflateReset(&state);
        if (rc != Z_OK && rc != Z_STREAM_END) break;
      } while (state.avail_in > 0 || state.avail_out == 0);
      made_.push_back(text_.size());
    }
    inflateEnd(&state);
  }
  const std::string& text() const { return text_; }
  /// At least so many bytes of text come from the first n packed ones.
  std::size_t made_from(std::size_t n) const { return n < kStep ? 0 : made_[n / kStep - 1]; }

 private:
  static constexpr std::size_t kStep = 16;
  std::string text_;
  std::vector<std::size_t> made_;
};

inline std::string pack_gzip(const std::string& in) {
  z_stream state{};
  deflateInit2(&state, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&state, in.size()), '\0');
  state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data()));
  state.avail_in = static_cast<uInt>(in.size());
  state.next_out = reinterpret_cast<Bytef*>(out.data());
  state.avail_out = static_cast<uInt>(out.size());
  deflate(&state, Z_FINISH);
  out.resize(state.total_out);
  deflateEnd(&state);
  return out;
}

/// Ends of the lines of a text, each behind its newline.
inline std::vector<std::size_t> line_ends(const std::string& text) {
  std::vector<std::size_t> ends;
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) ends.push_back(at + 1);
  if (ends.empty() || ends.back() < text.size()) ends.push_back(text.size());
  return ends;
}

/// A text log, plain or as a .gz. `path`: where it is put to see once which line each scan ends on.
/// beams: scans of a log with a beam a line end where the next one begins.
inline Sample text_sample(const std::string& name, const std::string& bytes, const std::string& path,
                          const LogOptions& options = {}, bool beams = false) {
  Sample sample;
  sample.name = name;
  sample.bytes = bytes;
  sample.options = options;
  write_bytes(path, bytes);
  const Reading whole = read_damaged(path, options);
  const bool packed = bytes.starts_with("\x1f\x8b");
  const auto progress = std::make_shared<GzipProgress>(packed ? bytes : pack_gzip(""));
  const std::string& text = packed ? progress->text() : bytes;
  const std::vector<std::size_t> ends = line_ends(text);
  std::vector<std::size_t> scan_ends;
  for (std::size_t k = 0; k < whole.lines.size(); ++k) {
    const bool last = k + 1 == whole.lines.size();
    const auto end_line = static_cast<std::size_t>(!beams ? whole.lines[k]
                                                   : last ? long(ends.size())
                                                          : whole.lines[k + 1]);
    scan_ends.push_back(ends.at(end_line - 1));
  }
  sample.scans_before = [scan_ends, packed, progress, size = bytes.size()](std::size_t n) {
    if (n == size) return scan_ends.size();
    const std::size_t made = packed ? progress->made_from(n) : n;
    return static_cast<std::size_t>(std::upper_bound(scan_ends.begin(), scan_ends.end(), made) - scan_ends.begin());
  };
  if (packed) return sample;
  sample.borders = ends;
  // A text ends where a line ends, with or without its newline.
  sample.looks_whole = [bytes](std::size_t n) { return n > 0 && (bytes[n - 1] == '\n' || bytes[n] == '\n'); };
  return sample;
}

}  // namespace phasescan::test
