/// Runs methods over pairs of scans and keeps what the tables need.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "eval/pair_outcome.hpp"
#include "methods/any_options.hpp"
#include "sim/pairs.hpp"

namespace phasescan {

/// One column of the comparison: a name and all options, the method among them.
struct BenchMethod {
  std::string name;
  AnyMatchOptions options;
};

/// Columns for methods by name ("icp,fft-icp2"), all with the same options otherwise.
/// @throws std::invalid_argument for an unknown or doubled name, or none.
std::vector<BenchMethod> bench_methods(const std::string& comma_separated, const AnyMatchOptions& options);

/// A column from "NAME: section.option=value, ...": these options over the given ones.
/// @throws std::invalid_argument saying what is wrong with the text.
BenchMethod bench_variant(const std::string& text, const AnyMatchOptions& options);

/// A pair and where it came from.
struct BenchPair {
  ScanPair pair;
  std::string source = {};  ///< the file's name without folder and ending, or the simulated set's
};

/// The file's name without folder and ending: "pairs/intel-180.jsonl.gz" -> "intel-180".
std::string source_name(const std::string& path);

/// Two files may hold pairs of one dataset under different conditions: where a dataset comes from several sources, it
/// is renamed to its source ("source/dataset" if that has other datasets too), so that each keeps rows of its own.
void separate_sources(std::vector<PairOutcome>& outcomes);

/// Gives the next pair, or nothing at the end.
using PairSource = std::function<std::optional<BenchPair>()>;

/// A source over pairs in memory; they must outlive it.
PairSource pair_source(const std::vector<ScanPair>& pairs);

/// The lines of a pairs file. A pair of any class but `none` must have a truth; a pair without a dataset takes the
/// file's name. The source throws InputError with the line of whatever cannot be used.
PairSource file_source(const std::string& path);

/// The first `count` pairs of a generator, made on `threads` threads.
PairSource simulated_source(std::shared_ptr<const sim::PairGenerator> generator, std::size_t count, int threads);

/// How to run. Nothing of it changes an outcome but its times.
struct BenchSettings {
  int threads = 1;
  int repeat = 1;  ///< passes over each block of pairs, in shuffled order; the fastest times of each match are kept
  bool prepared = false;  ///< references are prepared before a block is matched, outside of the times
  std::function<void(std::size_t pairs_done)> progress;
};

/// Outcomes pair by pair, method by method within a pair.
struct BenchRun {
  std::vector<PairOutcome> outcomes;
  std::size_t pairs = 0;
  double fft_ms = 0.0;  ///< CPU time of one 128 x 128 real-to-complex float FFT, median over the run
};

/// Matches every pair with every method. Memory: a block of 512 pairs at a time.
/// @throws what the source throws; std::invalid_argument for options out of bounds.
BenchRun run_bench(const PairSource& source, const std::vector<BenchMethod>& methods,
                   const BenchSettings& settings = {});

/// CPU time of one 128 x 128 real-to-complex float FFT: the median of `repeats` [ms].
double time_reference_fft(int repeats = 101);

}  // namespace phasescan
