/// What the parts of the paper's repetition share: methods, pairs and the report they add to.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "eval/bench.hpp"
#include "eval/paper.hpp"
#include "eval/statistics.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "fft_icp/missing/missing.hpp"

namespace phasescan {

/// The two ways each method runs.
enum class Variant { kPrinted, kOurs };

struct PaperKit {
  PaperOptions options;
  AnyMatchOptions printed, ours;
  HtmlReport report;
  PaperFiles files;

  explicit PaperKit(const PaperOptions& given);

  /// Adds an SVG to the report and to the files.
  void figure(const std::string& name, const std::string& svg, const std::string& caption);
  void data(const std::string& name, const nlohmann::ordered_json& json);
  const AnyMatchOptions& options_of(Variant variant) const { return variant == Variant::kPrinted ? printed : ours; }
  /// All options of one method in one variant.
  AnyMatchOptions method(Variant variant, MatchMethod method) const;
  /// The five methods of the paper in one variant, under their own names; with this project's defaults global too.
  std::vector<BenchMethod> methods(Variant variant) const;
};

inline const char* variant_name(Variant variant) {
  return variant == Variant::kPrinted ? "as printed" : "this project's defaults";
}

/// A simulated pair with the world it comes from, for the figures of single pairs.
struct PaperPairs {
  std::shared_ptr<const sim::PairGenerator> generator;  ///< A1 rows of bench-sim: room, office, flat, corridor
  std::size_t count = 0;
};
PaperPairs paper_pairs(const PaperOptions& options);

/// The missing-data features of a scan as fft-icp2 sees them.
MissingFeatures missing_features(const Scan& scan, const AnyMatchOptions& options);

// The parts, in the order of the report.
void paper_images(PaperKit& kit, const PaperPairs& pairs);     ///< Fig. 2, 3
void paper_stability(PaperKit& kit, const PaperPairs& pairs);  ///< missing-data features against the pose difference
void paper_steps(PaperKit& kit, const PaperPairs& pairs);      ///< Fig. 8, 9
void paper_success(PaperKit& kit, const PaperPairs& pairs);    ///< Fig. 10, Tables 2, 3, 4; the user's pairs files
void paper_changes(PaperKit& kit, const PaperPairs& pairs);    ///< why the order of Fig. 10 differs
void paper_drive(PaperKit& kit);                               ///< Fig. 11
void paper_maps(PaperKit& kit);                                ///< Fig. 12

}  // namespace phasescan
