# SPDX-License-Identifier: Apache-2.0
"""The values of fields: against a comparison with all triangles, and against closed forms."""

import brute_force
import numpy as np
import pytest
import shapes
import standoff as so


def allowed(distances, spacing):
    """The error that the library promises."""
    return 1e-6 * (np.abs(distances) + 16 * max(spacing)) + np.finfo(np.float32).eps * np.abs(distances)


def expect_close(field, expected):
    error = np.abs(field.numpy().astype(float) - expected)
    assert (error <= allowed(expected, field.grid.spacing)).all(), error.max()


MESHES = {
    "cube": shapes.cube(),
    "tetrahedron": shapes.tetrahedron(),
    "sphere": shapes.sphere(6),
    "sheet": shapes.sheet(),
    "soup": shapes.soup(40),
    "degenerate": (
        np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 1], [3, 0, 0]]),
        np.array([[0, 0, 0], [1, 1, 2], [0, 1, 3]]),
    ),
    "far away": (shapes.cube()[0] + 1e6, shapes.cube()[1]),
    "tiny": (shapes.cube()[0] * 1e-12, shapes.cube()[1]),
    "huge": (shapes.cube()[0] * 1e12, shapes.cube()[1]),
}
every_mesh = pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())


@every_mesh
def test_full_fields_against_brute_force(mesh):
    field = so.field(mesh, shape=(13, 11, 9), sign=None)
    grid = field.grid
    expect_close(field, brute_force.distance(mesh, grid.points().reshape(-1, 3)).reshape(grid.shape))
    assert not field.signed


@every_mesh
def test_bands_against_brute_force(mesh):
    field = so.field(mesh, resolution=14, band=2, sign=None)
    exact = brute_force.distance(mesh, field.grid.points().reshape(-1, 3)).reshape(field.shape)
    expect_close(field, np.minimum(exact, field.thickness))


@pytest.mark.parametrize("options", [{}, {"band": 2}, {"thickness": 0.3}, {"nearest": True}], ids=str)
def test_the_cube_against_its_closed_form(options):
    field = so.field(shapes.cube(), resolution=23, **options)
    exact = shapes.cube_distance(field.grid.points())
    clamped = np.clip(exact, -field.thickness, field.thickness)
    expect_close(field, clamped)
    sure = np.abs(exact) > 1e-5
    np.testing.assert_array_equal((field.numpy() < 0)[sure], (exact < 0)[sure])


@pytest.mark.parametrize("sign", ["auto", "winding", "parity", "flood", so.Sign("winding", rule="nonzero")], ids=str)
def test_the_side_of_a_tetrahedron(sign):
    field = so.field(shapes.tetrahedron(), resolution=20, sign=sign)
    points = field.grid.points()
    sure = np.abs(field.numpy()) > 1e-5
    np.testing.assert_array_equal((field.numpy() < 0)[sure], shapes.in_tetrahedron(points)[sure])
    assert field.signed
    assert field.sign.method != "auto"
    assert field.provenance["sign"].startswith(field.sign.method)
    assert field.sign.boundary_edges == 0


def test_the_sphere_against_its_closed_form():
    rings = 24
    field = so.field(shapes.sphere(rings), resolution=24)
    exact = np.linalg.norm(field.grid.points(), axis=-1) - 1
    difference = field.numpy() - exact
    assert difference.min() > -1e-5  # the polyhedron lies inside the sphere
    assert difference.max() < shapes.sphere_error(rings) + 1e-5


def test_signs_that_were_asked_for():
    mesh = shapes.cube()
    plain = so.field(mesh, resolution=12).numpy()
    np.testing.assert_array_equal(so.field(mesh, resolution=12, sign=so.Sign("winding", invert=True)).numpy(), -plain)
    np.testing.assert_array_equal(so.field(mesh, resolution=12, sign=None).numpy(), np.abs(plain))
    np.testing.assert_array_equal(so.field(mesh, resolution=12, sign="none").numpy(), np.abs(plain))
    inside_out = (mesh[0], mesh[1][:, ::-1])
    np.testing.assert_allclose(so.field(inside_out, resolution=12).numpy(), plain, rtol=1e-6, atol=1e-6)
    oriented = so.field(inside_out, resolution=12, sign=so.Sign("winding", as_oriented=True)).numpy()
    assert (oriented >= 0).all()  # its winding number is -1 inside; samples within its faces have the value 0


def test_a_sheet_is_warned_of():
    with pytest.warns(so.SignWarning, match="sign is not certain") as caught:
        field = so.field(shapes.sheet(), resolution=12)
    assert caught[0].filename == __file__
    assert not field.signed
    assert field.sign.method == "none"
    assert not field.sign.sure
    assert (field.numpy() >= 0).all()
    with pytest.raises(so.DoubtError):
        so.field(shapes.sheet(), resolution=12, sign=so.Sign(strict=True))
    shell = so.field(shapes.sheet(), resolution=12, sign=so.Sign("shell", shell=0.4))
    assert (shell.numpy() < 0).any()


def test_the_nearest_triangle():
    mesh = shapes.soup(60)
    field = so.field(mesh, resolution=16, band=2, sign=None, nearest=True)
    nearest = field.nearest()
    assert nearest.shape == field.shape
    assert nearest.dtype == np.uint32
    within = np.abs(field.numpy()) < field.thickness
    points = field.grid.points()[within]
    all_distances = brute_force.distances(mesh, points)
    of_nearest = all_distances[np.arange(len(points)), nearest[within]]
    assert (of_nearest - all_distances.min(axis=1) <= 2e-6 * (of_nearest + 16 * max(field.grid.spacing))).all()
    with pytest.raises(so.UsageError):
        so.field(mesh, resolution=8, sign=None).nearest()


def test_values_do_not_depend_on_threads_or_backend():
    mesh = shapes.sphere(8)
    expected = so.field(mesh, resolution=24, band=2, threads=1)
    for options in ({"threads": 2}, {"threads": 7}, {"device": "cpu"}, {"device": "emulated"}):
        again = so.field(mesh, resolution=24, band=2, **options)
        np.testing.assert_array_equal(again.numpy(), expected.numpy(), str(options))
