# SPDX-License-Identifier: Apache-2.0
"""The Python package beside Open3D, libigl, FCPW, trimesh, point-cloud-utils, Warp and mesh2sdf: fields of one mesh, and of
a thousand files. Writes python.csv and python-many.csv; output_quotes.py makes tables of them. All runs in the Python
that STANDOFF_PEER_PYTHON names, which has standoff and its peers installed."""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from exact_points import compare, read_mesh
from harness import chosen, header_of, markdown, peer_python, results_folder, write_csv

UNSIGNED = ("standoff", "fcpw", "open3d", "libigl", "warp", "pcu", "trimesh")
SIGNED = ("standoff", "open3d", "libigl", "warp", "pcu", "trimesh", "mesh2sdf")
NAMES = {"pcu": "point-cloud-utils", "fcpw": "FCPW", "open3d": "Open3D", "warp": "Warp (CPU)"}


def save_mesh(job, folder):
    """The mesh and the grid of a job, as every library's process reads them; whoever has standoff makes them."""
    script = ("import json, sys, numpy as np, standoff as so\n"
              "job, folder = json.loads(sys.argv[1]), sys.argv[2]\n"
              "mesh = so.read(job['mesh'])\n"
              "grid = so.Grid.fit(mesh, resolution=job['resolution'])\n"
              "np.asarray(mesh.vertices, np.float64).tofile(folder + '/vertices.f64')\n"
              "np.asarray(mesh.faces, np.uint32).tofile(folder + '/triangles.u32')\n"
              "json.dump({'shape': grid.shape, 'origin': grid.origin, 'spacing': grid.spacing, 'band': job['band']},"
              " open(folder + '/grid.json', 'w'))\n")
    subprocess.run([os.environ["STANDOFF_PEER_PYTHON"], "-c", script, json.dumps(job), str(folder)], check=True)


def program():
    """The program that is in the package."""
    return subprocess.run([os.environ["STANDOFF_PEER_PYTHON"], "-c", "import standoff._program as p; print(p.PROGRAM)"],
                          check=True, stdout=subprocess.PIPE, text=True).stdout.strip()


def mesh_file(job, folder):
    """The mesh of a job: a file, or a scene that the program writes."""
    if not job["mesh"].startswith("scene:"):
        return job["mesh"]
    path = folder / "scene.ply"
    subprocess.run([program(), "generate", job["mesh"].removeprefix("scene:"), "-o", str(path)], check=True, stdout=subprocess.DEVNULL)
    return str(path)


def exactness(folder, values, grid, signed, pairs):
    """How far some samples are from exact distances, and how many signs are wrong; looks at about so many pairs of a sample
    and a triangle."""
    vertices, triangles = read_mesh(folder)
    few = max(10, int(pairs / len(triangles)))
    known = np.flatnonzero(np.isfinite(values.ravel()))
    some = known[np.linspace(0, len(known) - 1, few, dtype=int)]
    places = np.stack(np.unravel_index(some, values.shape), axis=-1)
    found, points = values.ravel()[some].astype(np.float64), np.array(grid["origin"]) + np.array(grid["spacing"]) * places
    if grid["band"]:  # the others are clamped
        width = grid["band"] * max(grid["spacing"])
        inside = np.abs(found) < width * (1 - 1e-6)
        found, points = found[inside], points[inside]
    return compare(vertices, triangles, points, found, signed)


def contest(job, signed, pairs):
    """A row for each library."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        save_mesh({**job, "mesh": mesh_file(job, folder)}, folder)
        grid = json.loads((folder / "grid.json").read_text())
        for library in SIGNED if signed else UNSIGNED:
            values = folder / "values.npy"
            line = peer_python("peer_fields.py", library, folder, "--values", values, *["--signed"] * signed)
            if line is None:
                continue
            exact = exactness(folder, np.load(values), grid, signed, pairs)
            rows.append({"field": job["what"], "sign": "yes" if signed else "no", "triangles": line["triangles"],
                         "samples": line["samples"], "library": NAMES.get(library, library), "s": f"{line['seconds']:.4f}",
                         "processor s": f"{line['cpu_seconds']:.4f}", "peak MB": f"{line['peak_mb']:.0f}",
                         "share done": f"{line['share']:.3g}", "largest error": f"{exact['largest_error']:.1e}",
                         "wrong signs": exact["wrong_signs"] if signed else "", "compared": exact["compared"],
                         "overhead ms": f"{line['overhead_ms']:.2f}" if "overhead_ms" in line else ""})
            ours = rows[0]
            rows[-1]["standoff is faster"] = f"{float(rows[-1]['s']) / float(ours['s']):.3g}x"
            rows[-1]["in processor time"] = f"{float(rows[-1]['processor s']) / float(ours['processor s']):.3g}x"
    return rows


def run(workloads, only, note, build):
    """All contests, then the many files; with `only` those of that name, and nothing is written."""
    if not os.environ.get("STANDOFF_PEER_PYTHON"):
        raise SystemExit("bench: STANDOFF_PEER_PYTHON must name a Python that has standoff (pip install .) and its peers")
    jobs, header = workloads["python"], header_of(build, note)
    if not only or only in "many":
        many = [line for line in (peer_python("many_fields.py", library, jobs["many"]) for library in ("standoff", "open3d")) if line]
        for line in many:
            line["standoff is faster"] = f"{line['s'] / many[0]['s']:.3g}x"
        print(markdown(many))
        if not only:
            write_csv(results_folder() / "python-many.csv", header, many)
    rows = []
    for job in chosen(jobs["fields"], only):
        for signed in (False,) if job.get("open") else (False, True):
            rows += contest(job, signed, jobs["checked_pairs"])
            if not only:  # after each, since the whole takes long
                write_csv(results_folder() / "python.csv", header, rows)
    if rows:
        print(markdown(rows))
