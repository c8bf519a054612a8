# SPDX-License-Identifier: Apache-2.0
"""Random meshes, points, poses and options: an answer that holds, or a documented exception; never a crash."""

import warnings

import brute_force
import numpy as np
import shapes
import standoff as so
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from random_input import any_faces, any_vertices, floats, good_meshes, laid_out, shapes_of_rows, tame

DOCUMENTED = (so.Error, ValueError, TypeError, MemoryError)
FUZZ = settings(
    max_examples=60, deadline=None, database=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


def attempt(call):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", so.SignWarning)
        warnings.simplefilter("ignore", so.SurfaceWarning)
        try:
            return call()
        except DOCUMENTED as error:
            assert str(error) and "bad_cast" not in str(error)
            assert getattr(error, "triangle", 0) is None or getattr(error, "triangle", 0) >= 0
            return None


@FUZZ
@given(any_vertices(), any_faces())
def test_any_arrays_as_a_mesh(vertices, faces):
    mesh = attempt(lambda: so.Mesh(vertices, faces))
    if mesh is None:
        return
    for use in (
        lambda: mesh.bounds,
        lambda: so.field(mesh, resolution=6),
        lambda: so.field(mesh, resolution=6, band=1, nearest=True),
        lambda: so.distance(mesh, [[0, 0, 0], [1e3, 2, 3]], closest=True),
        lambda: so.collide(so.Body(mesh), so.Body(mesh), np.eye(4), containment=True),
        lambda: so.report(mesh),
        lambda: so.surface(mesh, resolution=6, at=0.1),
    ):
        attempt(use)


@FUZZ
@given(good_meshes(), arrays.arrays(np.float64, (5, 3), elements=tame))
def test_distances_of_any_triangles(mesh, points):
    exact = brute_force.distance(mesh, points)
    np.testing.assert_allclose(so.distance(mesh, points, sign=None), exact, atol=1e-12)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", so.SignWarning)
        found = so.distance(mesh, points, closest=True)
        np.testing.assert_allclose(np.abs(found.distance), exact, atol=1e-12)
        field = so.field(mesh, grid=so.Grid((5, 4, 3), (-2, -2, -2), (1, 1.25, 1.5)))
    exact = brute_force.distance(mesh, field.grid.points().reshape(-1, 3)).reshape(field.shape)
    np.testing.assert_allclose(np.abs(field.numpy()), exact, atol=1e-6 * (16 * 1.5 + 6))


@FUZZ
@given(arrays.arrays(np.float64, shapes_of_rows, elements=floats), st.data())
def test_any_points(points, data):
    points = data.draw(laid_out(points))
    query, field = so.MeshQuery(shapes.cube(), sign="auto"), so.field(shapes.cube(), resolution=6, band=2)
    on_border = [lambda p: field(p, outside="border"), lambda p: field.gradient(p, outside="border")]
    for ask in (query.distance, query.closest, query.winding_number, *on_border):
        answer = attempt(lambda ask=ask: ask(points))
        if isinstance(answer, np.ndarray):
            assert answer.shape[: np.ndim(points) - 1] == np.shape(points)[:-1]
            assert not np.isnan(answer).any()


@FUZZ
@given(arrays.arrays(np.float64, st.sampled_from([(4, 4), (7,), (2, 4, 4), (2, 7), (0, 7), (4,), ()]), elements=floats))
def test_any_poses(poses):
    body = so.Body(shapes.cube())
    for ask in (so.collide, so.distance_between, so.contacts, lambda a, b, p: so.sweep(a, b, p, p)):
        attempt(lambda ask=ask: ask(body, body, poses))


numbers = (
    st.none()
    | st.integers(-3, 40)
    | floats
    | st.sampled_from([2**31, 2**62, 2**70, "8", True, (8, 8, 8), (1, 2), [0.1] * 3, np.float32(0.5)])
)
options = st.fixed_dictionaries(
    {},
    optional={
        "resolution": numbers, "spacing": numbers, "shape": numbers, "padding": numbers, "band": numbers, "thickness": numbers,
        "sign": st.sampled_from([None, "auto", "winding", "flood", "x", 3, so.Sign("shell", shell=0.2), so.Sign(rule="x")]),
        "nearest": st.booleans(), "method": st.sampled_from(["tiles", "thesis", "fuhrmann", "propagate", "jumpflood+1", "x", None]), "threads": st.sampled_from([0, 1, 3, -1, None]),
        "device": st.sampled_from(["auto", "cpu", "emulated", "cuda", "cuda:9", "x", None]),
        "memory_limit": st.just(10**7) | numbers, "progress": st.sampled_from([None, False, 3]),
    },
)  # fmt: skip


@FUZZ
@given(options)
def test_any_options(chosen):
    chosen.setdefault("resolution", 8) if not {"spacing", "shape"} & chosen.keys() else None
    chosen["memory_limit"] = (
        chosen["memory_limit"] if type(chosen.get("memory_limit")) is int and chosen["memory_limit"] else 10**7
    )
    field = attempt(lambda: so.field(shapes.cube(), **chosen))
    if field is not None:
        assert np.abs(field.numpy()).max() <= np.float32(field.thickness)
        assert repr(field)
