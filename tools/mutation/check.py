"""Runs test programs until the first test fails: cheap tests first, and before those the tests that noticed other changes of
the same file."""
import json
import os
import resource
import subprocess

# Test programs by folder of the changed file, the one that should notice first in front. Others: their own and SLAM's.
PROGRAMS = {
    "scan": ["scan", "refine", "match", "odometry"],
    "refine": ["refine", "match"],
    "match": ["match"],
    "odometry": ["odometry", "slam"],
    "graph": ["graph", "slam"],
    "map": ["map", "slam"],
    "slam": ["slam"],
}
CHEAP_SHARE = 0.25  # of the time of all tests: so many of the shortest go first
MEMORY = 6 << 30


def programs_of(folder, wide):
    return [f"{name}_tests" for name in PROGRAMS.get(folder, [folder, "slam"]) + (["eval", "apps"] if wide else [])]


def run(program, names, env, cwd, timeout_s, go_on=False):
    """(what failed first, or None, and {test: seconds} of those that passed). @param go_on  after a test that failed"""
    report = cwd / "report.json"
    report.unlink(missing_ok=True)
    command = [program, f"--gtest_filter={':'.join(names)}", "--gtest_brief=1", f"--gtest_output=json:{report}"]
    if not go_on:
        command.append("--gtest_fail_fast")
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))  # noqa: E731
    try:
        done = subprocess.run(command, env=env, cwd=cwd, timeout=timeout_s, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=limit)
    except subprocess.TimeoutExpired:
        return "does not end", {}
    if not report.exists():
        return f"ends with {done.returncode}", {}
    took, failed = {}, []
    for suite in json.loads(report.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            name = f"{suite['name']}.{test['name']}"
            if test.get("failures"):
                failed.append(name)
            elif test.get("result") == "COMPLETED":
                took[name] = float(test["time"].rstrip("s"))
    if not failed and done.returncode:
        failed.append(f"ends with {done.returncode}")
    return " ".join(failed[:1 if not go_on else None]) or None, took


class Tests:
    """What the tests of the unchanged build are and how long they take."""

    def __init__(self, build, programs, work):
        self.build = build
        self.seconds = {}  # {program: {test: s}}
        known = work / "seconds.json"
        stamp = [[t, (build.folder / t).stat().st_mtime_ns] for t in sorted(build.objects_of)]
        if known.exists() and json.loads(known.read_text())["stamp"] == stamp:
            self.seconds = json.loads(known.read_text())["seconds"]
            return
        for program in programs:
            failed, took = run(str(self.path(program, {})), ["*"], self.environment(work, None), work, 3600, go_on=True)
            if failed:
                print(f"left out, as it fails without any change: {program}: {failed}", flush=True)
            if not took:
                raise SystemExit(f"mutants: no test of {program} passes")
            self.seconds[program] = took
        known.write_text(json.dumps({"stamp": stamp, "seconds": self.seconds}))

    def path(self, program, made):
        target = next(t for t in self.build.objects_of if t.split("/")[-1] == program)
        return made.get(target, self.build.folder / target)

    @staticmethod
    def environment(work, linked):
        (work / "tmp").mkdir(parents=True, exist_ok=True)
        libraries = {"LD_LIBRARY_PATH": str(linked)} if linked else {}
        return {**os.environ, "TMPDIR": str(work / "tmp"), **libraries}

    def stages(self, programs, first):
        """[(program, tests, seconds)]: those of `first`, then the cheap ones of every program, then the rest."""
        all_seconds = sorted(s for program in programs for s in self.seconds[program].values())
        total, sum_s, cheap = sum(all_seconds), 0.0, 0.0
        for s in all_seconds:
            sum_s += s
            if sum_s > CHEAP_SHARE * total:
                break
            cheap = s
        done = set()
        for chosen in (lambda name, s: name in first, lambda name, s: s <= cheap, lambda name, s: True):
            for program in programs:
                names = [n for n, s in self.seconds[program].items() if (program, n) not in done and chosen(n, s)]
                done.update((program, n) for n in names)
                if names:
                    yield program, sorted(names, key=self.seconds[program].get), sum(self.seconds[program][n] for n in names)

    def notice(self, made, programs, first, work):
        """The first test that fails with what was made for a mutant, or None."""
        env = self.environment(work, work / "linked")
        for program, names, seconds in self.stages(programs, first):
            failed, _ = run(str(self.path(program, made)), names, env, work, 30 + 6 * seconds)
            if failed:
                return f"{program}: {failed}"
        return None
