# SPDX-License-Identifier: Apache-2.0
"""What the documentation says of measured points, surfaces, files, sidecars, pictures and flights: {page: what it should hold}, made
from CSV files. quotes.py writes the pages; tests/bench/output_tables_test.py makes some."""

import re
import statistics

from harness import BENCH, markdown

DOCS = BENCH.parent / "docs"
RESULTS = BENCH / "results"
AVX512 = "2-core-avx512"  # the machine that these pages speak of, by its folder
# Where each table stands: the file that it is made of, its machine, the page and the name of its markers.
PLACES = {"points.csv": (AVX512, "points_benchmarks.md", "points"),
          "points-build.csv": (AVX512, "points_benchmarks.md", "points build"),
          "iso.csv": (AVX512, "output_benchmarks.md", "surfaces"), "files.csv": (AVX512, "output_benchmarks.md", "files"),
          "sidecars.csv": (AVX512, "output_benchmarks.md", "sidecars"), "limits.csv": (AVX512, "limits.md", "limits"),
          "render.csv": (AVX512, "render_benchmarks.md", "pictures"), "view.csv": (AVX512, "view_benchmarks.md", "pages"),
          "python.csv": (AVX512, "python_benchmarks.md", "fields"), "python-many.csv": (AVX512, "python_benchmarks.md", "many"),
          "fly_recompute.csv": (AVX512, "thesis.md", "fly recomputed"), "fly_large.csv": (AVX512, "thesis.md", "fly among millions")}


def number(ratio):
    """Of "12.30x" or "4.1 %"."""
    return float(re.match(r"-?[\d.]+", ratio).group())


def spread(rows, column, of):
    """The worst, the median and the best ratio of a column, and the worst one's place."""
    known = sorted((row for row in rows if row.get(column)), key=lambda row: number(row[column]))
    if not known:
        return {}
    worst = known[0]
    return {"cases": len(known), "worst": f"{worst[column]} ({of(worst)})",
            "median": f"{statistics.median(number(row[column]) for row in known):.2f}x", "best": known[-1][column]}


def better(rows, keys):
    """Of rows that differ in the peer only, the one whose peer is the quickest."""
    groups = {}
    for row in rows:
        if row.get("ratio"):
            groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    return [min(group, key=lambda row: number(row["ratio"])) for group in groups.values()]


def points_summary(rows):
    """For each set of points, and for signs, standoff beside the better peer."""
    best = better(rows, ("mesh", "points", "sign"))
    table = []
    for sign, where in dict.fromkeys((row["sign"], row["points"]) for row in rows):
        own = [row for row in best if (row["sign"], row["points"]) == (sign, where)]
        if own:
            table.append({"points": where, "sign": sign} | spread(own, "ratio", lambda row: f"{row['mesh']}, {row['peer']}") |
                         {"at least": own[0]["at least"], "goal": own[0]["goal"]})
    return table


def points(rows):
    shown = ("mesh", "triangles", "points", "asked", "sign", "peer", "order", "standoff processor s", "peer processor s", "ratio", "ratio on the wall",
             "largest error", "peer's largest error", "wrong signs", "peer's wrong signs", "compared", "from libigl", "signs unlike libigl's")
    kept = [key for key in shown if any(row.get(key) for row in rows)]
    return f"{markdown(points_summary(rows))}\n\n" + markdown([{key: row.get(key, "") for key in kept} for row in rows])


def build(rows):
    table = []
    for peer in ("embree", "fcpw"):
        found = spread(rows, f"{peer} / standoff", lambda row: row["mesh"])
        if found:
            table.append({"beside": peer} | found | {"at least": rows[0]["at least"], "goal": rows[0]["goal"]})
    return "\n\n".join(markdown(some) for some in (table, rows) if some)


def surfaces(rows):
    table = []
    for peer in dict.fromkeys(row["by"] for row in rows if row.get("ratio")):
        own = [row for row in rows if row["by"] == peer]
        table.append({"beside": peer} | spread(own, "ratio", lambda row: row["field"]) | {"at least": own[0]["at least"], "goal": own[0]["goal"]})
    return "\n\n".join(markdown(some) for some in (table, rows) if some)


def recomputed(rows):
    """Flights side by side that differ in where the field was computed only."""
    table = {}
    for row in rows:
        line = {key: row[key] for key in ("e", "speed", "labyrinth's grid", "samples", "fly's grid")}
        table.setdefault(tuple(line.values()), line)[f"steps a second, {row['on']}"] = row["steps a second"]
    return markdown(list(table.values()))


def plain(rows):
    return markdown(rows)


TABLES = {"points.csv": points, "points-build.csv": build, "iso.csv": surfaces, "files.csv": plain, "sidecars.csv": plain, "limits.csv": plain, "render.csv": plain, "view.csv": plain, "python.csv": plain,
          "python-many.csv": plain, "fly_recompute.csv": recomputed, "fly_large.csv": plain}


def pages(read, between_markers, measured):
    """Only of files that are there."""
    made = {}
    for name, (machine, page, marker) in PLACES.items():
        path, results = DOCS / page, RESULTS / machine / name
        if not results.exists() or not path.exists():
            continue
        comments, rows = read(results)
        rows = [{key: value for key, value in row.items() if key is not None} for row in rows]
        text = made.get(path, path.read_text())
        made[path] = between_markers(text, marker, f"{TABLES[name](rows)}\n\n{measured([*comments, f'results: {machine}'])}")
    return made
