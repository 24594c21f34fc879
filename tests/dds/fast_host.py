"""A host that runs Fast DDS beside `phasescan live`, for check_fast_peer.py: both in a network
namespace of their own, or one in each of two, joined by a wire that loses what it is told to lose."""
import atexit
import ctypes
import fcntl
import json
import math
import os
import pathlib
import random
import select
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time

EPOCH = 1_700_000_000  # what fast_peer adds to the stamps of a log
SKIPPED = 77
OURS, THEIRS = "10.77.0.1", "10.77.0.2"  # on the wire
CLONE_NEWNET, TUNSETIFF, TAP_WITHOUT_HEADER = 0x40000000, 0x400454CA, 0x1002


def fail(text):
    sys.exit(f"{pathlib.Path(sys.argv[0]).stem}: {text}")


def enter_namespace():
    """Begins the script again in a network namespace where there is nobody else; ends it where none can be had."""
    if os.environ.get("PHASESCAN_OWN_NETWORK") != str(os.getpid()):
        more = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
        if subprocess.run(["unshare", *more, "--net", "true"], stderr=subprocess.DEVNULL).returncode != 0:
            print("no network namespace can be made here: not checked")
            sys.exit(SKIPPED)
        os.environ["PHASESCAN_OWN_NETWORK"] = str(os.getpid())  # unshare runs the script in this process
        os.execvp("unshare", ["unshare", *more, "--net", sys.executable, *sys.argv])
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)


