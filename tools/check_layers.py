#!/usr/bin/env python3
"""Data flows one way: fails on an #include that points up the layers, lists files over 300 lines."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CORE = ["core", "scan", "refine", "match", "odometry", "graph", "map", "slam"]
# Around the core, never included by it; each may include what stands before it.
AROUND = ["fft_icp", "methods", "io", "sim", "report", "eval"]
ORDER = CORE + AROUND
INCLUDE = re.compile(r'#include "(?:phasescan/)?([a-z0-9_]+)/')


def main() -> int:
    bad = 0
    for base in (ROOT / "include/phasescan", ROOT / "src"):
        for path in sorted(base.rglob("*.[ch]pp")):
            layer = path.relative_to(base).parts[0]
            if layer not in ORDER:
                print(f"{path.relative_to(ROOT)}: folder {layer} has no place in the layers")
                bad += 1
                continue
            lines = path.read_text().splitlines()
            for number, line in enumerate(lines, 1):
                found = INCLUDE.match(line)
                if found and found[1] in ORDER and ORDER.index(found[1]) > ORDER.index(layer):
                    print(f"{path.relative_to(ROOT)}:{number}: {layer} may not include {found[1]}")
                    bad += 1
            if len(lines) > 300:
                print(f"note: {path.relative_to(ROOT)} has {len(lines)} lines: is it two of something?")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
