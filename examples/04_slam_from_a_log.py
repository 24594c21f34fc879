"""Makes a map of a log of any readable format: LOG [MAP.yaml]. Loops and graph run beside tracking."""
import sys

import phasescan

if len(sys.argv) < 2:
    sys.exit(f"usage: {sys.argv[0]} LOG [MAP.yaml]")
try:
    slam = phasescan.Slam(threads=2)
    for entry in phasescan.open_log(sys.argv[1]):
        update = slam.add(entry)
        if update.status == "lost":
            print(f"scan {update.scan}: lost")
    result = slam.finish()
except (phasescan.InputError, phasescan.SystemError) as error:
    sys.exit(f"phasescan: {error}")
print(result)
for kind, oddity in result.oddities.items():
    print(f"{kind}: {oddity['what']} ({oddity['count']} times)")
if len(sys.argv) > 2:
    result.map.save(sys.argv[2])
sys.exit(0 if len(result.keyframe_poses) > 0 else 1)
