/// The statistics that bench tables are made of.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace phasescan {

/// A range of values that is believed to hold the true one.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};

/// 95 % interval of a share, `hits` of `n` [Wilson27]; [0, 1] for n = 0.
Interval wilson_interval(std::size_t hits, std::size_t n);

/// Mean, sample variance (n - 1), standard deviation and median. All NaN for no values; variance 0 for one.
struct Moments {
  std::size_t n = 0;
  double mean, variance, std, median;
};
Moments moments(std::span<const double> values);

/// Value below which the share q of the values lies, linear between ranks (type 7 of [Hyndman96]). NaN for no values.
double quantile(std::vector<double> values, double q);

/// What a method said of an answer, and whether the answer was right.
struct Judgement {
  double confidence = 0.0;
  bool right = false;
};

/// Area under the ROC curve: the chance that a right answer has more confidence than a wrong one, ties count half.
/// NaN unless there are right and wrong ones. O(n log n).
double area_under_roc(std::span<const Judgement> judgements);

/// One of `bins` equal parts of [0, 1] of the confidence.
struct ReliabilityBin {
  std::size_t n = 0;
  double confidence = 0.0;  ///< mean in the bin
  double right = 0.0;       ///< share of right answers
};
std::vector<ReliabilityBin> reliability(std::span<const Judgement> judgements, int bins = 10);

/// Expected calibration error [Naeini15]: |share right - mean confidence| averaged over the bins by their counts. NaN
/// for none.
double calibration_error(std::span<const Judgement> judgements, int bins = 10);

}  // namespace phasescan
