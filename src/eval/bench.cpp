#include "phasescan/eval/bench.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <stdexcept>
#include <thread>

#include "phasescan/core/time.hpp"
#include "phasescan/eval/statistics.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/spectrum/fft.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kBlock = 512;

/// One thread's matchers, and what it does with a pair.
class Worker {
 public:
  Worker(const std::vector<BenchMethod>& methods, int repeat) : repeat_(std::max(1, repeat)) {
    for (const BenchMethod& method : methods) matchers_.emplace_back(method.options);
  }

  void run(const BenchPair& given, PairOutcome* out) {
    const ScanPair& pair = given.pair;
    const double overlap = pair.truth ? scan_overlap(pair.reference, pair.scan, *pair.truth) : 0.0;
    for (std::size_t m = 0; m < matchers_.size(); ++m) {
      MatchTimes fastest;
      fastest.total = std::numeric_limits<double>::infinity();
      MatchResult result;
      for (int r = 0; r < repeat_; ++r) {
        result = matchers_[m].match(pair.reference, pair.scan);
        if (result.ms.total < fastest.total) fastest = result.ms;
      }
      result.ms = fastest;
      out[m] = judge(pair, result, m, overlap, given.information);
    }
  }

 private:
  int repeat_;
  std::vector<ScanMatcher> matchers_;
};

/// Pairs k, k + threads, ... of the block go to worker k, so that an outcome's place never depends on who was faster.
void run_block(const std::vector<BenchPair>& block, std::vector<Worker>& workers, std::size_t methods, PairOutcome* out) {
  std::vector<std::exception_ptr> failures(workers.size());
  const auto work = [&](std::size_t k) {
    try {
      for (std::size_t i = k; i < block.size(); i += workers.size()) workers[k].run(block[i], out + i * methods);
    } catch (...) {
      failures[k] = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t k = 1; k < workers.size(); ++k) threads.emplace_back(work, k);
  work(0);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace

std::vector<BenchMethod> bench_methods(const std::string& comma_separated, const MatchOptions& options) {
  std::vector<BenchMethod> methods;
  for (std::size_t start = 0; start <= comma_separated.size();) {
    const std::size_t comma = std::min(comma_separated.find(',', start), comma_separated.size());
    const std::string name = comma_separated.substr(start, comma - start);
    start = comma + 1;
    BenchMethod method{name, options};
    method.options.match.method = enum_from_string<MatchMethod>(name);
    for (const BenchMethod& other : methods) {
      if (other.name == name) throw std::invalid_argument("method '" + name + "' is named twice");
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
  for (int k = 0; k < std::max(1, settings.threads); ++k) workers.emplace_back(methods, settings.repeat);
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
    run_block(block, workers, methods.size(), run.outcomes.data() + at);
    run.pairs += block.size();
    fft_ms.push_back(time_reference_fft());
    if (settings.progress) settings.progress(run.pairs);
  }
  run.fft_ms = quantile(std::move(fft_ms), 0.5);
  return run;
}

}  // namespace phasescan
