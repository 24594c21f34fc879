/// Seeded random numbers that give the same values with every compiler and standard library.
#pragma once

#include <cstdint>

namespace phasescan {

/// xoshiro256** generator [Blackman18] with splitmix64 seeding. Streams with different seeds are independent for our
/// use.
class Random {
 public:
  explicit Random(std::uint64_t seed);

  /// 64 uniform bits.
  std::uint64_t bits();
  /// Uniform in [0, 1).
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high);
  /// Uniform integer in [0, n), n >= 1.
  std::uint64_t below(std::uint64_t n);
  /// Normal with the given mean and standard deviation (polar method; the spare value is kept).
  double normal(double mean = 0.0, double sigma = 1.0);
  /// True with probability p.
  bool chance(double p) { return uniform() < p; }
  /// A new seed for an independent stream, e.g. one per pair, so that pair k does not depend on how many came before.
  static std::uint64_t derive(std::uint64_t seed, std::uint64_t stream);

 private:
  std::uint64_t state_[4];
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace phasescan
