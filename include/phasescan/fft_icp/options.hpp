/// Options of the system of [Jiang19] and of the methods it is compared with, one struct per stage: the only home of
/// their defaults. configs/paper-strict.yaml has the values as printed.
#pragma once

#include "phasescan/core/options.hpp"

namespace phasescan {

/// The five methods of [Jiang19] Sec. 5: refinement alone, from the guess or from no motion (icp, ndt); image and FFT
/// alone (fft); FFT, then ICP (fft-icp1); the same with the missing-data shortcut first (fft-icp2).
enum class FftIcpMethod { kIcp, kNdt, kFft, kFftIcp1, kFftIcp2 };
template <>
std::span<const std::string_view> enum_names<FftIcpMethod>();

/// What belongs to no single stage (section `fft_icp`).
struct FftIcpGeneralOptions {
  FftIcpMethod method = FftIcpMethod::kFftIcp2;
  int min_points = 10;
  double min_extent_m = 0.1;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("method", self.method, OptionInfo{"", "icp, ndt, fft, fft-icp1 or fft-icp2"});
    v("min_points", self.min_points, OptionInfo{"", "fewer hits in either scan: no answer", 1, 1e6});
    v("min_extent_m", self.min_extent_m,
      OptionInfo{"m", "all hits of either scan within a box of this diagonal: no answer", 0, 100});
  }
};

/// Section `image`. As printed: size 128 (256 for `fft`), dmax 3.5 m, no blur, no adaptive scale.
struct ImageOptions {
  int size = 128;
  int fft_size = 256;
  double dmax_m = 6.0;
  double adaptive_factor = 1.1;
  double blur_px = 0.8;
  double connect_m = 0.5;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("size", self.size, OptionInfo{"px", "side of the scan image of fft-icp1 and fft-icp2", 16, 2048, true});
    v("fft_size", self.fft_size, OptionInfo{"px", "side of the scan image of fft", 16, 2048, true, "size"});
    v("dmax_m", self.dmax_m,
      OptionInfo{"m", "range shown by the image; the least one where the scale adapts", 0.05, 1000});
    v("adaptive_factor", self.adaptive_factor,
      OptionInfo{"",
                 "the image shows this times the reference's 95th percentile range, at least dmax_m; 0: always dmax_m",
                 0, 10});
    v("blur_px", self.blur_px, OptionInfo{"px", "Gaussian blur of the binary image; 0: none", 0, 8});
    v("connect_m", self.connect_m,
      OptionInfo{"m",
                 "neighbouring hits up to this far apart are joined by a line, so that far walls weigh like near ones",
                 0, 100});
  }
};

/// Section `missing`. Gates are set so that the shortcut never costs a match (docs/fft_icp.md).
struct MissingOptions {
  double min_width_deg = 8.0;
  bool beyond_dmax = true;
  double min_size_deg = 30.0;
  double max_error = 0.3;
  double min_margin = 0.2;
  double verify_score = 0.3;
  double verify_overlap = 0.8;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("min_width_deg", self.min_width_deg, OptionInfo{"deg", "narrower runs of missing beams are dropped", 0, 360});
    v("beyond_dmax", self.beyond_dmax,
      OptionInfo{"", "a return beyond the image's dmax is missing too, as in the paper"});
    v("min_size_deg", self.min_size_deg, OptionInfo{"deg", "Th1: both scans' runs must add up to this", 0, 360});
    v("max_error", self.max_error, OptionInfo{"", "the rotation is accepted below this error of Eq. 7", 0, 1});
    v("min_margin", self.min_margin,
      OptionInfo{"", "and if every rotation more than 15 degrees away has an error larger by this", 0, 1});
    v("verify_score", self.verify_score,
      OptionInfo{"", "a translation peak below this at that rotation: go on with the spectrum; 0: no check", 0, 1});
    v("verify_overlap", self.verify_overlap,
      OptionInfo{"", "a match with a smaller overlap at that rotation: start again with the spectrum; 0: no check", 0,
                 1});
  }
};

