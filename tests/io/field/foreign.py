# SPDX-License-Identifier: Apache-2.0
"""Reads and writes fields with software that is not ours: VTK, numpy and teem.

    foreign.py read  FILE THICKNESS [nearest]   fails unless FILE holds the field of tests/io/field/odd_field.h
    foreign.py write FILE KIND                  writes that field, infinite thickness, in one of the ways of KINDS
"""

import subprocess
import sys

import numpy as np

SIZE = (11, 9, 21)
ORIGIN = (-1.5, 0.1, 1e6)
SPACING = (0.125, 0.3, 2.0)
METHOD, HASH, VERSION = "tiles", 0x0123456789ABCDEF, "1.2.3"
NO_TRIANGLE = 2**32 - 1


def expected():
    """a[i,j,k] is sample (i,j,k)."""
    i, j, k = np.meshgrid(*(np.arange(n) for n in SIZE), indexing="ij")
    return (0.25 + 0.5 * i + 16.0 * j + 512.0 * k).astype(np.float32), (i + 100 * j + 10000 * k).astype(np.uint32)


def same(name, found, wanted):
    if not np.array_equal(np.asarray(found), np.asarray(wanted)):
        sys.exit(f"{name}: found {found}, wanted {wanted}")


def vtk_modules():
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

    return numpy_support, vtkStringArray, vtkImageData, vtkXMLImageDataReader, vtkXMLImageDataWriter


def read_vti(path):
    numpy_support, _, _, Reader, _ = vtk_modules()
    reader = Reader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    same("extent", image.GetExtent(), [0, SIZE[0] - 1, 0, SIZE[1] - 1, 0, SIZE[2] - 1])
    same("origin", image.GetOrigin(), ORIGIN)
    same("spacing", image.GetSpacing(), SPACING)
    points, facts = image.GetPointData(), image.GetFieldData()
    same("scalars", points.GetScalars().GetName(), "distance")
    # By VTK's own way to name a sample, not by our idea of the order in memory.
    values = np.empty(SIZE, np.float32)
    for index in np.ndindex(*SIZE):
        values[index] = points.GetArray("distance").GetValue(image.ComputePointId(index))
    nearest = points.GetArray("nearest_triangle")
    if nearest is not None:
        same("type", nearest.GetDataTypeAsString(), "unsigned int")
        nearest = numpy_support.vtk_to_numpy(nearest).reshape(SIZE[::-1]).transpose()
    text = lambda name: facts.GetAbstractArray(name).GetValue(0)
    return values, nearest, facts.GetArray("thickness").GetValue(0), text("method"), int(text("mesh_hash"), 16), text("version")


def read_npz(path):
    with np.load(path, allow_pickle=False) as file:
        same("origin", file["origin"], ORIGIN)
        same("spacing", file["spacing"], SPACING)
        same("shape", file["distance"].shape, SIZE)
        same("type", file["distance"].dtype, np.dtype("<f4"))
        nearest = file["nearest_triangle"] if "nearest_triangle" in file else None
        return (file["distance"], nearest, float(file["thickness"]), str(file["method"]), int(file["mesh_hash"]),
                str(file["version"]))


