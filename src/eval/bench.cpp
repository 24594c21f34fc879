#include "eval/bench.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "io/nearest_word.hpp"
#include "core/parallel.hpp"
#include "core/random.hpp"
#include "phasescan/core/time.hpp"
#include "eval/pair_information.hpp"
#include "eval/statistics.hpp"
#include "methods/any_matcher.hpp"
#include "fft_icp/spectrum/fft.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kBlock = 512;

/// One thread's matchers, and what it does with a pair.
class Worker {
 public:
  Worker(const std::vector<BenchMethod>& methods, bool prepared) : prepared_(prepared) {
    for (const BenchMethod& method : methods) matchers_.emplace_back(method.options);
  }

  /// Forgets the references of the last block and prepares those of this one.
  void prepare(const std::vector<BenchPair>& block, const std::vector<std::size_t>& order, std::size_t first,
               std::size_t step) {
    references_.clear();
    if (!prepared_) return;
    for (std::size_t i = first; i < order.size(); i += step) {
      for (AnyMatcher& matcher : matchers_) references_.push_back(matcher.prepare(block[order[i]].pair.reference));
    }
  }

  /// Matches the worker's k-th pair and judges. @param out  one per method
  void run(const BenchPair& given, std::size_t k, PairOutcome* out) {
    const ScanPair& pair = given.pair;
    const double overlap = pair.truth ? scan_overlap(pair.reference, pair.scan, *pair.truth) : 0.0;
    const bool simulated = pair.information.has_value();
    std::optional<Eigen::Matrix3d> information = pair.information;
    if (!simulated && pair.truth) information = surface_information(pair.reference, pair.scan, *pair.truth);
    for (std::size_t turn = 0; turn < matchers_.size(); ++turn) {
      const std::size_t m = in_turn(turn, k);
      out[m] = judge(pair, match(m, k, pair), m, overlap, information,
                     simulated ? InformationSource::kSimulator : InformationSource::kSurfaces);
      out[m].source = given.source;
    }
  }

  /// Matches once more and keeps the faster times.
  void time_again(const ScanPair& pair, std::size_t k, PairOutcome* out) {
    for (std::size_t turn = 0; turn < matchers_.size(); ++turn) {
      const std::size_t m = in_turn(turn, k);
      const MatchTimes ms = match(m, k, pair).diagnostics.ms;
      if (ms.total < out[m].ms.total) out[m].ms = ms;
    }
  }

 private:
  /// Every method comes first for its share of the pairs: the first one finds the scans in no cache.
  std::size_t in_turn(std::size_t turn, std::size_t k) const { return (turn + k) % matchers_.size(); }

  MatchResult match(std::size_t m, std::size_t k, const ScanPair& pair) {
    return prepared_ ? matchers_[m].match(references_[k * matchers_.size() + m], pair.scan)
                     : matchers_[m].match(pair.reference, pair.scan);
  }

  bool prepared_;
  std::vector<AnyMatcher> matchers_;
  std::vector<AnyReference> references_;  // of the worker's pairs in turn, one per method
};

/// 0 .. n-1 shuffled, always alike: neighbours in a file are often of one class and one place.
std::vector<std::size_t> shuffled(std::size_t n) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(n);
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

/// Every workers.size()-th pair of the shuffled block goes to the same worker, so that an outcome never depends on who
/// was faster. Repeats go over the whole block again, so that each match meets another pair's data in the caches.
void run_block(const std::vector<BenchPair>& block, std::vector<Worker>& workers, std::size_t methods, int repeat,
               PairOutcome* out) {
  const std::vector<std::size_t> order = shuffled(block.size());
  run_workers(workers.size(), [&](std::size_t k) {
    workers[k].prepare(block, order, k, workers.size());
    for (int r = 0; r < repeat; ++r) {
      for (std::size_t i = k; i < order.size(); i += workers.size()) {
        const BenchPair& given = block[order[i]];
        PairOutcome* const at = out + order[i] * methods;
        const std::size_t nth = i / workers.size();
        r == 0 ? workers[k].run(given, nth, at) : workers[k].time_again(given.pair, nth, at);
      }
    }
  });
}

}  // namespace

std::vector<BenchMethod> bench_methods(const std::string& comma_separated, const AnyMatchOptions& options) {
  std::vector<BenchMethod> methods;
  for (std::size_t start = 0; start <= comma_separated.size();) {
    const std::size_t comma = std::min(comma_separated.find(',', start), comma_separated.size());
    const std::string name = comma_separated.substr(start, comma - start);
    start = comma + 1;
    BenchMethod method{"", options};
    method.options.match.method = enum_from_word<MatchMethod>(name);
    method.name = to_string(method.options.match.method);
    for (const BenchMethod& other : methods) {
      if (other.name == method.name) throw std::invalid_argument("method '" + name + "' is named twice");
    }
    methods.push_back(std::move(method));
  }
  return methods;
}

double time_reference_fft(int repeats) {
  RealFft fft = RealFft::image(128, 128);
  FloatBuffer in(fft.real_size(), 0.0F);
  for (std::size_t i = 0; i < in.size(); i += 37) in[i] = 1.0F;
  ComplexBuffer out;
  fft.forward(in, out);
  std::vector<double> ms;
  for (int i = 0; i < std::max(1, repeats); ++i) {
    const double start = thread_cpu_seconds();
    fft.forward(in, out);
    ms.push_back(1e3 * (thread_cpu_seconds() - start));
  }
  return quantile(std::move(ms), 0.5);
}

BenchRun run_bench(const PairSource& source, const std::vector<BenchMethod>& methods, const BenchSettings& settings) {
  std::vector<Worker> workers;
  for (int k = 0; k < std::max(1, settings.threads); ++k) workers.emplace_back(methods, settings.prepared);
  BenchRun run;
  std::vector<double> fft_ms{time_reference_fft()};
  std::vector<BenchPair> block;
  for (bool more = true; more;) {
    block.clear();
    while (block.size() < kBlock) {
      std::optional<BenchPair> pair = source();
      if (!pair) {
        more = false;
        break;
      }
      block.push_back(std::move(*pair));
    }
    const std::size_t at = run.outcomes.size();
    run.outcomes.resize(at + block.size() * methods.size());
    run_block(block, workers, methods.size(), std::max(1, settings.repeat), run.outcomes.data() + at);
    run.pairs += block.size();
    fft_ms.push_back(time_reference_fft());
    if (settings.progress) settings.progress(run.pairs);
  }
  separate_sources(run.outcomes);
  run.fft_ms = quantile(std::move(fft_ms), 0.5);
  return run;
}

}  // namespace phasescan
