#!/usr/bin/env python3
"""What `convert` and `slam` write, read back by other hands: g2o, TUM, CARMEN by plain parsing of the formats' own words,
PGM by python3-pil, the MCAP of `slam --mcap` and `live --record` by npm's @mcap/core (as check_interop.py).

Usage: check_writers.py PHASESCAN [--mcap | --pgm]; exit 77 (skipped) with one line where a judge is missing.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from check_interop import HERE, SKIPPED, find_modules, float32, run


def wrap(angle):
    return math.remainder(angle, 2 * math.pi)


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return (a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], wrap(a[2] + b[2]))


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return (-c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2])


def near(a, b, tolerance):
    return math.hypot(a[0] - b[0], a[1] - b[1]) < tolerance and abs(wrap(a[2] - b[2])) < tolerance


def room_log(path, scans=80, beams=240):
    """A robot on an arc through an L-shaped room, with wheel odometry that drifts; the true poses."""
    walls = [(-2.5, -2, 3.5, -2), (3.5, -2, 3.5, 1.5), (3.5, 1.5, 1.5, 1.5), (1.5, 1.5, 1.5, 3), (1.5, 3, -2.5, 3), (-2.5, 3, -2.5, -2)]
    truth, lines = [], []
    pose, wheels = (0.0, -0.5, 0.0), (0.0, 0.0, 0.0)
    for k in range(scans):
        ranges = []
        for i in range(beams):
            angle = pose[2] - math.pi + 2 * math.pi * i / beams
            dx, dy, best = math.cos(angle), math.sin(angle), 0.0
            for x0, y0, x1, y1 in walls:
                ex, ey = x1 - x0, y1 - y0
                det = dx * ey - dy * ex
                if abs(det) < 1e-12:
                    continue
                t = ((x0 - pose[0]) * ey - (y0 - pose[1]) * ex) / det
                u = ((x0 - pose[0]) * dy - (y0 - pose[1]) * dx) / det
                if t > 0 and -1e-9 <= u <= 1 + 1e-9 and (best == 0 or t < best):
                    best = t
            ranges.append(round(best + 0.003 * math.sin(12.9898 * (k * beams + i)), 4))
        truth.append(pose)
        lines.append({"angle_min": -math.pi, "angle_increment": 2 * math.pi / beams, "range_min": 0.1, "range_max": 12.0, "ranges": ranges,
                      "stamp": 1700000000 + 0.25 * k, "odometry": dict(zip(("x", "y", "theta"), wheels))})
        pose = compose(pose, (0.06, 0.0, 0.07))
        wheels = compose(wheels, (0.0615, 0.0, 0.071))
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return lines, truth


def poses_of(lines):
    return [(line["odometry"]["x"], line["odometry"]["y"], line["odometry"]["theta"]) for line in lines]


def read_tum(path):
    out = []
    for line in path.read_text().split("\n")[:-1]:
        fields = line.split(" ")
        assert len(fields) == 8, line
        t, x, y, z, qx, qy, qz, qw = map(float, fields)
        assert z == qx == qy == 0 and math.isclose(qz * qz + qw * qw, 1, abs_tol=1e-6), line
        assert len(fields[0].split(".")[1]) >= 6, line
        out.append((t, (x, y, wrap(2 * math.atan2(qz, qw)))))
    return out


def read_g2o(path):
    nodes, edges = {}, []
    for line in path.read_text().splitlines():
        tag, *fields = line.split()
        if tag == "VERTEX_SE2":
            assert len(fields) == 4 and int(fields[0]) == len(nodes), line
            nodes[int(fields[0])] = tuple(map(float, fields[1:]))
        elif tag == "EDGE_SE2":
            assert len(fields) == 11, line
            i, j = int(fields[0]), int(fields[1])
            numbers = list(map(float, fields[2:]))
            assert i in nodes and j in nodes and i != j, line
            xx, xy, xt, yy, yt, tt = numbers[3:]
            # The information is positive definite: all leading minors are.
            det = xx * (yy * tt - yt * yt) - xy * (xy * tt - yt * xt) + xt * (xy * yt - yy * xt)
            assert xx > 0 and xx * yy - xy * xy > 0 and det > 0, line
            edges.append((i, j, tuple(numbers[:3])))
        else:
            assert tag == "FIX" and int(fields[0]) in nodes, line
    return nodes, edges


def read_yaml(path):
    return {key: value.strip() for key, value in (line.split(":", 1) for line in path.read_text().splitlines() if ":" in line)}


def check_plain(phasescan, folder):
    lines, truth = room_log(folder / "log.jsonl")
    wheels = poses_of(lines)
    run(phasescan, "convert", folder / "log.jsonl", folder / "out.tum")
    tum = read_tum(folder / "out.tum")
    assert len(tum) == len(lines)
    for (t, pose), line, want in zip(tum, lines, wheels):
        assert t == line["stamp"] and near(pose, want, 2e-6), (t, pose, want)
    run(phasescan, "convert", folder / "log.jsonl", folder / "out.g2o")
    nodes, edges = read_g2o(folder / "out.g2o")
    assert len(nodes) == len(lines) and len(edges) == len(lines) - 1
    assert all(near(nodes[k], want, 1e-6) for k, want in enumerate(wheels))
    for i, j, step in edges:
        assert near(step, compose(inverse(nodes[i]), nodes[j]), 1e-6), (i, j)
    run(phasescan, "convert", folder / "log.jsonl", folder / "out.log")
    scans = [line.split() for line in (folder / "out.log").read_text().splitlines() if line.startswith("ROBOTLASER1 ")]
    assert len(scans) == len(lines)
    for words, line, want in zip(scans, lines, wheels):
        n = int(words[8])
        assert n == len(line["ranges"]) and len(words) == 9 + n + 1 + int(words[9 + n]) + 14, len(words)
        assert math.isclose(float(words[2]), line["angle_min"]) and math.isclose(float(words[4]), line["angle_increment"])
        assert [float32(float(w)) for w in words[9:9 + n]] == [float32(r) for r in line["ranges"]]
        tail = words[10 + n + int(words[9 + n]):]
        assert near(tuple(map(float, tail[:3])), want, 1e-6) and near(tuple(map(float, tail[3:6])), want, 1e-6)
        assert float(tail[11]) == line["stamp"], tail
    run(phasescan, "slam", folder / "log.jsonl", "--out", folder / "run", "--no-times")
    trajectory = read_tum(folder / "run/trajectory.tum")
    assert len(trajectory) == len(lines)
    start = compose(trajectory[0][1], inverse(truth[0]))
    worst = max(math.hypot(compose(start, want)[0] - pose[0], compose(start, want)[1] - pose[1]) for (_, pose), want in zip(trajectory, truth))
    assert worst < 0.05, worst
    nodes, edges = read_g2o(folder / "run/graph.g2o")
    # The graph is as its solver left it; the trajectory is polished against the map once more.
    assert len(edges) >= len(nodes) - 1 and all(any(near(node, pose, 5e-3) for _, pose in trajectory) for node in nodes.values())
    print(f"TUM, g2o and CARMEN as written; slam: {len(trajectory)} poses within {1000 * worst:.0f} mm, {len(nodes)} nodes, {len(edges)} edges")


def read_map(folder, name, image):
    about = read_yaml(folder / f"{name}.yaml")
    assert about["image"] == f"{name}.pgm" and about["negate"] in ("0", "false") and about.get("mode", "trinary") == "trinary", about
    assert float(about["occupied_thresh"]) == 0.65 and 0.19 < float(about["free_thresh"]) <= 0.196, about
    origin = [float(word) for word in about["origin"].strip("[]").split(",")]
    with image.open(folder / f"{name}.pgm") as picture:
        assert picture.mode == "L" and picture.format == "PPM", picture
        width, height = picture.size
        pixels = list(picture.getdata())
    assert set(pixels) <= {0, 205, 254}, set(pixels)
    return float(about["resolution"]), origin, width, height, pixels


def check_pgm(phasescan, folder):
    """The map as map_server reads it: row 0 is the top, the origin the lower left pixel."""
    from PIL import Image
    lines, truth = room_log(folder / "log.jsonl")
    run(phasescan, "convert", folder / "log.jsonl", folder / "drawn.pgm")
    run(phasescan, "slam", folder / "log.jsonl", "--out", folder / "run", "--no-times")
    for place, name, poses in ((folder, "drawn", poses_of(lines)), (folder / "run", "map", [p for _, p in read_tum(folder / "run/trajectory.tum")])):
        resolution, origin, width, height, pixels = read_map(place, name, Image)
        hits = free = ends = 0
        for line, pose in zip(lines, poses):
            for i in range(0, len(line["ranges"]), 5):
                angle = pose[2] + line["angle_min"] + i * line["angle_increment"]
                for share in (1.0, 0.5):
                    distance = share * line["ranges"][i]
                    column = math.floor((pose[0] + distance * math.cos(angle) - origin[0]) / resolution)
                    row = math.floor((pose[1] + distance * math.sin(angle) - origin[1]) / resolution)
                    around = [pixels[(height - 1 - r) * width + c] for r in range(max(0, row - 1), min(height, row + 2))
                              for c in range(max(0, column - 1), min(width, column + 2))]
                    if share == 1.0:
                        ends += 1
                        hits += 0 in around
                    else:
                        free += pixels[(height - 1 - row) * width + column] == 254
        assert hits > 0.8 * ends and free > 0.95 * ends, (name, hits, free, ends)
        print(f"python3-pil: {name}.pgm {width} x {height}, {hits} of {ends} hits on walls, {free} of {ends} halfway points free")


def check_mcap(phasescan, folder):
    lines, _ = room_log(folder / "log.jsonl")
    run(phasescan, "slam", folder / "log.jsonl", "--out", folder / "run", "--mcap", folder / "run.mcap", "--no-times")
    messages = [json.loads(line) for line in run("node", HERE / "read_mcap.mjs", folder / "run.mcap").splitlines()]
    trajectory = read_tum(folder / "run/trajectory.tum")

    def stamp_of(header):
        return header["stamp"]["sec"] + header["stamp"].get("nsec", header["stamp"].get("nanosec", 0)) * 1e-9

    def pose_of(place, turn):
        return (place["x"], place["y"], wrap(2 * math.atan2(turn["z"], turn["w"])))

    scans = [m["content"] for m in messages if m["type"] == "sensor_msgs/msg/LaserScan"]
    assert [stamp_of(s["header"]) for s in scans] == [line["stamp"] for line in lines]
    for scan, line in zip(scans, lines):
        assert scan["header"]["frame_id"] == "laser" and scan["ranges"] == [float32(r) for r in line["ranges"]]
    frames = {}
    for message in messages:
        for transform in message["content"].get("transforms", []):
            edge = (transform["header"]["frame_id"], transform["child_frame_id"])
            assert message["topic"] == ("/tf_static" if edge[1] == "laser" else "/tf"), (message["topic"], edge)
            move = transform["transform"]
            frames.setdefault(edge, []).append((stamp_of(transform["header"]), pose_of(move["translation"], move["rotation"])))
    assert set(frames) == {("map", "odom"), ("odom", "base_link"), ("base_link", "laser")}, set(frames)
    assert len(frames["base_link", "laser"]) == 1
    assert len(frames["map", "odom"]) == len(frames["odom", "base_link"]) == len(trajectory)
    for (t, pose), (t1, correction), (t2, odometry) in zip(trajectory, frames["map", "odom"], frames["odom", "base_link"]):
        assert t == t1 == t2 and near(compose(correction, odometry), pose, 3e-6), t
    (path,) = [m["content"] for m in messages if m["type"] == "nav_msgs/msg/Path"]
    assert path["header"]["frame_id"] == "map" and len(path["poses"]) == len(trajectory)
    for stamped, (t, pose) in zip(path["poses"], trajectory):
        assert stamp_of(stamped["header"]) == t and near(pose_of(stamped["pose"]["position"], stamped["pose"]["orientation"]), pose, 3e-6)
    (grid,) = [m["content"] for m in messages if m["type"] == "nav_msgs/msg/OccupancyGrid"]
    about, info = read_yaml(folder / "run/map.yaml"), grid["info"]
    origin = [float(word) for word in about["origin"].strip("[]").split(",")]
    assert grid["header"]["frame_id"] == "map" and math.isclose(info["resolution"], float(about["resolution"]), rel_tol=1e-6)
    assert near(pose_of(info["origin"]["position"], info["origin"]["orientation"]), origin, 1e-6), (info["origin"], origin)
    raw = (folder / "run/map.pgm").read_bytes()
    width, height = info["width"], info["height"]
    assert raw.startswith(b"P5") and str(width).encode() in raw[:40] and len(grid["data"]) == width * height
    pixels, values = raw[-width * height:], {254: 0, 0: 100, 205: -1}
    # Row 0 of the message is at the origin, below; row 0 of the picture is the top.
    assert all(grid["data"][r * width + c] == values[pixels[(height - 1 - r) * width + c]] for r in range(height) for c in range(width))
    print(f"@mcap/core: slam --mcap, {len(messages)} messages: {len(scans)} scans, map -> odom -> base_link -> laser = trajectory, "
          f"path of {len(path['poses'])}, grid {width} x {height} = map.pgm")


def check_recording(phasescan, folder):
    """What `live --record` leaves: finished, and killed while it was written."""
    lines, _ = room_log(folder / "log.jsonl", scans=12)
    run(phasescan, "live", "--replay", folder / "log.jsonl", "--record", folder / "whole.mcap")
    messages = [json.loads(line) for line in run("node", HERE / "read_mcap.mjs", folder / "whole.mcap").splitlines()]
    topics = {m["topic"]: m["type"] for m in messages}
    assert topics == {"/scan": "sensor_msgs/msg/LaserScan", "/tf": "tf2_msgs/msg/TFMessage", "/tf_static": "tf2_msgs/msg/TFMessage",
                      "/map": "nav_msgs/msg/OccupancyGrid", "/path": "nav_msgs/msg/Path", "/status": "std_msgs/msg/String",
                      "/pose": "geometry_msgs/msg/PoseWithCovarianceStamped", "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}, topics
    scans = [m["content"] for m in messages if m["topic"] == "/scan"]
    assert [s["ranges"] for s in scans] == [[float32(r) for r in line["ranges"]] for line in lines]
    poses = [m["content"] for m in messages if m["topic"] == "/pose"]
    for pose in poses:
        covariance = pose["pose"]["covariance"]
        assert pose["header"]["frame_id"] == "map" and covariance[0] > 0 and covariance[7] > 0 and covariance[35] > 0 and covariance[14] == 0
        assert covariance[1] == covariance[6] and covariance[5] == covariance[30]
    status = [m["content"]["data"] for m in messages if m["topic"] == "/status"]
    assert len(status) == len(lines) and set(status[1:]) == {"ok"}, status
    diagnostics = [m["content"]["status"] for m in messages if m["topic"] == "/diagnostics"]
    assert diagnostics[-1][0]["message"] == "ok" and diagnostics[-1][0]["level"] == 0, diagnostics[-1]
    assert {v["key"]: v["value"] for v in diagnostics[-1][0]["values"]}["scans"] == str(len(lines))
    process = subprocess.Popen([phasescan, "live", "--replay", folder / "log.jsonl", "--record", folder / "cut.mcap"], stderr=subprocess.DEVNULL)
    time.sleep(2.0)
    process.kill()
    process.wait()
    cut = [json.loads(line) for line in run("node", HERE / "read_mcap.mjs", folder / "cut.mcap", "--unfinished").splitlines()]
    kept = [m["content"]["ranges"] for m in cut if m["topic"] == "/scan"]
    assert 2 <= len(kept) < len(lines) and kept == [s["ranges"] for s in scans[:len(kept)]], len(kept)
    print(f"@mcap/core: live --record, {len(messages)} messages on {len(topics)} topics; killed after 2 s, {len(kept)} scans")


def main():
    phasescan = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if "--mcap" in sys.argv:
            if not find_modules():
                return SKIPPED
            check_mcap(phasescan, folder)
            check_recording(phasescan, folder)
        elif "--pgm" in sys.argv:
            try:
                import PIL  # noqa: F401
            except ImportError:
                print("skipped: python3-pil is not installed")
                return SKIPPED
            check_pgm(phasescan, folder)
        else:
            check_plain(phasescan, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
