# SPDX-License-Identifier: Apache-2.0
"""Figure 5.5 of the thesis, rebuilt and carried on: how fast the fly flies against the samples of the grid, with a field that
is computed once and with one that is computed anew at each step; what it flies through against its speed, in both modes; and how
fast it is among millions of triangles. Uses the standoff program, and a GPU where there is one that it can use."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from harness import header_of, markdown, results_folder, write_csv

# What else a machine does only makes a flight slower, so the fastest of several counts.
ROUNDS = 3


def told(program, *args):
    """The JSON that a verb of the program prints."""
    command = [str(program), *map(str, args), "--json"]
    print("  " + " ".join(command), file=sys.stderr)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(f"bench: {' '.join(command)} failed")
    return json.loads(done.stdout)


def fly(program, *args, rounds=1):
    return max((told(program, "fly", *args) for _ in range(rounds)), key=lambda line: line["steps_per_second"])


def cells(grid):
    return "x".join(map(str, grid["size"]))


def samples(grid):
    return grid["size"][0] * grid["size"][1] * grid["size"][2]


def rate(line):
    """Steps a second, with as many digits as they are worth."""
    value = line["steps_per_second"]
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def row_of(line, minimum=None):
    crossings, turned = line["wall_crossings"], line["collisions"]
    return {
        "mode": line["mode"], "e": minimum or "", "speed": line["speed"], "grid": cells(line["grid"]),
        "samples": samples(line["grid"]), "steps": line["steps"] * line["flies"],
        "steps a second": rate(line), "collisions": turned, "wall crossings": crossings,
        "share missed": f"{crossings / max(1, crossings + turned):.4f}",
    }


def where(line, threads):
    return line["device_name"] or f"CPU, {threads} thread{'s' if threads > 1 else ''}"


def recompute_row(line, e, threads):
    return {"on": where(line, threads), "e": e, "speed": line["speed"], "labyrinth's grid": cells(line["grid"]),
            "samples": samples(line["grid"]), "fly's grid": cells(line["fly_grid"]), "its samples": samples(line["fly_grid"]),
            "steps": line["steps"], "steps a second": rate(line), "collisions": line["collisions"]}


def places(program):
    """Options and number of threads of each place where a field is recomputed."""
    found = [(["--device", "cpu", "-j", threads], threads) for threads in (1, 2)]
    if any(device["device"].startswith("cuda") for device in told(program, "devices")["devices"]):
        found.append((["--device", "cuda"], 1))
    return found


def recomputed(program, job):
    """One fly, whose field is computed anew at each step."""
    return [recompute_row(fly(program, "--mode", "thesis", "--recompute", "--steps", job["recompute_steps"], "--minimum", e, "--speed",
                              speed, *place, rounds=ROUNDS), e, threads)
            for place, threads in places(program) for speed in job["recompute_speeds"] for e in job["minimums"]]


def among_millions(program, job):
    """The thesis's largest mesh as the labyrinth, so large that the fly finds room in it."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        body = Path(folder) / "large.body"
        triangles = told(program, "build", job["scene"], "--scale", job["scale"], "-o", body)["mesh"]["triangles"]
        ways = [("sweep", 1, ["-j", 1]), ("thesis", 1, ["--mode", "thesis", "-j", 1])]
        ways += [("thesis, recomputed", threads, ["--mode", "thesis", "--recompute", *place]) for place, threads in places(program)]
        for speed in job["speeds"]:
            for name, threads, args in ways:
                steps = job["recompute_steps" if "recomputed" in name else "steps"]
                line = fly(program, "--labyrinth", body, "--steps", steps, "--speed", speed, *args, rounds=ROUNDS)
                rows.append({"triangles": f"{triangles:,}", "mode": name, "on": where(line, threads), "speed": speed,
                             "grid": cells(line["grid"]), "steps": steps, "steps a second": rate(line),
                             "collisions": line["collisions"], "wall crossings": line["wall_crossings"]})
    return rows


def run(workloads, build, note=""):
    program, job = Path(build) / "standoff", workloads["fly"]
    if not program.exists():
        raise SystemExit(f"bench: no {program}; build it with script/bench")
    common = ["--flies", 4, "-j", 1]
    by_grid = [row_of(fly(program, *common, "--steps", job["grid_steps"], "--mode", "thesis", "--minimum", e, "--speed",
                          speed, rounds=ROUNDS), e)
               for speed in job["grid_speeds"] for e in job["minimums"]]
    by_speed = [row_of(fly(program, *common, "--steps", job["steps"], "--mode", mode, "--speed", speed, rounds=ROUNDS))
                for mode in ("thesis", "sweep") for speed in job["speeds"]]
    recompute, large = recomputed(program, job), among_millions(program, job["large"])
    header, folder = [*header_of(build, note), f"the fastest of {ROUNDS} flights"], results_folder()
    for name, rows in (("grid", by_grid), ("speed", by_speed), ("recompute", recompute), ("large", large)):
        print(markdown(rows) + "\n")
        write_csv(folder / f"fly_{name}.csv", header, rows)
