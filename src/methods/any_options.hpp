/// Options of all six methods together: what a configuration file holds and `--method` chooses from.
#pragma once

#include "phasescan/core/options.hpp"
#include "phasescan/fft_icp/options.hpp"
#include "phasescan/match/options.hpp"

namespace phasescan {

/// The methods that `match` and `bench` know: the five of [Jiang19] Sec. 5 and the default.
enum class MatchMethod { kIcp, kNdt, kFft, kFftIcp1, kFftIcp2, kGlobal };
template <>
std::span<const std::string_view> enum_names<MatchMethod>();

/// The default method's earlier name is still understood.
template <>
inline constexpr std::string_view current_enum_name<MatchMethod>(std::string_view text) {
  return text == "fft-mh" ? "global" : text;
}

/// Whose rotations the default method correlates at; those of the paper are for comparison.
enum class RotationsFrom { kOwn, kSpectrum, kMissing };
template <>
std::span<const std::string_view> enum_names<RotationsFrom>();

/// Section `match` of a configuration: the method, and what the methods' own general sections hold.
struct MatchSection {
  MatchMethod method = MatchMethod::kGlobal;
  RotationsFrom rotations = RotationsFrom::kOwn;
  MatchGeneralOptions general;
  double min_extent_m = FftIcpGeneralOptions{}.min_extent_m;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("method", self.method, OptionInfo{"", "icp, ndt, fft, fft-icp1, fft-icp2 or global"});
    MatchGeneralOptions::visit(self.general, v);
    v("min_extent_m", self.min_extent_m,
      OptionInfo{"m", "all hits of either scan within a box of this diagonal: no answer (not global)", 0, 100});
    v("rotations", self.rotations,
      OptionInfo{"", "rotations that global tries: its own, or spectrum or missing as in fft-icp2, to compare"});
  }
};

/// All sections that any method reads.
struct AnyMatchOptions {
  MatchSection match;
  ImageOptions image;
  MissingOptions missing;
  SpectrumOptions spectrum;
  RotationOptions rotation;
  TranslationOptions translation;
  IcpOptions icp;
  NdtOptions ndt;
  GlobalOptions global;

  /// Calls v(section_name, section_struct) for each.
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
    v("global", self.global);
  }

  /// @throws std::invalid_argument naming section, field and bounds.
  void validate() const;

  /// What the default matcher reads of it.
  MatchOptions for_global() const;
  /// What one of the paper's methods reads of it.
  FftIcpOptions for_fft_icp(FftIcpMethod method) const;
};

}  // namespace phasescan
