# SPDX-License-Identifier: Apache-2.0
"""What script/gpu-check measures: lines for tests/gpu_check/measure.cu, and what its rows say together."""

import csv
import json
from collections import Counter
from typing import NamedTuple

from harness import BENCH

# The meshes of the goals, in their grids: cells, then the box in units.
FACTORY = ((414, 406, 413), (414, 406, 413))
CATAPULT = ((412, 404, 416), (412, 404, 416))
CUBE = ((512, 512, 512), (512, 512, 512))
SMALL = ((64, 64, 64), (64, 64, 64))  # of each of many meshes
# The thesis's counts of examined samples, on unit grids and on grids finer than the unit, fit triangle boxes grown by so
# many units and so many samples on all sides: one unit on a unit grid.
GROWTH_UNITS, GROWTH_SAMPLES = 0.58, 0.42


class Job(NamedTuple):
    """One line for measure; what it means stands there."""
    table: str
    scene: str
    triangles: int
    method: str
    output: str
    size: tuple
    extent: tuple
    scale: float
    margin: float
    thickness: float
    seconds_2008: str = "-"
    at_most_ms: str = "-"

    def line(self):
        numbers = [*self.size, *self.extent, self.scale, self.margin, self.thickness]
        return " ".join([self.table, self.scene, str(self.triangles), self.method, self.output,
                         *(f"{n:g}" for n in numbers), self.seconds_2008, self.at_most_ms])

    def key(self):
        """What its row has in common with it."""
        return (self.table, self.scene, self.method, self.output, "x".join(str(n) for n in self.size),
                f"{self.thickness:g}")


def small(job):
    """The same with few triangles, samples and meshes, for the emulated GPU."""
    output = f"{job.output.rpartition('_')[0]}_9" if job.scene == "many" else job.output
    return job._replace(triangles=200, output=output, size=(9, 9, 9), extent=(9, 9, 9), scale=0)


def goal(scene, method, output, grid, thickness, at_most="-", triangles=0):
    return Job("goal", scene, triangles, method, output, *grid, 0, 2, thickness, "-", at_most)


def newton_jobs():
    """The case that Newton publishes: an icosphere of 5,120 triangles. This sphere has 5,000."""
    return [goal("sphere", "tiles", "signed", ((n, n, n), (n, n, n)), float("inf"), triangles=5120) for n in (32, 64, 128)]


def peer_jobs():
    """Those that others are measured at too."""
    return [goal("factory", "tiles", "dense", FACTORY, 2, "1.0"),
            goal("catapult", "tiles", "dense", CATAPULT, 2, "0.4"),
            goal("terrain", "tiles", "dense", CUBE, float("inf"), "25", 1000000)]


def goal_jobs():
    """Those of which we want something: measured before all else."""
    return [*peer_jobs(), goal("factory", "tiles", "sparse", FACTORY, 2, "0.9"),
            goal("machine_2", "tiles", "dense", CUBE, float("inf"), "25", 1000000),
            goal("many", "tiles", "batch_10000", SMALL, 2, "10", 5000)]


def own_jobs():
    """What else we want to know, and where the time goes (Table 5.4)."""
    jobs = [goal("factory", "tiles", output, FACTORY, 2) for output in ("graph", "compute", "host", "upload", "download")]
    jobs += [goal("many", "tiles", output, SMALL, 2, triangles=5000) for output in ("batch_1000", "singles_1000")]
    jobs += [goal("factory", "tiles", output, FACTORY, 2) for output in ("signed_sparse", "signed")]
    jobs += [goal("catapult", "tiles", "signed", CATAPULT, 2)]
    jobs += [goal("factory", "tiles", output, FACTORY, 2) for output in ("nearest", "beside")]
    jobs += newton_jobs()
    jobs += [goal("catapult", "tiles", "sparse", CATAPULT, 2), goal("factory", "thesis", "dense", FACTORY, 2),
             goal("catapult", "thesis", "dense", CATAPULT, 2), goal("factory", "tiles", "dense", FACTORY, 8)]
    bender = ((150, 150, 50), (150, 150, 50))
    jobs += [Job("figure_1.1", "bender", 0, method, "dense", *bender, 0, 2, 2, "0.02") for method in ("tiles", "thesis")]
    parts = {"tiles": ("dense", "through_distance", "through_rows", "through_set_up", "through_lists", "counting"),
             "thesis": ("dense", "write_always", "through_read", "through_distance", "through_lists")}
    for method, seconds in (("tiles", "-"), ("thesis", "0.64")):
        jobs += [Job("table_5.4", "factory", 0, method, output, *FACTORY, 0, 2, 1, seconds) for output in parts[method]]
    return jobs


def thesis_thickness(grid, extent):
    """Of a row of the thesis's tables, in units."""
    return GROWTH_UNITS + GROWTH_SAMPLES * sum(e / g for e, g in zip(extent, grid)) / 3


def thesis_jobs():
    """The rows of the thesis's tables, by both methods."""
    jobs = []
    for table in json.loads((BENCH / "thesis.json").read_text())["tables"]:
        for mesh in table["meshes"]:
            for row in mesh["rows"]:
                for method in ("thesis", "tiles"):
                    jobs.append(Job(f"table_{table['number']}", mesh["scene"], mesh["triangles"], method, "dense",
                                    tuple(row["grid"]), tuple(row["extent"]), row.get("scale", 0), 2,
                                    thesis_thickness(row["grid"], row["extent"]), f"{row['seconds']:g}"))
    return jobs


def rows_of(path):
    """The rows of a CSV file, without its comments; none where it is not there. One that was cut off is left out."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [row for row in rows if None not in row and None not in row.values()]


def left(jobs, rows):
    """The jobs that no row is of. (Small ones may look alike: each row counts for one.)"""
    done = Counter((r["table"], r["scene"], r["method"], r["output"], r["grid"], r["thickness"]) for r in rows)
    missing = []
    for job in jobs:
        if done[job.key()] > 0:
            done[job.key()] -= 1
        else:
            missing.append(job)
    return missing


# What Table 5.4 asks: a part's time is the difference between two outputs' times, with the part and without. The last
# number is the thesis's, in seconds.
PARTS = [
    ("thesis", "all", "dense", "", "0.64"),
    ("thesis", "point-triangle work", "through_distance", "through_lists", "0.46"),
    ("thesis", "memory read", "through_read", "through_distance", "0.03"),
    ("thesis", "memory write where smaller", "dense", "through_read", "-"),
    ("thesis", "memory write always", "write_always", "through_distance", "0.46"),
    ("thesis", "positions of samples and the rest", "through_lists", "", "-"),
    ("tiles", "all", "dense", "", "-"),
    ("tiles", "counting", "counting", "", "-"),
    ("tiles", "listing", "through_lists", "counting", "-"),
    ("tiles", "set-up of triangles", "through_set_up", "through_lists", "-"),
    ("tiles", "finding rows of samples", "through_rows", "through_set_up", "-"),
    ("tiles", "distances", "through_distance", "through_rows", "-"),
    ("tiles", "memory write", "dense", "through_distance", "-"),
]


def table_5_4(rows):
    """What the time goes to, as far as it was measured."""
    ms = {(r["method"], r["output"]): float(r["median_ms"]) for r in rows if r["table"] == "table_5.4"}
    return [{"method": method, "part": part, "ms": f"{ms[method, have] - ms.get((method, without), 0):.6g}",
             "seconds_2008": seconds}
            for method, part, have, without, seconds in PARTS
            if (method, have) in ms and (not without or (method, without) in ms)]
