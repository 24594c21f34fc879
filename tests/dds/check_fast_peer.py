#!/usr/bin/env python3
"""`phasescan live` and a host that runs Fast DDS, on the loopback interface: scans one way, transforms, pose, map and path the
other; a peer that goes and comes back; scans that are none.

Usage: check_fast_peer.py PHASESCAN FAST_PEER [--table]. With --table prints figures of longer runs instead of checking.
"""
import json
import math
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

PHASESCAN, PEER = sys.argv[1:3]
DOMAIN = 10 + os.getpid() % 90
EPOCH = 1_700_000_000  # what fast_peer adds to the stamps of a log
ENVIRONMENT = dict(os.environ, ROS_DOMAIN_ID=str(DOMAIN), ROS_LOCALHOST_ONLY="1")
ENVIRONMENT.pop("CYCLONEDDS_URI", None)


def fail(text):
    sys.exit(f"check_fast_peer: {text}")


def simulate(folder, beams=360, seconds=30):
    """A robot in a flat, 10 scans a second, with wheels that drift."""
    log, sensor = folder / f"drive{beams}.jsonl", folder / f"{beams}.yaml"
    sensor.write_text(f"beams: {beams}\nfov_deg: 360\nrange_min_m: 0.05\nrange_max_m: 12\nsigma_m: 0.012\ndropout: 0.01\nrate_hz: 10\n")
    subprocess.run([PHASESCAN, "simulate", "--world", "flat", "--sensor", sensor, "--duration", str(seconds), "--odometry", "--seed", "3",
                    "--out", log], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return log


class Live:
    """phasescan live, and what it says. `cpu_s` once it has ended."""

    def __init__(self, folder, *arguments):
        self.out, self.err = folder / "live.out", folder / "live.err"
        self.process = subprocess.Popen([PHASESCAN, "live", *arguments, "--json", "--serve", "off"], env=ENVIRONMENT, stdout=open(self.out, "w"),
                                        stderr=open(self.err, "w"))

    def end(self):
        self.process.send_signal(signal.SIGINT)
        _, status, usage = os.wait4(self.process.pid, 0)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        self.cpu_s = usage.ru_utime + usage.ru_stime
        if self.process.returncode not in (0, 130):
            fail(f"live ended with {self.process.returncode}: {self.err.read_text()}")
        return [json.loads(line) for line in self.out.read_text().splitlines()], self.err.read_text()


def peer(*arguments, **more):
    done = subprocess.run([PEER, "--domain", str(DOMAIN), *map(str, arguments)], capture_output=True, text=True, timeout=300, **more)
    if done.returncode != 0:
        fail(f"fast_peer: {done.returncode}: {done.stderr}")
    messages = [json.loads(line) for line in done.stdout.splitlines()]
    for message in messages:
        if "error" in message:
            fail(f"Fast CDR cannot read {message}")
    return messages


def on(topic, messages):
    return [message for message in messages if message["topic"] == topic]


def transforms(messages, child):
    return [t for m in on("/tf", messages) for t in m["transforms"] if t["child"] == child]


def times(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return [a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]]


def truth_of(log):
    """Pose by stamp [us]."""
    poses = {}
    for line in pathlib.Path(f"{log}.truth.tum").read_text().splitlines():
        if line.startswith("#"):
            continue
        t, x, y, _, _, _, z, w = map(float, line.split())
        poses[round((t + EPOCH) * 1e6)] = [x, y, 2 * math.atan2(z, w)]
    return poses


def relative(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    dx, dy = b[0] - a[0], b[1] - a[1]
    return [c * dx + s * dy, -s * dx + c * dy, b[2] - a[2]]


def check_scans_in(folder, log, odometry):
    live = Live(folder, "--port", "ros2:/scan", "--ros2")
    flags = ["--odometry"] if odometry else []
    messages = peer("--seconds", 12, "--scans", log, "--count", 80, *flags)
    late = peer("--seconds", 3)
    lines, err = live.end()
    if len(lines) < 70:
        fail(f"{len(lines)} of 80 scans were used: {err}")
    stamps = [line["stamp"] for line in lines]
    if len(set(stamps)) != len(stamps) or stamps != sorted(stamps):
        fail("a scan was used twice, or out of order")
    poses, truth = on("/pose", messages), truth_of(log)
    if len(poses) < 60:
        fail(f"{len(poses)} poses came")
    first, last = (truth[p["stamp"] // 1000] for p in (poses[0], poses[-1]))
    ours = relative(poses[0]["pose"], poses[-1]["pose"])
    error = math.hypot(*(a - b for a, b in zip(ours[:2], relative(first, last)[:2])))
    if error > 0.15:
        fail(f"the last pose is off by {error:.3f} m")
    if not all(0 < p["covariance"][i] < 10 for p in poses for i in (0, 3, 4)):
        fail("a covariance is none")
    to_odom = transforms(messages, "odom")
    if len(to_odom) < 60 or any(t["parent"] != "map" for t in to_odom):
        fail("map -> odom is missing")
    if bool(transforms(messages, "base_link")) == odometry:
        fail("odom -> base_link must be published where nobody else does, and there alone")
    for messages_of, when in ((messages, "while scans came"), (late, "to one who came late")):
        maps = on("/map", messages_of)
        if not maps or maps[-1]["occupied"] < 200 or maps[-1]["cells"] != maps[-1]["width"] * maps[-1]["height"]:
            fail(f"no map {when}")
    if "ok" not in [m["data"] for m in on("/status", messages)] or not on("/diagnostics", messages):
        fail("status or diagnostics are missing")
    if not odometry:  # the whole way from map to base, at the stamp of a pose
        base = {t["stamp"]: t["pose"] for t in transforms(messages, "base_link")}
        odom = {t["stamp"] - 200_000_000: t["pose"] for t in to_odom}
        pose = poses[-1]
        whole = times(odom[pose["stamp"]], base[pose["stamp"]])
        if math.dist(whole[:2], pose["pose"][:2]) > 1e-6:
            fail("map -> odom -> base_link is not the pose")
    print(f"scans of Fast DDS, odometry {'of /tf' if odometry else 'none'}: {len(lines)} used, last pose {error:.3f} m off, map "
          f"of {on('/map', messages)[-1]['occupied']} occupied cells")


def check_peer_comes_back(folder, log):
    live = Live(folder, "--port", "ros2:/scan", "--ros2")
    talker = subprocess.Popen([PEER, "--domain", str(DOMAIN), "--seconds", "60", "--scans", log, "--count", "1000"],
                              stdout=subprocess.DEVNULL)
    time.sleep(4)
    talker.kill()  # no goodbye: it is missed when its lease ends, or replaced before
    talker.wait()
    peer("--seconds", 5, "--scans", log, "--first", 60, "--count", 30)
    lines, err = live.end()
    stamps = [line["stamp"] for line in lines]
    if len(set(stamps)) != len(stamps):
        fail("scans were used twice after the peer was back")
    if len(lines) < 35 or lines[-1]["status"] != "ok":
        fail(f"{len(lines)} scans, in the end {lines[-1]['status']}: {err}")
    print(f"a peer killed and back: {len(lines)} scans, none twice")


def check_hostile(folder, log, kind, name):
    live = Live(folder, "--port", "ros2:/scan", "--ros2")
    more = ["--publishers", 2] if kind == "publishers" else ["--mangle", kind]
    messages = peer("--seconds", 6, "--scans", log, "--count", 40, *more)
    lines, err = live.end()
    values = on("/diagnostics", messages)[-1]["values"]
    if name not in values or name not in err:
        fail(f"{kind}: expected {name} in the diagnostics and on standard error: {values} {err}")
    if len(lines) < 15:
        fail(f"{kind}: {len(lines)} scans were used")
    print(f"{kind}: {name}: {values[name]}")


def check_demo(folder):
    live = Live(folder, "--demo", "--ros2")
    messages = peer("--seconds", 5, "--hear-scans", "--pose", "1,2,0.5")
    _, err = live.end()
    scans = on("/scan", messages)
    if len(scans) < 10 or scans[0]["frame"] == "" or not on("/map", messages):
        fail(f"the demo's scans or map did not come: {len(scans)}")
    mounted = [t for m in on("/tf_static", messages) for t in m["transforms"]]
    if not any(t["child"] == scans[0]["frame"] and t["parent"] == "base_link" for t in mounted):
        fail("no transform says where the laser sits")
    if "initialpose" not in err:
        fail(f"nothing was said of the pose on initialpose: {err}")
    print(f"a sensor's scans, mounting, map: {len(scans)} scans came to Fast DDS")


def table(folder):
    log = simulate(folder, beams=720, seconds=70)
    live = Live(folder, "--port", "ros2:/scan", "--ros2")
    start = time.time()
    messages = peer("--seconds", 64, "--scans", log, "--count", 600)
    lines, _ = live.end()
    wall = time.time() - start
    late = sorted(t["latency_ms"] for child in ("odom", "base_link") for t in transforms(messages, child) if "latency_ms" in t)
    beams = len(json.loads(log.read_text().splitlines()[0])["ranges"])
    print(f"| scan said by Fast DDS to tf heard by it, {len(lines)} scans of {beams} beams at 10 Hz | p50 {late[len(late) // 2]:.2f} ms, "
          f"p99 {late[int(0.99 * len(late))]:.2f} ms, most {late[-1]:.2f} ms |")
    print(f"| CPU of `phasescan live` | {100 * live.cpu_s / wall:.1f} % of one core |")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if "--table" in sys.argv:
            return table(folder)
        log = simulate(folder)
        check_scans_in(folder, log, odometry=False)
        check_scans_in(folder, log, odometry=True)
        check_peer_comes_back(folder, log)
        for kind, told in (("nan", "no_returns"), ("empty", "no_beams"), ("beams", "beams_changed"), ("noframe", "bad_scan"),
                           ("jump", "clock_jumped_back"), ("publishers", "two_publishers")):
            check_hostile(folder, log, kind, told)
        check_demo(folder)


if __name__ == "__main__":
    main()
