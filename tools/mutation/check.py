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
CHEAP_S = 0.3
MEMORY = 6 << 30


def programs_of(folder, wide):
    return [f"{name}_tests" for name in PROGRAMS.get(folder, [folder, "slam"]) + (["eval", "apps"] if wide else [])]


def run(program, names, env, cwd, timeout_s):
    """(None where all passed, or what failed first, {test: seconds} of those that passed)."""
    report = cwd / "report.json"
    report.unlink(missing_ok=True)
    command = [program, f"--gtest_filter={':'.join(names)}", "--gtest_fail_fast", "--gtest_brief=1", f"--gtest_output=json:{report}"]
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))  # noqa: E731
    try:
        done = subprocess.run(command, env=env, cwd=cwd, timeout=timeout_s, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=limit)
    except subprocess.TimeoutExpired:
        return "does not end", {}
    if not report.exists():
        return f"ends with {done.returncode}", {}
    took = {}
    for suite in json.loads(report.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            name = f"{suite['name']}.{test['name']}"
            if test.get("failures"):
                return name, took
            if test.get("result") == "COMPLETED":
                took[name] = float(test["time"].rstrip("s"))
    return (f"ends with {done.returncode}" if done.returncode else None), took


class Tests:
    """What the tests of the unchanged build are and how long they take."""

    def __init__(self, build, programs, work):
        self.build = build
        self.seconds = {}  # {program: {test: s}}
        for program in programs:
            failed, took = run(str(self.path(program, {})), ["*"], self.environment(work, None), work, 3600)
            if failed:
                raise SystemExit(f"mutants: {program} fails without any change: {failed}")
            self.seconds[program] = took

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
        done = set()
        for chosen in (lambda name, s: name in first, lambda name, s: s < CHEAP_S, lambda name, s: True):
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
