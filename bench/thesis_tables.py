# SPDX-License-Identifier: Apache-2.0
"""The tables of the 2008 thesis, rebuilt on this machine's CPU with both methods; and the page that shows them beside what
script/gpu-check measured on a GPU (docs/thesis_tables.md), written from the CSV files."""

import json

from gpu_jobs import GROWTH_SAMPLES, GROWTH_UNITS, rows_of, thesis_thickness
from harness import BENCH, machine_lines, markdown, results_folder, seconds, write_csv

# Its grids are the meshes' boxes grown by this many units on all sides (its thickness).
MARGIN = 2
# Work beyond this many examined samples is measured once, not three times.
LONG_WORK = 2e8

PAGE = """# The thesis's tables, rebuilt

This page is written by `script/bench thesis`, from CSV files: `bench/run.py quote` writes it again. It repeats Tables 5.1
to 5.5 of the thesis (Fagerjord and Lochehina, 2008) with both methods of standoff: `thesis`, its Algorithm 1, and
`tiles`, which is exact; and the time of its Figure 1.1.

**The meshes are stand-ins.** The thesis's meshes are not public. The meshes used here are made by code (`scenes/`). They
have the same numbers of triangles and the same extents, and are scaled, or stretched per axis, to the same grids. The
numbers of skipped triangles and of examined samples depend on the order and the shapes of the triangles, so they are
close to the thesis's numbers, but not equal.

- The *2008* columns are from the thesis. Its seconds are for a GeForce 8800 GTS 512 MB (in Table 5.5, for that and for
  its CPU emulation).
- *s*: measured on a CPU, with {threads} threads. A time is the median of the warm calls.
- *{card}, ms*: measured on one {card}, on another machine and in another run, by `script/gpu-check`
  ([its files](../bench/results/{gpu_folder})): medians, from device memory to device memory, with the triangles there
  already. Algorithm 1 ran there without its skip rule, so it examined more samples than on the CPU (`samples_examined`
  in `gpu.csv`). The errors are of the runs on the CPU.
- *units* is the box of the grid in the thesis's units ("resolution"); the mesh's box is {margin} units smaller on each side.
- *examined* counts point-triangle distances. The thesis gives its thickness as 2 units, but its counts fit triangle
  boxes that are grown by less: by {growth_units} units plus {growth_samples} samples, which is 1 unit on a unit grid (8.0
  samples for a small triangle). Both methods ran with this thickness.
- *largest error* and *mean error* compare the field of the method `thesis` with the exact one over the band, in
  samples. The errors come from triangles that its skip rule drops.

Measured on the CPU:
{machine}

Measured on the GPU:
{gpu_machine}

{sections}"""

FIGURE_1_1 = """## Figure 1.1: the bender

The thesis says nothing of the thickness here; ours is 2 units on its grid. {card} alone: this was not measured on the CPU.

{table}
"""

TABLE_5_4 = """## Table {number}: {title}

The thesis left a part of its kernel out and measured again: *2008, s* is what remained, *weight* the part. So did
`script/gpu-check`, for {triangles} triangles of the factory on a grid of {grid} samples: *{card}, ms* is the difference of
two medians, with the part and without. It may come out below zero where a part costs nothing that can be measured.

Four of the thesis's parts were not measured apart. Its kernel computes the closest point, the vector to it and its square
one after the other; ours computes them together, within *point-triangle work*. Nor is there a run without any kernel. The
thesis found that it wrote to memory whether or not a distance was smaller; both ways were measured here.

{table}

`tiles`, on the same grid:

{tiles}
"""


def arguments(mesh, row):
    """The workload of one row, and its thickness in units."""
    numbers = lambda values: ",".join(str(v) for v in values)
    place = ["--scale", str(row["scale"])] if "scale" in row else ["--margin", str(MARGIN)]
    return ["--scene", mesh["scene"], "--size", numbers(row["grid"]), "--extent", numbers(row["extent"]), *place,
            "--thickness", f"{thesis_thickness(row['grid'], row['extent']):.6g}"]


def by_axis(numbers):
    return "x".join(str(n) for n in numbers)


def percent(share):
    return f"{round(100 * share)} %"


def measure(drivers, table, mesh, row):
    """One row: the thesis's figures and ours."""
    args = [*arguments(mesh, row), "--output", "dense"]
    thesis = drivers.run("standoff", args, 2 if row["examined"] > LONG_WORK else 4, method="thesis", check=True)
    tiles = drivers.run("standoff", args, 4, method="tiles")
    check = thesis["check"]
    return {
        "table": table["number"], "mesh": mesh["mesh"], "scene": mesh["scene"], "triangles": thesis["triangles"],
        "grid": by_axis(row["grid"]), "units": by_axis(row["extent"]),
        "skipped_2008": row["skipped"], "skipped": thesis["skipped"],
        "examined_2008": row["examined"], "examined": thesis["samples_examined"],
        "seconds_2008": row.get("cpu_seconds", row["seconds"]),
        "thesis_s": round(thesis["warm_s"], 6), "tiles_s": round(tiles["warm_s"], 6),
        "largest_error_samples": round(check["largest_error_samples"], 4),
        "mean_error_samples": round(check["mean_error_samples"], 6),
        "threads": thesis["threads"],
    }


