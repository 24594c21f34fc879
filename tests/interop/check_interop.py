#!/usr/bin/env python3
"""Independent judges of the formats: what phasescan writes is read by npm's @mcap/core, and what it reads by python3-rosbag.

Usage: check_interop.py PHASESCAN [--bags]; exit 77 (skipped) with one line where a judge is missing.
With --bags: the bags of the recorded data ($PHASESCAN_DATA, else ../shared/data beside the source root). The npm packages are looked for in $INTEROP_MODULES, else in build/interop, where `scripts/test` puts them.
"""
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77


def find_modules():
    """Whether the npm packages are there; names the folder for read_mcap.mjs."""
    folder = pathlib.Path(os.environ.get("INTEROP_MODULES", HERE.parents[1] / "build/interop"))
    os.environ["INTEROP_MODULES"] = str(folder)
    if (folder / "node_modules/@mcap/core").is_dir():
        return True
    print(f"skipped: {folder} holds no node_modules with @mcap/core and @foxglove/rosmsg2-serialization ($INTEROP_MODULES)")
    return False


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def number(value):
    return float(value.replace("Infinity", "inf")) if isinstance(value, str) else float(value)


def same(a, b):
    return (math.isnan(a) and math.isnan(b)) or a == b


def make_log(path, scans=40):
    """A scan log with every kind of missing beam, and odometry."""
    lines = []
    for k in range(scans):
        ranges = [round(1 + 0.01 * ((7 * k + 3 * i) % 300), 3) for i in range(181)]
        ranges[5], ranges[6], ranges[7] = 0, None, 9.0
        lines.append({"angle_min": -1.5, "angle_increment": 0.0166, "range_min": 0.1, "range_max": 6.0, "ranges": ranges,
                      "time_increment": 0.0005, "stamp": 1700000000 + 0.125 * k,
                      "odometry": {"x": 0.1 * k, "y": -0.05 * k, "theta": math.remainder(0.1 * k, 2 * math.pi)}})
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return lines


def check_mcap(phasescan, folder):
    log = folder / "log.jsonl"
    expected = make_log(log)
    run(phasescan, "convert", log, folder / "out.mcap")
    messages = [json.loads(line) for line in run("node", HERE / "read_mcap.mjs", folder / "out.mcap").splitlines()]
    scans = [m for m in messages if m["type"] == "sensor_msgs/msg/LaserScan"]
    poses = [m for m in messages if m["type"] == "nav_msgs/msg/Odometry"]
    transforms = [m for m in messages if m["topic"] == "/tf"]
    assert len(scans) == len(poses) == len(transforms) == len(expected), (len(scans), len(poses), len(transforms))
    assert len([m for m in messages if m["topic"] == "/tf_static"]) == 1
    for want, scan, pose, transform in zip(expected, scans, poses, transforms):
        got = scan["content"]
        stamp = got["header"]["stamp"]
        assert stamp["sec"] + stamp["nsec" if "nsec" in stamp else "nanosec"] * 1e-9 == want["stamp"], stamp
        assert int(scan["log_time"]) == int(want["stamp"] * 8) * 125_000_000
        assert got["header"]["frame_id"] == "laser"
        for field in ("angle_min", "angle_increment", "range_min", "range_max", "time_increment"):
            assert got[field] == float32(want[field]), (field, got[field], want[field])
        assert math.isclose(got["angle_max"], want["angle_min"] + 180 * want["angle_increment"], rel_tol=1e-6)
        assert len(got["ranges"]) == 181 and got["intensities"] == []
        for i, (a, b) in enumerate(zip(got["ranges"], want["ranges"])):
            b = math.nan if b is None else math.inf if b > want["range_max"] else float32(b)
            assert same(number(a), b), (i, a, b)
        for place, turn, frames in (
                (pose["content"]["pose"]["pose"]["position"], pose["content"]["pose"]["pose"]["orientation"],
                 (pose["content"]["header"]["frame_id"], pose["content"]["child_frame_id"])),
                (transform["content"]["transforms"][0]["transform"]["translation"],
                 transform["content"]["transforms"][0]["transform"]["rotation"],
                 (transform["content"]["transforms"][0]["header"]["frame_id"],
                  transform["content"]["transforms"][0]["child_frame_id"]))):
            odometry = want["odometry"]
            assert math.isclose(place["x"], odometry["x"], abs_tol=1e-12) and math.isclose(place["y"], odometry["y"], abs_tol=1e-12)
            assert math.isclose(2 * math.atan2(turn["z"], turn["w"]), odometry["theta"], abs_tol=1e-9) or \
                math.isclose(abs(2 * math.atan2(turn["z"], turn["w"]) - odometry["theta"]), 2 * math.pi, abs_tol=1e-9)
            assert frames == ("odom", "base_link"), frames
    print(f"@mcap/core with @foxglove/rosmsg2-serialization: {len(messages)} messages, every field as written")


def check_bag(phasescan, rosbag, bag, folder):
    """Our reader's scans of a bag against python3-rosbag's, by way of a scan log."""
    log = folder / "bag.jsonl"
    run(phasescan, "convert", bag, log)
    ours = [json.loads(line) for line in log.read_text().splitlines()]
    count = 0
    with rosbag.Bag(bag) as source:
        for _, message, _ in source.read_messages(raw=False):
            if message._type != "sensor_msgs/LaserScan":
                continue
            scan = ours[count]
            count += 1
            assert abs(scan["stamp"] - message.header.stamp.to_sec()) < 1e-6
            assert len(scan["ranges"]) == len(message.ranges)
            for a, b in zip(scan["ranges"], message.ranges):
                if message.range_min <= b <= message.range_max:
                    assert float32(a) == float32(b), (a, b)
                else:
                    assert a is None or not scan["range_min"] <= a <= scan["range_max"], (a, b)
    assert count == len(ours), (count, len(ours))
    print(f"python3-rosbag: {pathlib.Path(bag).name}, {count} scans the same to the last bit")


def main():
    phasescan = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if "--bags" in sys.argv:
            data = pathlib.Path(os.environ.get("PHASESCAN_DATA", HERE.parents[2] / "shared/data")) / "bags"
            bags = sorted(bag for bag in data.glob("*.bag") if bag.read_bytes()[:12] == b"#ROSBAG V2.0")
            if not bags:
                print(f"skipped: no bags in {data} ($PHASESCAN_DATA)")
                return SKIPPED
            try:
                import rosbag
            except ImportError:
                print("skipped: python3-rosbag is not installed")
                return SKIPPED
            for bag in bags:
                check_bag(phasescan, rosbag, bag, folder)
            return 0
        if not find_modules():
            return SKIPPED
        check_mcap(phasescan, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
