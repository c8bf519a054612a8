# SPDX-License-Identifier: Apache-2.0
"""Reads and writes fields with software that is not ours: VTK, numpy, teem and OpenVDB.

    foreign.py read  FILE THICKNESS [nearest]   fails unless FILE holds the field of tests/io/field/odd_field.h
    foreign.py ball  FILE                       fails unless FILE holds the ball of odd_field.h, signed, at all samples
    foreign.py sidecars FILE                    fails unless FILE holds the sidecars of sidecars_test.cpp
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


def read_vdb(path):
    import pyopenvdb

    grid = pyopenvdb.read(path, "distance")
    same("class", grid.gridClass, "unknown")
    same("origin", grid.transform.indexToWorld((0, 0, 0)), ORIGIN)
    same("spacing", grid.transform.voxelSize(), SPACING)
    values = np.empty(SIZE, np.float32)
    grid.copyToArray(values)
    facts = grid.metadata
    same("active", grid.activeVoxelCount(), np.count_nonzero(values < np.float32(facts["standoff_thickness"])))
    same("size", facts["standoff_size"], SIZE)
    return (values, None, facts["standoff_thickness"], facts["standoff_method"], int(facts["standoff_mesh_hash"], 16),
            facts["standoff_version"])


def vtk_array(path, name, size):
    numpy_support, _, _, Reader, _ = vtk_modules()
    reader = Reader()
    reader.SetFileName(path)
    reader.Update()
    array = reader.GetOutput().GetPointData().GetArray(name)
    found = numpy_support.vtk_to_numpy(array).reshape((*size[::-1], array.GetNumberOfComponents()))
    return found.transpose(2, 1, 0, 3).squeeze(axis=3) if found.shape[3] == 1 else found.transpose(2, 1, 0, 3)


def teem_array(path, size):
    raw = subprocess.run(["teem-unu", "save", "-f", "nrrd", "-e", "raw", "-en", "little", "-i", path, "-o", "-"], check=True,
                         capture_output=True).stdout
    return np.frombuffer(raw[raw.index(b"\n\n") + 2:], "<f4").reshape(size, order="F")


def openvdb_array(path, size):
    import pyopenvdb

    grid = pyopenvdb.read(path, "distance")
    same("class", grid.gridClass, pyopenvdb.GridClass.LEVEL_SET)
    same("background", grid.background, 2)
    accessor = grid.getConstAccessor()  # by its own way to name a sample
    return np.array([[[accessor.getValue((i, j, k)) for k in range(size[2])] for j in range(size[1])]
                     for i in range(size[0])], np.float32)


def ball(path):
    size = (61, 43, 45)
    i, j, k = np.meshgrid(*(np.arange(n) for n in size), indexing="ij")
    wanted = np.clip(np.sqrt((i - 20.0)**2 + (j - 21.0)**2 + (k - 40.0)**2) - 16, -2, 2).astype(np.float32)
    found = {"vti": lambda: vtk_array(path, "distance", size), "npz": lambda: np.load(path)["distance"],
             "nrrd": lambda: teem_array(path, size), "vdb": lambda: openvdb_array(path, size)}
    same("values", found[path.rsplit(".", 1)[1]](), wanted)


def sidecars(path):
    i, j, k = np.meshgrid(*(np.arange(n) for n in SIZE), indexing="ij")
    stored = 0.25 + 0.5 * (i // 8 * 8) + 16.0 * (j // 8 * 8) + 512.0 * (k // 8 * 8) < 4200.5
    point = np.stack([i + 0.5, 100.0 * j, 1.0 * k], axis=3) * stored[..., None]
    feature = (i + j + k) % 7 * stored
    if path.endswith(".npz"):
        with np.load(path) as file:
            found = file["closest_point"], file["feature"]
    else:
        found = vtk_array(path, "closest_point", SIZE), vtk_array(path, "feature", SIZE)
    same("types", [a.dtype for a in found], [np.dtype("float32"), np.dtype("uint8")])
    same("closest points", found[0], point.astype(np.float32))
    same("features", found[1], feature)


def read(path, thickness, nearest=False):
    readers = {"vti": read_vti, "npz": read_npz, "nrrd": read_nrrd, "vdb": read_vdb}
    values, triangles, *facts = readers[path.rsplit(".", 1)[1]](path)
    full, indices = expected()
    same("values", values, np.minimum(full, np.float32(thickness)))
    same("facts", facts, [thickness, METHOD, HASH, VERSION])
    same("has nearest triangles", triangles is not None, nearest)
    if nearest:
        same("nearest triangles", triangles, np.where(full < thickness, indices, NO_TRIANGLE))


def write_vti(path, header64, big_endian=False, extent_from=(0, 0, 0), compressor="None", block=None):
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
    getattr(writer, "SetCompressorTypeTo" + compressor)()
    if block:
        writer.SetBlockSize(block)
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


def write_vdb(path, half=False, more=(), name="ball", matrix=None, instance=False):
    """A level set of a ball of radius 30.25 about (3, -7, 100), 0.5 between samples, half width 2."""
    import pyopenvdb

    grid = pyopenvdb.createLevelSetSphere(radius=30.25, center=(3, -7, 100), voxelSize=0.5, halfWidth=4)
    grid.name = name
    grid.saveFloatAsHalf = half
    if matrix:
        grid.transform = pyopenvdb.createLinearTransform(matrix)
    grids = [grid]
    for kind in more:
        other = getattr(pyopenvdb, kind)()
        other.name = kind
        grids.append(other)
    if instance:
        other = grid.copy()  # shares the tree
        other.name = "again"
        grids.append(other)
    pyopenvdb.write(path, grids)


def write_tiles(path):
    """Active tiles of 128 samples a side, and single samples beside them."""
    import pyopenvdb

    grid = pyopenvdb.FloatGrid(5.0)
    grid.name = "tiles"
    grid.fill((-8, -8, -8), (7, 7, 7), 2.0)
    grid.fill((0, 0, 0), (200, 140, 130), 1.0)
    pyopenvdb.write(path, grid)


def write_empty_vdb(path):
    import pyopenvdb

    pyopenvdb.write(path, pyopenvdb.FloatGrid(1.0))


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
    "vtk zlib": lambda path: write_vti(path, True, compressor="ZLib"),
    "vtk zlib header 32": lambda path: write_vti(path, False, compressor="ZLib", block=1000),
    "vtk zlib big endian": lambda path: write_vti(path, True, big_endian=True, compressor="ZLib", block=512),
    "vtk lz4": lambda path: write_vti(path, True, compressor="LZ4"),
    "vtk extent from 5": lambda path: write_vti(path, True, extent_from=(5, -3, 2)),
    "vtk rewritten": rewrite_vti,
    "numpy C order": lambda path: write_npz(path, expected()[0]),
    "numpy Fortran order": lambda path: write_npz(path, np.asfortranarray(expected()[0])),
    "numpy big endian": lambda path: write_npz(path, expected()[0].astype(">f4")),
    "numpy extra arrays": lambda path: write_npz(path, expected()[0], other=np.zeros(3), thickness=np.inf),
    "numpy compressed C order": lambda path: write_npz(path, expected()[0], np.savez_compressed, thickness=np.inf),
    "numpy compressed Fortran order": lambda path: write_npz(path, np.asfortranarray(expected()[0]), np.savez_compressed),
    "numpy compressed zeros": lambda path: write_npz(path, np.zeros((200, 200, 200), "<f4"), np.savez_compressed),
    "openvdb ball": write_vdb,
    "openvdb half": lambda path: write_vdb(path, half=True),
    "openvdb named distance": lambda path: write_vdb(path, name="distance", more=["FloatGrid", "BoolGrid"]),
    "openvdb several": lambda path: write_vdb(path, more=["FloatGrid", "Vec3SGrid"]),
    "openvdb sheared": lambda path: write_vdb(path, matrix=[[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]),
    "openvdb anisotropic": lambda path: write_vdb(path, matrix=[[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 3, 0], [1, 2, 3, 1]]),
    "openvdb instance": lambda path: write_vdb(path, name="distance", instance=True),
    "openvdb tiles": write_tiles,
    "openvdb empty": write_empty_vdb,
    "teem gzip": lambda path: write_nrrd(path, "big", "gzip"),
    "teem little": lambda path: write_nrrd(path, "little"),
    "teem big": lambda path: write_nrrd(path, "big"),
}

if __name__ == "__main__":
    if sys.argv[1] in ("ball", "sidecars"):
        globals()[sys.argv[1]](sys.argv[2])
    elif sys.argv[1] == "read":
        read(sys.argv[2], float(sys.argv[3]), "nearest" in sys.argv[4:])
    else:
        KINDS[sys.argv[3]](sys.argv[2])
