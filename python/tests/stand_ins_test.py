# SPDX-License-Identifier: Apache-2.0
"""Mesh objects of other libraries, known by their attributes: small classes that have the same ones."""

import enum
from types import SimpleNamespace as Thing

import numpy as np
import pytest
import shapes
import standoff as so

VERTICES, FACES = shapes.cube()
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
CUBE = so.Mesh(VERTICES, FACES)


class Tensor:
    """An array that numpy gets by DLPack alone."""

    def __init__(self, array):
        self.array = np.ascontiguousarray(array)

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


class NamedDevice(Tensor):
    """Open3D names the device by an enumeration that does not equal its number."""

    def __dlpack_device__(self):
        return (enum.Enum("Device", {"CPU": 1}).CPU, 0)


class OnGpu(Tensor):
    def __dlpack_device__(self):
        return (2, 0)


class Cupy:
    @property
    def __cuda_array_interface__(self):
        return {"shape": (8, 3), "typestr": "<f8", "data": (0, False), "version": 3}


def scene():
    return Thing(geometry={}, to_geometry=lambda: Thing(vertices=VERTICES, faces=FACES))


def grid_of_cells():
    surface = Thing(points=VERTICES, is_all_triangles=True, regular_faces=FACES)
    return Thing(points=VERTICES, extract_surface=lambda: surface)


def polygons():
    return Thing(
        points=VERTICES,
        is_all_triangles=False,
        regular_faces=QUADS,
        triangulate=lambda: Thing(points=VERTICES, regular_faces=FACES),
    )


OBJECTS = {
    "trimesh": Thing(vertices=VERTICES, faces=FACES),
    "trimesh scene": scene(),
    "open3d": Thing(vertices=VERTICES.tolist(), triangles=FACES.tolist()),
    "open3d tensor": Thing(vertex=Thing(positions=NamedDevice(VERTICES)), triangle=Thing(indices=NamedDevice(FACES))),
    "pyvista": Thing(points=VERTICES, is_all_triangles=True, regular_faces=FACES),
    "pyvista polygons": polygons(),
    "pyvista grid": grid_of_cells(),
    "pyvista cells": Thing(points=VERTICES, cells_dict={5: FACES}, extract_surface=lambda: polygons()),
    "meshio": Thing(points=VERTICES, cells_dict={"triangle": FACES}),
    "meshio quads": Thing(points=VERTICES, cells_dict={"quad": QUADS}),
    "meshio both": Thing(points=VERTICES, cells_dict={"triangle": FACES[:2], "quad": QUADS[1:], "line": FACES[:, :2]}),
    "pytorch3d": Thing(verts_packed=lambda: Tensor(VERTICES), faces_packed=lambda: Tensor(FACES)),
    "warp": Thing(points=Tensor(VERTICES), indices=Tensor(FACES.astype(np.int32).ravel())),
}


@pytest.mark.parametrize("thing", OBJECTS.values(), ids=OBJECTS.keys())
def test_objects_are_the_cube(thing):
    points = np.random.default_rng(1).uniform(-1, 1, (100, 3))
    np.testing.assert_allclose(so.distance(thing, points), shapes.cube_distance(points), atol=1e-12)
    report = so.report(thing)
    assert report.triangles == 12 and report.volume == pytest.approx(1)
    assert so.Grid.fit(thing, resolution=8) == so.Grid.fit(CUBE, resolution=8)
    assert so.collide(so.Body(thing), so.Body(CUBE), np.eye(4)).hit
    assert next(so.fields([thing], resolution=8)).error is None


BROKEN = {
    "no triangles": Thing(points=VERTICES, cells_dict={"tetra": QUADS}),
    "no cells": Thing(points=VERTICES, cells_dict={}),
    "flat points": Thing(points=VERTICES[:, :2], cells_dict={"triangle": FACES}),
    "points of nothing": Thing(points=None, cells_dict={"triangle": FACES}),
    "no arrays": Thing(vertices=None, faces=None),
    "methods": Thing(vertices=lambda: VERTICES, faces=lambda: FACES),
    "on a GPU": Thing(vertices=OnGpu(VERTICES), faces=FACES),
    "cupy": Thing(vertices=Cupy(), faces=FACES),
    "quads": Thing(vertices=VERTICES, faces=QUADS),
    "float indices": Thing(points=VERTICES, indices=FACES.astype(float).ravel()),
    "odd indices": Thing(points=VERTICES, indices=FACES.ravel()[:-1]),
    "unknown": Thing(corners=VERTICES),
}


@pytest.mark.parametrize("thing", BROKEN.values(), ids=BROKEN.keys())
def test_objects_that_cannot_be_meshes(thing):
    with pytest.raises((TypeError, ValueError, so.DeviceError)):
        so.field(thing, resolution=8)


def test_arrays_on_a_gpu_are_named():
    for vertices in (OnGpu(VERTICES), Cupy()):
        with pytest.raises(so.DeviceError, match="copy it"):
            so.Mesh(vertices, FACES)
    with pytest.raises(so.DeviceError, match="points"):
        so.distance(CUBE, OnGpu(VERTICES), sign=None)
    with pytest.raises(so.DeviceError, match="poses"):
        so.collide(so.Body(CUBE), so.Body(CUBE), OnGpu(np.eye(4)))


def test_a_failing_object_says_why():
    class Failing:
        faces = FACES

        @property
        def vertices(self):
            raise RuntimeError("lost")

    with pytest.raises(RuntimeError, match="lost"):
        so.field(Failing())


def test_array_api_answers_come_back_in_the_callers_library():
    class Namespace:
        @staticmethod
        def asarray(array):
            made = Other(array)
            return made

    class Other(Tensor):
        def __array_namespace__(self):
            return Namespace

    points = np.random.default_rng(1).uniform(-1, 1, (5, 3))
    answers = so.distance(CUBE, Other(points), sign=None, closest=True)
    for name, value in vars(answers).items():
        assert isinstance(value, Other), name
    np.testing.assert_array_equal(answers.distance.array, so.distance(CUBE, points, sign=None))
    poses = Other(np.stack([np.eye(4)] * 3))
    assert isinstance(so.collide(so.Body(CUBE), so.Body(CUBE), poses).hit, Other)
    touching = so.contacts(so.Body(CUBE), so.Body(CUBE), Other(np.eye(4)))
    for name in ("point", "normal", "depth", "triangle_a", "triangle_b"):
        assert isinstance(getattr(touching, name), Other), name
    assert isinstance(so.contacts(so.Body(CUBE), so.Body(CUBE), np.eye(4)).point, np.ndarray)
