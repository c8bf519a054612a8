# SPDX-License-Identifier: Apache-2.0
"""What docs/methods.md and docs/methods_tables.md say of methods.csv, and two plots of it (those need matplotlib)."""

import re
import statistics
import sys

from harness import BENCH, markdown
from output_quotes import AVX512, RESULTS

DOCS = BENCH.parent / "docs"
SIDE = "128"  # the resolution of which the page speaks; the tables have all
ERRORS = ("largest", "99 %", "mean", "exact %", "wrong %")
COLUMNS = ["method", "mesh", "side", "triangles", "samples", "field", "threads", *[f"near {what}" for what in ERRORS],
           *[f"far {what}" for what in ERRORS], "s", "calls", "MB", "refuses", "note", "near checked", "near signs", "far checked",
           "far signs", "version", "run"]
# The parts of the page, and the methods whose rows stand there.
PARTS = {"brute": ["brute force", "standoff thesis"], "thesis": ["standoff thesis, band"], "tiles": ["standoff tiles, band", "standoff tiles"],
         "fuhrmann": ["standoff fuhrmann, band"], "propagate": ["standoff propagate", "SDFGen (mesh2sdf)"],
         "jumpflood": ["standoff jumpflood", "standoff jumpflood+1"], "eikonal": ["scikit-fmm", "OpenVDB fast sweeping"],
         "openvdb": ["OpenVDB, band"],
         "voxels": ["SciPy EDT of voxels", "edt of voxels", "ITK Maurer of voxels", "ITK Danielsson of voxels", "ITK chamfer of voxels"],
         "trees": ["Embree", "FCPW", "libigl", "Open3D", "point-cloud-utils", "VTK", "pysdf"]}

TABLES = """# All methods, all meshes

This page is written by `script/bench methods`, from [its CSV file](../bench/results/{machine}/methods.csv).
[methods.md](methods.md) explains the methods and the columns.

{measured}
"""


def read(path):
    import quotes  # which includes this file
    return quotes.read(path)


def number(text):
    return float(text) if text else None


def three(text):
    """Three digits, and rounding where a number is nothing else."""
    value = number(text)
    if value is None:
        return ""
    if value == 0 or value >= 1e4:
        return f"{value:.0f}"
    return f"{value:.1e}" if value < 1e-3 else f"{value:.3g}"


def shown(row, with_mesh):
    """A row of a table. Errors are in samples."""
    cells = {"method": f"{row['method']}"}
    cells |= {"mesh": row["mesh"]} if with_mesh else {"samples": row["side"]}
    for where in ("near", "far"):
        cells |= {f"{where}: largest": three(row[f"{where} largest"]), f"{where}: 99 %": three(row[f"{where} 99 %"]),
                  f"{where}: mean": three(row[f"{where} mean"]), f"{where}: right, %": row[f"{where} exact %"],
                  f"{where}: wrong signs, %": row[f"{where} wrong %"]}
    return cells | {"s": row["note"] if row["note"] else row["s"], "MB": row["MB"], "threads": row["threads"]}


def part(rows, methods):
    """The rows of some methods at one resolution."""
    own = [row for name in methods for row in rows if row["method"] == name and row["side"] == SIDE]
    return markdown([shown(row, True) for row in own]) if own else "Not measured."


def worst(rows, column):
    known = [float(row[column]) for row in rows if row[column]]
    return three(f"{max(known)}") if known else ""


def summary(rows):
    """A line for each method: the worst of all its meshes and resolutions."""
    table = []
    for name in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == name]
        done = [row for row in own if row["s"]]
        bunny = next((row for row in own if row["mesh"] == "bunny" and row["side"] == SIDE), None)
        notes = dict.fromkeys(row["note"] for row in own if row["note"])
        table.append({"method": name, "field": own[0]["field"], "cases": f"{len(done)} of {len(own)}",
                      "near: largest error": worst(done, "near largest"), "near: 99 %": worst(done, "near 99 %"), "near: mean": worst(done, "near mean"),
                      "near: wrong signs, %": worst(done, "near wrong %"), "far: 99 %": worst(done, "far 99 %"),
                      "bunny, s": (bunny["s"] or bunny["note"]) if bunny else "", "bunny, MB": bunny["MB"] if bunny else "",
                      "refuses": own[0]["refuses"], "where there is nothing": "; ".join(notes)})
    return markdown(table)


def machine(comments, rows):
    runs = sorted({row["run"] for row in rows})
    return f"Measured: {'; '.join(comments)}; rows of: {', '.join(runs)}. Results: {AVX512}."


