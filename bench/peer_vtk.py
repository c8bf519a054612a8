# SPDX-License-Identifier: Apache-2.0
"""peer_vtk.py FOLDER [--threads N] [--repeats N] [--save FOLDER]: VTK's flying edges on the field that bench_iso saved in
FOLDER (field.f32, grid.json), as one JSON line. Needs VTK and numpy: Debian's python3-vtk9, or PyPI's vtk. Returns 3 if this
Python has no VTK."""

import argparse
import json
import statistics
import sys
import time
from pathlib import Path

import numpy as np

try:
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
except ImportError:
    sys.exit(3)


def quickest_backend():
    """TBB where this VTK has it."""
    for name in ("TBB", "STDThread"):
        vtkSMPTools.SetBackend(name)
        if vtkSMPTools.GetBackend() == name:
            break
    return vtkSMPTools.GetBackend()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--save", type=Path)
    arguments = parser.parse_args()

    grid = json.loads((arguments.folder / "grid.json").read_text())
    values = np.fromfile(arguments.folder / "field.f32", np.float32)
    image = vtkImageData()
    image.SetDimensions(grid["size"])
    image.SetOrigin(grid["origin"])
    image.SetSpacing([grid["spacing"]] * 3)
    image.GetPointData().SetScalars(numpy_to_vtk(values))
    backend = quickest_backend()
    vtkSMPTools.Initialize(arguments.threads)
    wall, processor = [], []
    for _ in range(arguments.repeats):
        edges = vtkFlyingEdges3D()
        edges.SetInputData(image)
        edges.ComputeNormalsOff()
        edges.ComputeGradientsOff()
        edges.ComputeScalarsOff()
        edges.SetValue(0, grid["at"])
        began, began_processor = time.perf_counter(), time.process_time()
        edges.Update()
        wall.append(time.perf_counter() - began)
        processor.append(time.process_time() - began_processor)
    surface = edges.GetOutput()
    if arguments.save:
        arguments.save.mkdir(parents=True, exist_ok=True)
        vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float64).tofile(arguments.save / "vertices.f64")
        vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).astype(np.uint32).tofile(arguments.save / "triangles.u32")
    print(json.dumps({"driver": "vtk", "version": vtkVersion().GetVTKVersion(), "backend": backend,
                      "surface_triangles": surface.GetNumberOfPolys(), "iso_s": statistics.median(wall),
                      "iso_cpu_s": statistics.median(processor)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
