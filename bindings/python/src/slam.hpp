// A run of SLAM that Python holds.
#pragma once

#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "bind.hpp"
#include "options.hpp"
#include "phasescan/slam/slam.hpp"
#include "phasescan/slam/state.hpp"

namespace phasescan::python {

void bind_slam_result(py::module_& module);

/// A state with the options of its run: what a file holds.
struct PyState {
  SavedRun run;
};

/// Several threads of Python may hold it: one works at a time.
struct PySlam {
  PySlam(MappingOptions o, Schedule schedule, bool beside)
      : options(std::move(o)),
        executor(beside ? std::make_unique<ThreadExecutor>() : nullptr),
        slam(options.slam, schedule, executor.get()) {}
  PySlam(const SlamState& state, MappingOptions o, Schedule schedule, bool beside)
      : options(std::move(o)),
        executor(beside ? std::make_unique<ThreadExecutor>() : nullptr),
        slam(state, options.slam, schedule, executor.get()) {}

  /// @throws std::runtime_error after finish()
  Slam& open() {
    if (finished) throw std::runtime_error("the run is finished; expected another Slam");
    return slam;
  }

  MappingOptions options;
  std::unique_ptr<ThreadExecutor> executor;  // outlives `slam`
  Slam slam;
  bool finished = false;
  std::mutex mutex;
};

}  // namespace phasescan::python
