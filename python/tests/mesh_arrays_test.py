# SPDX-License-Identifier: Apache-2.0
"""Meshes from arrays of every kind: the same mesh, and the caller's memory where its layout allows."""

import numpy as np
import pytest
import standoff as so
from shapes import cube

VERTICES, FACES = cube()
VERTICES = VERTICES + 0.25  # exact in every float type
POINTS = np.random.default_rng(1).uniform(-1, 2, (50, 3))
EXPECTED = so.distance((VERTICES, FACES), POINTS)


def address(array):
    return array.__array_interface__["data"][0]


def misaligned(array):
    memory = np.zeros(array.nbytes + 1, np.uint8)
    view = memory[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    assert not view.flags.aligned
    return view


def packed_records(array):
    """Rows whose distance in memory is no multiple of a number's size."""
    records = np.zeros(len(array), np.dtype([("rows", array.dtype, 3), ("tag", np.uint8)]))
    records["rows"] = array
    return records["rows"]


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


LAYOUTS = {
    "C order": np.ascontiguousarray,
    "Fortran order": np.asfortranarray,
    "every second row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "columns of a wider array": lambda a: np.concatenate([a, a], axis=1)[:, :3],
    "reversed rows in memory": lambda a: a[::-1].copy()[::-1],
    "reversed columns in memory": lambda a: a[:, ::-1].copy()[:, ::-1],
    "misaligned": misaligned,
    "packed records": packed_records,
    "read-only": read_only,
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "subclass": lambda a: a.view(type("Tracked", (np.ndarray,), {})),
    "lists": lambda a: a.tolist(),
    "tuples": lambda a: tuple(map(tuple, a.tolist())),
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("vertex_type", [np.float32, np.float64])
@pytest.mark.parametrize("face_type", [np.int32, np.uint32, np.int64, np.uint64])
def test_layouts_give_the_same_mesh(layout, vertex_type, face_type):
    lay = LAYOUTS[layout]
    mesh = so.Mesh(lay(VERTICES.astype(vertex_type)), lay(FACES.astype(face_type)))
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    np.testing.assert_array_equal(mesh.faces, FACES)
    np.testing.assert_array_equal(so.distance(mesh, POINTS), EXPECTED)
    field = so.field(mesh, resolution=12)
    np.testing.assert_array_equal(field.numpy(), so.field((VERTICES, FACES), resolution=12).numpy())


@pytest.mark.parametrize("vertex_type", [np.float16, np.int8, np.int32, np.int64, np.uint16, np.uint64])
def test_other_number_types_are_converted(vertex_type):
    mesh = so.Mesh((4 * (VERTICES + 1)).astype(vertex_type), FACES)
    assert mesh.vertices.dtype == np.float64
    np.testing.assert_array_equal(mesh.vertices, 4 * (VERTICES + 1))


@pytest.mark.parametrize("face_type", [np.int8, np.uint8, np.int16, np.uint16])
def test_small_indices_are_converted(face_type):
    np.testing.assert_array_equal(so.Mesh(VERTICES, FACES.astype(face_type)).faces, FACES)


@pytest.mark.parametrize("layout", ["C order", "every second row", "columns of a wider array", "read-only", "subclass"])
def test_memory_that_fits_is_not_copied(layout):
    for vertex_type, face_type in ((np.float32, np.int32), (np.float64, np.uint64)):
        vertices, faces = LAYOUTS[layout](VERTICES.astype(vertex_type)), LAYOUTS[layout](FACES.astype(face_type))
        mesh = so.Mesh(vertices, faces)
        assert address(mesh.vertices) == address(vertices)
        assert address(mesh.faces) == address(faces)


def test_inputs_are_not_changed_and_not_kept():
    vertices, faces = VERTICES.copy(), FACES.copy()
    field = so.field((vertices, faces), resolution=16, band=2)
    query, body = so.MeshQuery((vertices, faces), sign=None), so.Body((vertices, faces))
    np.testing.assert_array_equal(vertices, VERTICES)
    np.testing.assert_array_equal(faces, FACES)
    before = field.numpy().copy()
    vertices[:] = 7
    faces[:] = 10**9
    np.testing.assert_array_equal(field.numpy(), before)
    np.testing.assert_array_equal(query.distance(POINTS), np.abs(EXPECTED))
    assert so.collide(body, body, np.eye(4)).hit


def test_buffers_and_array_interfaces():
    class Interface:
        def __init__(self, array):
            self.__array_interface__ = array.__array_interface__
            self.keep = array

    class Dlpack:
        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **options):
            return self.array.__dlpack__(**options)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    faces = FACES.astype(np.int32)
    for wrap in (Interface, Dlpack, memoryview):
        mesh = so.Mesh(wrap(VERTICES), wrap(faces))
        assert address(mesh.vertices) == address(VERTICES)
        assert address(mesh.faces) == address(faces)


class Sealed(np.ndarray):
    """A subclass that lets nobody index it or compute with it."""

    def __getitem__(self, place):
        raise RuntimeError("sealed")

    def __array_ufunc__(self, *_, **__):
        raise RuntimeError("sealed")

    def __array_function__(self, *_, **__):
        raise RuntimeError("sealed")


def test_subclasses_of_arrays_are_taken_as_arrays():
    mesh = so.Mesh(VERTICES.view(Sealed), FACES.view(Sealed))
    assert type(mesh.vertices) is type(mesh.faces) is np.ndarray
    assert address(mesh.vertices) == address(VERTICES)
    field = so.field(mesh, resolution=8)
    np.testing.assert_array_equal(field(POINTS.view(Sealed)), field(POINTS))
    np.testing.assert_array_equal(
        so.distance(mesh, POINTS.view(Sealed), sign=None), so.distance(mesh, POINTS, sign=None)
    )
    body = so.Body(mesh)
    for pose in (np.eye(4), np.eye(7)[6]):
        assert so.collide(body, body, pose.view(Sealed)).hit
    values = field.numpy()
    again = so.DistanceField.from_numpy(values.view(Sealed), field.grid)
    np.testing.assert_array_equal(again.numpy(), values)


def test_repr_equality_and_size():
    mesh = so.Mesh(VERTICES, FACES)
    assert repr(mesh) == "<standoff.Mesh: 8 vertices, 12 triangles>"
    assert mesh == so.Mesh(VERTICES.astype(np.float32), FACES.astype(np.uint32))
    assert mesh != so.Mesh(VERTICES + 1, FACES)
    assert mesh != "mesh"
    assert mesh.bounds == ((-0.25,) * 3, (0.75,) * 3)
    assert mesh.notes == ()