class Wire:
    """Two network namespaces, this one and another, and what lies between. `loss` is the share of frames that vanish."""

    def __init__(self, seed=1):
        self.loss, self.frames, self.lost = 0.0, 0, 0
        self.random, self.ended = random.Random(seed), False
        self.other = subprocess.Popen(["unshare", "--net", "sleep", "infinity"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        atexit.register(self.other.kill)  # where a check fails, too
        self.enter = ["nsenter", "--target", str(self.other.pid), "--net"]
        deadline = time.time() + 10
        while os.readlink(f"/proc/{self.other.pid}/ns/net") == os.readlink("/proc/self/ns/net"):
            if time.time() > deadline:
                fail("the second network namespace did not come")
            time.sleep(0.01)
        opened = threading.Event()
        self.thread = threading.Thread(target=self.carry, args=(opened,), daemon=True)
        self.thread.start()
        if not opened.wait(10):
            fail("the wire did not come")
        for enter, device, address in ([], "ours", OURS), (self.enter, "theirs", THEIRS):
            subprocess.run([*enter, "ip", "link", "set", "lo", "up"], check=True)
            subprocess.run([*enter, "ip", "address", "add", f"{address}/24", "dev", device], check=True)
            subprocess.run([*enter, "ip", "link", "set", device, "up"], check=True)

    @staticmethod
    def can_be():
        try:
            os.close(Wire.end_of_wire("try"))
        except OSError:
            return False
        return subprocess.run(["unshare", "--net", "true"], stderr=subprocess.DEVNULL).returncode == 0

    @staticmethod
    def end_of_wire(name):
        file = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(file, TUNSETIFF, struct.pack("16sH22x", name.encode(), TAP_WITHOUT_HEADER))
        return file

    def carry(self, opened):
        ours = self.end_of_wire("ours")
        libc = ctypes.CDLL(None, use_errno=True)
        with open(f"/proc/{self.other.pid}/ns/net") as namespace:
            if libc.setns(namespace.fileno(), CLONE_NEWNET) != 0:  # this thread alone
                raise OSError(ctypes.get_errno(), "setns")
        theirs = self.end_of_wire("theirs")
        opened.set()
        across = {ours: theirs, theirs: ours}
        while not self.ended:
            for end in select.select([ours, theirs], [], [], 0.2)[0]:
                frame = os.read(end, 70_000)
                self.frames += 1
                if self.random.random() < self.loss:
                    self.lost += 1
                    continue
                try:
                    os.write(across[end], frame)
                except OSError:
                    pass  # an interface that is not up yet

    def end(self):
        self.ended = True
        self.thread.join()
        self.other.kill()
        self.other.wait()


class Hosts:
    """Where `phasescan live` and the peer run: on one loopback interface, or at the ends of a wire."""

    def __init__(self, phasescan, fast_peer, folder, wire=None):
        self.phasescan, self.fast_peer, self.folder, self.wire = phasescan, fast_peer, folder, wire
        self.environment = dict(os.environ, ROS_DOMAIN_ID="17")
        for name in "CYCLONEDDS_URI", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS":
            self.environment.pop(name, None)
        if not wire:
            self.environment["ROS_LOCALHOST_ONLY"] = "1"

    def live(self, *arguments):
        return Live(self, arguments)

    def talker(self, *arguments):
        """A peer that goes on beside what follows."""
        return Talker(self, arguments)

    def peer(self, *arguments):
        return self.talker(*arguments).heard()


class Talker:
    """fast_peer. What it prints goes into a file: in a pipe that nobody reads it would stop."""

    def __init__(self, hosts, arguments):
        enter, address = (hosts.wire.enter, THEIRS) if hosts.wire else ([], "127.0.0.1")
        self.out = tempfile.TemporaryFile("w+", dir=hosts.folder)
        self.process = subprocess.Popen([*enter, hosts.fast_peer, "--domain", "17", "--address", address, *map(str, arguments)], stdout=self.out)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def heard(self):
        """All that it heard, once it has ended."""
        if self.process.wait(timeout=300) != 0:
            fail(f"fast_peer ended with {self.process.returncode}")
        self.out.seek(0)
        messages = [json.loads(line) for line in self.out]
        for message in messages:
            if "error" in message:
                fail(f"Fast CDR cannot read {message}")
        return messages


class Live:
    """phasescan live, and what it says. `cpu_s` once it has ended."""

    def __init__(self, hosts, arguments):
        self.out, self.err = hosts.folder / "live.out", hosts.folder / "live.err"
        self.began = time.time()
        self.process = subprocess.Popen([hosts.phasescan, "live", *map(str, arguments), "--json", "--serve", "off"], env=hosts.environment,
                                        stdout=open(self.out, "w"), stderr=open(self.err, "w"))

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self):
        self.process.send_signal(signal.SIGINT)
        _, status, usage = os.wait4(self.process.pid, 0)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        self.cpu_s = usage.ru_utime + usage.ru_stime
        if self.process.returncode not in (0, 130):
            fail(f"live ended with {self.process.returncode}: {self.err.read_text()}")
        return [json.loads(line) for line in self.out.read_text().splitlines()], self.err.read_text()


def simulate(phasescan, folder, beams=360, seconds=30):
    """A robot in a flat, 10 scans a second, with wheels that drift."""
    log, sensor = folder / f"drive{beams}.jsonl", folder / f"{beams}.yaml"
    sensor.write_text(f"beams: {beams}\nfov_deg: 360\nrange_min_m: 0.05\nrange_max_m: 12\nsigma_m: 0.012\ndropout: 0.01\nrate_hz: 10\n")
    subprocess.run([phasescan, "simulate", "--world", "flat", "--sensor", sensor, "--duration", str(seconds), "--odometry", "--seed", "3",
                    "--out", log], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return log


def on(topic, messages):
    return [message for message in messages if message["topic"] == topic]


def transforms(messages, child):
    return [t for m in on("/tf", messages) for t in m["transforms"] if t["child"] == child]


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


def way_error_m(poses, log):
    """How far the last of some poses is off, seen from the first."""
    truth = truth_of(log)
    first, last = (truth[p["stamp"] // 1000] for p in (poses[0], poses[-1]))
    return math.dist(relative(poses[0]["pose"], poses[-1]["pose"])[:2], relative(first, last)[:2])
