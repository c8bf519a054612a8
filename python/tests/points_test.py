# SPDX-License-Identifier: Apache-2.0
"""Exact answers at points: against a comparison with all triangles, solid angles and closed forms."""

import warnings

import brute_force
import numpy as np
import pytest
import shapes
import standoff as so

RANDOM = np.random.default_rng(3)
MESHES = {
    "cube": shapes.cube(),
    "tetrahedron": shapes.tetrahedron(),
    "sphere": shapes.sphere(6),
    "sheet": shapes.sheet(),
    "soup": shapes.soup(80),
    "one triangle": (np.eye(3), np.array([[0, 1, 2]])),
    "degenerate": (
        np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 1], [3, 0, 0]]),
        np.array([[0, 0, 0], [1, 1, 2], [0, 1, 3]]),
    ),
    "far away": (shapes.cube()[0] + 1e6, shapes.cube()[1]),
}
every_mesh = pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())


def points_about(mesh, count=300):
    low, high = mesh[0].min(axis=0), mesh[0].max(axis=0)
    size = (high - low).max()
    on_it = mesh[0][mesh[1]].mean(axis=1)[:40]
    return np.concatenate([RANDOM.uniform(low - size, high + size, (count, 3)), mesh[0][:20], on_it])


@every_mesh
def test_distances(mesh):
    points = points_about(mesh)
    exact = brute_force.distance(mesh, points)
    scale = np.abs(points).max()
    np.testing.assert_allclose(so.distance(mesh, points, sign=None), exact, rtol=1e-13, atol=1e-14 * scale)


@every_mesh
def test_closest_points(mesh):
    points = points_about(mesh)
    found = so.distance(mesh, points, sign=None, closest=True)
    vertices, faces = mesh
    scale = np.abs(points).max()
    all_distances = brute_force.distances(mesh, points)
    exact = all_distances.min(axis=1)
    np.testing.assert_allclose(found.distance, exact, rtol=1e-13, atol=1e-14 * scale)
    np.testing.assert_allclose(np.linalg.norm(points - found.point, axis=1), exact, rtol=1e-12, atol=1e-13 * scale)
    np.testing.assert_allclose(
        all_distances[np.arange(len(points)), found.triangle], exact, rtol=1e-12, atol=1e-13 * scale
    )
    corners = vertices[faces[found.triangle]]
    np.testing.assert_allclose((found.barycentric[..., None] * corners).sum(axis=1), found.point, atol=1e-12 * scale)
    np.testing.assert_allclose(found.barycentric.sum(axis=1), 1, atol=1e-14)
    assert (found.barycentric >= 0).all()
    off = exact > 1e-6 * scale
    away = (points - found.point)[off] / exact[off, None]
    np.testing.assert_allclose(found.gradient[off], away, atol=1e-7 if scale > 100 else 1e-9)


def test_ties_go_to_the_lowest_index():
    mesh = shapes.cube()
    twice = (mesh[0], np.concatenate([mesh[1], mesh[1]]))
    found = so.distance(twice, RANDOM.uniform(-1, 1, (200, 3)), sign=None, closest=True)
    assert found.triangle.max() < 12


@pytest.mark.parametrize("mesh", [shapes.tetrahedron(), (np.eye(3), np.array([[0, 1, 2]]))], ids=["closed", "open"])
def test_features(mesh):
    vertices, _ = mesh
    middle = vertices.mean(axis=0)
    points = np.concatenate([middle + 10 * (vertices - middle), points_about(mesh)])
    found = so.distance(mesh, points, sign=None, closest=True)
    assert list(so.FEATURES) == ["face", "edge 0", "edge 1", "edge 2", "vertex 0", "vertex 1", "vertex 2"]
    for feature, weights in zip(found.feature, found.barycentric):
        kind, _, number = so.FEATURES[feature].partition(" ")
        on = np.flatnonzero(weights > 1e-14)
        if kind == "vertex":
            assert list(on) == [int(number)]
        elif kind == "edge":
            assert set(on) <= {int(number), (int(number) + 1) % 3}
    assert {so.FEATURES[f].split()[0] for f in found.feature} == {"face", "edge", "vertex"}


