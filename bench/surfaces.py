# SPDX-License-Identifier: Apache-2.0
"""Isosurfaces of one signed field: standoff's marching cubes beside VTK's flying edges and OpenVDB's volumeToMesh. Writes
iso.csv."""

import os
import tempfile
from pathlib import Path

from exact_points import read_mesh
from harness import chosen, header_of, median, peer_python, results_folder, tell, write_csv
from surface_check import closedness, in_words

DEBIANS = "/usr/bin/python3"  # its VTK has TBB, PyPI's has not


def vtk(folder, save):
    """By the Python that STANDOFF_PEER_PYTHON names, and by Debian's: the quicker of the two."""
    named = os.environ.get("STANDOFF_PEER_PYTHON")
    lines = []
    for python in filter(None, dict.fromkeys((named, DEBIANS))):
        os.environ["STANDOFF_PEER_PYTHON"] = python
        lines.append(peer_python("peer_vtk.py", folder, "--repeats", 5, "--save", save))
    os.environ.pop("STANDOFF_PEER_PYTHON")
    if named:
        os.environ["STANDOFF_PEER_PYTHON"] = named
    return min(filter(None, lines), key=lambda line: line["iso_cpu_s"], default=None)


def rows_of(job, limits, lines, found):
    rows = []
    ours, our_processor = median(lines["standoff"], "iso_s"), median(lines["standoff"], "iso_cpu_s")
    for name in lines:
        wall, processor = median(lines[name], "iso_s"), median(lines[name], "iso_cpu_s")
        one = lines[name][0]
        row = {"field": job["what"], "by": " ".join(str(one[key]) for key in ("driver", "version", "backend") if key in one),
               "ms": f"{1e3 * wall:.1f}", "processor ms": f"{1e3 * processor:.1f}", "triangles": one["surface_triangles"],
               "surface": in_words(found[name])}
        rows.append(row if name == "standoff" else row | {
            "ratio": f"{processor / our_processor:.2f}x", "ratio on the wall": f"{wall / ours:.2f}x",
            "at least": f"{limits['at_least']}x", "goal": f"{limits['goal']}x"})
    return rows


def run(drivers, workloads, with_peers, only, rounds, build, note=""):
    job = workloads["iso"]
    rows = []
    for field in chosen(job["fields"], only):
        args = [*field["args"], "--at", str(field.get("at", 0))]
        with tempfile.TemporaryDirectory() as name:
            folder, lines = Path(name), {}
            for _ in range(rounds or job["rounds"]):
                lines.setdefault("standoff", []).append(drivers.run("iso", args, 5, save=folder / "standoff"))
                if not with_peers:
                    continue
                if drivers.has("openvdb_iso"):
                    lines.setdefault("openvdb", []).append(drivers.run("openvdb_iso", args, 5, save=folder / "openvdb"))
                if line := vtk(folder / "standoff", folder / "vtk"):
                    lines.setdefault("vtk", []).append(line)
            rows += rows_of(field, job, lines, {by: closedness(*read_mesh(folder / by)) for by in lines})
    header = header_of(build, note)
    tell(header, rows)
    if not only and with_peers:
        write_csv(results_folder() / "iso.csv", header, rows)