/// Taper of the image before its FFT.
enum class ImageWindow { kNone, kHann };
template <>
std::span<const std::string_view> enum_names<ImageWindow>();

/// What is kept of a magnitude.
enum class MagnitudeScale { kLinear, kSqrt, kLog };
template <>
std::span<const std::string_view> enum_names<MagnitudeScale>();

/// Section `spectrum`. The paper says nothing on window, scale or which radii are read.
struct SpectrumOptions {
  ImageWindow window = ImageWindow::kNone;
  MagnitudeScale magnitude = MagnitudeScale::kLinear;
  int angle_bins = 180;
  int radii = 32;
  double radius_min = 0.04;
  double radius_max = 0.75;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("window", self.window, OptionInfo{"", "taper of the image before its FFT for the rotation: none or hann"});
    v("magnitude", self.magnitude, OptionInfo{"", "linear, sqrt or log"});
    v("angle_bins", self.angle_bins, OptionInfo{"", "samples over 180 degrees of a polar ring", 16, 4096, true});
    v("radii", self.radii, OptionInfo{"", "rings of the polar grid", 1, 1024});
    v("radius_min", self.radius_min, OptionInfo{"", "innermost ring, as a share of the Nyquist frequency", 0, 1});
    v("radius_max", self.radius_max,
      OptionInfo{"", "outermost ring, as a share of the Nyquist frequency", 0, 1, false, "radius_min"});
  }
};

/// How the rings of two polar spectra are compared.
enum class RotationMode {
  kPerRadius,  ///< each ring is correlated, the correlations are added
  kRadiusSum,  ///< the rings are added first, one correlation
};
template <>
std::span<const std::string_view> enum_names<RotationMode>();

/// Section `rotation`. As printed: radius-sum, whiten, one candidate, no twin.
struct RotationOptions {
  RotationMode mode = RotationMode::kPerRadius;
  bool whiten = false;
  bool normalise = true;
  int candidates = 1;
  double separation_deg = 8.0;
  bool twin = true;
  bool subbin = true;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("mode", self.mode, OptionInfo{"", "per-radius or radius-sum"});
    v("whiten", self.whiten, OptionInfo{"", "phase correlation along the angle instead of cross-correlation"});
    v("normalise", self.normalise, OptionInfo{"", "every ring weighs the same, whatever its energy (per-radius)"});
    v("candidates", self.candidates, OptionInfo{"", "peaks tried, each with its twin", 1, 64});
    v("separation_deg", self.separation_deg, OptionInfo{"deg", "least distance between two candidates", 0, 90});
    v("twin", self.twin,
      OptionInfo{"",
                 "also try every peak turned by 180 degrees; without, the answer is within 90 degrees of straight on"});
    v("subbin", self.subbin, OptionInfo{"", "peak between the bins by a parabola"});
  }
};

/// What is correlated.
enum class TranslationMode {
  kImage,        ///< the images, in two dimensions
  kProjections,  ///< their projections onto x and onto y (Eq. 22-25), one dimension each: as printed
};
template <>
std::span<const std::string_view> enum_names<TranslationMode>();

/// Section `translation`. As printed: projections, whitening 1.
struct TranslationOptions {
  TranslationMode mode = TranslationMode::kImage;
  double whitening = 0.5;
  bool subpixel = true;
  double min_score = 0.05;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("mode", self.mode, OptionInfo{"", "image or projections"});
    v("whitening", self.whitening,
      OptionInfo{"", "spectra are divided by their magnitude to this power: 0 cross-correlation, 1 phase correlation",
                 0, 1});
    v("subpixel", self.subpixel, OptionInfo{"", "peak between the pixels by a parabola"});
    v("min_score", self.min_score, OptionInfo{"", "a lower peak is no answer", 0, 1});
  }
};