def read_nrrd(path):
    """teem reads the file and says what it found, samples as text, x fastest."""
    text = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "ascii", "-i", path, "-o", "-"],
                          check=True, capture_output=True, text=True).stdout
    header, samples = text.split("\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.splitlines() if ": " in line)
    keys = dict(line.split(":=", 1) for line in header.splitlines() if ":=" in line)
    vector = lambda text: [float(n) for n in text.strip("()").split(",")]
    same("sizes", [int(n) for n in fields["sizes"].split()], SIZE)
    same("type", fields["type"], "float")
    same("space origin", vector(fields["space origin"]), ORIGIN)
    same("space directions", [vector(v) for v in fields["space directions"].split()], np.diag(SPACING))
    values = np.array([float(n) for n in samples.split()], np.float32).reshape(SIZE, order="F")
    # teem's own way to name a sample: cut at x, then at y, then at z.
    sample = subprocess.run(f"teem-unu slice -a 2 -p 20 -i {path} | teem-unu slice -a 1 -p 3 | teem-unu slice -a 0 -p 7"
                            " | teem-unu save -f text", shell=True, check=True, capture_output=True, text=True).stdout
    same("sample (7,3,20)", float(sample), values[7, 3, 20])
    return values, None, float(keys["thickness"]), keys["method"], int(keys["mesh_hash"], 16), keys["version"]


def read(path, thickness, nearest=False):
    readers = {"vti": read_vti, "npz": read_npz, "nrrd": read_nrrd}
    values, triangles, *facts = readers[path.rsplit(".", 1)[1]](path)
    full, indices = expected()
    same("values", values, np.minimum(full, np.float32(thickness)))
    same("facts", facts, [thickness, METHOD, HASH, VERSION])
    same("has nearest triangles", triangles is not None, nearest)
    if nearest:
        same("nearest triangles", triangles, np.where(full < thickness, indices, NO_TRIANGLE))


def write_vti(path, header64, big_endian=False, extent_from=(0, 0, 0)):
    numpy_support, _, Image, _, Writer = vtk_modules()
    image = Image()
    a = extent_from
    image.SetExtent(a[0], a[0] + SIZE[0] - 1, a[1], a[1] + SIZE[1] - 1, a[2], a[2] + SIZE[2] - 1)
    image.SetOrigin([o - h * n for o, h, n in zip(ORIGIN, SPACING, a)])
    image.SetSpacing(SPACING)
    array = numpy_support.numpy_to_vtk(expected()[0].ravel(order="F"), deep=True)
    array.SetName("values")
    image.GetPointData().SetScalars(array)
    writer = Writer()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    writer.SetHeaderTypeToUInt64() if header64 else writer.SetHeaderTypeToUInt32()
    writer.SetByteOrderToBigEndian() if big_endian else writer.SetByteOrderToLittleEndian()
    writer.Write()


def rewrite_vti(path):
    """What VTK makes of our file, facts and nearest triangles with it."""
    _, _, _, Reader, Writer = vtk_modules()
    reader = Reader()
    reader.SetFileName(path)
    reader.Update()
    writer = Writer()
    writer.SetFileName(path)
    writer.SetInputData(reader.GetOutput())
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    writer.Write()


def write_npz(path, values, save=np.savez, **more):
    save(path, **more, spacing=SPACING, distance=values, origin=np.array(ORIGIN))


def write_nrrd(path, endian, encoding="raw"):
    """teem makes the file from bare samples."""
    values = expected()[0].astype("<f4").ravel(order="F").tobytes()
    make = ["teem-unu", "make", "-t", "float", "-s", *map(str, SIZE), "-en", "little", "-e", "raw", "-i", "-", "-spc", "3",
            "-orig", "({},{},{})".format(*ORIGIN), "-dirs", "({},0,0) (0,{},0) (0,0,{})".format(*SPACING)]
    made = subprocess.run(make, input=values, check=True, capture_output=True).stdout
    subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", encoding, "-en", endian, "-i", "-", "-o", path], input=made, check=True)


KINDS = {
    "vtk header 32": lambda path: write_vti(path, False),
    "vtk header 64": lambda path: write_vti(path, True),
    "vtk big endian": lambda path: write_vti(path, True, big_endian=True),
    "vtk extent from 5": lambda path: write_vti(path, True, extent_from=(5, -3, 2)),
    "vtk rewritten": rewrite_vti,
    "numpy C order": lambda path: write_npz(path, expected()[0]),
    "numpy Fortran order": lambda path: write_npz(path, np.asfortranarray(expected()[0])),
    "numpy big endian": lambda path: write_npz(path, expected()[0].astype(">f4")),
    "numpy extra arrays": lambda path: write_npz(path, expected()[0], other=np.zeros(3), thickness=np.inf),
    "numpy compressed C order": lambda path: write_npz(path, expected()[0], np.savez_compressed, thickness=np.inf),
    "numpy compressed Fortran order": lambda path: write_npz(path, np.asfortranarray(expected()[0]), np.savez_compressed),
    "numpy compressed zeros": lambda path: write_npz(path, np.zeros((200, 200, 200), "<f4"), np.savez_compressed),
    "teem gzip": lambda path: write_nrrd(path, "big", "gzip"),
    "teem little": lambda path: write_nrrd(path, "little"),
    "teem big": lambda path: write_nrrd(path, "big"),
}

if __name__ == "__main__":
    if sys.argv[1] == "read":
        read(sys.argv[2], float(sys.argv[3]), "nearest" in sys.argv[4:])
    else:
        KINDS[sys.argv[3]](sys.argv[2])
