#!/usr/bin/env python3
"""Who may include whom: fails on an #include that GRAPH does not allow, lists files over 300 lines.

A new folder is one line of GRAPH; a new arrow is one word in it. `--graph` prints what is really included.
"""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# Folder of src/ and include/phasescan/, and the folders it may include besides itself. Nothing may lead back.
GRAPH = """
core
state        core
scan         core
refine       core scan
match        core scan refine
fft_icp      core scan refine match
methods      core scan match fft_icp
odometry     core state scan match refine
graph        core
map          core scan
slam         core state scan match odometry graph map
localize     core state scan match odometry map slam
io           core scan
live         core scan match odometry map slam localize io
sim          core scan io
emulate      core scan io live sim
ros2         core scan map slam odometry localize io
dds          core scan map slam odometry io live ros2
calibrate    core scan io sim
config       core methods io match fft_icp slam localize
output       core scan map match methods slam io
report       core scan match map slam localize output io
serve        core scan map odometry slam localize io live output
foxglove     core scan map slam localize io live serve
eval         core scan match fft_icp methods odometry map slam localize sim config output report io
"""
# Around the core: tests of any folder may use these to make and read their inputs.
TOOLS = {"io", "sim", "config", "output", "eval"}
# What stands on top of all and is included by nothing but itself.
TOP = ["apps", "bench", "bindings", "fuzz", "tests/apps", "tests/interop", "tests/simd", "tests/ros2_shell", "tests/slow", "tests/slow_io", "tests/package",
       "tests/support"]
INCLUDE = re.compile(r'#\s*include "([^"]+)"')


def read_graph(text: str) -> dict[str, set[str]]:
    graph: dict[str, set[str]] = {}
    for line in text.strip().splitlines():
        folder, *others = line.split()
        unknown = [name for name in others if name not in graph]
        if unknown:  # a folder is named before those that include it, so the graph has no circle
            sys.exit(f"check_layers: {folder} may include {' '.join(unknown)}, which must stand above it")
        graph[folder] = set(others)
    return graph


def folder_of(include: str) -> str:
    """The folder an include leads to: "phasescan/scan/scan.hpp" and "scan/points.hpp" both to scan."""
    parts = include.split("/")
    if parts[0] == "phasescan":
        parts = parts[1:]
    return parts[0] if len(parts) > 1 else ""


def below(folder: str, graph: dict[str, set[str]]) -> set[str]:
    """All that a folder stands on, directly or not: its tests may build their inputs with them."""
    return graph[folder].union(*(below(other, graph) for other in graph[folder]))


def allowed_for(place: str, graph: dict[str, set[str]]) -> set[str] | None:
    """What files of a place ("src/io", "tests/scan", "apps") may include; None: it is in no list."""
    top, _, folder = place.partition("/")
    if place in TOP or top in TOP:
        return set(graph) | {"support", "simd"}
    if folder not in graph:
        return None
    if top == "tests":
        return below(folder, graph) | {folder, "support"} | TOOLS
    return graph[folder] | {folder}


def place_of(path: pathlib.Path) -> str:
    parts = path.relative_to(ROOT).parts
    if parts[:2] == ("include", "phasescan"):
        return f"include/{parts[2]}" if len(parts) > 3 else "include/core"
    return "/".join(parts[:2]) if parts[0] in ("src", "tests") and len(parts) > 2 else parts[0]


def sources() -> list[pathlib.Path]:
    found = []
    for base in ("include", "src", "apps", "bindings", "tests", "bench", "fuzz", "examples"):
        found += [p for p in (ROOT / base).rglob("*") if p.suffix in (".hpp", ".cpp", ".inc", ".h")]
    return sorted(found)


def main() -> int:
    graph = read_graph(GRAPH)
    bad = 0
    seen = collections.defaultdict(set)
    for path in sources():
        name, place = path.relative_to(ROOT), place_of(path)
        lines = path.read_text().splitlines()
        if place == "examples" or name == pathlib.Path("include/phasescan/phasescan.hpp"):
            allowed = set(graph)
        else:
            allowed = allowed_for(place, graph)
        if allowed is None:
            print(f"{name}: folder {place} has no line in GRAPH")
            bad += 1
            continue
        for number, line in enumerate(lines, 1):
            found = INCLUDE.match(line)
            folder = folder_of(found[1]) if found else ""
            if not folder:
                continue
            if place.startswith(("src/", "include/")):
                seen[place.partition("/")[2]].add(folder)
            if place == "examples" and not found[1].startswith("phasescan/"):
                print(f"{name}:{number}: an example includes the public headers alone")
                bad += 1
            elif folder not in allowed:
                print(f"{name}:{number}: {place.replace('src/', '').replace('include/', '')} may not include {folder}")
                bad += 1
        if len(lines) > 300 and place.startswith(("src", "include")):
            print(f"note: {name} has {len(lines)} lines: is it two of something?")
    if "--graph" in sys.argv[1:]:
        for folder in graph:
            print(f"{folder:12} {' '.join(name for name in graph if name in seen[folder] - {folder})}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
