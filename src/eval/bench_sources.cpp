#include <deque>
#include <map>
#include <set>

#include "core/parallel.hpp"
#include "eval/bench.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
std::string source_name(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  return name.substr(0, name.find('.'));
}

void separate_sources(std::vector<PairOutcome>& outcomes) {
  std::map<std::string, std::set<std::string>> sources_of, datasets_of;
  for (const PairOutcome& o : outcomes) {
    sources_of[o.dataset].insert(o.source);
    datasets_of[o.source].insert(o.dataset);
  }
  for (PairOutcome& o : outcomes) {
    if (sources_of[o.dataset].size() < 2) continue;
    o.dataset = datasets_of[o.source].size() > 1 ? o.source + "/" + o.dataset : o.source;
  }
}

PairSource pair_source(const std::vector<ScanPair>& pairs) {
  return [&pairs, next = std::size_t{0}]() mutable -> std::optional<BenchPair> {
    if (next == pairs.size()) return std::nullopt;
    return BenchPair{pairs[next++], {}};
  };
}

PairSource file_source(const std::string& path) {
  auto reader = std::make_shared<PairReader>(path);
  return [reader, path]() -> std::optional<BenchPair> {
    std::optional<PairLine> line = reader->next();
    if (!line) return std::nullopt;
    if (!line->pair) throw InputError(path, line->line, line->error);
    ScanPair& pair = *line->pair;
    if (pair.cls.empty())
      throw InputError(path, line->line, "no \"class\": expected small, middle, large, global, none or another name");
    if (!pair.truth && pair.cls != kNoneClass) {
      throw InputError(path, line->line, "no \"truth\": expected {\"x\", \"y\", \"theta\"} for every class but none");
    }
    if (pair.dataset.empty()) pair.dataset = source_name(path);
    return BenchPair{std::move(pair), source_name(path)};
  };
}

PairSource simulated_source(std::shared_ptr<const sim::PairGenerator> generator, std::size_t count, int threads) {
  struct State {
    std::size_t next = 0;
    std::deque<BenchPair> ready;
  };
  auto state = std::make_shared<State>();
  const auto workers = static_cast<std::size_t>(std::max(1, threads));
  return [generator, count, workers, state]() -> std::optional<BenchPair> {
    if (state->ready.empty()) {
      const std::size_t n = std::min(count - state->next, 32 * workers);
      if (n == 0) return std::nullopt;
      std::vector<BenchPair> block(n);
      parallel_for(n, workers,
                   [&](std::size_t i, std::size_t) { block[i].pair = generator->make(state->next + i).pair; });
      state->next += n;
      std::move(block.begin(), block.end(), std::back_inserter(state->ready));
    }
    BenchPair out = std::move(state->ready.front());
    state->ready.pop_front();
    return out;
  };
}

}  // namespace phasescan
