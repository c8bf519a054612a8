# SPDX-License-Identifier: Apache-2.0
"""Every family of distance field algorithms on the same meshes, grids and machine: how exact, which signs, how long, how much
memory. methods_page.py makes the documentation of what is measured here. Needs numpy.

One process measures one method on one mesh at one resolution, so that its memory is its own and a crash is a row. A process
that takes longer than the limit is ended, and that method is not started at larger resolutions of that mesh."""

import datetime
import json
import os
import re
import resource
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import methods_page
import numpy as np
from exact_points import read_mesh
from harness import BENCH, commit, machine_lines, results_folder, write_csv

MARGIN = 4  # samples between the mesh and the border of the grid; also the thickness of bands, in samples
RESOLUTIONS = (64, 128, 256)
CHECKED = 20000  # samples whose exact distances are known, per mesh and resolution
UNCLEAR = 127  # what bench_exact says where no ray tells the winding number
LIMIT = 20  # seconds of all processors together that a call may take
START = 5  # more of them for a process to start, read the mesh and write the values
PATIENCE = 6  # so many times the limit may pass on the wall, on a machine with other work
REPEATS, ENOUGH = 5, 2  # calls in a process; none after so many seconds
BUNNY = "/usr/share/glmark2/models/bunny.obj"

FULL, BAND = "full", f"band of {MARGIN}"


@dataclass
class Shape:
    """A mesh, by the options of a driver. `change` makes other vertices and triangles of its own."""
    name: str
    args: list
    change: object = None
    closed: bool = True


