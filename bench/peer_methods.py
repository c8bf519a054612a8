# SPDX-License-Identifier: Apache-2.0
"""peer_methods.py PEER FOLDER [--signed] [--repeats N] [--enough SECONDS] [--values FILE]: the values of a grid's samples by
a Python library, with time and memory, as one JSON line. FOLDER has what bench_exact --truth writes, and given.f32: standoff's
exact values, of which voxels and fronts are made before the clock starts. Beside the transforms of this file PEER may be a
library of peer_fields.py. No call is cut short and nothing is estimated: whoever starts this ends what takes too long. Returns
3 if this Python lacks the library, and 4 with a message if the library refuses the mesh."""

import argparse
import importlib.metadata
import json
import statistics
import sys
import time
from pathlib import Path

import numpy as np

import peer_fields
from exact_points import read_mesh


class Voxels:
    """What a transform of voxels gets: the samples inside; of an open mesh, which has none, those that are at most half a
    step away from it."""

    def __init__(self, given, grid):
        self.step = grid["spacing"][0]
        inside = given < 0
        self.closed = bool(inside.any())
        self.voxels = inside if self.closed else np.abs(given) <= self.step / 2

    def values(self, grid):
        if not self.closed:
            return self.distances(~self.voxels) * self.step
        # From the nearest voxel of the other kind; the surface is half way to it, says the usual recipe.
        outwards, inwards = self.distances(~self.voxels), self.distances(self.voxels)
        return np.where(self.voxels, 0.5 - inwards, outwards - 0.5) * self.step


class Scipy(Voxels):
    def distances(self, voxels):
        from scipy import ndimage
        return ndimage.distance_transform_edt(voxels)


class Edt(Voxels):
    def distances(self, voxels):
        import edt
        return edt.edt(voxels, parallel=2)


class Itk(Voxels):
    """A filter of ITK, which makes the sign too. Where `half` says so, its zero is at the outermost voxels inside, and the surface
    half a step beyond them."""

    half = True

    def __init__(self, given, grid):
        super().__init__(given, grid)
        import SimpleITK
        self.itk = SimpleITK
        SimpleITK.ProcessObject.SetGlobalDefaultNumberOfThreads(2)
        self.image = SimpleITK.GetImageFromArray(self.voxels.astype(np.uint8))

    def values(self, grid):
        found = self.itk.GetArrayFromImage(self.map())
        return (found - (0.5 if self.half else 0) if self.closed else np.abs(found)) * self.step


class Maurer(Itk):
    def map(self):
        return self.itk.SignedMaurerDistanceMap(self.image, insideIsPositive=False, squaredDistance=False, useImageSpacing=False)


class Danielsson(Itk):
    def map(self):
        return self.itk.SignedDanielssonDistanceMap(self.image, insideIsPositive=False, squaredDistance=False, useImageSpacing=False)


class Chamfer(Itk):
    half = False

    def map(self):
        return self.itk.ApproximateSignedDistanceMap(self.image, insideValue=1, outsideValue=0)


class FastMarching:
    """scikit-fmm, second order. It takes the zero crossings between samples from exact distances."""

    def __init__(self, given, grid):
        self.step = grid["spacing"][0]
        self.front = np.clip(given, -3 * self.step, 3 * self.step).astype(np.float64)

    def values(self, grid):
        import skfmm
        return np.asarray(skfmm.distance(self.front, dx=self.step))


class Pysdf:
    """Its nearest vertex, of whose triangles the nearest counts; the sign by rays."""

    def __init__(self, vertices, triangles, signed=False):
        import pysdf
        self.library = pysdf
        self.arrays = vertices.astype(np.float32), triangles.astype(np.uint32)

    def build(self):
        self.sdf = self.library.SDF(*self.arrays)

    def prepare(self, points):
        return points.astype(np.float32)

    def ask(self, points):
        return -self.sdf(points, n_threads=2)

    def distances(self, answer):
        return answer


