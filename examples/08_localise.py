"""Finds a robot on a map that is known, with no first guess, and follows it: [MAP.yaml LOG]."""
import sys

import numpy as np

import phasescan

truth = None
if len(sys.argv) > 2:
    grid, log = phasescan.TrinaryMap.load(sys.argv[1]), phasescan.open_log(sys.argv[2])
else:  # a map of one drive through a flat; another drive to be found on it
    slam = phasescan.Slam()
    first = phasescan.simulate("flat:3", seed=3, duration_s=60.0)
    for entry in first:
        slam.add(entry)
    grid = slam.finish().map
    second = phasescan.simulate("flat:3", seed=4, duration_s=40.0)
    log = [second[k] for k in range(100, 160)]
    truth = second.truth[159]

localizer = phasescan.Localizer(phasescan.LocalizationMap.from_grid(grid))
for entry in log:
    update = localizer.add(entry)
    if update.usable and update.scan % 10 == 0:
        x, y, theta = update.pose
        print(f"{update.stamp:8.2f} s  x {x:6.2f} m  y {y:6.2f} m  heading {np.degrees(theta):6.1f} deg  {update.confidence:.3f}")
print(update)
if truth is None:
    sys.exit(0)
T_world_map = phasescan.Pose2(*first.truth[0])  # the map begins where the robot stood at the first scan
off = T_world_map * update.pose
sys.exit(0 if update.usable and np.hypot(off.x - truth[0], off.y - truth[1]) < 0.1 else 1)
