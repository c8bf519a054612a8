# SPDX-License-Identifier: Apache-2.0
"""Surfaces of fields and meshes: closed oriented manifolds where the solid is."""

import math

import numpy as np
import pytest
import shapes
import standoff as so


def expect_closed(mesh):
    """Each edge is used once in each direction, and each vertex's triangles form one fan."""
    faces = mesh.faces.astype(np.int64)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    assert (edges[:, 0] != edges[:, 1]).all()
    directed, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 1).all()
    assert {tuple(e) for e in directed.tolist()} == {(b, a) for a, b in directed.tolist()}
    assert set(np.unique(faces)) == set(range(len(mesh.vertices)))
    following = {}
    for a, b, c in faces.tolist():
        for corner, first, second in ((a, b, c), (b, c, a), (c, a, b)):
            following.setdefault(corner, {})[first] = second
    for around in following.values():
        start = at = next(iter(around))
        for steps in range(1, len(around) + 1):  # noqa: B007
            at = around[at]
            if at == start:
                break
        assert steps == len(around)


def volume(mesh):
    a, b, c = (np.asarray(mesh.vertices, float)[mesh.faces[:, k].astype(int)] for k in range(3))
    return (a * np.cross(b, c)).sum() / 6


FIELDS = {
    "full": lambda mesh, n: so.field(mesh, resolution=n),
    "band": lambda mesh, n: so.field(mesh, resolution=n, band=4),
    "of numbers": lambda mesh, n: so.DistanceField.from_numpy(*_numbers(so.field(mesh, resolution=n))),
}


def _numbers(field):
    return field.numpy(), field.grid


@pytest.mark.parametrize("method", ["marching_cubes", "dual"])
@pytest.mark.parametrize("make", FIELDS.values(), ids=FIELDS.keys())
def test_the_surface_of_a_sphere(make, method):
    field = make(shapes.sphere(16), 20)
    for at in (0.0, 0.1, -0.1):
        mesh = so.surface(field, at=at, method=method)
        expect_closed(mesh)
        spread = max(field.grid.spacing)
        radii = np.linalg.norm(mesh.vertices, axis=1)
        np.testing.assert_allclose(radii, 1 + at, atol=shapes.sphere_error(16) + 0.5 * spread**2 + 0.01)
        assert volume(mesh) == pytest.approx(4 / 3 * math.pi * (1 + at) ** 3, rel=0.05)


def test_the_surface_of_a_mesh():
    for method, tolerance in (("marching_cubes", 0.05), ("dual", 1e-3)):
        mesh = so.surface(shapes.cube(), resolution=24, method=method)
        expect_closed(mesh)
        assert volume(mesh) == pytest.approx(1, rel=tolerance)
    grown = so.surface(shapes.cube(), at=0.25, resolution=28)
    expect_closed(grown)
    assert volume(grown) == pytest.approx(
        1 + 6 * 0.25 + 12 / 4 * math.pi * 0.25**2 + 4 / 3 * math.pi * 0.25**3, rel=0.01
    )
    assert np.abs(grown.vertices).max() == pytest.approx(0.75, abs=1e-3)  # the grid holds all of it
    assert volume(so.surface(shapes.cube(), at=-0.25, resolution=28)) == pytest.approx(0.125, rel=0.02)


def test_walls():
    mesh = so.surface(so.field(shapes.cube(), resolution=30), wall=0.2)
    expect_closed(mesh)
    assert volume(mesh) == pytest.approx(1 - 0.6**3, rel=0.02)


def test_sheets_and_nothing():
    both = so.surface(so.field(shapes.sheet(), resolution=30, padding=5, sign=None), at=0.1)
    expect_closed(both)
    exact = 0.2 + math.pi * 0.1**2 / 2 * 4 + 4 / 3 * math.pi * 0.1**3
    assert volume(both) == pytest.approx(exact, rel=0.04)
    assert len(so.surface(shapes.cube(), at=-0.6, resolution=20).faces) == 0
    with pytest.warns(so.SignWarning):
        so.surface(shapes.sheet(), at=0.1, resolution=20)


def test_a_surface_goes_back_to_a_field():
    first = so.field(shapes.sphere(12), resolution=32)
    again = so.field(so.surface(first), grid=first.grid)
    assert again.sign.sure
    assert np.abs(again.numpy() - first.numpy()).max() < max(first.grid.spacing)


@pytest.mark.parametrize(
    "arguments",
    [
        {"at": math.nan}, {"at": math.inf}, {"at": 99}, {"at": -99}, {"wall": -1}, {"wall": math.nan}, {"wall": 99},
        {"method": "cubes"}, {"resolution": 8}, {"spacing": 1}, {"shape": (8, 8, 8)}, {"padding": 1}, {"threads": -1},
        {"grid": so.Grid((2, 2, 2), (0, 0, 0), (1, 1, 1))},
    ],
    ids=str,
)  # fmt: skip
def test_arguments_that_make_no_sense(arguments):
    with pytest.raises(ValueError):
        so.surface(so.field(shapes.cube(), resolution=16, band=3), **arguments)
    for wrong in ({"at": "0"}, {"wall": None}, {"method": None}, {"threads": "2"}):
        with pytest.raises(TypeError):
            so.surface(so.field(shapes.cube(), resolution=16, band=3), **wrong)
    with pytest.raises(TypeError):
        so.surface(None)


def test_a_field_without_a_sign_has_no_surface_at_zero():
    unsigned = so.field(shapes.cube(), resolution=16, sign=None)
    for at in (0, -0.1):
        with pytest.raises(ValueError, match="no sign"):
            so.surface(unsigned, at=at)
    assert len(so.surface(unsigned, at=0.1).faces) > 0
