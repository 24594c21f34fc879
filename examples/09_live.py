"""A plugged-in lidar: poses as they come. With no argument a simulated one, for two seconds; else PORT (auto, /dev/ttyUSB0)."""
import sys

import phasescan

source = phasescan.live(sys.argv[1]) if len(sys.argv) > 1 else phasescan.live(demo=True)
with source as sensor:
    for update in sensor:
        x, y, theta = update.pose
        print(f"{update.stamp:10.3f} s  {update.status:<12} x {x:6.2f} m  y {y:6.2f} m  {update.latency_ms:5.1f} ms late")
        if len(sys.argv) == 1 and update.update.scan >= 10:
            break
    print(sensor.map())
