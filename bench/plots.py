#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""plots.py [NAME ...]: draws the plots of the documentation, docs/images, out of bench/results. Needs matplotlib (Debian:
python3-matplotlib). The same numbers draw the same bytes. Without a name all are drawn: fly, scaling, methods, python."""

import sys

import methods_page
from harness import BENCH
from output_quotes import AVX512, RESULTS
from plot_style import BLUE, FAINT, RED, REST, SERIES, pyplot, save
from quotes import read

IMAGES = BENCH.parent / "docs" / "images"


def rows_of(name):
    return read(RESULTS / AVX512 / name)[1]


def fly(plt):
    """Figure 5.5 of the thesis, and what is missed at which speed."""
    by_grid, by_speed, recompute = (rows_of(f"fly_{name}.csv") for name in ("grid", "speed", "recompute"))
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
    speeds = list(dict.fromkeys(row["speed"] for row in by_grid))
    for color, speed in zip(SERIES, speeds):
        some = [row for row in by_grid if row["speed"] == speed]
        left.plot([float(r["samples"]) for r in some], [float(r["steps a second"]) for r in some], "o-", color=color, label=f"field moves along, speed {speed}")
    for color, on in zip(SERIES[len(speeds) :], dict.fromkeys(row["on"] for row in recompute)):
        some = [row for row in recompute if row["on"] == on and row["speed"] == recompute[0]["speed"]]
        left.plot([float(r["samples"]) for r in some], [float(r["steps a second"]) for r in some], "s--", color=color,
                  label=f"computed anew, speed {some[0]['speed']}, {on}")
    left.set(xscale="log", yscale="log", xlabel="samples of the labyrinth's grid", ylabel="steps a second", title="Thesis mode (Figure 5.5)")
    for mode, color in (("thesis", BLUE), ("sweep", RED)):
        some = [row for row in by_speed if row["mode"] == mode]
        right.plot([float(r["speed"]) for r in some], [100 * float(r["share missed"]) for r in some], "o-", color=color, label=mode, clip_on=False)
    right.set(xscale="log", xlabel="speed, units a step", ylabel="walls passed, % of all that were met", title="Collisions missed", ylim=(0, None))
    for axes in (left, right):
        axes.grid()
    left.set_ylim(bottom=left.get_ylim()[0] / 40)  # room for the legend
    left.legend(fontsize=8, loc="lower left")
    right.legend(loc="upper left")
    figure.tight_layout(w_pad=3)
    save(figure, IMAGES / "fly.png")


def scaling(plt):
    """Time against triangles and against samples."""
    for axis in ("triangles", "samples"):
        comments, rows = read(RESULTS / AVX512 / f"scaling-{axis}-full.csv")
        x = [float(row[axis]) for row in rows]
        warm, cold = ([float(row[name]) for row in rows] for name in ("warm_s", "cold_s"))
        figure, axes = plt.subplots(figsize=(6, 4))
        axes.loglog(x, cold, "s--", color=BLUE, label="first call of a process")
        axes.loglog(x, warm, "o-", color=RED, label="later calls")
        axes.loglog(x, [warm[-1] * n / x[-1] for n in x], ":", color=FAINT, label="linear")
        axes.set(xlabel=axis, ylabel="seconds", title=comments[0])
        axes.grid()
        axes.legend()
        figure.tight_layout()
        save(figure, IMAGES / f"scaling_{axis}.png")


def methods(plt):
    methods_page.draw(rows_of("methods.csv"), plt)


def python(plt):
    """How many samples a second each library finds: a line for each field, a dot for each library."""
    groups = {}
    for row in rows_of("python.csv"):
        groups.setdefault(f"{row['field']}{', signed' if row['sign'] == 'yes' else ''}", []).append(row)
    libraries = list(dict.fromkeys(row["library"] for own in groups.values() for row in own))
    markers = dict(zip(libraries, ["o", "D", "s", "^", "v", "P", "X", "d"]))
    colors = {library: RED if library == "standoff" else SERIES[1:][n % 5] for n, library in enumerate(libraries, -1)}
    figure, axes = plt.subplots(figsize=(9, 4.2))
    for place, own in enumerate(groups.values()):
        axes.axhline(place, color=REST, linewidth=0.8, zorder=0)
        for row in own:
            rate = float(row["samples"]) / float(row["s"]) / 1e6
            axes.plot(rate, place, markers[row["library"]], color=colors[row["library"]], markersize=10 if row["library"] == "standoff" else 6.5,
                      markeredgecolor="white", markeredgewidth=0.7)
    axes.set_yticks(range(len(groups)), list(groups))
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="x")
    axes.set(xlabel="million samples a second")
    handles = [plt.Line2D([], [], marker=markers[library], color=colors[library], linestyle="", label=library) for library in libraries]
    axes.legend(handles=handles, ncols=4, loc="lower left", bbox_to_anchor=(0, 1.01))
    figure.tight_layout()
    save(figure, IMAGES / "python_fields.svg")


PLOTS = {"fly": fly, "scaling": scaling, "methods": methods, "python": python}


if __name__ == "__main__":
    plt = pyplot() or sys.exit("plots.py: needs matplotlib (Debian: python3-matplotlib)")
    wanted = sys.argv[1:] or list(PLOTS)
    if unknown := set(wanted) - PLOTS.keys():
        sys.exit(f"plots.py: no plot {', '.join(sorted(unknown))}; there are {', '.join(PLOTS)}")
    for name in wanted:
        PLOTS[name](plt)
