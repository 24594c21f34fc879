// What odometry and SLAM tell alike.
#pragma once

#include "bind.hpp"
#include "phasescan/odometry/odometry.hpp"

namespace phasescan::python {

py::dict diagnostics_dict(const TrackingDiagnostics& diagnostics);

inline constexpr const char* kAddDoc = R"(Takes the next scan, in order of time.

Parameters
----------
scan : Scan, RangeMeasurement, LogEntry or array_like, shape (n,)
T_base_laser : pose, optional
    Where the laser sits on the robot [m, rad].
T_odom_base : pose, optional
    Where wheel odometry has the robot at the scan's stamp [m, rad].
laser : str
    Scans of one name are of one laser.)";

}  // namespace phasescan::python
