# SPDX-License-Identifier: Apache-2.0
"""peer_points.py PEER FOLDER [--repeats N] [--signed] [--forms given,morton]: distances of the points of FOLDER (vertices.f64,
triangles.u32, points.f64: --save of the drivers of points) by a Python library, as one JSON line. PEER is fcpw, libigl or
open3d; the Python needs it and numpy. Points are asked as they come and in Morton order (sorting is not counted), in the
library's own batch call, on all cores; its structures are built before, apart. Returns 3 if this Python has no such library."""

import argparse
import json
import statistics
import sys
import time
from pathlib import Path

import numpy as np

from exact_points import read_mesh

LONG = 20  # seconds; no further call after so many


def morton_order(points):
    """The points' order along the Morton curve through their box."""
    low = points.min(axis=0)
    widest = (points.max(axis=0) - low).max()
    cells = ((points - low) * (1048575 / widest if widest > 0 else 0)).astype(np.uint64)
    for shift, mask in ((32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F), (4, 0x10C30C30C30C30C3),
                        (2, 0x1249249249249249)):
        cells = (cells | cells << np.uint64(shift)) & np.uint64(mask)
    return np.argsort(cells[:, 0] | cells[:, 1] << np.uint64(1) | cells[:, 2] << np.uint64(2), kind="stable")


class Fcpw:
    """Its tree with vector instructions, where the module is built with them, and without."""

    def __init__(self, vertices, triangles, vectorised=True):
        import fcpw
        named = lambda new, old: getattr(fcpw, new, None) or getattr(fcpw, old)  # names of 1.2.1, and of 1.2.0
        self.Scene, self.Found = named("Scene3D", "scene_3D"), named("Interaction3DList", "interaction_3D_list")
        kinds = named("AggregateType", "aggregate_type")
        self.kind = getattr(kinds, "Bvh_SurfaceArea", None) or kinds.bvh_surface_area
        self.vectorised = vectorised
        self.vertices, self.triangles = vertices.astype(np.float32), triangles.astype(np.int32)

    def build(self):
        self.scene = self.Scene()
        self.scene.set_object_count(1)
        self.scene.set_object_vertices(self.vertices, 0)
        self.scene.set_object_triangles(self.triangles, 0)
        self.scene.build(self.kind, self.vectorised)

    def prepare(self, points):
        return np.asfortranarray(points.astype(np.float32)), np.full(len(points), np.inf, np.float32)

    def ask(self, prepared):
        if not hasattr(self, "found"):
            self.found = self.Found()
        self.scene.find_closest_points(*prepared, self.found)
        return self.found

    def distances(self, answer):
        if hasattr(answer, "get_distances"):
            return np.array(answer.get_distances(), dtype=np.float64)
        return np.array([one.d for one in answer])


class Libigl:
    """Its box tree; the sign by its fast winding numbers."""

    def __init__(self, vertices, triangles, signed=False):
        import igl
        self.igl, self.signed, self.vertices, self.triangles = igl, signed, vertices, triangles.astype(np.int64)

    def build(self):
        self.tree = self.igl.AABB()
        self.tree.init(self.vertices, self.triangles)
        if self.signed:
            self.winding = self.igl.FastWindingNumberBVH()
            self.winding.init(self.vertices, self.triangles)

    def prepare(self, points):
        return points

    def ask(self, points):
        squared = self.tree.squared_distance(self.vertices, self.triangles, points)[0]
        return squared, self.winding.winding_number(points) if self.signed else None

    def distances(self, answer):
        distance = np.sqrt(answer[0])
        return distance if answer[1] is None else np.where(np.abs(answer[1]) > 0.5, -distance, distance)


class Open3D:
    """Its RaycastingScene; the sign by the parity of one ray."""

    def __init__(self, vertices, triangles, signed=False):
        import open3d
        self.open3d, self.signed = open3d, signed
        self.vertices, self.triangles = (open3d.core.Tensor(a) for a in (vertices.astype(np.float32), triangles))

    def build(self):
        self.scene = self.open3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(self.vertices, self.triangles)
        self.ask(self.prepare(np.zeros((1, 3))))  # it builds at the first question

    def prepare(self, points):
        return self.open3d.core.Tensor(points.astype(np.float32))

    def ask(self, points):
        return self.scene.compute_signed_distance(points) if self.signed else self.scene.compute_distance(points)

    def distances(self, answer):
        return answer.numpy().astype(np.float64)


PEERS = {"fcpw": Fcpw, "libigl": Libigl, "open3d": Open3D}


def measure(repeats, name, line, job):
    """The medians of some calls, on the wall and of all processors."""
    wall, processor = [], []
    for _ in range(repeats):
        began, began_processor = time.perf_counter(), time.process_time()
        answer = job()
        wall.append(time.perf_counter() - began)
        processor.append(time.process_time() - began_processor)
        if sum(wall) > LONG:
            break
    line[f"{name}_s"], line[f"{name}_cpu_s"] = statistics.median(wall), statistics.median(processor)
    return answer


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("peer", choices=PEERS)
    parser.add_argument("folder")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--signed", action="store_true")
    parser.add_argument("--scalar", action="store_true", help="FCPW: the tree without vector instructions")
    parser.add_argument("--forms", default="given,morton", help="the orders in which the points are asked")
    parser.add_argument("--answers", help="write the distances to this file, as raw doubles")
    arguments = parser.parse_args()

    vertices, triangles = read_mesh(arguments.folder)
    points = np.fromfile(Path(arguments.folder) / "points.f64").reshape(-1, 3)
    try:
        __import__({"libigl": "igl"}.get(arguments.peer, arguments.peer))
    except ImportError:
        return 3
    options = {"vectorised": not arguments.scalar} if arguments.peer == "fcpw" else {"signed": arguments.signed}
    peer = PEERS[arguments.peer](vertices, triangles, **options)
    line = {"driver": arguments.peer, "triangles": len(triangles), "points": len(points), "signed": arguments.signed}
    measure(arguments.repeats, "build", line, peer.build)
    distances = np.empty(len(points))
    for form in arguments.forms.split(","):
        order = morton_order(points) if form == "morton" else np.arange(len(points))
        prepared = peer.prepare(points[order])
        distances[order] = peer.distances(measure(arguments.repeats, form, line, lambda: peer.ask(prepared)))
    if arguments.answers:
        distances.tofile(arguments.answers)
    print(json.dumps(line))
    return 0


if __name__ == "__main__":
    sys.exit(main())