def pages(read_csv, between_markers, results=RESULTS / AVX512):
    """{file: what it should hold}"""
    path, page = results / "methods.csv", DOCS / "methods.md"
    if not path.exists() or not page.exists():
        return {}
    comments, rows = read_csv(path)
    measured = machine(comments, rows)
    text = between_markers(page.read_text(), "methods summary", f"{summary(rows)}\n\n{measured}")
    for name, methods in PARTS.items():
        text = between_markers(text, f"methods {name}", part(rows, methods))
    sections = [TABLES.format(machine=AVX512, measured=measured)]
    for mesh in dict.fromkeys(row["mesh"] for row in rows):
        own = [row for row in rows if row["mesh"] == mesh]
        names = list(dict.fromkeys(row["method"] for row in own))
        own.sort(key=lambda row: names.index(row["method"]))
        sections.append(f"## {mesh}: {int(own[0]['triangles']):,} triangles\n\n{markdown([shown(row, False) for row in own])}\n")
    return {page: text, DOCS / "methods_tables.md": "\n".join(sections)}


# ---- Plots ----

COLOURS = {"standoff": "#b3202a", "OpenVDB": "#2a6db3", "SciPy": "#7a7a7a", "edt": "#7a7a7a", "ITK": "#7a7a7a"}


def colour(method):
    return next((of for start, of in COLOURS.items() if method.startswith(start)), "#4a8a4a")


def draw_errors(rows, path, plt):
    """The 99 % of errors near the surface over the time, of all methods on the bunny."""
    own = [row for row in rows if row["mesh"] == "bunny" and row["side"] == SIDE and row["s"]]
    figure, axes = plt.subplots(figsize=(7, 5))
    for row in own:
        x, y = float(row["s"]), max(float(row["near 99 %"]), 1e-8)
        axes.loglog(x, y, "o" if row["field"] == "full" else "^", color=colour(row["method"]), markersize=5)
    spread_labels(axes, [(float(row["s"]), max(float(row["near 99 %"]), 1e-8), row["method"]) for row in own])
    axes.set(xlabel="seconds", ylabel="error, in samples: 99 % near the surface are better")
    axes.set_title("bunny, 128 samples on the longest side (triangles: bands only)", loc="left", fontsize=9)
    axes.grid(True, which="major", alpha=0.3)
    finish(figure, axes, path, plt)


def spread_labels(axes, labels):
    """Beside their points; those that would overlap move up."""
    used = []
    for x, y, text in sorted(labels, key=lambda one: (one[1], one[0])):
        at = y
        while any(abs(statistics.log(at / other)) < 0.35 and 0.03 < x / x2 < 30 for x2, other in used) if hasattr(statistics, "log") else False:
            at *= 1.4
        used.append((x, at))
        axes.annotate(text, (x, y), (5, 0), textcoords="offset points", fontsize=7, va="center")


def draw_triangles(rows, path, plt):
    """The time over the number of triangles, of all methods at one resolution."""
    figure, axes = plt.subplots(figsize=(7, 5))
    ends = []
    for name in dict.fromkeys(row["method"] for row in rows):
        own = sorted((int(row["triangles"]), float(row["s"])) for row in rows if row["method"] == name and row["side"] == SIDE and row["s"])
        if not own:
            continue
        axes.loglog(*zip(*own), "o-", color=colour(name), markersize=3, linewidth=1)
        ends.append((*own[-1], name))
    spread_labels(axes, ends)
    axes.set(xlabel="triangles", ylabel="seconds")
    axes.set_title("128 samples on the longest side", loc="left", fontsize=9)
    axes.grid(True, which="major", alpha=0.3)
    finish(figure, axes, path, plt)


def finish(figure, axes, path, plt):
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    print(f"wrote {path}", file=sys.stderr)


def draw(rows):
    try:
        import matplotlib
    except ImportError:
        print("bench: no plots without matplotlib (Debian: python3-matplotlib)", file=sys.stderr)
        return
    matplotlib.use("Agg")
    matplotlib.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": "standoff"}
    from matplotlib import pyplot
    draw_errors(rows, DOCS / "images" / "methods_error.svg", pyplot)
    draw_triangles(rows, DOCS / "images" / "methods_triangles.svg", pyplot)


def write():
    import quotes
    made = pages(quotes.read, quotes.between_markers)
    for path, text in made.items():
        path.write_text(text)
    if made:
        draw(quotes.read(RESULTS / AVX512 / "methods.csv")[1])
