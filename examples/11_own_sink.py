"""Poses into something of your own: here a table in SQLite, a row a scan, written as the scans come."""
import sqlite3
import sys

import phasescan

table = sqlite3.connect(sys.argv[1] if len(sys.argv) > 1 else ":memory:")
table.execute("CREATE TABLE poses (scan INTEGER PRIMARY KEY, stamp REAL, status TEXT, x REAL, y REAL, theta REAL)")
slam = phasescan.Slam()
with table:
    for entry in phasescan.simulate("flat", seed=8, duration_s=10.0):
        update = slam.add(entry)
        table.execute("INSERT INTO poses VALUES (?, ?, ?, ?, ?, ?)", (update.scan, update.stamp, update.status, *update.pose))
    # What the end of a run knows is better than what was known as the scans came.
    corrected = slam.finish().poses
    table.executemany("UPDATE poses SET x = ?, y = ?, theta = ? WHERE scan = ?", [(*pose, k) for k, pose in enumerate(corrected)])
count, way = table.execute("SELECT count(*), max(x) - min(x) FROM poses WHERE status != 'lost'").fetchone()
print(f"{count} poses, {way:.2f} m along x")
sys.exit(0 if count == len(corrected) else 1)
