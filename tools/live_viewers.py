"""Live runs that are watched, for scripts/live_results: viewers that read all, viewers that read nothing, and what that costs."""
import base64
import json
import os
import pathlib
import re
import selectors
import signal
import socket
import subprocess
import threading
import time
import urllib.request

TICKS = os.sysconf("SC_CLK_TCK")


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else float("nan")


def cpu_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


class Viewers(threading.Thread):
    """Clients of /ws in one thread: `count` that read all, `deaf` that read nothing."""

    def __init__(self, port, count, deaf=0):
        super().__init__(daemon=True)
        self.selector, self.deaf, self.bytes, self.going = selectors.DefaultSelector(), [], 0, True
        for i in range(count + deaf):
            client = socket.create_connection(("127.0.0.1", port))
            if i >= count:
                client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            key = base64.b64encode(os.urandom(16)).decode()
            client.sendall((f"GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n").encode())
            if i >= count:
                self.deaf.append(client)
            else:
                client.setblocking(False)
                self.selector.register(client, selectors.EVENT_READ)

    def run(self):
        while self.going:
            for key, _ in self.selector.select(0.2):
                try:
                    data = key.fileobj.recv(1 << 18)
                    self.bytes += len(data)
                    if data.startswith(b"\x89"):  # a ping wants its pong: an empty one, masked
                        key.fileobj.send(b"\x8a\x80\0\0\0\0")
                    if not data:
                        self.selector.unregister(key.fileobj)
                except OSError:
                    self.selector.unregister(key.fileobj)

    def close(self):
        self.going = False
        self.join()
        for client in [key.fileobj for key in list(self.selector.get_map().values())] + self.deaf:
            client.close()


class Run:
    """`emulate` and `live` at its port, poses as JSON lines."""

    def __init__(self, phasescan, sensor):
        self.emulator = subprocess.Popen([phasescan, "emulate", "--sensor", sensor, "--world", "flat"], stdout=subprocess.PIPE,
                                         stderr=subprocess.DEVNULL, text=True)
        port = self.emulator.stdout.readline().split()[-1]
        self.live = subprocess.Popen([phasescan, "live", "--port", port, "--sensor", sensor, "--json", "--serve", "127.0.0.1:0"],
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.port = 0
        for line in self.live.stderr:
            found = re.search(r"open http://127\.0\.0\.1:(\d+)/", line)
            if found:
                self.port = int(found[1])
                break
        threading.Thread(target=self.live.stderr.read, daemon=True).start()
        self.latencies = []
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.live.stdout:
            self.latencies.append(json.loads(line)["latency_ms"])

    def measure(self, seconds):
        time.sleep(3.0)  # the sensor starts
        begin, cpu, wall = len(self.latencies), cpu_seconds(self.live.pid), time.monotonic()
        time.sleep(seconds)
        return self.latencies[begin:], (cpu_seconds(self.live.pid) - cpu) / (time.monotonic() - wall)

    def close(self):
        self.live.send_signal(signal.SIGINT)
        self.live.wait(20)
        self.emulator.terminate()
        self.emulator.wait(20)


def one(phasescan, sensor, seconds, viewers, deaf=0):
    run = Run(phasescan, sensor)
    try:
        watching = Viewers(run.port, viewers, deaf)
        watching.start()
        latencies, cpu = run.measure(seconds)
        watching.going = False
        status = json.load(urllib.request.urlopen(f"http://127.0.0.1:{run.port}/api/status"))
        return latencies, cpu, watching.bytes / seconds, status
    finally:
        run.close()


def in_turns(phasescan, sensor, seconds, rounds, audiences):
    """One run that different audiences watch in turns, so that what else the machine does falls upon all of them alike.

    `audiences`: name -> (viewers, deaf). Gives name -> (latencies of all its turns, CPU share, bytes a second).
    """
    run = Run(phasescan, sensor)
    try:
        run.measure(2.0)
        found = {name: ([], [], []) for name in audiences}
        for _ in range(rounds):
            for name, (viewers, deaf) in audiences.items():
                watching = Viewers(run.port, viewers, deaf)
                watching.start()
                time.sleep(1.0)  # they are sent the whole map first
                before, begin, cpu, wall = watching.bytes, len(run.latencies), cpu_seconds(run.live.pid), time.monotonic()
                time.sleep(seconds)
                found[name][0].extend(run.latencies[begin:])
                found[name][1].append((cpu_seconds(run.live.pid) - cpu) / (time.monotonic() - wall))
                found[name][2].append((watching.bytes - before) / seconds)
                watching.close()
        return {name: (latencies, sum(cpu) / rounds, sum(sent) / rounds) for name, (latencies, cpu, sent) in found.items()}
    finally:
        run.close()


def page_bytes(phasescan):
    """The size of the page."""
    run = Run(phasescan, "ld06")
    try:
        return len(urllib.request.urlopen(f"http://127.0.0.1:{run.port}/").read())
    finally:
        run.close()
