# SPDX-License-Identifier: Apache-2.0
"""peer_render.py LIBRARY FOLDER [--size WxH] [--slice] [--repeats N]: a picture of the mesh that bench_render saved in FOLDER,
by VTK or polyscope in software, as a PNG file there; one JSON line. Returns 3 if this Python has not the library.

The clock runs from arrays in memory to the file. What a library does once per process, opening its context, is done
before. Both ask Mesa for an EGL context, so no display is needed; four samples a pixel; no shadows."""

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path

import numpy as np

from exact_points import read_mesh

TURNS = 8


def measured(jobs):
    """Medians of the seconds on the wall, and of processors, of some calls."""
    wall, processor = [], []
    for job in jobs:
        began, began_processor = time.perf_counter(), time.process_time()
        job()
        wall.append(time.perf_counter() - began)
        processor.append(time.process_time() - began_processor)
    return statistics.median(wall), statistics.median(processor)


class Vtk:
    def __init__(self, width, height, folder):
        try:
            import vtkmodules.vtkInteractionStyle  # noqa: F401  registers itself
            import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
            from vtkmodules import vtkCommonCore, vtkCommonDataModel, vtkFiltersCore, vtkIOImage, vtkRenderingCore
            from vtkmodules.util import numpy_support
        except ImportError:
            sys.exit(3)
        self.core, self.data, self.filters, self.image = vtkCommonCore, vtkCommonDataModel, vtkFiltersCore, vtkIOImage
        self.rendering, self.arrays, self.folder = vtkRenderingCore, numpy_support, folder
        self.version = vtkCommonCore.vtkVersion.GetVTKVersion()
        self.window = vtkRenderingCore.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(4)
        self.window.SetSize(width, height)
        self.window.Render()

    def surface(self, vertices, triangles, cut_at):
        mesh = self.data.vtkPolyData()
        points = self.core.vtkPoints()
        points.SetData(self.arrays.numpy_to_vtk(vertices))
        mesh.SetPoints(points)
        cells = self.data.vtkCellArray()
        cells.SetData(3, self.arrays.numpy_to_vtkIdTypeArray(triangles.reshape(-1).astype(np.int64)))
        mesh.SetPolys(cells)
        mapper = self.rendering.vtkPolyDataMapper()
        mapper.SetInputData(mesh)
        if cut_at is not None:
            plane = self.data.vtkPlane()
            plane.SetOrigin(0, 0, cut_at)
            plane.SetNormal(0, 0, -1)
            mapper.AddClippingPlane(plane)
        actor = self.rendering.vtkActor()
        actor.SetMapper(mapper)
        return actor

    def slice(self, values, grid, at):
        image = self.data.vtkImageData()
        image.SetDimensions(grid["size"])
        image.SetOrigin(grid["origin"])
        image.SetSpacing([grid["spacing"]] * 3)
        image.GetPointData().SetScalars(self.arrays.numpy_to_vtk(values))
        cutter = self.filters.vtkCutter()
        plane = self.data.vtkPlane()
        plane.SetOrigin(0, 0, at)
        plane.SetNormal(0, 0, 1)
        cutter.SetCutFunction(plane)
        cutter.SetInputData(image)
        mapper = self.rendering.vtkPolyDataMapper()
        mapper.SetInputConnection(cutter.GetOutputPort())
        mapper.SetScalarRange(float(values.min()), float(values.max()))
        actor = self.rendering.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        return actor

    def first(self, vertices, triangles, field):
        for renderer in list(self.window.GetRenderers()):
            self.window.RemoveRenderer(renderer)
        self.renderer = self.rendering.vtkRenderer()
        self.renderer.SetBackground(1, 1, 1)
        self.window.AddRenderer(self.renderer)
        values, grid = field or (None, None)
        at = grid["origin"][2] + grid["spacing"] * (grid["size"][2] - 1) / 2 if grid else None
        self.renderer.AddActor(self.surface(vertices, triangles, at))
        if field:
            self.renderer.AddActor(self.slice(values, grid, at))
        camera = self.renderer.GetActiveCamera()
        camera.SetViewUp(0, 1, 0)
        camera.Azimuth(35)
        camera.Elevation(25)
        self.renderer.ResetCamera()
        camera.Zoom(1.5)  # as large in the picture as standoff draws it
        self.write("vtk.png")

    def turn(self, number):
        self.renderer.GetActiveCamera().Azimuth(360 / TURNS)
        self.write(f"vtk-turn-{number}.png")

    def write(self, name):
        self.window.Render()
        pixels = self.rendering.vtkWindowToImageFilter()
        pixels.SetInput(self.window)
        pixels.ReadFrontBufferOff()
        writer = self.image.vtkPNGWriter()
        writer.SetFileName(str(self.folder / name))
        writer.SetInputConnection(pixels.GetOutputPort())
        writer.Write()


class Polyscope:
    def __init__(self, width, height, folder):
        try:
            import polyscope
        except ImportError:
            sys.exit(3)
        self.ps, self.folder, self.version = polyscope, folder, polyscope.__version__
        polyscope.set_verbosity(0)
        polyscope.set_use_prefs_file(False)
        polyscope.set_allow_headless_backends(True)
        polyscope.set_SSAA_factor(2)  # four samples a pixel: it has no other
        polyscope.set_ground_plane_mode("none")
        polyscope.init("openGL3_egl")
        polyscope.set_window_size(width, height)
        self.write("polyscope.png")

    def first(self, vertices, triangles, field):
        if field:
            sys.exit(3)  # only meshes are asked of it
        self.ps.remove_all_structures()
        self.ps.register_surface_mesh("mesh", vertices, triangles)
        self.centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        self.size = np.ptp(vertices, axis=0).max()
        self.look(35)
        self.write("polyscope.png")

    def look(self, degrees):
        angle = np.radians(degrees)
        eye = self.centre + 1.15 * self.size * np.array([np.sin(angle), 0.45, np.cos(angle)])
        self.ps.look_at(eye, self.centre)

    def turn(self, number):
        self.look(35 + 360 / TURNS * (number + 1))
        self.write(f"polyscope-turn-{number}.png")

    def write(self, name):
        self.ps.screenshot(str(self.folder / name), transparent_bg=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", choices=["vtk", "polyscope"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", default="1280x960")
    parser.add_argument("--slice", action="store_true")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()

    os.environ["LP_NUM_THREADS"] = str(arguments.threads)  # of Mesa's rasterizer
    width, height = map(int, arguments.size.split("x"))
    vertices, triangles = read_mesh(arguments.folder)
    vertices = vertices.astype(np.float32)
    field = None
    if arguments.slice:
        field = np.fromfile(arguments.folder / "field.f32", np.float32), json.loads((arguments.folder / "grid.json").read_text())
    library = {"vtk": Vtk, "polyscope": Polyscope}[arguments.library](width, height, arguments.folder)
    first = measured([lambda: library.first(vertices, triangles, field)] * arguments.repeats)
    turns = measured([lambda number=number: library.turn(number) for number in range(TURNS)])
    print(json.dumps({"driver": arguments.library, "version": library.version, "first_s": first[0], "first_cpu_s": first[1],
                      "turns_s": turns[0], "turns_cpu_s": turns[1]}))


if __name__ == "__main__":
    main()
