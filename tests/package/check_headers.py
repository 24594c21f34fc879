#!/usr/bin/env python3
"""Every public header compiles alone, with nothing but include/ and Eigen to be found, under each compiler.

check_headers.py SOURCE_DIR EIGEN_INCLUDE_DIR COMPILER...

The headers are listed in public_headers.txt, so that none becomes public unseen. Headers that stand behind
phasescan/match/scan_matcher.hpp are counted: a matcher shall not pull in the rest.
"""
import concurrent.futures
import pathlib
import shutil
import subprocess
import sys

MOST_BEHIND_THE_MATCHER = 8


def compiled(compiler, header, include, eigen, more=()):
    return subprocess.run([compiler, "-std=c++20", "-x", "c++", "-fsyntax-only", "-Wall", "-Wextra", "-Wshadow", "-Werror",
                           f"-I{include}", "-isystem", eigen, *more, "-"], input=f"#include <{header}>\n", text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def main():
    source, eigen, *compilers = sys.argv[1:]
    include = pathlib.Path(source).resolve() / "include"
    listed = (pathlib.Path(source) / "tests/package/public_headers.txt").read_text().split()
    there = sorted(str(path.relative_to(include)) for path in include.rglob("*.hpp"))
    bad = [f"{name} is listed and not there" for name in listed if name not in there]
    bad += [f"{name} is there and not listed" for name in there if name not in listed]
    jobs = [(compiler, header) for compiler in compilers if shutil.which(compiler) for header in listed if header in there]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for (compiler, header), done in zip(jobs, pool.map(lambda job: compiled(*job, include, eigen), jobs)):
            if done.returncode != 0:
                bad.append(f"{header} does not compile alone with {compiler}:\n{done.stderr[:600]}")
    listing = compiled(compilers[0], "phasescan/match/scan_matcher.hpp", include, eigen, ["-H"]).stderr
    behind = {line.split()[-1] for line in listing.splitlines() if line.startswith(".") and str(include) in line}
    behind = {name for name in behind if not name.endswith("match/scan_matcher.hpp")}
    if len(behind) > MOST_BEHIND_THE_MATCHER:
        bad.append(f"scan_matcher.hpp pulls in {len(behind)} headers: " + ", ".join(sorted(behind)))
    print("\n".join(bad) or f"{len(jobs)} compiled, {len(behind)} headers behind scan_matcher.hpp")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
