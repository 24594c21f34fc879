/// Times of one laser's scans: their usual distance, and where they leave it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "phasescan/core/time.hpp"

namespace phasescan {

/// Counts distances between stamps in bins of 5 %, from 10 us to days.
class StampStatistics {
 public:
  void add(Stamp stamp) {
    if (count_++ > 0) {
      const Stamp step = stamp - last_;
      if (step < 0) ++backwards_;
      if (step == 0) ++repeated_;
      if (step > 0) ++steps_[bin(static_cast<double>(step) * 1e-9)];
    }
    last_ = stamp;
  }

  std::size_t count() const { return count_; }
  std::size_t backwards() const { return backwards_; }
  std::size_t repeated() const { return repeated_; }
  /// The median distance [s], within 5 %; 0 with fewer than two stamps that follow one another.
  double median_seconds() const {
    const std::size_t half = (total() + 1) / 2;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      seen += steps_[i];
      if (half > 0 && seen >= half) return seconds(i);
    }
    return 0.0;
  }
  /// Distances longer or shorter than a multiple of the median.
  std::size_t longer_than(double seconds) const {
    return count_if([&](double s) { return s > seconds; });
  }
  std::size_t shorter_than(double seconds) const {
    return count_if([&](double s) { return s < seconds; });
  }

 private:
  static constexpr double kShortest = 1e-5;
  static constexpr double kRatio = 1.05;

  static std::size_t bin(double s) {
    const double at = std::log(s / kShortest) / std::log(kRatio);
    return at <= 0.0 ? 0 : at >= 511.0 ? 511 : static_cast<std::size_t>(at);
  }
  static double seconds(std::size_t bin) { return kShortest * std::pow(kRatio, static_cast<double>(bin) + 0.5); }
  std::size_t total() const {
    return count_if([](double) { return true; });
  }
  template <class Test>
  std::size_t count_if(Test test) const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < steps_.size(); ++i) sum += test(seconds(i)) ? steps_[i] : 0;
    return sum;
  }

  std::array<std::size_t, 512> steps_{};
  std::size_t count_ = 0, backwards_ = 0, repeated_ = 0;
  Stamp last_ = 0;
};

}  // namespace phasescan
