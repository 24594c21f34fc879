// The Python module phasescan._core: names and shapes of the library for numpy. The package around it is in
// ../phasescan.
#include "bind.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace phasescan::python;
  module.doc() = "Scan matching, SLAM and logs of 2-D lidars. Use it as `import phasescan`.";
  module.attr("__version__") = PHASESCAN_VERSION;
  pybind11::options options;
  options.disable_function_signatures();  // they stand in the stubs, with shapes
  bind_errors(module);
  bind_poses(module);
  bind_options(module);
  bind_scans(module);
  bind_match(module);
  bind_map(module);
  bind_odometry(module);
  bind_logs(module);
  bind_slam(module);
  bind_live(module);
  bind_simulation(module);
  bind_evaluation(module);
  bind_localize(module);
  bind_places(module);
}
