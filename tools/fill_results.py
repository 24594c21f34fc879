#!/usr/bin/env python3
"""Fills the tables of docs/RESULTS.md from the results.json files of scripts/results.

A place for a table is `<!-- table: KIND FOLDER [METHOD,...] -->` ... `<!-- end -->`; what stands between is replaced.
A place whose results are not there keeps its old content. Usage: fill_results.py RESULTS_FOLDER docs/RESULTS.md
"""
import datetime
import json
import pathlib
import re
import subprocess
import sys

CLASSES = ["small", "middle", "large", "global"]


def number(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def percent(share, digits=1):
    return "-" if share is None else f"{100 * share:.{digits}f}"


def markdown(header, rows, words=1):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * words + "---:|" * (len(header) - words)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


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


KINDS = {"success": success, "honesty": honesty, "accuracy": accuracy, "time": time, "shortcut": shortcut}


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
    path = folder / source / "results.json"
    return KINDS[kind](json.loads(path.read_text()), methods) if path.exists() else None


def main():
    folder, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])

    def replace(match):
        words = match[1].split()
        content = fill(folder, words[0], words[1] if len(words) > 1 else "", words[2].split(",") if len(words) > 2 else [])
        return match[0] if content is None else f"<!-- table: {match[1]} -->\n\n{content}\n<!-- end -->"

    page.write_text(re.sub(r"<!-- table: (.*?) -->\n.*?<!-- end -->", replace, page.read_text(), flags=re.S))


if __name__ == "__main__":
    main()
