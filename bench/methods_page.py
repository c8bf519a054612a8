# SPDX-License-Identifier: Apache-2.0
"""What docs/methods.md and docs/methods_tables.md say of methods.csv, and two plots of it (those need matplotlib)."""

import sys

from harness import BENCH, markdown
from output_quotes import AVX512, RESULTS
from plot_style import BLUE, FAINT, RED, SERIES, pyplot, save

DOCS = BENCH.parent / "docs"
SIDE = "128"  # the resolution of which the page speaks; the tables have all
ERRORS = ("largest", "99 %", "mean", "exact %", "wrong %")
COLUMNS = ["method", "mesh", "side", "triangles", "edge", "samples", "field", "threads", *[f"near {what}" for what in ERRORS],
           *[f"far {what}" for what in ERRORS], "s", "processor s", "calls", "MB", "refuses", "note", "near wrong outside %", "far wrong outside %",
           "near checked", "near signs", "far checked", "far signs", "version", "run"]
# The parts of the page, and the methods whose rows stand there.
PARTS = {"brute": ["brute force", "standoff thesis"], "thesis": ["standoff thesis, band"], "tiles": ["standoff tiles, band", "standoff tiles"],
         "fuhrmann": ["standoff fuhrmann, band", "standoff tiles, sign facet", "standoff tiles, sign normal"], "propagate": ["standoff propagate", "SDFGen (mesh2sdf)"],
         "jumpflood": ["standoff jumpflood", "standoff jumpflood+1"], "eikonal": ["scikit-fmm", "OpenVDB fast sweeping"],
         "openvdb": ["OpenVDB, band"],
         "voxels": ["SciPy EDT of voxels", "edt of voxels", "ITK Maurer of voxels", "ITK Danielsson of voxels", "ITK chamfer of voxels"],
         "trees": ["Embree", "FCPW", "libigl", "Open3D", "point-cloud-utils", "VTK", "pysdf"]}

MESHES = {"catapult": "CAD: few large triangles, parts that overlap (scene)", "nested": "five spheres in each other, every other one inside out (scene)",
          "bunny": "a scan (bunny.obj)", "terrain": "a surface with a border (scene)",
          "bunny-fine": "the surface of bunny, each triangle split into 16"}

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
    return cells | {"s": row["note"] or row["s"], "processor s": row["processor s"], "MB": row["MB"], "threads": row["threads"]}


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
                      "bunny, s": (bunny["s"] or bunny["note"]) if bunny else "", "processor s": bunny["processor s"] if bunny else "", "bunny, MB": bunny["MB"] if bunny else "",
                      "refuses": own[0]["refuses"], "where there is nothing": "; ".join(notes)})
    return markdown(table)


def spread(rows, column, unit=""):
    """The least and the largest of a column."""
    known = [float(row[column]) for row in rows if row[column]]
    if not known:
        return "not measured"
    low, high = three(f"{min(known)}"), three(f"{max(known)}")
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}"


def by_mesh(rows, column, unit=""):
    """A column's spread over the resolutions of each mesh, and how long its triangles are."""
    parts = []
    for mesh in dict.fromkeys(row["mesh"] for row in rows if row[column]):
        own = [row for row in rows if row["mesh"] == mesh]
        parts.append(f"{mesh} {spread(own, column, unit)}")
    return "; ".join(parts) or "not measured"


def growth(rows, name):
    """How many times the processor time grows from bunny to bunny-fine, which has sixteen times the triangles."""
    of = {(row["mesh"], row["side"]): float(row["processor s"]) for row in rows if row["method"] == name and row["s"]}
    ratios = [of["bunny-fine", side] / of["bunny", side] for mesh, side in of if mesh == "bunny" and ("bunny-fine", side) in of]
    shown_ratios = list(dict.fromkeys(f"{ratio:.1f}" for ratio in (min(ratios), max(ratios)))) if ratios else []
    return f"{' to '.join(shown_ratios)} times" if ratios else "not measured"


