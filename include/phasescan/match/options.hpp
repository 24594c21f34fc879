/// Every option of a match, one struct per stage: the only home of their defaults.
#pragma once

#include "phasescan/core/options.hpp"
#include "image/rasterize.hpp"
#include "match/mh_options.hpp"
#include "refine/icp.hpp"
#include "refine/ndt.hpp"
#include "rotation/from_spectrum.hpp"
#include "scan/missing.hpp"
#include "spectrum/spectrum.hpp"
#include "translation/phase_correlation.hpp"

namespace phasescan {

/// The matchers: the five of [Jiang19] Sec. 5 and this project's own.
enum class MatchMethod { kIcp, kNdt, kFft, kFftIcp1, kFftIcp2, kFftMh };
template <>
std::span<const std::string_view> enum_names<MatchMethod>();

/// What belongs to no single stage (section `match`).
struct MatchGeneralOptions {
  MatchMethod method = MatchMethod::kFftMh;
  bool fast = false;
  double min_confidence = 0.9;
  int min_points = 10;
  double min_extent_m = 0.1;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("method", self.method, OptionInfo{"", "icp, ndt, fft, fft-icp1, fft-icp2 or fft-mh"});
    v("fast", self.fast, OptionInfo{"", "trade a little robustness for time (fft-mh)"});
    v("min_confidence", self.min_confidence, OptionInfo{"", "usable above this probability (fft-mh)", 0, 1});
    v("min_points", self.min_points, OptionInfo{"", "fewer hits in either scan: no answer", 1, 1e6});
    v("min_extent_m", self.min_extent_m,
      OptionInfo{"m", "all hits of either scan within a box of this diagonal: no answer", 0, 100});
  }
};

/// All sections a match reads.
struct MatchOptions {
  MatchGeneralOptions match;
  ImageOptions image;
  MissingOptions missing;
  SpectrumOptions spectrum;
  RotationOptions rotation;
  TranslationOptions translation;
  IcpOptions icp;
  NdtOptions ndt;
  MhOptions mh;

  /// Calls v(section_name, section_struct) for each stage, in the order of the pipeline.
  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("match", self.match);
    v("image", self.image);
    v("missing", self.missing);
    v("spectrum", self.spectrum);
    v("rotation", self.rotation);
    v("translation", self.translation);
    v("icp", self.icp);
    v("ndt", self.ndt);
    v("mh", self.mh);
  }

  /// @throws std::invalid_argument naming section, field and bounds.
  void validate() const;
};

}  // namespace phasescan