def test_signs():
    points = RANDOM.uniform(-1, 1, (2000, 3))
    signed = so.distance(shapes.cube(), points)
    np.testing.assert_allclose(signed, shapes.cube_distance(points), rtol=1e-12, atol=1e-13)
    for sign in ("auto", "winding", "parity", so.Sign("winding")):
        np.testing.assert_array_equal(so.distance(shapes.cube(), points, sign=sign), signed)
    np.testing.assert_array_equal(so.distance(shapes.cube(), points, sign=so.Sign("winding", invert=True)), -signed)
    np.testing.assert_array_equal(so.distance(shapes.cube(), points, sign=None), np.abs(signed))
    found = so.distance(shapes.cube(), points, closest=True)
    np.testing.assert_array_equal(found.distance, signed)
    inside = so.distance(shapes.tetrahedron(), points) < 0
    np.testing.assert_array_equal(inside, shapes.in_tetrahedron(points))


def test_the_gradient_leads_out_of_the_cube():
    points = RANDOM.uniform(-1, 1, (500, 3))
    found = so.distance(shapes.cube(), points, closest=True)
    step = 1e-6
    grown = shapes.cube_distance(points + step * found.gradient)
    np.testing.assert_allclose((grown - shapes.cube_distance(points)) / step, 1, atol=1e-5)


@every_mesh
def test_winding_numbers(mesh):
    points = points_about(mesh)
    points = points[brute_force.distance(mesh, points) > 1e-3]
    query = so.MeshQuery(mesh, sign=so.Sign("winding", as_oriented=True))
    np.testing.assert_allclose(query.winding_number(points), brute_force.winding_number(mesh, points), atol=1e-6)
    for sign in (None, "parity"):
        with pytest.raises(so.UsageError, match="winding"):
            so.MeshQuery(shapes.cube(), sign=sign).winding_number(points)


def test_a_query_answers_like_the_function():
    points = points_about(shapes.sphere(6))
    query = so.MeshQuery(shapes.sphere(6), sign="auto")
    assert query.signed
    np.testing.assert_array_equal(query.distance(points), so.distance(shapes.sphere(6), points))
    np.testing.assert_array_equal(so.distance(query, points), query.distance(points))
    assert query.nbytes > 0
    assert repr(query).startswith(f"<standoff.MeshQuery: {len(shapes.sphere(6)[1])} triangles, signed (winding)")
    for threads in (1, 2, 5):
        np.testing.assert_array_equal(query.distance(points, threads=threads), query.distance(points))
    for wrong in (None, "winding", so.Sign("winding")):
        with pytest.raises(ValueError, match="^sign: "):
            so.distance(query, points, sign=wrong)
    unsigned = so.MeshQuery(shapes.sphere(6), sign=None)
    np.testing.assert_array_equal(so.distance(unsigned, points), np.abs(query.distance(points)))
    body = so.Body(shapes.cube())
    for wrong in ((body, body), (shapes.cube(), body), (body, points)):
        with pytest.raises(TypeError, match=r"standoff\.distance_between\(a, b\)"):
            so.distance(*wrong)
    with pytest.warns(so.SignWarning) as caught:
        assert not so.MeshQuery(shapes.sheet(), sign="auto").signed
    assert caught[0].filename == __file__


def test_what_users_of_trimesh_look_for():
    mesh, open_mesh = so.Mesh(*shapes.cube()), so.Mesh(shapes.cube()[0], shapes.cube()[1][2:])
    assert mesh.area == pytest.approx(6) and mesh.volume == pytest.approx(1)
    assert mesh.is_watertight and not open_mesh.is_watertight
    assert open_mesh.area == pytest.approx(5)
    asked = [[[0.0, 0, 0], [0.4, 0.4, -0.4]], [[0.6, 0, 0], [0, 0, 0.5]]]
    for inside in (mesh.contains(asked), so.MeshQuery(mesh).contains(asked)):
        assert inside.dtype == bool and inside.tolist() == [[True, True], [False, False]]
    for contains in (so.MeshQuery(mesh, sign=None).contains, so.Mesh(*shapes.sheet()).contains):
        with pytest.raises(so.MeshError, match="^contains: "), warnings.catch_warnings():
            warnings.simplefilter("ignore", so.SignWarning)
            contains(asked)
    with pytest.raises(so.MeshError):
        _ = so.Mesh([[0, 0, 0]], [[0, 0, 7]]).area