SHAPES = [
    Shape("catapult", ["--scene", "catapult"]),
    # Without the last of its six spheres, which lies inside solid matter.
    Shape("nested", ["--scene", "nested"], change=lambda vertices, triangles: (vertices[:len(vertices) * 5 // 6], triangles[:len(triangles) * 5 // 6])),
    Shape("bunny", ["--mesh", BUNNY]),
    Shape("terrain", ["--scene", "terrain"], closed=False),
    Shape("bunny-fine", ["--mesh", BUNNY], change=lambda *mesh: split_in_four(*split_in_four(*mesh))),
]


@dataclass
class Method:
    """`driver` is one of the harness's programs, or "python" for peer_methods.py with the peer named by `args`. `solid`: it
    knows the border of what is inside and not the triangles, so that no surface inside solid matter counts."""
    name: str
    driver: str
    args: list
    field: str = FULL
    threads: int = 2
    signed: bool = True
    refuses: str = ""
    solid: bool = False


def ours(method, field_kind, sign="auto", name=None, refuses=""):
    output = ["--output", "sparse"] if field_kind == BAND else ["--output", "dense"]
    return Method(name or f"standoff {method}", "standoff", ["--method", method, "--sign", sign, *output], field_kind, refuses=refuses)


def python(name, peer, threads=2, signed=True, refuses="", solid=False):
    return Method(name, "python", [peer, *(["--signed"] if signed else [])], FULL, threads, signed, refuses, solid)


def voxels(name, peer, threads):
    return python(name, peer, threads, refuses="meshes: needs voxels", solid=True)


METHODS = [
    ours("tiles", BAND, name="standoff tiles, band"),
    ours("tiles", FULL, name="standoff tiles"),
    ours("thesis", BAND, name="standoff thesis, band"),
    ours("thesis", FULL, name="standoff thesis"),
    ours("fuhrmann", BAND, sign="facet", name="standoff fuhrmann, band", refuses="full fields"),
    ours("tiles", FULL, sign="facet", name="standoff tiles, sign facet", refuses="meshes without orientation: wrong signs"),
    ours("tiles", FULL, sign="normal", name="standoff tiles, sign normal", refuses="meshes without orientation: wrong signs"),
    ours("propagate", FULL),
    ours("jumpflood", FULL),
    ours("jumpflood+1", FULL),
    Method("brute force", "exact", [], signed=False, refuses="signs"),
    Method("Embree", "embree", [], signed=False, refuses="signs"),
    python("FCPW", "fcpw", signed=False, refuses="signs"),
    python("libigl", "libigl"),
    python("Open3D", "open3d"),
    python("point-cloud-utils", "pcu"),
    python("VTK", "vtk", threads=1),
    python("pysdf", "pysdf"),
    Method("OpenVDB, band", "openvdb", ["--signed"], BAND, refuses="full fields; cells that are no cubes", solid=True),
    Method("OpenVDB fast sweeping", "openvdb", ["--sweep"], refuses="cells that are no cubes", solid=True),
    python("scikit-fmm", "skfmm", threads=1, refuses="meshes: needs distances near the surface; open surfaces", solid=True),
    python("SDFGen (mesh2sdf)", "mesh2sdf", threads=1, refuses="grids that are no cube"),
    voxels("SciPy EDT of voxels", "scipy", 1),
    voxels("edt of voxels", "edt", 2),
    voxels("ITK Maurer of voxels", "maurer", 2),
    voxels("ITK Danielsson of voxels", "danielsson", 1),
    voxels("ITK chamfer of voxels", "chamfer", 1),
]


# ---- Meshes and truth ----

def split_in_four(vertices, triangles):
    """Each triangle by the middles of its edges, which neighbours share."""
    edges = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, of_edge = np.unique(edges, axis=0, return_inverse=True)
    middles = (len(vertices) + of_edge.reshape(-1, 3)).astype(np.uint32)
    (a, b, c), (ab, bc, ca) = triangles.T, middles.T
    new = np.stack([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))], axis=1).reshape(-1, 3)
    return np.vstack([vertices, vertices[unique].mean(axis=1)]), new


def write_ply(path, vertices, triangles):
    """With double coordinates, so that nothing moves."""
    faces = np.empty(len(triangles), dtype=[("n", "u1"), ("v", "<u4", 3)])
    faces["n"], faces["v"] = 3, triangles
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty double x\nproperty double y\n"
              f"property double z\nelement face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + vertices.astype("<f8").tobytes() + faces.tobytes())


class Case:
    """A mesh at a resolution: the arguments of drivers, the folder for other programs, and the truth of some samples."""

    def __init__(self, drivers, work, shape, side):
        self.shape, self.side, self.folder = shape, side, work / f"{shape.name}-{side}"
        mesh = shape.args
        if shape.change:
            path = work / f"{shape.name}.ply"
            if not path.exists():
                drivers.run("exact", [*shape.args, "--samples", "64", "--margin", str(MARGIN), "--full"], None, truth=work / "before", count=2)
                write_ply(path, *shape.change(*read_mesh(work / "before")))
            mesh = ["--mesh", str(path)]
        self.args = [*mesh, "--samples", str(side), "--margin", str(MARGIN)]
        if not (self.folder / "given.f32").exists():
            drivers.run("exact", [*self.args, "--full"], None, truth=self.folder, count=CHECKED, reach=MARGIN)
            sign = "winding" if shape.closed else "none"
            drivers.run("standoff", [*self.args, "--full"], 1, output="dense", sign=sign, values=self.folder / "given.f32")
        grid = json.loads((self.folder / "grid.json").read_text())
        self.spacing, self.samples_of_grid = grid["spacing"][0], int(np.prod(grid["shape"]))
        self.samples = np.fromfile(self.folder / "samples.i64", np.int64)
        self.distances = np.fromfile(self.folder / "distances.f64") / self.spacing
        self.windings = np.fromfile(self.folder / "windings.i8", np.int8)
        vertices, triangles = read_mesh(self.folder)
        corners = vertices[triangles]
        self.triangles = len(triangles)
        self.edge = np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)) / self.spacing

    def errors(self, values, method):
        """What a row says of exactness, near the surface (where bands have values) and beyond it. Errors are in samples."""
        found = np.memmap(values, np.float32, mode="r")[self.samples].astype(np.float64) / self.spacing
        off = np.abs(np.abs(found) - self.distances)
        off[~np.isfinite(off)] = np.inf
        counts = self.windings == 0 if method.solid and (self.windings[self.windings != UNCLEAR] > 1).any() else self.distances >= 0
        near = self.distances < MARGIN * (1 - 1e-9)
        told = self.shape.closed & ((self.windings == 0) | (self.windings == 1)) & (self.distances > 1e-6)
        wrong = (found < 0) != (self.windings == 1)
        row = {}
        for where, chosen in (("near", near & counts), ("far", ~near & counts)):
            if where == "far" and method.field != FULL or not chosen.any():
                continue
            row |= {f"{where} checked": int(chosen.sum()), f"{where} largest": digits(off[chosen].max()),
                    f"{where} 99 %": digits(np.quantile(off[chosen], 0.99, method="higher")), f"{where} mean": digits(off[chosen].mean()),
                    f"{where} exact %": f"{100 * (off[chosen] < 1e-3).mean():.2f}"}
            signs = told & (near if where == "near" else ~near)
            if method.signed and signs.any():
                row |= {f"{where} signs": int(signs.sum()), f"{where} wrong %": f"{100 * wrong[signs].mean():.3g}"}
                outside = signs & (self.windings == 0)
                row |= {f"{where} wrong outside %": f"{100 * wrong[outside].mean():.3g}"} if outside.any() else {}
        return row


def digits(value):
    return f"{value:.3g}"


# ---- Measuring ----

def command(drivers, case, method, values, limit):
    repeats = ["--repeats", str(REPEATS), "--enough", str(ENOUGH), "--values", str(values)]
    if method.driver == "python":
        signed = [a for a in method.args if a != "--signed" or case.shape.closed]
        return [os.environ["STANDOFF_PEER_PYTHON"], str(BENCH / "peer_methods.py"), signed[0], str(case.folder), *signed[1:], *repeats]
    kind = ["--full"] if method.field == FULL else ["--thickness", str(MARGIN)]
    return [str(drivers.path(method.driver)), *case.args, *kind, *method.args, "--threads", str(method.threads), *repeats]


