"""How far a map's trajectory is from the truth, and the map as a picture where matplotlib is there: [MAP.png]."""
import sys

import phasescan

drive = phasescan.simulate("office", seed=2, duration_s=40.0)
slam = phasescan.Slam()
for entry in drive:
    slam.add(entry)
result = slam.finish()
error = phasescan.evaluate(result, (drive.stamps, drive.truth), delta=1.0, delta_unit="m")
print(f"{result}\nabsolute: {error['ate_m']['rmse']:.4f} m; over a metre: {error['rpe_m']['mean']:.4f} m, {error['rpe_deg']['mean']:.3f} deg")
if len(sys.argv) > 1:
    phasescan.plot(result).figure.savefig(sys.argv[1], dpi=150)
sys.exit(0 if error["ate_m"]["rmse"] < 0.1 else 1)
