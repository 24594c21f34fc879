#!/usr/bin/env python3
"""Fills the tables of docs/results and docs/global.md from the results.json files of scripts/bench.

A place for a table is `<!-- table: KIND FOLDER[,FOLDER...] [METHOD,...] -->` ... `<!-- end -->`; what stands between is replaced.
A place whose results are not there keeps its old content.
Usage: fill_results.py RESULTS_FOLDER PAGE [SOURCE...]   (PAGE: a file, or a folder of pages; only the tables of these sources, as `fuzz.md`)
"""
import datetime
import json
import pathlib
import re
import subprocess
import sys

import slam_tables
from command import markdown

CLASSES = ["small", "middle", "large", "global"]


def number(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def percent(share, digits=1):
    return "-" if share is None else f"{100 * share:.{digits}f}"


def keep(rows, methods):
    return [r for r in rows if not methods or r["method"] in methods]


def success(results, methods):
    """Success per class: one line per dataset x method, then all datasets together."""
    table = []
    rows = keep(results["rows"], methods) + keep([r for r in results["totals"] if r["dataset"] == "all" and r["class"] != "all"], methods)
    for key in dict.fromkeys((r["dataset"], r["method"]) for r in rows):
        of_key = {r["class"]: r for r in rows if (r["dataset"], r["method"]) == key}
        if not any(r["success"] for r in of_key.values()):
            continue
        cells = []
        for cls in CLASSES:
            s = of_key[cls]["success"] if cls in of_key else None
            cells.append(f"{percent(s['share'])} ({percent(s['low'])}-{percent(s['high'])})" if s else "-")
        n = max(r["success"]["n"] for r in of_key.values() if r["success"])
        table.append([*key, n, *cells])
    return markdown(["dataset", "method", "n per class", *CLASSES], table, 2)


def honesty(results, methods):
    table = []
    for r in keep(results["totals"], methods):
        if r["class"] != "all":
            continue
        h, c = r["honesty"], r["confidence"] or {}
        right = h["right_usable"] + h["right_refused"]
        table.append([r["dataset"], r["method"], r["n"], h["right_usable"], h["right_refused"], h["wrong_refused"], h["wrong_usable"],
                      percent(h["right_refused"] / right if right else None), percent(h["wrong_usable"] / r["n"], 2),
                      number(c.get("auc"), 4), number(c.get("calibration_error"), 4), percent(r["nees_below_7_81"])])
    return markdown(["dataset", "method", "n", "right & usable", "right & refused", "wrong & refused", "wrong & usable",
                     "right refused [%]", "wrong & usable [%]", "AUC", "ECE", "NEES < 7.81 [%]"], table, 2)


def accuracy(results, methods):
    table = []
    for r in keep(results["totals"], methods):
        if r["class"] != "all":
            continue
        x, y, a = (r["errors"][k] for k in ("x_m", "y_m", "rotation_deg"))
        cells = [number(e[k], 4) for e in (x, y) for k in ("mean", "std", "median")]
        cells += [number(e["variance"], 6) for e in (x, y)]
        table.append([r["dataset"], r["method"], *cells, *(number(a[k], 3) for k in ("mean", "std", "median")), number(a["variance"], 4),
                      number(r.get("times_the_bound"), 2)])
    return markdown(["dataset", "method", "x mean [m]", "x std", "x median", "y mean [m]", "y std", "y median", "x var", "y var",
                     "rot mean [deg]", "rot std", "rot median", "rot var", "times the bound"], table, 2)


def time(results, methods):
    fft = results["timing"]["fft_128_r2c_ms"]
    table = []
    for r in keep(results["totals"], methods):
        if r["dataset"] == "all" and r["class"] == "all":
            total = r["ms"]["total"]
            steps = [number(r["ms"][s]["p50"], 3) for s in ("image", "missing", "rotation", "translation", "refine")]
            table.append([r["method"], r["n"], *(number(total[k], 3) for k in ("mean", "p50", "p95", "p99")),
                          number(r["ms"]["p50_in_ffts"], 1), *steps])
    return (f"CPU milliseconds of all threads; one 128 x 128 float FFT: {fft:.4f} ms; steps: medians; fastest of {results['timing']['repeat']}.\n\n"
            + markdown(["method", "n", "mean", "p50", "p95", "p99", "p50 in FFTs", "image", "missing", "rotation", "translation", "refine"],
                       table))


def shortcut(results, methods):
    table = []
    for r in results["totals"]:
        if r["class"] != "all" or r["method"] != "fft-icp2" or not r["success"]:
            continue
        other = next((o for o in results["totals"] if o["dataset"] == r["dataset"] and o["class"] == "all" and o["method"] == "fft-icp1"), None)
        used = r["rotation_source"]["missing-data"]
        table.append([r["dataset"], r["n"], percent(used / r["n"]), percent(r["missing_data_right"] / used if used else None),
                      percent(r["success"]["share"]), percent(other["success"]["share"] if other else None),
                      number(r["ms"]["total"]["p50"], 3), number(other["ms"]["total"]["p50"] if other else None, 3)])
    return markdown(["dataset", "n", "shortcut used [%]", "right when used [%]", "fft-icp2 [%]", "fft-icp1 [%]", "fft-icp2 p50 [ms]",
                     "fft-icp1 p50 [ms]"], table)


def of_dataset(results, methods):
    """[(dataset, method, row of all classes, {class: row})], datasets as they come and all together last."""
    totals = keep(results["totals"], methods)
    rows = keep(results["rows"], methods) + [r for r in totals if r["dataset"] == "all" and r["class"] != "all"]
    wholes = [r for r in totals if r["class"] == "all"]
    return [(r["dataset"], r["method"], r, {c["class"]: c for c in rows if (c["dataset"], c["method"]) == (r["dataset"], r["method"])})
            for r in wholes]


def corridors(results, methods):
    """Pairs whose truth leaves sigma > 0.05 m in some direction, and the success of the others by class."""
    table = []
    for dataset, method, whole, classes in of_dataset(results, methods):
        weak = whole["weak"]
        if not weak["n"]:
            continue
        others = [(classes.get(c) or {}).get("success_without_weak") for c in CLASSES]
        table.append([dataset, method, weak["n"], percent(weak["ambiguous"] / weak["n"]), percent(weak["across_below_0_1_m"] / weak["n"]),
                      *(f"{percent(s['share'])} ({s['n']})" if s else "-" for s in others)])
    return markdown(["dataset", "method", "corridor pairs", "called ambiguous [%]", "across < 0.1 m [%]",
                     *(f"others, {c} [%] (n)" for c in CLASSES)], table, 2)


def nees(results, methods):
    """Share of e' C^-1 e below 7.81 among usable answers."""
    table = [[dataset, method, *(percent((classes.get(c) or {}).get("nees_below_7_81")) for c in CLASSES), percent(whole["nees_below_7_81"])]
             for dataset, method, whole, classes in of_dataset(results, methods) if whole["nees_below_7_81"] is not None]
    return markdown(["dataset", "method", *CLASSES, "all"], table, 2)


NO_RIGHT_ANSWER = ("empty-room", "bare-corridor")  # rooms that repeat themselves: which pose is found is chance


def success_share(results, method):
    """Of all pairs of a method that have one right answer."""
    found = [r["success"] for r in results["totals"]
             if r["class"] == "all" and r["dataset"] not in ("all", *NO_RIGHT_ANSWER) and r["method"] == method and r["success"]]
    return sum(s["count"] for s in found) / sum(s["n"] for s in found)


def ablation(results_of):
    """One line per variant: success on each set, against the first line's, and the median time on the first set."""
    first = next(iter(results_of.values()))
    of_first = {r["method"]: r for r in first["totals"] if r["dataset"] == "all" and r["class"] == "all"}
    base = next(iter(first["options"]))
    table = []
    for method in first["options"]:
        cells = []
        for results in results_of.values():
            share, whole = success_share(results, method), success_share(results, base)
            cells.append(percent(share, 2) + ("" if method == base else f" ({100 * (share - whole):+.2f})"))
        us, base_us = (1000 * of_first[m]["ms"]["total"]["p50"] for m in (method, base))
        bound = of_first[method].get("times_the_bound")
        table.append([method, *cells, number(bound, 2), f"{us:.0f}" + ("" if method == base else f" ({us - base_us:+.0f})")])
    sets = [f"{name.removeprefix('ablation-')} [%]" for name in results_of]
    return markdown(["variant", *sets, "times the bound", "median [us]"], table)


KINDS = {"success": success, "honesty": honesty, "accuracy": accuracy, "time": time, "shortcut": shortcut, "corridors": corridors,
         "nees": nees, **slam_tables.KINDS}


def machine():
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    first = lambda *command: subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0]
    return (f"{datetime.date.today()}, {cpu[1] if cpu else 'unknown CPU'}, {first('c++', '--version')}, preset release, "
            f"commit {first('git', 'rev-parse', '--short', 'HEAD')}\n")


def fill(folder, kind, source, methods):
    if kind == "machine":
        return machine()
    if kind == "text":
        path = folder / source
        return path.read_text() if path.exists() else None
    if kind == "ablation":
        found = {s: folder / s / "results.json" for s in source.split(",")}
        found = {s: json.loads(p.read_text()) for s, p in found.items() if p.exists()}
        return ablation(found) if found else None
    path = folder / source / "results.json"
    return KINDS[kind](json.loads(path.read_text()), methods) if path.exists() else None


def main():
    folder, pages = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    only = sys.argv[3:]

    def replace(match):
        words = match[1].split()
        if only and (len(words) < 2 or words[1] not in only):
            return match[0]
        content = fill(folder, words[0], words[1] if len(words) > 1 else "", words[2].split(",") if len(words) > 2 else [])
        return match[0] if content is None else f"<!-- table: {match[1]} -->\n\n{content}\n<!-- end -->"

    for page in sorted(pages.glob("*.md")) if pages.is_dir() else [pages]:
        page.write_text(re.sub(r"<!-- table: (.*?) -->\n.*?<!-- end -->", replace, page.read_text(), flags=re.S))


if __name__ == "__main__":
    main()