def shown(row, before, on_gpu, card):
    """A row of a CSV file as the page shows it, beside the GPU's times; the mesh is named where it changes."""
    again = before and before["mesh"] == row["mesh"]
    whole = lambda name: f"{int(row[name]):,}"
    two = lambda text: f"{float(text):.2f}"
    gpu = [on_gpu.get(method) for method in ("thesis", "tiles")]
    # Table 5.5's seconds are those of the thesis's CPU emulation; its card's stand beside the GPU's times.
    past = {"2008, emulation, s": two(row["seconds_2008"])} if row["table"] == "5.5" else {"2008, s": two(row["seconds_2008"])}
    if row["table"] == "5.5" and gpu[0]:
        past = {"2008, s": two(gpu[0]["seconds_2008"])} | past
    return {
        "mesh": "" if again else row["mesh"], "triangles": "" if again else whole("triangles"),
        "units": row["units"], "grid": row["grid"],
        "skipped 2008": whole("skipped_2008"), "skipped": whole("skipped"),
        "examined 2008": whole("examined_2008"), "examined": whole("examined"), **past,
        "thesis, s": seconds(float(row["thesis_s"])), "tiles, s": seconds(float(row["tiles_s"])),
        **{f"{method}, {card}, ms": f"{float(one['median_ms']):.3g}" if one else "-" for method, one in zip(("thesis", "tiles"), gpu)},
        "largest error": f"{float(row['largest_error_samples']):.4f}", "mean error": f"{float(row['mean_error_samples']):.6f}",
    }


def figure_1_1(gpu_rows, card):
    rows = {row["method"]: row for row in gpu_rows if row["table"] == "figure_1.1"}
    one = rows["thesis"]
    return {"mesh": "Bender", "triangles": f"{int(one['triangles']):,}", "grid": one["grid"], "2008, s": one["seconds_2008"],
            **{f"{method}, {card}, ms": f"{float(rows[method]['median_ms']):.3g}" for method in ("thesis", "tiles")}}


def table_5_4(bottlenecks, parts, card):
    """The thesis's parts beside ours, and the parts of `tiles`."""
    ms = {method: {part["part"]: float(part["ms"]) for part in parts if part["method"] == method} for method in ("thesis", "tiles")}
    measured = lambda method, part: {f"{card}, ms": f"{ms[method][part]:.3g}", f"{card}, share": percent(ms[method][part] / ms[method]["all"])}
    rows = []
    for part in bottlenecks["parts"]:
        past = {"part left out": part["excluded"] or "-", "2008, s": part["seconds"], "weight": part["weight"],
                "2008, share": part["weight"] and percent(part["weight"] / bottlenecks["parts"][0]["seconds"])}
        now = measured("thesis", part["measured"]) if part["measured"] in ms["thesis"] else {f"{card}, ms": "-", f"{card}, share": "-"}
        rows.append({key: "-" if value is None else value for key, value in past.items()} | {"measured here": part["measured"] or "-"} | now)
    return rows, [{"part": part} | measured("tiles", part) for part in ms["tiles"]]


def csv_of(path):
    """What the file's comments say, and its rows."""
    return [line[2:] for line in path.read_text().splitlines() if line.startswith("#")], rows_of(path)


def page(results, gpu_results):
    """The page, from the CSV files of a CPU and of a GPU."""
    thesis = json.loads((BENCH / "thesis.json").read_text())
    machine = (gpu_results / "machine.txt").read_text().splitlines()
    card = machine[1].split(",")[0].split()[-1]
    gpu_rows = rows_of(gpu_results / "gpu.csv")
    on_gpu = {}
    for row in gpu_rows:
        on_gpu.setdefault((row["table"], row["scene"], row["grid"], row["thickness"]), {})[row["method"]] = row
    sections = [FIGURE_1_1.format(card=card, table=markdown([figure_1_1(gpu_rows, card)]))]
    for table in thesis["tables"]:
        comments, rows = csv_of(results / f"thesis-{table['number']}.csv")
        lines = []
        for row, before in zip(rows, [None, *rows]):
            size, extent = ([int(n) for n in row[name].split("x")] for name in ("grid", "units"))
            key = (f"table_{table['number']}", row["scene"], row["grid"], f"{thesis_thickness(size, extent):g}")
            lines.append(shown(row, before, on_gpu.get(key, {}), card))
        sections.append(f"## Table {table['number']}: {table['title']}\n\n{markdown(lines)}\n")
    parts, tiles = table_5_4(thesis["bottlenecks"], rows_of(gpu_results / "table-5.4.csv"), card)
    whole = next(row for row in gpu_rows if row["table"] == "table_5.4" and row["method"] == "thesis")
    sections.insert(-1, TABLE_5_4.format(**thesis["bottlenecks"] | {"table": markdown(parts), "tiles": markdown(tiles)}, card=card,
                                         triangles=f"{int(whole['triangles']):,}", grid=whole["grid"]))
    return PAGE.format(threads=rows[0]["threads"], margin=MARGIN, growth_units=GROWTH_UNITS, growth_samples=GROWTH_SAMPLES, card=card,
                       gpu_folder=gpu_results.name, machine="\n".join(f"- {line}" for line in comments[1:]),
                       gpu_machine="\n".join(f"- {line}" for line in machine[1:]), sections="\n".join(sections))


def run(drivers, only, build):
    """Measures the tables (or those whose number is `only`), prints them, and writes the CSV files."""
    tables = json.loads((BENCH / "thesis.json").read_text())["tables"]
    header, folder = machine_lines(build), results_folder()
    for table in tables:
        if only and only != table["number"]:
            continue
        rows = [measure(drivers, table, mesh, row) for mesh in table["meshes"] for row in mesh["rows"]]
        print(f"\n## Table {table['number']}: {table['title']}\n\n{markdown(rows)}\n")
        if not only:
            write_csv(folder / f"thesis-{table['number']}.csv",
                      ["scenes made by code stand in for the thesis's meshes", *header], rows)