def claims(rows):
    """What the thesis says, and what was measured."""
    of = lambda *names: [row for row in rows if row["method"] in names]
    right = lambda name: f"near {spread(of(name), 'near exact %', ' %')}, far {spread(of(name), 'far exact %', ' %')}"
    table = [
        ("Fuhrmann: \"suffers of sign errors if the size of the triangles becomes too large\" (4.4)",
         f"wrong signs near the surface, of samples outside: {by_mesh(of('standoff fuhrmann, band'), 'near wrong outside %', ' %')}"),
        ("Fuhrmann: \"asymptotic time complexity [...] is O(nm)\" (4.4)",
         f"16 times the triangles, the same surface: {growth(rows, 'standoff fuhrmann, band')} the time"),
        ("Satherley and Jones: \"the correct distance for 90% of voxels\" (2.1)",
         f"right within 0.001 sample: vector propagation {right('standoff propagate')}; SDFGen {right('SDFGen (mesh2sdf)')}"),
        ("EVDT on binary data: \"the correct distance to less than 1% of voxels\" (2.1)",
         f"right within 0.001 sample: exact transform of voxels {right('edt of voxels')}; ITK's Danielsson {right('ITK Danielsson of voxels')}"),
        ("Algorithm 1: \"some errors in distance values can become a problem if the size of the triangles becomes too large\" (4.1)",
         f"largest error near the surface, in samples: {by_mesh(of('standoff thesis, band'), 'near largest')}"),
        ("Algorithm 1: O(nm), if almost no triangle is skipped (4.4)",
         f"16 times the triangles, the same surface: {growth(rows, 'standoff thesis, band')} the time"),
    ]
    return markdown([{"the thesis says": said, "measured here": found} for said, found in table])


def meshes(rows):
    """The meshes, and the length of their triangles at each resolution."""
    table = []
    for mesh in dict.fromkeys(row["mesh"] for row in rows):
        own = {row["side"]: row for row in rows if row["mesh"] == mesh}
        table.append({"mesh": mesh, "what": MESHES[mesh], "triangles": f"{int(next(iter(own.values()))['triangles']):,}"} |
                     {f"longest edge at {side}": row["edge"] for side, row in own.items()})
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
    text = between_markers(text, "methods meshes", meshes(rows))
    text = between_markers(text, "methods claims", claims(rows))
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

GROUPS = {"standoff": ("standoff", RED), "of voxels": ("transforms of voxels", SERIES[2]), "OpenVDB": ("fronts and OpenVDB", BLUE),
          "scikit": ("fronts and OpenVDB", BLUE), "": ("other libraries", FAINT)}
LEAST = 1e-8  # errors below it are drawn there


def group(method):
    return next(of for part, of in GROUPS.items() if part in method)


def place_labels(axes, labels):
    """Names beside their points, from the lowest up; one that would cover another or a point moves up, with a line to its
    point."""
    axes.figure.canvas.draw()
    to_pixels = axes.transData.transform
    taken = [(px - 4, px + 4, py) for px, py in (to_pixels(label[:2]) for label in labels)]
    for x, y, text, colour in sorted(labels, key=lambda one: (one[1], one[0])):
        px, py = to_pixels((x, y))
        left_end, width, height, at = px + 6, 6 * len(text), 9, py
        while any(left_end < right and left < left_end + width and abs(at - middle) < height for left, right, middle in taken):
            at += 1
        taken.append((left_end, left_end + width, at))
        line = {"arrowstyle": "-", "color": colour, "linewidth": 0.4, "shrinkA": 0, "shrinkB": 2} if at - py > 4 else None
        axes.annotate(text, (x, y), (7, (at - py) * 72 / axes.figure.dpi), textcoords="offset points", fontsize=6.5, va="center", color=colour,
                      arrowprops=line)


