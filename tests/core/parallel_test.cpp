#include "core/parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace phasescan::parallel_test {
namespace {

TEST(Parallel, EveryIndexIsWorkedOnOnceForAnyNumberOfWorkers) {
  for (const std::size_t count : {0U, 1U, 7U, 100U}) {
    for (const std::size_t workers : {1U, 2U, 3U, 16U}) {
      std::vector<int> times(count, 0);
      parallel_for(count, workers, [&](std::size_t i, std::size_t worker) {
        EXPECT_LT(worker, workers);
        ++times[i];
      });
      EXPECT_EQ(times, std::vector<int>(count, 1)) << count << " on " << workers;
    }
  }
}

TEST(Parallel, OneWorkerGoesInOrder) {
  std::vector<std::size_t> seen;
  parallel_for(20, 1, [&](std::size_t i, std::size_t) { seen.push_back(i); });
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i);
}

TEST(Parallel, OfSeveralExceptionsThatOfTheLowestWorkerArrives) {
  for (int attempt = 0; attempt < 20; ++attempt) {
    std::vector<int> ran(4, 0);
    try {
      run_workers(4, [&](std::size_t worker) {
        ran[worker] = 1;
        if (worker > 0) throw std::runtime_error(std::to_string(worker));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "1");
    }
    EXPECT_EQ(ran, std::vector<int>(4, 1)) << "all have been waited for";
  }
}

}  // namespace
}  // namespace phasescan::parallel_test
