"""Tasks on Dask's distributed scheduler: in order, retried where a worker dies."""
from __future__ import annotations

import contextlib
import functools
import logging
import os
import sys
import time
from typing import Any, Callable, Iterator, Sequence, TypeVar

import dask
import distributed

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")

MOST_DEATHS = 20  # of workers under one task, until that task is taken for what kills them


class Engine:
    """A client of a scheduler, with its tasks' progress on standard error, and what they took."""

    def __init__(self, client: distributed.Client, say: Callable[[str], None]) -> None:
        self.client = client
        self.say = say
        self.begin = time.monotonic()
        self.cpu_s: dict[str, float] = {}  # of the tasks of each name, and of the programs that they ran [s]
        self.busy_s = 0.0  # that workers had a task, all of them together [s]

    @property
    def workers(self) -> int:
        """How many there are now, at least one."""
        threads: int = sum(self.client.nthreads().values())
        return max(1, threads)

    def map(self, name: str, work: Callable[[Item], Outcome], items: Sequence[Item]) -> list[Outcome]:
        """``work`` of each item, wherever there is a worker; the results in the order of the items."""
        futures = [self.client.submit(functools.partial(_counted, work), item, pure=False, retries=MOST_DEATHS, key=f"{name}-{k}-{id(self)}") for k, item in enumerate(items)]
        done = 0
        for _ in distributed.as_completed(futures):
            done += 1
            self.say(f"{name}: {done} of {len(futures)} tasks")
        counted: list[tuple[Outcome, float, float]] = self.client.gather(futures)
        self.count(name, sum(cpu for _, cpu, _ in counted))
        self.busy_s += sum(wall for _, _, wall in counted)
        return [outcome for outcome, _, _ in counted]

    def count(self, name: str, cpu_s: float) -> None:
        """Adds CPU time to what stands under a name."""
        self.cpu_s[name] = self.cpu_s.get(name, 0.0) + cpu_s

    def cost(self) -> dict[str, Any]:
        """What it took so far: CPU time by name, wall time, for how long of it workers had a task, workers."""
        return {"wall_s": round(time.monotonic() - self.begin, 3), "busy_s": round(self.busy_s, 3), "workers": self.workers,
                "cpu_s": {name: round(cpu, 3) for name, cpu in self.cpu_s.items()}}


def cpu_time() -> float:
    """CPU time of this thread and of the programs that this process ran to their end [s]."""
    return time.thread_time() + sum(os.times()[2:4])


def _counted(work: Callable[[Item], Outcome], item: Item) -> tuple[Outcome, float, float]:
    begin, cpu = time.monotonic(), cpu_time()
    outcome = work(item)
    return outcome, cpu_time() - cpu, time.monotonic() - begin


@contextlib.contextmanager
def open_engine(scheduler: str | None, workers: int, say: Callable[[str], None]) -> Iterator[Engine]:
    """Workers here, as processes of one thread, or those of a scheduler that runs.

    Raises
    ------
    OSError
        No scheduler answers at that address.
    """
    dask.config.set({"distributed.scheduler.allowed-failures": MOST_DEATHS, "distributed.comm.timeouts.connect": "20s",
                     "distributed.worker.daemon": True, "distributed.admin.tick.limit": "60s",
                     # What looks at its own processes up to 100 times a second, and takes a share of the cores that grows with the time a run takes.
                     "distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "1s",
                     "distributed.admin.system-monitor.interval": "5s", "distributed.client.scheduler-info-interval": "10s",
                     "distributed.scheduler.work-stealing-interval": "1s"})
    logging.getLogger("distributed").setLevel(logging.ERROR)
    if scheduler:
        with distributed.Client(scheduler) as client:
            say(f"dashboard at {client.dashboard_link}")
            yield Engine(client, say)
        return
    with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", memory_limit=0,
                                  silence_logs=logging.CRITICAL) as cluster, distributed.Client(cluster) as client:
        say(f"dashboard at {client.dashboard_link}")
        yield Engine(client, say)


def progress() -> Callable[[str], None]:
    """Says a line on standard error; on a terminal the next one takes its place."""
    terminal = sys.stderr.isatty()
    before = [""]

    def say(text: str) -> None:
        head = text.split(":")[0]
        if terminal:
            sys.stderr.write(("\r\x1b[K" if head == before[0] else "\n" if before[0] else "") + f"phasescan fleet: {text}")
            sys.stderr.flush()
        elif ": " not in text or text.startswith("dashboard"):
            sys.stderr.write(f"phasescan fleet: {text}\n")
        before[0] = head

    return say


def in_chunks(items: Sequence[Any], costs: Sequence[float], workers: int, most_s: float = 120.0) -> list[list[Any]]:
    """Neighbours together, in tasks of at most ``most_s`` or a tenth of a worker's share, whichever is less."""
    most = min(most_s, sum(costs) / max(1, workers) / 10)
    chunks: list[list[Any]] = []
    size = 0.0
    for item, cost in zip(items, costs):
        if not chunks or size + cost > most:
            chunks.append([])
            size = 0.0
        chunks[-1].append(item)
        size += cost
    return chunks