class Vtk:
    """vtkImplicitPolyDataDistance: a cell locator; the sign by the normal of the nearest feature."""

    def __init__(self, vertices, triangles, signed=False):
        from vtkmodules.util import numpy_support
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        self.convert = numpy_support
        points, cells = vtkPoints(), vtkCellArray()
        points.SetData(numpy_support.numpy_to_vtk(vertices, deep=True))
        offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int64)
        cells.SetData(numpy_support.numpy_to_vtkIdTypeArray(offsets, deep=True),
                      numpy_support.numpy_to_vtkIdTypeArray(triangles.astype(np.int64).reshape(-1), deep=True))
        self.mesh = vtkPolyData()
        self.mesh.SetPoints(points)
        self.mesh.SetPolys(cells)

    def build(self):
        from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
        self.distance = vtkImplicitPolyDataDistance()
        self.distance.SetInput(self.mesh)

    def prepare(self, points):
        return self.convert.numpy_to_vtk(np.ascontiguousarray(points))

    def ask(self, points):
        from vtkmodules.vtkCommonCore import vtkDoubleArray
        found = vtkDoubleArray()
        self.distance.FunctionValue(points, found)
        return found

    def distances(self, answer):
        return self.convert.vtk_to_numpy(answer)


TRANSFORMS = {"scipy": Scipy, "edt": Edt, "maurer": Maurer, "danielsson": Danielsson, "chamfer": Chamfer, "skfmm": FastMarching}
LIBRARIES = peer_fields.LIBRARIES | {"pysdf": Pysdf, "vtk": Vtk}
MODULES = peer_fields.MODULES | {"maurer": "SimpleITK", "danielsson": "SimpleITK", "chamfer": "SimpleITK", "vtk": "vtkmodules"}
PACKAGES = {"maurer": "SimpleITK", "danielsson": "SimpleITK", "chamfer": "SimpleITK", "skfmm": "scikit-fmm", "pcu": "point-cloud-utils",
            "open3d": "open3d-cpu"}


def process_bytes(key):
    """Of a line of /proc/self/status that counts kilobytes."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{key}:"):
            return 1024 * int(line.split()[1])
    return 0


def version(peer):
    for name in (PACKAGES.get(peer, peer), peer):
        try:
            return importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("peer", choices=[*TRANSFORMS, *LIBRARIES])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--signed", action="store_true")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--enough", type=float, default=3, help="no further call after so many seconds")
    parser.add_argument("--values", type=Path, help="write the values to this file: raw floats, x fastest")
    arguments = parser.parse_args()
    try:
        __import__(MODULES.get(arguments.peer, arguments.peer))
    except ImportError:
        return 3
    grid = json.loads((arguments.folder / "grid.json").read_text())
    shape = grid["shape"][::-1]
    if arguments.peer in TRANSFORMS:
        given = np.fromfile(arguments.folder / "given.f32", np.float32).reshape(shape)
        make = lambda: TRANSFORMS[arguments.peer](given, grid)
    else:
        vertices, triangles = read_mesh(arguments.folder)
        options = {} if arguments.peer == "fcpw" else {"signed": arguments.signed}
        make = lambda: LIBRARIES[arguments.peer](vertices, triangles, **options)
    wall, processor, line = [], [], {"driver": arguments.peer, "version": version(arguments.peer)}
    for _ in range(arguments.repeats):
        library = make()
        if not wall:
            Path("/proc/self/clear_refs").write_text("5")
            line["memory_before"] = process_bytes("VmRSS")
        began, began_processor = time.perf_counter(), time.process_time()
        try:
            if hasattr(library, "values"):  # of all samples at once
                values = library.values(grid)
                values = values.T if arguments.peer in peer_fields.LIBRARIES else values
            else:
                values = peer_fields.fill(library, grid, float("inf"))[0].T
        except (ValueError, RuntimeError) as refusal:
            print(refusal, file=sys.stderr)
            return 4
        wall.append(time.perf_counter() - began)
        processor.append(time.process_time() - began_processor)
        if len(wall) == 1:
            line["memory_peak"] = process_bytes("VmHWM")
        if sum(wall) > arguments.enough:
            break
    if arguments.values:
        np.ascontiguousarray(values, dtype=np.float32).tofile(arguments.values)
    print(json.dumps(line | {"cold_s": wall[0], "warm_s": statistics.median(wall[1:] or wall), "cold_cpu_s": processor[0],
                             "warm_cpu_s": statistics.median(processor[1:] or processor), "calls": len(wall)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
