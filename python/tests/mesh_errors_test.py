# SPDX-License-Identifier: Apache-2.0
"""Meshes that are none: an exception that says which triangle, and never a crash."""

import numpy as np
import pytest
import standoff as so
from shapes import cube

VERTICES, FACES = cube()
USES = {
    "field": lambda mesh: so.field(mesh, resolution=8),
    "band": lambda mesh: so.field(mesh, resolution=16, band=2),
    "distance": lambda mesh: so.distance(mesh, [[0, 0, 0]], sign=None),
    "closest": lambda mesh: so.distance(mesh, [[0, 0, 0]], sign=None, closest=True),
    "signed": lambda mesh: so.MeshQuery(mesh, sign="auto"),
    "body": so.Body,
    "report": so.report,
    "surface": lambda mesh: so.surface(mesh, resolution=8),
    "grid": so.Grid.fit,
    "bounds": lambda mesh: so.Mesh(*mesh).bounds,
    "verify": lambda mesh: so.verify(so.field(cube(), resolution=8), mesh),
    "plot": lambda mesh: so.Mesh(*mesh).plot(width=64, height=48),
    "in a grid of its own": lambda mesh: so.field(mesh, grid=so.Grid((4, 4, 4), (0, 0, 0), (1, 1, 1))),
}
every_use = pytest.mark.parametrize("use", USES.values(), ids=USES.keys())


def with_face(row, value, dtype=np.int64):
    faces = FACES.astype(dtype)
    faces[row, 1] = value
    return faces


@every_use
@pytest.mark.parametrize(
    "faces",
    [
        with_face(5, 8),
        with_face(5, -1),
        with_face(5, -1, np.int32),
        with_face(5, -(2**31), np.int32),
        with_face(5, 2**31 - 1, np.int32),
        with_face(5, 2**32 - 1, np.uint32),
        with_face(5, 2**32),
        with_face(5, 2**32 + 1),  # 1 in its low 32 bits
        with_face(5, -(2**32)),
        with_face(5, 2**63 - 1),
        with_face(5, -(2**63)),
        with_face(5, 2**64 - 1, np.uint64),
        with_face(5, 2**63 + 2, np.uint64),
        with_face(5, 200, np.uint8),
    ],
    ids=lambda faces: f"{faces[5, 1]} {faces.dtype}",
)
def test_faces_out_of_range(use, faces):
    with pytest.raises(so.MeshError) as caught:
        use((VERTICES, faces))
    assert caught.value.triangle == 5
    assert isinstance(caught.value, (so.InputError, so.Error, ValueError))


@every_use
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_corners_that_are_not_finite(use, value, dtype):
    vertices = VERTICES.astype(dtype)
    vertices[7, 2] = value
    with pytest.raises(so.MeshError) as caught:
        use((vertices, FACES))
    assert caught.value.triangle == 2


def test_vertices_that_no_face_uses_may_be_anything():
    vertices = np.concatenate([VERTICES, [[np.nan, np.inf, 1e308]]])
    mesh = so.Mesh(vertices, FACES)
    assert mesh.bounds == ((-0.5,) * 3, (0.5,) * 3)
    np.testing.assert_array_equal(
        so.field(mesh, resolution=9).numpy(), so.field((VERTICES, FACES), resolution=9).numpy()
    )


@pytest.mark.parametrize("use", sorted(USES.keys() - {"report", "plot"}))
@pytest.mark.parametrize("vertices", [np.zeros((0, 3)), np.zeros((0, 3), np.float32), VERTICES])
@pytest.mark.parametrize("faces", [[], np.zeros((0, 3), np.int32)])
def test_empty_meshes(use, vertices, faces):
    with pytest.raises(so.Error):
        USES[use]((vertices, faces))
    assert so.report((vertices, faces)).triangles == 0


WRONG = {
    "no arrays": (None, None),
    "strings": ("abc", "def"),
    "string numbers": (VERTICES.astype(str), FACES),
    "objects": (VERTICES.astype(object), FACES),
    "bool vertices": (VERTICES.astype(bool), FACES),
    "complex vertices": (VERTICES.astype(complex), FACES),
    "long doubles": (VERTICES.astype(np.longdouble), FACES),
    "dates": (VERTICES.astype("datetime64[s]"), FACES),
    "ragged vertices": ([[0, 0, 0], [1, 1]], FACES),
    "masked vertices": (np.ma.masked_array(VERTICES, VERTICES > 0), FACES),
    "float faces": (VERTICES, FACES.astype(float)),
    "bool faces": (VERTICES, FACES.astype(bool)),
    "string faces": (VERTICES, FACES.astype(str)),
    "object faces": (VERTICES, FACES.astype(object)),
    "ragged faces": (VERTICES, [[0, 1, 2], [1, 2]]),
    "one vertex": (VERTICES[0], FACES),
    "flat vertices": (VERTICES.ravel(), FACES),
    "2-d vertices": (VERTICES[:, :2], FACES),
    "homogeneous vertices": (np.ones((8, 4)), FACES),
    "transposed vertices": (VERTICES.T, FACES),
    "batched vertices": (VERTICES[None], FACES),
    "flat faces": (VERTICES, FACES.ravel()),  # pyvista's have a 3 before each triangle
    "quads": (VERTICES, [[0, 1, 3, 2]]),
    "edges": (VERTICES, [[0, 1]]),
    "batched faces": (VERTICES, FACES[None]),
    "scalars": (1.0, 2),
}


@pytest.mark.parametrize("vertices, faces", WRONG.values(), ids=WRONG.keys())
def test_what_is_no_mesh(vertices, faces):
    with pytest.raises((TypeError, ValueError)) as caught:
        so.Mesh(vertices, faces)
    assert str(caught.value).startswith(("vertices: ", "faces: "))
    assert not isinstance(caught.value, UnicodeError)


@pytest.mark.parametrize("mesh", [None, 3, object(), {}, set(), (), (1, 2, 3), [[0, 0, 0]], np.zeros((3, 3)), b"x.obj"])
def test_objects_that_are_no_mesh(mesh):
    with pytest.raises(TypeError, match="^mesh: "):
        so.field(mesh)


def test_a_mesh_that_somebody_broke_afterwards():
    mesh = so.Mesh(VERTICES, FACES)
    for broken in ("junk", None, [[0, 1, 2]], np.zeros((2, 2)), np.asfortranarray(FACES), FACES.astype(np.int8)):
        mesh.faces = broken
        with pytest.raises((TypeError, ValueError)):
            so.field(mesh, resolution=8)
