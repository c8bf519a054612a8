# SPDX-License-Identifier: Apache-2.0
"""Surfaces against those of VTK's flying edges: on smooth fields both have the same triangles but for their diagonals."""

import pathlib
import sys
import tempfile

import numpy as np
from program import run
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkMassProperties, vtkPolyDataConnectivityFilter
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter



def field(name, function, size, spacing):
    i, j, k = np.meshgrid(*(np.arange(n) * s for n, s in zip(size, spacing)), indexing="ij")
    image = vtkImageData()
    image.SetDimensions(size)
    image.SetSpacing(spacing)
    values = numpy_to_vtk(function(i, j, k).astype(np.float32).ravel(order="F"), deep=1)
    values.SetName("distance")
    image.GetPointData().SetScalars(values)
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(name)
    writer.SetCompressorTypeToNone()
    writer.EncodeAppendedDataOff()
    writer.SetInputData(image)
    writer.Write()
    return image


def measure(surface):
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    parts = vtkPolyDataConnectivityFilter()
    parts.SetInputData(surface)
    parts.SetExtractionModeToAllRegions()
    parts.Update()
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    return (surface.GetNumberOfPolys(), surface.GetNumberOfPoints(), mass.GetVolume(), mass.GetSurfaceArea(),
            parts.GetNumberOfExtractedRegions(), edges.GetOutput().GetNumberOfCells())


CASES = {
    "balls": (lambda x, y, z: np.minimum(np.sqrt((x - 8) ** 2 + (y - 9) ** 2 + (z - 8) ** 2) - 5.3,
                                         np.sqrt((x - 20) ** 2 + (y - 9) ** 2 + (z - 8) ** 2) - 3.7), (28, 19, 17), (1, 1, 1)),
    "torus": (lambda x, y, z: np.hypot(np.hypot(x - 5, y - 5) - 3, z - 2) - 1.1, (50, 40, 30), (0.2, 0.25, 0.15)),
    "gyroid": (lambda x, y, z: np.maximum(np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x),
                                          np.sqrt((x - 6) ** 2 + (y - 6) ** 2 + (z - 6) ** 2) - 5.5), (61, 61, 61), (0.2, 0.2, 0.2)),
}

folder = pathlib.Path(tempfile.mkdtemp(dir="."))
bad = []
for name, (function, size, spacing) in CASES.items():
    image = field(str(folder / f"{name}.vti"), function, size, spacing)
    for level in (0.0, 0.125):
        cubes = vtkFlyingEdges3D()
        cubes.SetInputData(image)
        cubes.SetValue(0, level)
        cubes.Update()
        theirs = measure(cubes.GetOutput())
        made = folder / f"{name}.ply"
        run("surface", folder / f"{name}.vti", "--at", level, "-f", "-o", made)
        reader = vtkPLYReader()
        reader.SetFileName(str(made))
        reader.Update()
        ours = measure(reader.GetOutput())
        print(name, level, ours, theirs)
        same = ours[4] == theirs[4] and ours[5] == 0 and np.allclose(ours[:4], theirs[:4], rtol=2e-3)
        if not same:
            bad.append(f"{name} at {level}: {ours}, VTK {theirs}")
print(*bad, sep="\n")
sys.exit(1 if bad else 0)
