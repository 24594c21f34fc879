#!/usr/bin/env python3
"""`phasescan live` and a host that runs Fast DDS, in network namespaces: scans one way, transforms, pose, map and path the
other; a peer that goes and comes back; a run that is killed and goes on; a wire that loses packets or is cut; scans that are none.

Usage: check_fast_peer.py PHASESCAN FAST_PEER [in|back|restart|hostile|demo|lossy ...]
"""
import math
import pathlib
import sys
import tempfile
import time

from fast_host import SKIPPED, Hosts, Wire, enter_namespace, fail, on, simulate, transforms, way_error_m

HOSTILE = (("nan", "no_returns"), ("empty", "no_beams"), ("beams", "beams_changed"), ("noframe", "bad_scan"), ("jump", "clock_jumped_back"),
           ("publishers", "two_publishers"))
MOST_RESTART_S = 3.0  # 2 s on a machine that does nothing else; the time is printed


def times(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return [a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]]


def check_once(what, stamps):
    if len(set(stamps)) != len(stamps):
        fail(f"{what} came twice")
    if stamps != sorted(stamps):
        fail(f"{what} came out of order")


def check_map(messages, when):
    maps = on("/map", messages)
    if not maps or maps[-1]["occupied"] < 200 or maps[-1]["cells"] != maps[-1]["width"] * maps[-1]["height"]:
        fail(f"no map {when}")
    return maps[-1]


def check_scans_in(hosts, log, odometry):
    live = hosts.live("--port", "ros2:/scan", "--ros2")
    flags = ["--odometry"] if odometry else []
    messages = hosts.peer("--seconds", 12, "--scans", log, "--count", 80, *flags)
    late = hosts.peer("--seconds", 3)
    lines, err = live.end()
    if len(lines) < 70:
        fail(f"{len(lines)} of 80 scans were used: {err}")
    check_once("a scan", [line["stamp"] for line in lines])
    poses = on("/pose", messages)
    if len(poses) < 60:
        fail(f"{len(poses)} poses came")
    check_once("a pose", [pose["stamp"] for pose in poses])
    error = way_error_m(poses, log)
    if error > 0.15:
        fail(f"the last pose is off by {error:.3f} m")
    if not all(0 < p["covariance"][i] < 10 for p in poses for i in (0, 3, 4)):
        fail("a covariance is none")
    to_odom = transforms(messages, "odom")
    if len(to_odom) < 60 or any(t["parent"] != "map" for t in to_odom):
        fail("map -> odom is missing")
    if bool(transforms(messages, "base_link")) == odometry:
        fail("odom -> base_link must be published where nobody else does, and there alone")
    occupied = check_map(messages, "while scans came")["occupied"]
    check_map(late, "to one who came late")
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
          f"of {occupied} occupied cells")


def check_peer_comes_back(hosts, log):
    live = hosts.live("--port", "ros2:/scan", "--ros2")
    talker = hosts.talker("--seconds", 60, "--scans", log)
    time.sleep(5)
    talker.kill()  # no goodbye: it is missed when its lease ends, or replaced before
    hosts.peer("--seconds", 6, "--scans", log, "--first", 60, "--count", 30)
    lines, err = live.end()
    check_once("a scan", [line["stamp"] for line in lines])
    if len(lines) < 35 or lines[-1]["status"] != "ok":
        fail(f"a peer that came back: {len(lines)} scans, in the end {lines[-1]['status']}: {err}")
    print(f"a peer killed and back: {len(lines)} scans, none twice")


def check_live_comes_back(hosts, log):
    """Killed without a goodbye and started again with what it had saved, while the robot drives on."""
    state = hosts.folder / "run.state"
    arguments = ["--port", "ros2:/scan", "--ros2", "--save", state]
    live = hosts.live(*arguments)
    talker = hosts.talker("--seconds", 24, "--scans", log, "--count", 200)
    time.sleep(13)
    live.kill()
    killed = time.time()
    live = hosts.live(*arguments, "--resume", state)
    messages = talker.heard()
    lines, err = live.end()
    after = [pose for pose in on("/pose", messages) if pose["heard"] > killed]
    if not after:
        fail(f"no pose came after the run was killed: {err}")
    back = after[0]["heard"] - killed
    poses = [p for p in on("/pose", messages) if p["heard"] <= killed][:1] + after
    check_once("a pose", [pose["stamp"] for pose in on("/pose", messages)])
    error = way_error_m(poses, log)
    if back > MOST_RESTART_S:
        fail(f"a pose came {back:.2f} s after the run was killed, not within {MOST_RESTART_S} s")
    if error > 0.15 or lines[-1]["status"] != "ok":
        fail(f"gone on, the last pose is {error:.3f} m off, {lines[-1]['status']}: {err}")
    print(f"killed and started again: a pose after {back:.2f} s, the last one {error:.3f} m off on the map of before")


