// After the first match the image, spectrum, rotation and translation stages allocate nothing, and no match makes
// memory grow.
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "fft_icp/image_stages.hpp"
#include "match/global_matcher.hpp"
#include "fft_icp/rotation_proposers.hpp"
#include "methods/any_matcher.hpp"
#include "support/rooms.hpp"

namespace {

std::atomic<long> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* p =
      alignment > 0 ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment) : std::malloc(size);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size, 0);
}
void* operator new[](std::size_t size) {
  return counted(size, 0);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return counted(size, 0);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return counted(size, 0);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, const std::nothrow_t&) noexcept {
  std::free(p);
}
void operator delete[](void* p, const std::nothrow_t&) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace phasescan::allocation_test {
namespace {

/// What a match does before its refinement, and how often it allocates.
long allocations_of_stages(ImageStages& stages, ImageReference& reference, ScanPoints (&points)[2], const Scan& a,
                           const Scan& b) {
  const long before = allocations;
  MatchTimes ms;
  scan_to_points(a, points[0]);
  scan_to_points(b, points[1]);
  stages.prepare(a, points[0], reference, ms);
  stages.finish(reference, ms);
  stages.rotation_from_missing(reference, b, ms);
  for (const RotationCandidate& candidate : stages.rotations_from_spectrum(reference, points[1], ms)) {
    stages.translate(reference, points[1], candidate.theta, true, ms);
  }
  return allocations - before;
}

TEST(Allocation, TheImageStagesAllocateNothingAfterTheirFirstUse) {
  for (const TranslationMode mode : {TranslationMode::kImage, TranslationMode::kProjections}) {
    FftIcpOptions options;
    options.translation.mode = mode;
    options.spectrum.window = mode == TranslationMode::kImage ? ImageWindow::kNone : ImageWindow::kHann;
    ImageStages stages(options, options.image.size, true);
    ImageReference reference;
    ScanPoints points[2];
    const Scan a = test::cast_room({}, 360, 0.01, 0.3), b = test::cast_room({0.3, 0.1, 1.0}, 360, 0.01, 0.3, 2);
    EXPECT_GT(allocations_of_stages(stages, reference, points, a, b), 0) << "the counter counts";
    allocations_of_stages(stages, reference, points, b, a);
    EXPECT_EQ(allocations_of_stages(stages, reference, points, a, b), 0);
    EXPECT_EQ(allocations_of_stages(stages, reference, points, b, a), 0);
  }
}

TEST(Allocation, TheGlobalSearchAllocatesNothingAfterItsFirstUse) {
  const Scan a = test::cast_room({}, 360, 0.01, 0.1), b = test::cast_room({0.3, 0.1, 1.0}, 360, 0.01, 0.1, 2);
  for (const RotationSearch rotations :
       {RotationSearch::kAutomatic, RotationSearch::kSweep, RotationSearch::kNormals}) {
    GlobalOptions options;
    options.rotations = rotations;
    GlobalSearch search(options);
    PrepareWorkspace work;
    PreparedScan reference, scan;
    SearchOutcome outcome;
    const auto run = [&](const Scan& of_ref, const Scan& of_scan) {
      const long before = allocations;
      prepare_scan(of_ref, {}, search.prepare_options(true), work, reference);
      prepare_scan(of_scan, {}, search.prepare_options(false), work, scan);
      search.run(reference, scan, {}, nullptr, outcome);
      return allocations - before;
    };
    EXPECT_GT(run(a, b), 0) << "the counter counts";
    run(b, a);
    EXPECT_EQ(run(a, b), 0) << to_string(rotations);
    EXPECT_EQ(run(b, a), 0) << to_string(rotations);
  }
}

TEST(Allocation, RotationProposersAllocateNothingAfterTheirFirstUse) {
  const Scan a = test::cast_room({}, 360, 0.01, 0.1), b = test::cast_room({0.3, 0.1, 1.0}, 360, 0.01, 0.1, 2);
  GlobalSearch search{GlobalOptions{}};
  PrepareWorkspace work;
  PreparedScan prepared[2];
  prepare_scan(a, {}, search.prepare_options(true), work, prepared[0]);
  prepare_scan(b, {}, search.prepare_options(true), work, prepared[1]);
  for (const bool spectrum : {true, false}) {
    const auto proposer = spectrum ? propose_from_spectrum(8) : propose_from_missing(0.05);
    const auto of_a = proposer->make_cue(), of_b = proposer->make_cue();
    std::vector<RotationHypothesis> out;
    const auto run = [&] {
      const long before = allocations;
      out.clear();
      proposer->describe(a, *of_a);
      proposer->describe(b, *of_b);
      proposer->propose(prepared[0], *of_a, prepared[1], *of_b, out);
      proposer->describe(b, *of_a);
      proposer->describe(a, *of_b);
      proposer->propose(prepared[1], *of_a, prepared[0], *of_b, out);
      return allocations - before;
    };
    EXPECT_GT(run(), 0) << "the counter counts";
    EXPECT_EQ(run(), 0) << spectrum;
  }
}

TEST(Allocation, NoMethodMakesMemoryGrow) {
  const Scan a = test::cast_room({}, 360, 0.01), b = test::cast_room({0.3, 0.1, 1.0}, 360, 0.01, 0.0, 2);
  for (const MatchMethod method : {MatchMethod::kIcp, MatchMethod::kNdt, MatchMethod::kFft, MatchMethod::kFftIcp1,
                                   MatchMethod::kFftIcp2, MatchMethod::kGlobal}) {
    AnyMatchOptions options;
    options.match.method = method;
    AnyMatcher matcher(options);
    const auto run = [&](int times) {
      for (int i = 0; i < times; ++i) {
        matcher.match(a, b);
        matcher.match(b, a);
      }
      return mallinfo2().uordblks;
    };
    const std::size_t early = run(3);
    EXPECT_EQ(run(20), early) << to_string(method);
  }
}

}  // namespace
}  // namespace phasescan::allocation_test