/// Section `icp`. [Jiang19] uses every closest point (gate 0, trim 1); rejecting far pairs is the largest single gain.
struct IcpOptions {
  int max_iterations = 200;
  double gate_m = 0.1;
  double gate_guess_m = 0.3;
  double gate_shrink = 0.6;
  double gate_start_m = 2.0;
  double gate_start_shrink = 0.9;
  int coarse_points = 100;
  double trim = 1.0;
  double tolerance_m = 1e-4;
  double tolerance_deg = 0.005;
  double min_overlap = 0.3;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("max_iterations", self.max_iterations, OptionInfo{"", "iterations at most", 1, 10000});
    v("gate_m", self.gate_m,
      OptionInfo{"m", "closest points farther apart are no pair; 0: every pair counts", 0, 1000});
    v("gate_guess_m", self.gate_guess_m,
      OptionInfo{"m", "gate of the first iteration from a guess or from the FFT's estimate", 0, 1000});
    v("gate_shrink", self.gate_shrink, OptionInfo{"", "factor of that gate per iteration, until gate_m", 0.01, 1});
    v("gate_start_m", self.gate_start_m,
      OptionInfo{"m", "gate of the first iteration where there is no first estimate", 0, 1000});
    v("gate_start_shrink", self.gate_start_shrink,
      OptionInfo{"", "factor of that gate per iteration, until gate_m", 0.01, 1});
    v("coarse_points", self.coarse_points,
      OptionInfo{"", "while the gate shrinks about this many points are paired, evenly chosen; 0: all", 0, 1e6});
    v("trim", self.trim, OptionInfo{"", "share of the pairs kept, the nearest first", 0.05, 1});
    v("tolerance_m", self.tolerance_m, OptionInfo{"m", "converged when an iteration moves less", 0, 1});
    v("tolerance_deg", self.tolerance_deg, OptionInfo{"deg", "converged when an iteration turns less", 0, 180});
    v("min_overlap", self.min_overlap, OptionInfo{"", "usable only with this share of the scan's hits paired", 0, 1});
  }
};

/// Section `ndt`. [Biber03] has one cell size; coarse cells first widen the reach.
struct NdtOptions {
  double cell_m = 2.0;
  int levels = 3;
  int max_iterations = 200;
  int min_cell_points = 3;
  double min_sigma_m = 0.02;
  double tolerance_m = 1e-4;
  double tolerance_deg = 0.005;
  double min_overlap = 0.3;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("cell_m", self.cell_m, OptionInfo{"m", "cell size of the first level", 0.01, 1000});
    v("levels", self.levels, OptionInfo{"", "levels, each with half the cell size of the one before", 1, 10});
    v("max_iterations", self.max_iterations, OptionInfo{"", "Newton steps at most, all levels together", 1, 10000});
    v("min_cell_points", self.min_cell_points, OptionInfo{"", "a cell with fewer points has no Gaussian", 2, 1000});
    v("min_sigma_m", self.min_sigma_m, OptionInfo{"m", "no Gaussian is thinner than this", 1e-4, 100});
    v("tolerance_m", self.tolerance_m, OptionInfo{"m", "a level is done when a step moves less", 0, 1});
    v("tolerance_deg", self.tolerance_deg, OptionInfo{"deg", "and turns less", 0, 180});
    v("min_overlap", self.min_overlap,
      OptionInfo{"", "usable only with this share of the scan's hits within three sigma of a cell", 0, 1});
  }
};

/// All sections that the five methods read.
struct FftIcpOptions {
  FftIcpGeneralOptions fft_icp;
  ImageOptions image;
  MissingOptions missing;
  SpectrumOptions spectrum;
  RotationOptions rotation;
  TranslationOptions translation;
  IcpOptions icp;
  NdtOptions ndt;

  /// Calls v(section_name, section_struct) for each stage, in the order of the pipeline.
  template <class Self, class Visitor>
  static void visit_sections(Self& self, Visitor&& v) {
    v("fft_icp", self.fft_icp);
    v("image", self.image);
    v("missing", self.missing);
    v("spectrum", self.spectrum);
    v("rotation", self.rotation);
    v("translation", self.translation);
    v("icp", self.icp);
    v("ndt", self.ndt);
  }

  /// @throws std::invalid_argument naming section, field and bounds.
  void validate() const;
};

}  // namespace phasescan
