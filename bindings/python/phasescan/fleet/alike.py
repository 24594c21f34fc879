"""Stage 2, first half: which views of different logs look alike, by descriptors of all keyframes in one index.

An index is files in a folder: numbers.npy (n, 160) and turning.npy (n, 160), a row a view; sessions.npy, the first row of each log.
Workers map them into memory. Beyond a few ten thousand views a query reads only the cells of the index near to it: cells are
k-means of a sample, their number the square root of the views.
"""
from __future__ import annotations

import dataclasses
import math
import pathlib
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from .._core import _places
from .files import write_whole

Ints = npt.NDArray[np.int64]

BRUTE_FORCE = 20000   # views up to which every query reads all
MOST_CELLS_READ = 24  # of the cells, by a query
LOOKED = 8            # alike views of other logs that a view is matched with, two of a log at most
PER_LOG = 2


@dataclasses.dataclass(frozen=True)
class Index:
    """Descriptors of all views, and in which cell each is."""

    numbers: npt.NDArray[np.int8]
    turning: npt.NDArray[np.uint8]
    first: Ints               # row of each log's first view, and the end
    centres: npt.NDArray[np.float32]
    order: Ints               # rows, cell by cell
    cell_first: Ints          # where each cell begins in `order`, and the end

    def members(self, query: npt.NDArray[np.int8], log: int) -> Ints:
        """Rows that a query is compared with: those of other logs, all or in the cells near to it; in order."""
        own = slice(int(self.first[log]), int(self.first[log + 1]))
        if len(self.centres) == 0:
            return np.concatenate([np.arange(0, own.start), np.arange(own.stop, self.first[-1])])
        centres = self.centres
        distance = (centres * centres).sum(axis=1) - 2 * centres @ query.astype(np.float32)
        near = np.argsort(distance, kind="stable")[:MOST_CELLS_READ]
        rows = np.concatenate([self.order[self.cell_first[c]:self.cell_first[c + 1]] for c in np.sort(near)])
        rows = np.sort(rows)
        others: Ints = rows[(rows < own.start) | (rows >= own.stop)]
        return others


def write_index(folder: pathlib.Path, views: Sequence[dict[str, Any]]) -> int:
    """An index of the views of logs in their order. Returns how many views there are."""
    first = np.cumsum([0] + [len(v["numbers"]) for v in views]).astype(np.int64)
    empty = np.zeros((0, 160), np.int8)
    numbers = np.concatenate([empty, *(v["numbers"] for v in views)])
    turning = np.concatenate([empty.astype(np.uint8), *(v["turning"] for v in views)])
    write_arrays(folder, numbers, turning, first)
    return int(first[-1])


def write_arrays(folder: pathlib.Path, numbers: npt.NDArray[np.int8], turning: npt.NDArray[np.uint8], first: Ints) -> None:
    """An index of descriptors; cells where there are many."""
    centres = cells_of(numbers) if len(numbers) > BRUTE_FORCE else np.zeros((0, 160), np.float32)
    cell = nearest_cell(numbers, centres) if len(centres) else np.zeros(0, np.int64)
    order = np.argsort(cell, kind="stable").astype(np.int64)
    cell_first = np.searchsorted(cell[order], np.arange(len(centres) + 1)).astype(np.int64)
    for name, array in (("numbers", numbers), ("turning", turning), ("first", first), ("centres", centres), ("order", order), ("cell_first", cell_first)):
        write_whole(folder / f"{name}.npy", lambda place, array=array: np.save(place, array))  # type: ignore[misc]


def read_index(folder: pathlib.Path) -> Index:
    """What `write_index` wrote, the large parts mapped, not read."""
    return Index(**{f.name: np.load(folder / f"{f.name}.npy", mmap_mode="r" if f.name in ("numbers", "turning") else None)
                    for f in dataclasses.fields(Index)})


def cells_of(numbers: npt.NDArray[np.int8]) -> npt.NDArray[np.float32]:
    """k-means of an even sample, a few rounds from evenly spread rows: no chance, the same bytes always."""
    count = int(math.sqrt(len(numbers)))
    sample = numbers[:: max(1, len(numbers) // (40 * count))].astype(np.float32)
    centres = sample[:: max(1, len(sample) // count)][:count].copy()
    for _ in range(6):
        cell = nearest_cell(sample, centres)
        order = np.argsort(cell, kind="stable")
        starts = np.searchsorted(cell[order], np.arange(len(centres) + 1))
        for c in range(len(centres)):
            if starts[c + 1] > starts[c]:
                centres[c] = sample[order[starts[c]:starts[c + 1]]].mean(axis=0)
    return centres


def nearest_cell(numbers: npt.NDArray[Any], centres: npt.NDArray[np.float32], block: int = 4096) -> Ints:
    """The nearest centre of each row, the first among equals."""
    squares = (centres * centres).sum(axis=1)
    return np.concatenate([np.zeros(0, np.int64), *(np.argmin(squares - 2 * numbers[k:k + block].astype(np.float32) @ centres.T, axis=1)
                                                     for k in range(0, len(numbers), block))])


def alike_views(index: Index, log: int) -> Ints:
    """(n, 3) of own view, other log, view of it: what a log's views look most like, best first for each view."""
    first = index.first
    found = []
    for row in range(int(first[log]), int(first[log + 1])):
        members = index.members(index.numbers[row], log)
        shortlist = max(64, 2 * math.isqrt(len(members)))
        rows, _ = _places.alike_places(index.numbers, index.turning, members, np.array(index.numbers[row]), np.array(index.turning[row]), 4 * LOOKED, shortlist)
        others = np.searchsorted(first, rows, side="right") - 1
        seen: dict[int, int] = {}
        kept = 0
        for other, place in zip(others.tolist(), rows.tolist()):
            if kept == LOOKED:
                break
            if seen.get(other, 0) == PER_LOG:
                continue
            seen[other] = seen.get(other, 0) + 1
            found.append((row - int(first[log]), other, place - int(first[other])))
            kept += 1
    return np.array(found, np.int64).reshape(-1, 3)
