# SPDX-License-Identifier: Apache-2.0
"""Figure 5.5 of the thesis, rebuilt and carried on: how fast the fly flies against the samples of the grid, and what it
flies through against its speed, in both modes. Uses the standoff program."""

import json
import subprocess
import sys
from pathlib import Path

from harness import machine_lines, markdown, results_folder, write_csv


def fly(program, *args):
    command = [str(program), "fly", "--json", *map(str, args)]
    print("  " + " ".join(command), file=sys.stderr)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"bench: {' '.join(command)} failed")
    return json.loads(done.stdout)


def row_of(line, minimum=None):
    size = line["grid"]["size"]
    crossings, turned = line["wall_crossings"], line["collisions"]
    return {
        "mode": line["mode"], "e": minimum or "", "speed": line["speed"], "grid": "x".join(map(str, size)),
        "samples": size[0] * size[1] * size[2], "steps": line["steps"] * line["flies"],
        "steps a second": f"{line['steps_per_second']:.0f}", "collisions": turned, "wall crossings": crossings,
        "share missed": f"{crossings / max(1, crossings + turned):.4f}",
    }


def plot(path, by_grid, by_speed):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2))
    for speed in dict.fromkeys(row["speed"] for row in by_grid):
        some = [row for row in by_grid if row["speed"] == speed]
        left.plot([r["samples"] for r in some], [float(r["steps a second"]) for r in some], "o-", label=f"speed {speed}")
    left.set(xscale="log", yscale="log", xlabel="samples of the labyrinth's grid", ylabel="steps a second",
             title="thesis mode (Figure 5.5)")
    for mode in ("thesis", "sweep"):
        some = [row for row in by_speed if row["mode"] == mode]
        right.plot([r["speed"] for r in some], [float(r["share missed"]) for r in some], "o-", label=mode)
    right.set(xscale="log", xlabel="speed, units a step", ylabel="wall crossings / (crossings + collisions)",
              title="collisions missed")
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    print(f"wrote {path}", file=sys.stderr)


def run(workloads, build):
    program, job = Path(build) / "standoff", workloads["fly"]
    if not program.exists():
        raise SystemExit(f"bench: no {program}; build it with script/bench")
    common = ["--flies", 4, "-j", 1]
    by_grid = [row_of(fly(program, *common, "--steps", job["grid_steps"], "--mode", "thesis", "--minimum", e, "--speed",
                          speed), e)
               for speed in job["grid_speeds"] for e in job["minimums"]]
    by_speed = [row_of(fly(program, *common, "--steps", job["steps"], "--mode", mode, "--speed", speed))
                for mode in ("thesis", "sweep") for speed in job["speeds"]]
    header, folder = machine_lines(build), results_folder()
    print(markdown(by_grid) + "\n\n" + markdown(by_speed))
    write_csv(folder / "fly_grid.csv", header, by_grid)
    write_csv(folder / "fly_speed.csv", header, by_speed)
    plot(folder / "fly.png", by_grid, by_speed)
