"""The SLAM tables of docs/results/slam.md, from the results.json files of scripts/slam_results."""
import burst_table
import verdict_runs
from command import markdown


def number(value, digits):
    return "-" if value is None else f"{value:.{digits}f}"


def options_of(row):
    options = row["cut"] + (["--odometry none"] if row["odometry"] == "none" else [])
    return f"`{' '.join(options)}`" if options else ""


def relations(rows, _):
    table = []
    for r in rows:
        e = r["error"]
        reading = "base" if r["log"].startswith("fr079") and not r["reading"] else "laser"
        table.append([r["log"], options_of(r), r["relations"], reading, number(e["translation_m"]["mean"], 4),
                      number(e["rotation_deg"]["mean"], 3), number(e["translation_m"]["max"], 3), e["above_0.2_m"],
                      f"{e['unanswered']} of {e['relations']}"])
    return markdown(["log", "options", "relations", "poses of the", "translation, mean [m]", "rotation, mean [deg]", "largest [m]",
                     "above 0.2 m", "unanswered"], table, 4)


def relation_noise(rows, _):
    columns = ("apart", "match_base", "slam_base", "match_laser", "slam_laser")
    return markdown(["log", "turn [deg]", "relations", "matched", "match and SLAM [m]", "match and relation, base [m]", "SLAM and relation, base [m]",
                     "match and relation, laser [m]", "SLAM and relation, laser [m]", "exact poses and relation [m]"],
                    [[r["log"], "{:.0f} to {:.0f}".format(*r["turn_deg"]), r["relations"], r["n"], *(number(r["mean_m"][c], 4) for c in columns),
                      number(r["exact_mean_m"], 4)] for r in rows], 2)


def cost(rows, _):
    table = []
    for r in rows:
        t = r["timing"]
        row = [r["log"], options_of(r), t["scans"], number(t["cpu_ms_per_scan"], 3),
               *(number(t.get("tracking_cpu_ms", {}).get(k), 3) for k in ("mean", "p99")), number(t["step_cpu_ms"]["mean"], 3),
               number(t["step_cpu_ms"]["p99"], 2), number(t["peak_memory_mib"], 1)]
        if row not in table:
            table.append(row)
    return markdown(["log", "options", "scans", "whole, CPU ms a scan", "tracking, mean [ms]", "tracking, p99 [ms]", "a step with loops, mean [ms]",
                     "with loops, p99 [ms]", "peak MiB"], table, 2)


def sparse(rows, _):
    return markdown(["log", "tracked", "by the full search", "pieces", "ATE RMSE [m]", "median [m]", "largest [m]", "CPU ms a scan"],
                    [[r["log"], f"{r['summary']['scans_tracked']} of {r['summary']['scans']}", r["summary"]["full_searches_used"],
                      r["summary"]["map"]["pieces"], *(number(r["error"]["ate_m"][k], 3) for k in ("rmse", "median", "max")),
                      number(r["timing"]["cpu_ms_per_scan"], 3)] for r in rows], 2)


def lowcost(rows, _):
    table = []
    for r in rows:
        c, s = r["closure"], r["summary"]
        auto = next(o for o in rows if o["log"] == r["log"] and o["odometry"] == "auto")["summary"]["map"]["occupied_cells"]
        some = c["matched"] > 0
        table.append([r["log"], "none" if r["odometry"] == "none" else "used", f"{s['scans_tracked']} of {s['scans']}", c["returns"],
                      c["matched"], number(c["translation_m"]["mean"] if some else None, 4),
                      number(c["translation_m"]["max"] if some else None, 3), number(c["last_return_m"] if some else None, 4),
                      s["map"]["occupied_cells"], number(s["map"]["occupied_cells"] / auto, 3)])
    return markdown(["log", "odometry", "tracked", "returns", "matched", "closure, mean [m]", "largest [m]", "at the last [m]",
                     "occupied cells", "times those with odometry"], table, 2)


def simulated(rows, _):
    table = [[r["world"], f"{r['speed']} m/s, {r['turn_rate']} deg/s", " ".join(number(e, 3) for e in r["ate_rmse_m"]),
              number(max(r["ate_rmse_m"]), 3)] for r in rows]
    return markdown(["world", "at most", "ATE RMSE of ten buildings [m]", "worst [m]"], table, 3)


def glass(rows, _):
    share = lambda part, whole: number(100 * part / whole if whole > 0 else None, 0)
    return markdown(["sensor", "flats", "glass [m]", "found [%]", "black [m]", "found [%]", "claimed [m]", "of it right [%]", "claimed across open doors [m]"],
                    [[r["sensor"], "with glass and black" if r["kind"] == "hidden" else "all matt", number(r["glass_m"], 1),
                      share(r["glass_found_m"], r["glass_m"]), number(r["black_m"], 1), share(r["black_found_m"], r["black_m"]),
                      number(r["claimed_m"], 1), share(r["right_m"], r["claimed_m"]), number(r["door_m"], 1)] for r in rows], 2)


def same(rows, _):
    return markdown(["file", "three runs, 1, 1 and 2 threads"], [[r["file"], "same" if r["same"] else "DIFFERENT"] for r in rows], 2)


def memory(rows, _):
    return markdown(["scans", "keyframes at 20,000", "at the end", "MiB at 20,000", "grown [bytes]", "allowed [bytes]", "bytes a scan",
                     "off at the end [m]", "farthest off [m]", "scans over 0.2 m off [%]", "CPU ms a scan"],
                    [[r["scans"], r["nodes_settled"], r["nodes"], r["rss_settled_mib"], int(r["grown_bytes"]), r["allowed_bytes"],
                      r["bytes_per_scan"], number(r["end_off_m"], 3), number(r["largest_off_m"], 3),
                      number(100 * r["share_off_0.2m"], 3), r["cpu_ms_per_scan"]] for r in rows], 0)


def retrieval(rows, _):
    table = []
    for r in rows:
        checked = r["verified"] > 0
        table.append([r["places"], r["queries"], number(100 * r["recall_at_1"], 1), number(100 * r["recall_at_10"], 1),
                      "-" if checked else number(r["query_us_p50"], 1), number(r["describe_us"], 1),
                      f"{r['verified_found']} of {r['verified']}" if checked else "-", r["verified_wrong"] if checked else "-"])
    return markdown(["places", "queries", "recall@1 [%]", "recall@10 [%]", "a query, p50 [us]", "a descriptor [us]", "found and verified",
                     "wrong and verified"], table, 0)


def verdict(rows, _):
    header, table = verdict_runs.table(rows)
    return markdown(header, table, 1)


def bursts(rows, _):
    header, table = burst_table.table(rows)
    return markdown(header, table, 2)


KINDS = {"slam-bursts": bursts, "slam-verdict": verdict, "slam-relations": relations, "slam-relation-noise": relation_noise, "slam-cost": cost, "slam-lowcost": lowcost, "slam-simulated": simulated, "slam-same": same, "slam-glass": glass, "slam-sparse": sparse,
         "slam-retrieval": retrieval, "slam-memory": memory}
