# SPDX-License-Identifier: Apache-2.0
"""The tables of the 2008 thesis, rebuilt on this machine's CPU with both methods."""

import json

from harness import BENCH, machine_lines, markdown, results_folder, seconds, write_csv

# Its grids are the meshes' boxes grown by this many units on all sides (its thickness).
MARGIN = 2
# Its counts of examined samples, on unit grids and on grids finer than the unit, fit triangle boxes grown by so many
# units and so many samples on all sides: one unit on a unit grid.
GROWTH_UNITS, GROWTH_SAMPLES = 0.58, 0.42
# Work beyond this many examined samples is measured once, not three times.
LONG_WORK = 2e8

INTRODUCTION = """# The thesis's tables, rebuilt

This page is written by `script/bench thesis`. It repeats Tables 5.1, 5.2, 5.3 and the CPU half of 5.5 of the thesis
(Fagerjord and Lochehina, 2008) with both methods of standoff: `thesis`, its Algorithm 1, and `tiles`, which is exact.

**The meshes are stand-ins.** The thesis's meshes are not public. The meshes used here are made by code (`scenes/`). They
have the same numbers of triangles and the same extents, and are scaled, or stretched per axis, to the same grids. The
numbers of skipped triangles and of examined samples depend on the order and the shapes of the triangles, so they are
close to the thesis's numbers, but not equal.

- The *2008* columns are from the thesis. Its seconds are for a GeForce 8800 GTS 512 MB (in Table 5.5, for its CPU
  emulation).
- All other columns were measured here, on the CPU, with {threads} threads. A time is the median of the warm calls.
- *units* is the box of the grid in the thesis's units ("resolution"); the mesh's box is {margin} units smaller on each side.
- *examined* counts point-triangle distances. The thesis gives its thickness as 2 units, but its counts fit triangle
  boxes that are grown by less: by {growth_units} units plus {growth_samples} samples, which is 1 unit on a unit grid (8.0
  samples for a small triangle). Both methods ran with this thickness.
- *largest error* and *mean error* compare the field of the method `thesis` with the exact one over the band, in
  samples. The errors come from triangles that its skip rule drops.

{machine}
"""


def arguments(mesh, row):
    """The workload of one row, and its thickness in units."""
    spacing = [e / g for e, g in zip(row["extent"], row["grid"])]
    thickness = GROWTH_UNITS + GROWTH_SAMPLES * sum(spacing) / 3
    numbers = lambda values: ",".join(str(v) for v in values)
    place = ["--scale", str(row["scale"])] if "scale" in row else ["--margin", str(MARGIN)]
    return ["--scene", mesh["scene"], "--size", numbers(row["grid"]), "--extent", numbers(row["extent"]), *place,
            "--thickness", f"{thickness:.6g}", "--output", "dense"]


def measure(drivers, table, mesh, row):
    """One row: the thesis's figures and ours."""
    args = arguments(mesh, row)
    thesis = drivers.run("standoff", args, 2 if row["examined"] > LONG_WORK else 4, method="thesis", check=True)
    tiles = drivers.run("standoff", args, 4, method="tiles")
    cells = "x".join(str(n) for n in row["grid"])
    check = thesis["check"]
    return {
        "table": table["number"], "mesh": mesh["mesh"], "scene": mesh["scene"], "triangles": thesis["triangles"],
        "grid": cells, "units": "x".join(str(n) for n in row["extent"]),
        "skipped_2008": row["skipped"], "skipped": thesis["skipped"],
        "examined_2008": row["examined"], "examined": thesis["samples_examined"],
        "seconds_2008": row.get("cpu_seconds", row["seconds"]),
        "thesis_s": round(thesis["warm_s"], 6), "tiles_s": round(tiles["warm_s"], 6),
        "largest_error_samples": round(check["largest_error_samples"], 4),
        "mean_error_samples": round(check["mean_error_samples"], 6),
        "threads": thesis["threads"],
    }


def shown(row, before):
    """A row as the page shows it; the mesh is named where it changes."""
    again = before and before["mesh"] == row["mesh"]
    return {
        "mesh": "" if again else row["mesh"], "triangles": "" if again else f"{row['triangles']:,}",
        "units": row["units"], "grid": row["grid"],
        "skipped 2008": f"{row['skipped_2008']:,}", "skipped": f"{row['skipped']:,}",
        "examined 2008": f"{row['examined_2008']:,}", "examined": f"{row['examined']:,}",
        "2008, s": f"{row['seconds_2008']:.2f}", "thesis, s": seconds(row["thesis_s"]), "tiles, s": seconds(row["tiles_s"]),
        "largest error": f"{row['largest_error_samples']:.4f}", "mean error": f"{row['mean_error_samples']:.6f}",
    }


def run(drivers, only, build):
    """Rebuilds the tables (or those whose number is `only`), prints them, writes the CSV files and the page."""
    tables = json.loads((BENCH / "thesis.json").read_text())["tables"]
    header, folder, sections, threads = machine_lines(build), results_folder(), [], 2
    for table in tables:
        if only and only != table["number"]:
            continue
        rows = [measure(drivers, table, mesh, row) for mesh in table["meshes"] for row in mesh["rows"]]
        threads = rows[0]["threads"]
        page = [shown(row, before) for row, before in zip(rows, [None, *rows])]
        sections.append(f"## Table {table['number']}: {table['title']}\n\n{markdown(page)}\n")
        print(f"\n{sections[-1]}")
        if not only:
            write_csv(folder / f"thesis-{table['number']}.csv",
                      ["scenes made by code stand in for the thesis's meshes", *header], rows)
    if not only:
        machine = "\n".join(f"- {line}" for line in header)
        introduction = INTRODUCTION.format(threads=threads, margin=MARGIN, growth_units=GROWTH_UNITS,
                                           growth_samples=GROWTH_SAMPLES, machine=machine)
        (BENCH.parent / "docs" / "thesis_tables.md").write_text(introduction + "\n" + "\n".join(sections))
