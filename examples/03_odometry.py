"""Follows a robot through its scans, and says how far it is off in the end."""
import sys

import numpy as np

import phasescan

drive = phasescan.simulate("flat", seed=5, duration_s=20.0)
odometry = phasescan.Odometry(keyframe_distance_m=0.3)
updates = [odometry.add(entry) for entry in drive]
last = updates[-1]
print(f"{len(updates)} scans, {last}")
print(f"standard deviation of x {np.sqrt(last.covariance[0, 0]):.4f} m, speed {last.twist.vx:.2f} m/s")
error = phasescan.evaluate((drive.stamps, np.array([u.pose for u in updates])), (drive.stamps, drive.truth))
print(f"off by {error['ate_m']['mean']:.4f} m on average")
sys.exit(0 if error["ate_m"]["mean"] < 0.05 else 1)
