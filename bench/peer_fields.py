# SPDX-License-Identifier: Apache-2.0
"""peer_fields.py LIBRARY FOLDER [--signed] [--repeats N] [--limit SECONDS]: the values of a grid's samples by a Python
library, as one JSON line. FOLDER has vertices.f64, triangles.u32 and grid.json (shape, origin, spacing, band or null).
From the mesh's arrays to an array of values; building the library's structures is counted. Libraries that know no grids
get the samples as points, a slice after another, on all cores; what is not done at the limit is counted by the time of
what is. Returns 3 if this Python lacks the library, or
it would take minutes."""

import argparse
import json
import resource
import statistics
import sys
import time
from pathlib import Path

import numpy as np

from exact_points import read_mesh
from peer_points import Fcpw, Libigl, Open3D


class Standoff:
    """The package, with its own grids and bands."""

    def __init__(self, vertices, triangles, signed=False):
        import standoff
        self.standoff, self.mesh = standoff, standoff.Mesh(vertices, triangles)
        self.sign = "winding" if signed else None

    def values(self, grid):
        where = self.standoff.Grid(grid["shape"], grid["origin"], grid["spacing"])
        field = self.standoff.field(self.mesh, grid=where, band=grid["band"], sign=self.sign)
        self.call = field.computation["seconds"]
        return field if grid["band"] else field.numpy()


class Mesh2Sdf:
    """Its cube of samples over [-1, 1], of which the grid's are a part. Distances away from the surface are guessed from their
    neighbours'; the error says by how much."""

    def __init__(self, vertices, triangles, signed=False):
        import mesh2sdf.core
        self.compute, self.vertices, self.triangles = mesh2sdf.core.compute, vertices, triangles

    def values(self, grid):
        size = max(grid["shape"])
        step = 2 / size
        inside = (self.vertices - grid["origin"]) / grid["spacing"] * step - 1
        cube = self.compute(inside.astype(np.float32), self.triangles, size)
        nx, ny, nz = grid["shape"]
        return cube[:nx, :ny, :nz] * np.float32(grid["spacing"][0] / step)


class Trimesh:
    """Its closest_point, which is what its signed_distance calls first."""

    def __init__(self, vertices, triangles, signed=False):
        import trimesh
        self.trimesh, self.signed = trimesh, signed
        self.arrays = vertices, triangles

    def build(self):
        self.mesh = self.trimesh.Trimesh(*self.arrays, process=False)

    def prepare(self, points):
        return points

    def ask(self, points):
        proximity = self.trimesh.proximity
        return proximity.signed_distance(self.mesh, points) if self.signed else proximity.closest_point(self.mesh, points)[1]

    def distances(self, answer):
        return -answer if self.signed else answer  # it is positive inside


class PointCloudUtils:
    """Its closest points, and its signed distances, which build their trees in each call: so all samples in one."""

    whole = True

    def __init__(self, vertices, triangles, signed=False):
        import point_cloud_utils
        self.library, self.signed = point_cloud_utils, signed
        self.vertices, self.triangles = vertices, triangles.astype(np.int32)

    def build(self):
        pass

    def prepare(self, points):
        return points

    def ask(self, points):
        call = self.library.signed_distance_to_mesh if self.signed else self.library.closest_points_on_mesh
        return call(points, self.vertices, self.triangles)[0]

    def distances(self, answer):
        return np.asarray(answer, dtype=np.float64)


class Warp:
    """A kernel on the CPU: mesh_query_point_sign_winding_number, or without a sign."""

    def __init__(self, vertices, triangles, signed=False):
        import warp
        warp.config.quiet = True
        warp.init()
        self.warp, self.signed = warp, signed
        self.vertices, self.triangles = vertices.astype(np.float32), triangles.astype(np.int32).reshape(-1)

        @warp.kernel
        def signed_distances(mesh: warp.uint64, points: warp.array(dtype=warp.vec3), out: warp.array(dtype=float)):
            n = warp.tid()
            found = warp.mesh_query_point_sign_winding_number(mesh, points[n], 1.0e9)
            nearest = warp.mesh_eval_position(mesh, found.face, found.u, found.v)
            out[n] = found.sign * warp.length(nearest - points[n])

        @warp.kernel
        def distances(mesh: warp.uint64, points: warp.array(dtype=warp.vec3), out: warp.array(dtype=float)):
            n = warp.tid()
            found = warp.mesh_query_point_no_sign(mesh, points[n], 1.0e9)
            nearest = warp.mesh_eval_position(mesh, found.face, found.u, found.v)
            out[n] = warp.length(nearest - points[n])

        self.kernel = signed_distances if signed else distances
        self.ask_few()  # compiles the kernel

    def ask_few(self):
        mesh, triangles = self.vertices, self.triangles
        self.vertices, self.triangles = np.eye(3, dtype=np.float32), np.arange(3, dtype=np.int32)
        self.build()
        self.ask(self.prepare(np.zeros((1, 3))))
        self.vertices, self.triangles = mesh, triangles

    def build(self):
        warp = self.warp
        self.mesh = warp.Mesh(points=warp.array(self.vertices, dtype=warp.vec3, device="cpu"),
                              indices=warp.array(self.triangles, dtype=int, device="cpu"), support_winding_number=self.signed)

    def prepare(self, points):
        return self.warp.array(points.astype(np.float32), dtype=self.warp.vec3, device="cpu")

    def ask(self, points):
        out = self.warp.empty(len(points), dtype=float, device="cpu")
        self.warp.launch(self.kernel, len(points), inputs=[self.mesh.id, points, out], device="cpu")
        return out

    def distances(self, answer):
        return answer.numpy().astype(np.float64)


