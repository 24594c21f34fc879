#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "contender.hpp"
#include "methods/any_matcher.hpp"

namespace phasescan::rivals {
namespace {

Contender own(const std::string& name, const std::string& settings, const AnyMatchOptions& options) {
  return {name, settings, [matcher = std::make_shared<AnyMatcher>(options)](const Scan& reference, const Scan& scan) {
            return matcher->match(reference, scan).T_ref_scan;
          }};
}

}  // namespace

std::vector<Contender> own_contenders() {
  std::vector<Contender> all;
  for (const MatchMethod method : {MatchMethod::kIcp, MatchMethod::kNdt, MatchMethod::kFftIcp2, MatchMethod::kGlobal}) {
    AnyMatchOptions options;
    options.match.method = method;
    const std::string name(to_string(method));
    all.push_back(own("phasescan " + name, "--method " + name + ", defaults", options));
  }
  AnyMatchOptions gated;
  gated.match.method = MatchMethod::kIcp;
  gated.icp.max_iterations = kIterations;
  gated.icp.gate_m = gated.icp.gate_start_m = kDuelGate_m;
  all.push_back(own("phasescan icp, fixed gate",
                    fmt::format("--method icp with icp.gate_m = icp.gate_start_m = {} m, {} iterations at most",
                                kDuelGate_m, kIterations),
                    gated));
  return all;
}

std::vector<Duel> duels(const std::vector<Contender>& contenders) {
  const std::vector<Duel> all{
      {fmt::format("icp against PCL ICP: both with a fixed gate of {} m, {} iterations at most, the same tolerances",
                   kDuelGate_m, kIterations),
       "phasescan icp, fixed gate",
       {"PCL ICP"}},
      {"ndt against PCL NDT2D: defaults against the best of PCL's five settings",
       "phasescan ndt",
       {"PCL NDT2D, 0.5 m x 0.05", "PCL NDT2D, 1 m x 0.05", "PCL NDT2D, 2 m x 0.02", "PCL NDT2D, 2 m x 0.1",
        "PCL NDT2D, 2-1-0.5 m x 0.05"}},
  };
  const auto is_there = [&](const std::string& name) {
    return std::any_of(contenders.begin(), contenders.end(), [&](const Contender& c) { return c.name == name; });
  };
  std::vector<Duel> possible;
  for (Duel duel : all) {
    std::erase_if(duel.theirs, [&](const std::string& name) { return !is_there(name); });
    if (is_there(duel.ours) && !duel.theirs.empty()) possible.push_back(std::move(duel));
  }
  return possible;
}

}  // namespace phasescan::rivals
