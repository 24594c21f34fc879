"""What came out, for people: report.html, a row a log with its map, sorted by verdict."""
from __future__ import annotations

import html
from typing import Any, Sequence

ORDER = ("broken", "failed", "doubtful", "done", "good")  # what wants to be looked at comes first

STYLE = """body{font:14px sans-serif;margin:2em;color:#222}table{border-collapse:collapse}td,th{padding:4px 10px;border-bottom:1px solid #ddd;text-align:right;vertical-align:middle}
td.t,th.t{text-align:left}th{cursor:pointer;background:#f4f4f4;position:sticky;top:0}img{max-width:120px;max-height:80px;image-rendering:pixelated}
.broken,.failed{color:#b00020}.doubtful{color:#a05a00}.good,.done{color:#006b2d}h1{font-size:22px}h2{font-size:17px;margin-top:2em}"""

SCRIPT = """for (const table of document.querySelectorAll("table"))
  table.querySelectorAll("th").forEach((head, column) => head.onclick = () => {
    const body = table.tBodies[0], up = head.dataset.up = head.dataset.up === "1" ? "" : "1";
    const value = row => row.cells[column].dataset.v ?? row.cells[column].textContent;
    [...body.rows].sort((a, b) => { const x = value(a), y = value(b), n = x - y; return (isNaN(n) ? x.localeCompare(y) : n) * (up ? 1 : -1); })
      .forEach(row => body.append(row));
  });"""


def format_report(rows: Sequence[dict[str, Any]], groups: Sequence[dict[str, Any]], errors: Sequence[str], costs: Sequence[dict[str, Any]]) -> str:
    """The page. It needs no network; pictures are those beside it."""
    together = [g for g in groups if len(g["logs"]) > 1]
    counts = {s: sum(row["status"] == s for row in rows) for s in ORDER}
    told = ", ".join(f"{n} {s}" for s, n in counts.items() if n)
    parts = [f"<!doctype html><html lang='en'><meta charset='utf-8'><title>Fleet</title><style>{STYLE}</style>",
             f"<h1>{len(rows)} logs: {told}</h1>",
             f"<p>{sum(len(g['logs']) for g in together)} logs share a place with others, in {len(together)} groups.</p>"]
    parts += [f"<p class='failed'>{html.escape(error)}</p>" for error in errors]
    if together:
        parts.append("<h2>Groups</h2><table><thead><tr><th>group</th><th class='t'>map</th><th>logs</th><th class='t'>names</th></tr></thead><tbody>")
        for number, group in enumerate(groups, 1):
            if len(group["logs"]) > 1:
                names = ", ".join(html.escape(name) for name in group["logs"][:12]) + (" ..." if len(group["logs"]) > 12 else "")
                parts.append(f"<tr><td>{number}</td><td class='t'>{_picture(group['map'].rsplit('/', 1)[0])}</td><td>{len(group['logs'])}</td><td class='t'>{names}</td></tr>")
        parts.append("</tbody></table>")
    parts.append("<h2>Logs</h2><table><thead><tr>" + "".join(f"<th{' class=t' if t else ''}>{name}</th>" for name, t in (
        ("map", 1), ("log", 1), ("status", 1), ("cause", 1), ("scans", 0), ("way m", 0), ("loops", 0), ("closure m", 0), ("CPU s", 0), ("peak MB", 0), ("version", 1)))
        + "</tr></thead><tbody>")
    order = sorted(range(len(rows)), key=lambda k: (ORDER.index(rows[k]["status"]), rows[k]["number"]))
    parts += [_row(rows[k], costs[k]) for k in order]
    parts.append(f"</tbody></table><script>{SCRIPT}</script></html>")
    return "\n".join(parts) + "\n"


def _row(row: dict[str, Any], cost: dict[str, Any]) -> str:
    picture = _picture(row["folder"]) if row["status"] != "broken" else ""
    numbers = [row["scans"], _short(row["way_m"], 1), row["loops"], _short(row["closure_m"], 3), _short(cost.get("cpu_s"), 2), _short(cost.get("peak_mb"), 0)]
    rank = ORDER.index(row["status"])
    return (f"<tr><td class='t'>{picture}</td><td class='t'>{html.escape(row['log'])}</td><td class='t {row['status']}' data-v='{rank}'>{row['status']}</td>"
            f"<td class='t'>{html.escape(row['cause'] or '')}</td>" + "".join(f"<td>{'' if n is None else n}</td>" for n in numbers)
            + f"<td class='t'>{html.escape(row['version'])}</td></tr>")


def _picture(folder: str) -> str:
    return f"<a href='{html.escape(folder)}/report.html'><img loading='lazy' alt='' src='{html.escape(folder)}/map.png'></a>"


def _short(value: float | None, digits: int) -> str | None:
    return None if value is None else f"{value:.{digits}f}"
