#include <fmt/format.h>

#include "eval/bench_report.hpp"
#include "match/confidence.hpp"

namespace phasescan {
namespace {

/// A CSV cell: quoted where it must be.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string bench_features(const BenchRun& run, const std::vector<BenchMethod>& methods) {
  std::string out = "source,dataset,class,id,method,right,usable,ambiguous,confidence,weak_sigma_m,across_m";
  for (const std::string_view name : confidence_feature_names()) out += fmt::format(",{}", name);
  out += "\n";
  for (const PairOutcome& o : run.outcomes) {
    if (o.features.empty()) continue;
    out += fmt::format("{},{},{},{},{},{:d},{:d},{:d},{:.6g},{:.4g},{:.4g}", cell(o.source), cell(o.dataset),
                       cell(o.cls), cell(o.id), cell(methods[o.method].name), o.right, o.usable, o.ambiguous,
                       o.confidence.value_or(0.0), o.weak_sigma_m, o.error_across_m);
    for (const double value : o.features) out += fmt::format(",{:.9g}", value);
    out += "\n";
  }
  return out;
}

}  // namespace phasescan