def measure(drivers, case, method, limit):
    """One process: (what it printed, why there is nothing)."""
    values = case.folder / "values.f32"
    values.unlink(missing_ok=True)
    line = command(drivers, case, method, values, limit)
    print("  " + " ".join(line), file=sys.stderr)
    most = int(limit + START)
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (most, most)))
    try:
        out, errors = process.communicate(timeout=PATIENCE * most)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return None, f"> {limit:g} s"
    if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL):  # what a limit of processor time ends a process with
        return None, f"> {limit:g} s"
    if process.returncode < 0:
        return None, f"crashed: {signal.Signals(-process.returncode).name}"
    if process.returncode == 3 and method.driver == "python":
        return None, "not installed"
    if process.returncode:
        if "--method" in errors or "--sign" in errors:  # not a name that the driver knows
            return None, "not in this build"
        last = (errors.strip().splitlines() or [f"exit code {process.returncode}"])[-1]
        return None, f"refused: {shortened(last)}"
    told = json.loads(out.splitlines()[-1])
    if told["cold_cpu_s"] > limit:
        return None, f"> {limit:g} s"
    return told | case.errors(values, method), ""


def shortened(message):
    """Of an error: without names of classes, addresses in memory, and what explains it further."""
    return re.sub(r"\(0x[0-9a-f]+\)", "", message.split("Error: ")[-1].split(": ", 1)[-1]).split(" (")[0][:70]


def row_of(case, method, told, why, run):
    row = {"method": method.name, "mesh": case.shape.name, "side": case.side, "triangles": case.triangles, "edge": f"{case.edge:.2f}", "samples": case.samples_of_grid,
           "field": method.field, "threads": method.threads, "refuses": method.refuses, "note": why}
    if told:
        when = "warm" if told["calls"] > 1 else "cold"
        row |= {"s": f"{told[when + '_s']:.4g}", "processor s": f"{told[when + '_cpu_s']:.4g}", "calls": told["calls"], "MB": f"{(told['memory_peak'] - told['memory_before']) / 1e6:.0f}"}
        row |= {key: told[key] for key in told if key.split(" ")[0] in ("near", "far")} | {"version": told.get("version", "")}
    return row | {"run": run}


def run(drivers, only, mesh, limit, missing, unstopped, note, build):
    """Measures, and puts the rows into the table that is there. Rows are kept apart by method, mesh and resolution. `missing`:
    only those that are not there; `unstopped`: not those that were stopped at this limit."""
    limit, path = limit or LIMIT, results_folder() / "methods.csv"
    rows = {key_of(row): row for row in (methods_page.read(path)[1] if path.exists() else [])}
    work = Path(build) / "methods"
    work.mkdir(parents=True, exist_ok=True)
    when = f"{datetime.date.today().isoformat()} {commit()}"
    header = [*machine_lines(build), f"limit: {limit:g} s of processors a call", *([note] if note else [])]
    python_path = os.environ.get("STANDOFF_PEER_PYTHON")
    for shape in SHAPES:
        stopped = {}
        for side in RESOLUTIONS:
            if mesh and mesh not in (shape.name, f"{shape.name}-{side}"):
                stopped |= {name: rows[name, of, n]["note"] for name, of, n in rows
                            if (of, n) == (shape.name, str(side)) and rows[name, of, n]["note"].startswith(">") and is_done(rows[name, of, n], limit)}
                continue
            case = None
            for method in METHODS:
                if only and only not in method.name:
                    continue
                key = (method.name, shape.name, str(side))
                if key in rows and (missing or unstopped and rows[key]["note"].startswith(">")) and is_done(rows[key], limit):
                    stopped |= {method.name: rows[key]["note"]} if rows[key]["note"].startswith(">") else {}
                    continue
                case = case or Case(drivers, work, shape, side)
                if method.driver == "python" and not python_path or method.driver != "python" and not drivers.has(method.driver):
                    told, why = None, "not installed"
                elif method.name in stopped:
                    told, why = None, stopped[method.name]
                else:
                    told, why = measure(drivers, case, method, limit)
                if why.startswith(">"):
                    stopped[method.name] = why
                if why in ("not installed", "not in this build"):
                    print(f"bench: {method.name}: {why}", file=sys.stderr)
                rows[key] = {name: str(value) for name, value in row_of(case, method, told, why, when).items()}
            if case:
                (case.folder / "values.f32").unlink(missing_ok=True)
                write_csv(path, header, in_order(rows))
    methods_page.write()


def is_done(row, limit):
    """Whether a row need not be measured again: it has a value, or could not get one within as much time."""
    if row["note"].startswith(">"):
        return float(row["note"].split()[1]) >= limit
    return row["note"] not in ("not installed", "not in this build")


def key_of(row):
    return row["method"], row["mesh"], row["side"]


def in_order(rows):
    """By mesh, resolution and method; rows of methods that are no longer there are left out."""
    wanted = [(method.name, shape.name, str(side)) for shape in SHAPES for side in RESOLUTIONS for method in METHODS]
    return [{column: rows[key].get(column, "") for column in methods_page.COLUMNS} for key in wanted if key in rows]
