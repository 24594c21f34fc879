"""How a sensor is found, and what a scan costs, for scripts/live_results."""
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import threading
import time

TITLES = {line.split('"')[1]: line.split('"')[3] for line in
          (pathlib.Path(__file__).resolve().parent.parent / "src/live/sensors.cpp").read_text().splitlines() if line.startswith('    {"')}


def found_after(command, sensor):
    """Seconds from the start of `live --port auto` until it names the sensor at an emulated one's port, and the name."""
    emulator = subprocess.Popen([command, "emulate", "--sensor", sensor, "--world", "flat"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    port = emulator.stdout.readline().strip()
    began = time.monotonic()
    live = subprocess.Popen([command, "live", "--port", "auto", "--serve", "off"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                            env={**os.environ, "PHASESCAN_PORTS": port})
    guard = threading.Timer(20.0, live.kill)
    guard.start()
    name, after = "", 99.0
    for line in live.stderr:
        found = re.match(r"phasescan: (.*) at " + re.escape(port), line)
        if found:
            name, after = found[1], time.monotonic() - began
            break
    guard.cancel()
    live.send_signal(signal.SIGINT)
    live.stderr.read()
    live.wait(20)
    emulator.terminate()
    emulator.wait(20)
    return after, name


def nothing_after(command):
    """Seconds until `live --port auto` says that there is no sensor, its exit code and what it says."""
    began = time.monotonic()
    run = subprocess.run([command, "live", "--port", "auto", "--serve", "off"], capture_output=True, text=True, env={**os.environ, "PHASESCAN_PORTS": ""})
    return time.monotonic() - began, run.returncode, run.stderr.strip()


def instructions_a_scan(command, beams, hz, seconds):
    """Of `live --replay` under callgrind: what a drive of `seconds` takes more than one of half of it, per scan."""
    counts = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "sensor.yaml").write_text(f"beams: {beams}\nrate_hz: {hz}\nrange_max_m: 12\n")
        for part in (seconds / 2, seconds):
            log = folder / "drive.jsonl"
            subprocess.run([command, "simulate", "--world", "flat", "--sensor", folder / "sensor.yaml", "--duration", str(part), "--out", log], check=True,
                           capture_output=True)
            run = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder / 'out'}", command, "live", "--replay", log, "--json", "--serve",
                                  "off"], capture_output=True, text=True)
            counts.append((int(re.search(r"Collected : (\d+)", run.stderr)[1]), len(run.stdout.splitlines())))
    (half, few), (whole, many) = counts
    return (whole - half) / (many - few), many - few