MOST = 1e6  # samples that those get which take minutes, or all memory, for more
MODULES = {"libigl": "igl", "pcu": "point_cloud_utils"}
LIBRARIES = {"standoff": Standoff, "fcpw": Fcpw, "open3d": Open3D, "libigl": Libigl, "trimesh": Trimesh, "pcu": PointCloudUtils,
             "warp": Warp, "mesh2sdf": Mesh2Sdf}


def slices(grid):
    """The positions of the samples of each slice along z, x fastest; from the middle outwards, so that a part of them is
    like all of them."""
    axes = [o + s * np.arange(n) for o, s, n in zip(grid["origin"], grid["spacing"], grid["shape"])]
    order = sorted(range(grid["shape"][2]), key=lambda k: (k * 37) % grid["shape"][2])
    for k in order:
        plane = np.stack(np.meshgrid(axes[0], axes[1], [axes[2][k]], indexing="ij"), axis=-1)
        yield k, plane[:, :, 0].transpose(1, 0, 2).reshape(-1, 3)


def fill(library, grid, limit):
    """All values that a library without grids finds within the limit, and which share of the samples these are."""
    began = time.perf_counter()
    library.build()
    built = time.perf_counter() - began
    nx, ny, nz = grid["shape"]
    values, done = np.full((nz, ny, nx), np.nan), 0
    if getattr(library, "whole", False):
        order, planes = zip(*slices(grid))
        values[list(order)] = library.distances(library.ask(library.prepare(np.concatenate(planes)))).reshape(nz, ny, nx)
        return values.T, 1, built
    for k, points in slices(grid):
        values[k] = library.distances(library.ask(library.prepare(points))).reshape(ny, nx)
        done += 1
        if time.perf_counter() - began > limit:
            break
    return values.T, done / nz, built


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("library", choices=LIBRARIES)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--signed", action="store_true")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--limit", type=float, default=6)
    parser.add_argument("--values", type=Path, help="write the values to this file, .npy")
    arguments = parser.parse_args()
    try:
        __import__(MODULES.get(arguments.library, arguments.library))
    except ImportError:
        return 3
    vertices, triangles = read_mesh(arguments.folder)
    grid = json.loads((arguments.folder / "grid.json").read_text())
    if arguments.library in ("pcu", "trimesh") and np.prod(grid["shape"]) > MOST:
        return 3
    options = {} if arguments.library == "fcpw" else {"signed": arguments.signed}
    wall, processor, calls, share = [], [], [], 1
    for _ in range(arguments.repeats):
        library = LIBRARIES[arguments.library](vertices, triangles, **options)
        began, began_processor = time.perf_counter(), time.process_time()
        if hasattr(library, "values"):  # it knows grids
            values, built = library.values(grid), 0
            calls += [library.call] if hasattr(library, "call") else []
        else:
            values, share, built = fill(library, grid, arguments.limit)
        seconds, busy = time.perf_counter() - began, time.process_time() - began_processor
        # What was not done would have taken as long as what was; structures are built once.
        rest = (seconds - built) * (1 / share - 1)
        wall.append(seconds + rest)
        processor.append(busy * (seconds + rest) / seconds)
        if sum(wall) > arguments.limit:
            break
    if arguments.values:
        np.save(arguments.values, values if isinstance(values, np.ndarray) else values.numpy())
    line = {"library": arguments.library, "triangles": len(triangles), "samples": int(np.prod(grid["shape"])), "seconds": statistics.median(wall),
            "cpu_seconds": statistics.median(processor), "least_seconds": min(wall), "share": share,
            "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000}
    if calls:
        line["overhead_ms"] = 1000 * min(w - c for w, c in zip(wall, calls))
    print(json.dumps(line))
    return 0


if __name__ == "__main__":
    sys.exit(main())
