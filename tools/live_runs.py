"""Whole live runs for scripts/live_results: an emulated sensor, `phasescan live` at the other end, poses against the truth."""
import bisect
import json
import math
import pathlib
import signal
import subprocess
import tempfile


def json_lines(text):
    """The whole lines: the last one may have been cut by a kill."""
    return [json.loads(line) for line in text.splitlines() if line.endswith("}")]


def read_tum(path):
    rows = [[float(word) for word in line.split()] for line in path.read_text().splitlines() if line]
    return [(row[0], row[1], row[2], 2 * math.atan2(row[6], row[7])) for row in rows]


def pose_at(truth, stamps, stamp):
    """The pose at a time between two of them, or None."""
    i = bisect.bisect_left(stamps, stamp)
    if i == 0 or i >= len(truth):
        return None
    a, b = truth[i - 1], truth[i]
    share = (stamp - a[0]) / (b[0] - a[0])
    turn = math.remainder(b[3] - a[3], 2 * math.pi)
    return a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2]), a[3] + share * turn


def aligned_errors(pairs):
    """Distances of points from their true places, after the rigid motion that makes them least [m]."""
    n = len(pairs)
    mean = [sum(pair[side][axis] for pair in pairs) / n for side in (0, 1) for axis in (0, 1)]
    sin = cos = 0.0
    for (x, y), (u, v) in pairs:
        dx, dy, du, dv = x - mean[0], y - mean[1], u - mean[2], v - mean[3]
        cos += dx * du + dy * dv
        sin += dx * dv - dy * du
    turn = math.atan2(sin, cos)
    c, s = math.cos(turn), math.sin(turn)
    return [math.hypot(mean[2] + c * (x - mean[0]) - s * (y - mean[1]) - u, mean[3] + s * (x - mean[0]) + c * (y - mean[1]) - v)
            for (x, y), (u, v) in pairs]


def worst_from_first(pairs):
    """How far the poses (x, y, theta) are at most from their true ones, both seen from the first of them [m]."""
    def seen_from(first, pose):
        c, s = math.cos(first[2]), math.sin(first[2])
        dx, dy = pose[0] - first[0], pose[1] - first[1]
        return c * dx + s * dy, -s * dx + c * dy
    worst = 0.0
    for pose, true in pairs:
        (x, y), (u, v) = seen_from(pairs[0][0], pose), seen_from(pairs[0][1], true)
        worst = max(worst, math.hypot(x - u, y - v))
    return worst


def drive(command, sensor, seconds, faults, more=()):
    """A drive of `seconds` through a flat: the JSON lines of `live`, its exit code, and the errors of its poses."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        truth = folder / "truth.tum"
        emulator = subprocess.Popen([command, "emulate", "--sensor", sensor, "--world", "flat", "--duration", str(seconds), "--link", folder / "lidar",
                                     "--truth", truth, *map(str, faults)], stdout=subprocess.PIPE, text=True)
        port = emulator.stdout.readline().strip()
        with open(folder / "lines", "wb") as out, open(folder / "said", "wb") as said:
            live = subprocess.Popen([command, "live", "--port", port, "--sensor", sensor, "--json", "--serve", "off", *more], stdout=out, stderr=said)
            emulator.wait()
            live.send_signal(signal.SIGINT)
            code = live.wait()
        lines = json_lines((folder / "lines").read_text())
        path = read_tum(truth)
        said = (folder / "said").read_text()
    stamps = [row[0] for row in path]
    found = [(line, pose_at(path, stamps, line["stamp"])) for line in lines if line["status"] not in ("lost", "initialising")]
    found = [(line, true) for line, true in found if true is not None]
    result = {"code": code, "lines": lines, "said": said, "ate_m": 99.0, "worst_ok_m": 0.0, "scans": len(lines)}
    between = sorted(b["stamp"] - a["stamp"] for a, b in zip(lines, lines[1:]))
    result["turns_possible"] = (stamps[-1] - stamps[0]) / between[len(between) // 4] if between else 0.0
    if len(found) > 1:
        errors = aligned_errors([((line["pose"]["x"], line["pose"]["y"]), true[:2]) for line, true in found])
        result["ate_m"] = math.sqrt(sum(e * e for e in errors) / len(errors))
        # What is not called ok claims nothing: it must not bend the frame in which the others are judged.
        result["worst_ok_m"] = worst_from_first([(tuple(line["pose"][k] for k in ("x", "y", "theta")), true) for line, true in found if line["status"] == "ok"])
    return result


def gaps(lines, longer_s):
    """Times between scans that are longer than this [s]."""
    return [b["stamp"] - a["stamp"] for a, b in zip(lines, lines[1:]) if b["stamp"] - a["stamp"] > longer_s]


def recorded_to(command, mcap, otherwise):
    """The stamp of the last scan in a recording, `otherwise` where there is none yet; None where it cannot be read."""
    if not mcap.exists() or mcap.stat().st_size == 0:
        return otherwise
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "scans.jsonl"
        done = subprocess.run([command, "convert", mcap, log], capture_output=True)
        if done.returncode == 1 or (done.returncode == 2 and b"ends without its end record" in done.stderr):  # not one scan yet
            return otherwise
        if done.returncode not in (0, 4):
            return None
        return json.loads(log.read_text().splitlines()[-1]).get("stamp", 0.0)  # a stamp of 0 is not written
