/// SLAM: measurements in, a pose at once for each, a map and all poses at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"
#include "phasescan/slam/options.hpp"
#include "phasescan/slam/result.hpp"

namespace phasescan {

/// Who does the work beside the caller: the library starts no thread by itself. Runs tasks. The library gives it one
/// task at a time and waits for it, where it must, by means of its own.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Runs `task` now or later, on any thread. Every task must be run, also when the executor ends.
  virtual void run(std::function<void()> task) = 0;
};

/// One thread that runs tasks in the order in which they came. Its destructor runs what is left and then joins. It must
/// live longer than what uses it.
class ThreadExecutor final : public Executor {
 public:
  ThreadExecutor();
  ~ThreadExecutor() override;
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;
  void run(std::function<void()> task) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// When the results of loops and graph enter.
enum class Schedule {
  kDeterministic,  ///< at fixed keyframe counts, whatever runs beside: the same bytes always; `add` may wait for a
                   ///< batch
  kLatest,         ///< as soon as they are there: `add` never waits, and answers depend on how fast the executor is
};

/// The map while it is being made: immutable, shared, cheap to take.
class MapSnapshot {
 public:
  virtual ~MapSnapshot() = default;
  virtual std::uint64_t version() const = 0;
  virtual const Pose2& T_map_odom() const = 0;
  virtual std::vector<MapKeyframe> keyframes() const = 0;
  /// Draws it. @cost O(beams of all keyframes drawn), in the caller's thread
  virtual TrinaryMap draw() const = 0;
};

/// What happens beside the scans. Called from within `add` and `finish`, on the caller's thread.
class SlamObserver {
 public:
  virtual ~SlamObserver() = default;
  virtual void on_keyframe(KeyframeId, const Pose2& /*T_odom_base*/, ScanId) {}
  /// A loop that entered the graph, or left it again (`accepted` false).
  virtual void on_loop(const MapEdge&, bool /*accepted*/) {}
  /// A result of loops and graph entered: `T_map_odom` is another now.
  virtual void on_correction(const Pose2& /*before*/, const Pose2& /*after*/, std::uint64_t /*map_version*/) {}
  virtual void on_warning(ScanId, const std::string& /*kind*/, const std::string& /*what*/, bool /*damage*/) {}
};

/// A run as a value: all that is needed to go on with the same bytes. Copies share it.
class SlamState {
 public:
  struct Data;
  explicit SlamState(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }
  std::size_t scans() const;

 private:
  std::shared_ptr<const Data> data_;
};

/// Tracks, closes loops and keeps the map's poses straight. One object per thread. @cost docs/results/slam.md
class Slam {
 public:
  /// @param executor  runs loops and graph beside `add`; null: they run inside it. It must outlive this object.
  /// @throws std::invalid_argument naming the option out of bounds.
  explicit Slam(const SlamOptions& options = {}, Schedule schedule = Schedule::kDeterministic,
                Executor* executor = nullptr);
  /// Goes on from a state: under kDeterministic with the same bytes as the run that it was taken from.
  Slam(const SlamState& state, const SlamOptions& options, Schedule schedule = Schedule::kDeterministic,
       Executor* executor = nullptr);
  ~Slam();
  Slam(Slam&&) noexcept;
  Slam& operator=(Slam&&) noexcept;

  /// The next measurement. Messages that repeat the one before are noticed and count once.
  /// @throws std::invalid_argument for a mounting or a wheel pose that is not finite
  ScanUpdate add(const RangeMeasurement& measurement);

  /// T_map_base at another time, going on as at the last scan; empty before the first tracked scan, where the time is
  /// more than a second away, and while lost.
  std::optional<Pose2> predict(Stamp stamp) const;

  /// The map as the last result left it. Never waits, never null.
  std::shared_ptr<const MapSnapshot> map() const;

  /// What comes next is another drive, perhaps of another robot: tracking begins anew, and nothing ties it to what was
  /// before but loops, which are looked for with no guess.
  void begin_session();

  /// Null: none. It must outlive this object or be taken away before.
  void set_observer(SlamObserver* observer);

  /// In bounded-memory mode the poses of so many scans are kept, beside those of keyframes and of the newest scans: the
  /// longer the run gets, the fewer of those of long ago, and days take no more memory than hours. What is saved and
  /// the result hold the scans that were kept; updates number them as they came. 0: all are kept
  void set_path_limit(std::size_t scans);

  /// All of the run so far, the batch in work included. Waits for it.
  SlamState checkpoint();

  /// Last loops, the full graph, every scan matched once more against the finished map (slam.polish), the map and its
  /// glass. No `add` afterwards. @throws std::logic_error when called twice
  SlamResult finish();

  std::size_t scans() const;
  const SlamOptions& options() const;
  /// CPU time of this thread that the last add() spent on loops and graph [s]; the rest of it was tracking.
  double last_backend_cpu_s() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