def check_lossy(hosts, log):
    """One frame in ten vanishes; then all do for longer than a lease, while the robot stands still."""
    wire = hosts.wire
    wire.loss, wire.frames, wire.lost = 0.1, 0, 0
    live = hosts.live("--port", "ros2:/scan", "--ros2")
    talker = hosts.talker("--seconds", 52, "--scans", log, "--count", 300, "--pause-at", 150, "--pause-s", 16)
    time.sleep(19)
    frames, lost = wire.frames, wire.lost
    wire.loss = 1.0
    cut = time.time()
    time.sleep(12)
    wire.loss = 0.1
    whole = time.time()
    messages = talker.heard()
    late = hosts.peer("--seconds", 8)
    wire.loss = 0.0
    lines, err = live.end()
    check_once("a scan", [line["stamp"] for line in lines])
    poses = on("/pose", messages)
    check_once("a pose", [pose["stamp"] for pose in poses])
    for child in "odom", "base_link":
        check_once(f"the transform to {child}", [t["stamp"] for t in transforms(messages, child)])
    check_map(late, "to one who came late, where packets are lost")
    before, after = ([p for p in poses if p["heard"] < cut], [p for p in poses if p["heard"] > whole])
    if len(before) < 50 or len(after) < 50 or lines[-1]["status"] != "ok":
        fail(f"{len(before)} poses came before the wire was cut, {len(after)} after; in the end {lines[-1]['status']}: {err}")
    # Poses are reliable: none between the first and the last may be missing.
    published = [round(line["stamp"] * 1e6) for line in lines if line["status"] in ("ok", "degraded")]
    heard = {pose["stamp"] // 1000 for pose in poses}
    missing = [stamp for stamp in published if min(heard) <= stamp <= max(heard) and stamp not in heard]
    error = way_error_m(poses, log)
    if missing or error > 0.15:
        fail(f"{len(missing)} poses did not come where packets are lost; the last one is {error:.3f} m off")
    print(f"{100 * lost / frames:.1f} % of {frames} frames lost: {len(lines)} of 300 scans were used, all {len(poses)} poses came once; the wire cut "
          f"for {whole - cut:.0f} s: the first pose {after[0]['heard'] - whole:.1f} s after it was whole, the last one {error:.3f} m off")


def check_hostile(hosts, log, kind, name):
    live = hosts.live("--port", "ros2:/scan", "--ros2")
    more = ["--publishers", 2] if kind == "publishers" else ["--mangle", kind]
    messages = hosts.peer("--seconds", 7, "--scans", log, "--count", 40, *more)
    lines, err = live.end()
    told = on("/diagnostics", messages)
    values = told[-1]["values"] if told else {}
    if name not in values or name not in err:
        fail(f"{kind}: expected {name} in the diagnostics and on standard error: {values} {err}")
    if len(lines) < 15:
        fail(f"{kind}: {len(lines)} scans were used")
    print(f"{kind}: {name}: {values[name]}")


def check_demo(hosts):
    live = hosts.live("--demo", "--ros2")
    messages = hosts.peer("--seconds", 5, "--hear-scans", "--pose", "1,2,0.5")
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


def main():
    enter_namespace()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        hosts = Hosts(*sys.argv[1:3], folder)
        log, long_log = simulate(sys.argv[1], folder), simulate(sys.argv[1], folder, beams=361, seconds=60)
        wanted = sys.argv[3:] or ["in", "back", "restart", "hostile", "demo", "lossy"]
        if "in" in wanted:
            check_scans_in(hosts, log, odometry=False)
            check_scans_in(hosts, log, odometry=True)
        if "back" in wanted:
            check_peer_comes_back(hosts, log)
        if "restart" in wanted:
            check_live_comes_back(hosts, log)
        if "hostile" in wanted:
            for kind, told in HOSTILE:
                check_hostile(hosts, log, kind, told)
        if "demo" in wanted:
            check_demo(hosts)
        if "lossy" in wanted:
            if not Wire.can_be():
                print("no wire between network namespaces can be made here (/dev/net/tun): packet loss is not checked")
                sys.exit(SKIPPED)
            wire = Wire()
            check_lossy(Hosts(*sys.argv[1:3], folder, wire), long_log)
            wire.end()


if __name__ == "__main__":
    main()