def legend(axes, plt):
    shown = dict(GROUPS.values())
    axes.legend([plt.Line2D([], [], color=colour, marker="o", linestyle="") for colour in shown.values()], shown, fontsize=7, frameon=False,
                loc="upper left", bbox_to_anchor=(0, -0.1), ncols=4)


def draw_errors(rows, path, plt):
    """Near the surface and far from it: the errors over the time, of all methods on the bunny."""
    figure, panels = plt.subplots(1, 2, figsize=(12, 6), dpi=100, sharey=True)
    names = []
    for axes, where in zip(panels, ("near", "far")):
        own = [row for row in rows if row["mesh"] == "bunny" and row["side"] == SIDE and row["s"] and row[f"{where} 99 %"] and ", sign" not in row["method"]]
        labels = [(float(row["processor s"]), max(float(row[f"{where} 99 %"]), LEAST), row["method"].removeprefix("standoff "), group(row["method"])[1])
                  for row in own]
        for (x, y, _, colour), row in zip(labels, own):
            axes.loglog(x, y, "o" if row["field"] == "full" else "^", color=colour, markersize=5)
        if labels:
            axes.set_xlim(min(one[0] for one in labels) / 1.5, max(one[0] for one in labels) * 8)
            axes.set_ylim(LEAST, 30)
        axes.set_xlabel("processor seconds, of all threads", fontsize=9)
        if where == "near":
            axes.set_ylabel("error in samples: 99 % of the samples are better", fontsize=9)
        axes.set_title(f"bunny, {SIDE} samples on the longest side, {where} the surface" if where == "near" else "far from it", loc="left", fontsize=9)
        axes.grid()
        names.append((axes, labels))
        axes.tick_params(labelsize=8)
    legend(panels[0], plt)
    panels[1].text(1, -0.12, "triangles: bands only", transform=panels[1].transAxes, fontsize=7, ha="right")
    finish(figure, names, path, plt)


def draw_triangles(rows, path, plt):
    """The time over the number of triangles, of all methods at one resolution."""
    figure, axes = plt.subplots(figsize=(9, 7), dpi=100)
    ends = []
    for name in dict.fromkeys(row["method"] for row in rows):
        own = sorted((int(row["triangles"]), float(row["processor s"])) for row in rows if row["method"] == name and row["side"] == SIDE and row["s"])
        if own and ", sign" not in name:
            axes.loglog(*zip(*own), "o-", color=group(name)[1], markersize=3, linewidth=0.8)
            ends.append((*own[-1], name.removeprefix("standoff "), group(name)[1]))
    counts = {int(row["triangles"]): row["mesh"] for row in rows}
    if ends:
        axes.set_xlim(min(counts) / 1.2, max(counts) * 6)
        axes.set_ylim(top=3 * axes.get_ylim()[1])
    axes.set_xlabel("triangles", fontsize=9)
    axes.set_ylabel("processor seconds, of all threads", fontsize=9)
    axes.set_title(f"{SIDE} samples on the longest side; from the left: {', '.join(counts[count] for count in sorted(counts))}", loc="left", fontsize=9)
    axes.grid()
    legend(axes, plt)
    axes.tick_params(labelsize=8)
    finish(figure, [(axes, ends)], path, plt)


def finish(figure, names, path, plt):
    figure.tight_layout()
    for axes, labels in names:
        place_labels(axes, labels)
    save(figure, path)
    plt.close(figure)


def draw(rows, plt):
    draw_errors(rows, DOCS / "images" / "methods_error.svg", plt)
    draw_triangles(rows, DOCS / "images" / "methods_triangles.svg", plt)


def write():
    import quotes
    made = pages(quotes.read, quotes.between_markers)
    for path, text in made.items():
        path.write_text(text)
    plt = pyplot()
    if plt is None:
        print("bench: no plots without matplotlib (Debian: python3-matplotlib)", file=sys.stderr)
    elif made:
        draw(quotes.read(RESULTS / AVX512 / "methods.csv")[1], plt)
