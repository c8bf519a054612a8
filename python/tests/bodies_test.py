# SPDX-License-Identifier: Apache-2.0
"""Collision, distance, contacts and sweeps against closed forms of cubes and spheres."""

import numpy as np
import pytest
import shapes
import standoff as so
from shapes import pose

CUBE = so.Body(shapes.cube())
SMALL = so.Body(shapes.cube(0.2))
RINGS = 16
SPHERE = so.Body(shapes.sphere(RINGS))
RANDOM = np.random.default_rng(7)


def test_a_body_says_what_it_is():
    assert CUBE.has_inside and not so.Body(shapes.sheet()).has_inside
    assert CUBE.bounds == ((-0.5,) * 3, (0.5,) * 3)
    assert CUBE.nbytes > 12 * 3 * 8
    assert repr(CUBE).startswith("<standoff.Body: 12 triangles, with an inside, ")
    assert so.Body(shapes.cube(), spacing=0.25).nbytes < so.Body(shapes.cube(), spacing=0.02).nbytes


def test_cubes_side_by_side():
    offsets = RANDOM.uniform(-2.5, 2.5, (500, 3))
    offsets[:20] = 0.3 * offsets[:20]
    poses = np.stack([pose(offset) for offset in offsets])
    apart = np.linalg.norm(np.maximum(np.abs(offsets) - 1, 0), axis=1)
    found = so.collide(CUBE, CUBE, poses)
    np.testing.assert_array_equal(found.hit, apart == 0)
    assert not found.ambiguous.any()
    assert ((found.triangle_a == so.NO_TRIANGLE) == ~found.hit).all()
    assert (found.triangle_a[found.hit] < 12).all() and (found.triangle_b[found.hit] < 12).all()
    distances = so.distance_between(CUBE, CUBE, poses)
    np.testing.assert_allclose(distances.distance, apart, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(distances.point_a - distances.point_b, axis=1), apart, atol=1e-12)
    np.testing.assert_allclose(shapes.cube_distance(distances.point_a), 0, atol=1e-12)
    np.testing.assert_allclose(shapes.cube_distance(distances.point_b - offsets), 0, atol=1e-12)
    np.testing.assert_allclose(distances.lower, distances.distance, atol=1e-9)


def test_margins_and_limits():
    poses = np.stack([pose((1 + gap, 0, 0)) for gap in (0.05, 0.15, 0.25)])
    np.testing.assert_array_equal(so.collide(CUBE, CUBE, poses, margin=0.1).hit, [True, False, False])
    np.testing.assert_array_equal(so.collide(CUBE, CUBE, poses, margin=0.2).hit, [True, True, False])
    far = so.distance_between(CUBE, CUBE, poses, limit=0.2).distance
    np.testing.assert_allclose(far[:2], [0.05, 0.15], atol=1e-12)
    assert far[2] == np.inf
    rough = so.distance_between(CUBE, CUBE, poses, tolerance=0.02)
    assert (rough.lower <= [0.05, 0.15, 0.25]).all() and (rough.distance - rough.lower <= 0.02 + 1e-12).all()
    assert rough.finished.all()


def test_one_body_inside_another():
    poses = np.stack([np.eye(4), pose((0.2, 0, 0)), pose((3, 0, 0)), pose((0.5, 0, 0))])
    surfaces = so.collide(CUBE, SMALL, poses)
    np.testing.assert_array_equal(surfaces.hit, [False, False, False, True])
    solids = so.collide(CUBE, SMALL, poses, containment=True)
    np.testing.assert_array_equal(solids.hit, [True, True, False, True])
    assert [so.CONTAINMENTS[c] for c in solids.containment[:3]] == ["b in a", "b in a", "none"]
    other = so.collide(SMALL, CUBE, poses[:1], containment=True)
    assert so.CONTAINMENTS[other.containment[0]] == "a in b"
    np.testing.assert_allclose(so.distance_between(CUBE, SMALL, poses[:2]).distance, [0.4, 0.2], atol=1e-12)


def test_spheres():
    directions = RANDOM.normal(size=(100, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    gaps = RANDOM.uniform(0.05, 2, 100)
    poses = np.stack([pose((2 + gap) * d, RANDOM.normal(size=3), 3 * gap) for gap, d in zip(gaps, directions)])
    error = 2 * shapes.sphere_error(RINGS)
    found = so.distance_between(SPHERE, SPHERE, poses).distance
    assert (found >= gaps - 1e-12).all() and (found <= gaps + error).all()
    assert not so.collide(SPHERE, SPHERE, poses).hit.any()
    closer = poses.copy()
    closer[:, :3, 3] *= ((2 - 2 * error) / (2 + gaps))[:, None]
    assert so.collide(SPHERE, SPHERE, closer).hit.all()


def test_certified_answers_are_never_wrong():
    poses = np.stack([pose(offset, RANDOM.normal(size=3), offset[0]) for offset in RANDOM.uniform(-3, 3, (300, 3))])
    exact, certified = so.collide(SPHERE, CUBE, poses), so.collide(SPHERE, CUBE, poses, mode="certified")
    sure = ~certified.ambiguous
    assert sure.any()
    np.testing.assert_array_equal(certified.hit[sure], exact.hit[sure])
    assert not certified.hit[certified.ambiguous].any()


def test_contacts():
    found = so.contacts(CUBE, CUBE, pose((0.9, 0.1, 0.1)))
    assert len(found) == len(found.depth) == len(found.point) == len(found.normal) > 0
    assert not found.overflow
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=1), 1, atol=1e-9)
    assert found.point.min() >= -0.5 - 1e-9 and found.point.max() <= 1.4 + 1e-9
    few = so.contacts(CUBE, CUBE, pose((0.9, 0.1, 0.1)), most=2)
    assert len(few) <= 2 and few.overflow
    assert len(so.contacts(CUBE, CUBE, pose((1.1, 0, 0)))) == 0
    near = so.contacts(CUBE, CUBE, pose((1.1, 0, 0)), margin=0.2)
    facing = near.normal[:, 0] > 0.999
    assert facing.any()
    np.testing.assert_allclose(near.depth[facing], -0.1, atol=1e-9)


def test_sweeps():
    starts = np.stack([pose((3, 0, 0)), pose((3, 0.5, 0)), pose((3, 2, 0)), pose((0.5, 0, 0)), pose((-9e3, 0, 0))])
    ends = np.stack([pose((0, 0, 0)), pose((-3, 0.5, 0)), pose((0, 2, 0)), pose((3, 0, 0)), pose((9e3, 0, 0))])
    found = so.sweep(CUBE, CUBE, starts, ends)
    np.testing.assert_array_equal(found.hit, [True, True, False, True, True])
    expected = [2 / 3, 1 / 3, 1, 0, 8999 / 18000]
    np.testing.assert_allclose(found.time, expected, atol=1e-3)
    assert (found.time <= np.array(expected) + 1e-12).all()  # never too late
    np.testing.assert_allclose(found.normal[[0, 1]], [[1, 0, 0]] * 2, atol=1e-6)
    np.testing.assert_allclose(found.point[[0, 1], 0], 0.5, atol=1e-2)
    assert (found.normal[3] == 0).all()
    turning = so.sweep(CUBE, CUBE, pose((1.15, 0, 0)), pose((1.15, 0, 0), (0, 0, 1), np.pi / 4))
    assert turning.hit and 0 < turning.time < 1
    angle = turning.time * np.pi / 4
    assert 1.15 - (np.cos(angle) + np.sin(angle)) / 2 == pytest.approx(0.5, abs=1e-2)
    off_centre = so.sweep(
        CUBE, CUBE, pose((1.15, 0, 0)), pose((1.15, 0, 0), (0, 0, 1), np.pi / 4), center=(0.5, 0.5, 0)
    )
    assert off_centre.hit.shape == ()
    exact = so.sweep(CUBE, CUBE, starts[:1], ends[:1], tolerance=1e-9).time
    assert exact == pytest.approx(2 / 3, abs=1e-8)


def test_sweeps_along_screws():
    # The cube turns twice about z, at a distance, and rises by 3 towards the resting one, whose lower side is at -0.5.
    starts = np.stack([pose((0, 0, -2)), pose((0, 0, 2)), pose((9, 0, 0))])
    found = so.sweep_screw(CUBE, CUBE, starts, axis=(0, 0, 3), angle_rad=4 * np.pi, along=3)
    np.testing.assert_array_equal(found.hit, [True, False, False])
    assert found.time[0] == pytest.approx(1 / 3, abs=1e-4) and found.time[0] <= 1 / 3
    # It flies about a point beside it: once around, twice around, and not far enough.
    start = pose((9, 0, 0))
    for angle_rad, hits in ((0.95 * np.pi, True), (-4 * np.pi, True), (0.3, False)):
        assert so.sweep_screw(CUBE, CUBE, start, axis=(0, 0, 1), angle_rad=angle_rad, point=(4.5, 0, 0)).hit == hits
    for words, options in (
        ("axis needs a direction", {"axis": (0, 0, 0), "angle_rad": 1}),
        ("radians", {"axis": (0, 0, 1), "angle_rad": 1e8}),
        ("finite", {"axis": (0, 0, 1), "angle_rad": 1, "point": (np.inf, 0, 0)}),
    ):
        with pytest.raises(ValueError, match=words):
            so.sweep_screw(CUBE, CUBE, start, **options)


def test_sweeps_along_paths():
    way = np.stack([pose((3, 3, 0)), pose((3, 0, 0)), pose((-3, 0, 0))])
    found = so.sweep_path(CUBE, CUBE, way)
    single = so.sweep(CUBE, CUBE, way[1], way[2])
    assert found.motion == 1 and found.sweep.hit and found.sweep.hit.shape == ()
    assert found.sweep.time == single.time and found.sweep.triangle_b == single.triangle_b
    np.testing.assert_array_equal(found.sweep.point, single.point)
    free = so.sweep_path(CUBE, CUBE, way[:2])
    assert free.motion == 0 and not free.sweep.hit and free.sweep.finished
    assert not so.sweep_path(CUBE, CUBE, way, max_steps=1).sweep.finished
    for few in (way[:1], way[0], way[:0], way.reshape(1, 3, 4, 4)):
        with pytest.raises(ValueError, match="two poses or more"):
            so.sweep_path(CUBE, CUBE, few)


def test_a_distance_may_end_unfinished():
    apart = pose((3, 2, 1))
    whole = so.distance_between(SPHERE, SPHERE, apart)
    assert whole.finished
    early = so.distance_between(SPHERE, SPHERE, apart, max_steps=1)
    assert not early.finished and early.lower <= whole.distance <= early.distance < np.inf
    with pytest.raises(ValueError, match="must not be negative"):
        so.distance_between(SPHERE, SPHERE, apart, max_steps=-1)


def test_distances_of_a_gpu_are_those_of_the_cpu():
    poses = np.stack([pose((x, 0.7, 0.4), (1, 2, 3), x) for x in np.linspace(-4, 4, 30)])
    for limit in (np.inf, 1.5):
        expected = so.distance_between(SPHERE, CUBE, poses, limit=limit, device="cpu")
        found = so.distance_between(SPHERE, CUBE, poses, limit=limit, device="emulated")
        for name in ("distance", "lower", "point_a", "point_b", "triangle_a", "triangle_b", "finished"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    with pytest.raises(ValueError, match="with a tolerance or most steps: this runs on the CPU only"):
        so.distance_between(SPHERE, CUBE, poses, tolerance=0.1, device="emulated")


def test_a_sweep_may_end_unfinished():
    start, end = pose((3, 0, 0)), pose((-3, 0, 0), (0, 0, 1), 1)
    whole = so.sweep(CUBE, CUBE, start, end)
    assert whole.hit and whole.finished
    early = so.sweep(CUBE, CUBE, start, end, max_steps=1)
    assert not early.finished and not early.hit and 0 <= early.time <= whole.time
    with pytest.raises(ValueError, match="must not be negative"):
        so.sweep(CUBE, CUBE, start, end, max_steps=-1)


def test_triangles_are_those_of_their_body():
    poses = np.stack([pose((1.2, 0.1 * n, 0)) for n in range(-5, 6)])
    start = np.stack([pose((4, 0.1 * n, 0)) for n in range(-5, 6)])
    contacts = so.contacts(SPHERE, CUBE, poses[5])
    for found in (
        so.collide(SPHERE, CUBE, poses),
        so.distance_between(SPHERE, CUBE, start),
        so.sweep(SPHERE, CUBE, start, poses),
        contacts,
    ):
        assert found.triangle_a.max() >= 12 > found.triangle_b.max()  # the cube has 12


def test_both_bodies_can_be_placed():
    a_at = pose((5, 1, 2), (1, 2, 3), 0.7)
    poses = np.stack([pose(offset, RANDOM.normal(size=3), 1) for offset in RANDOM.uniform(-2, 2, (50, 3))])
    moved = so.distance_between(CUBE, SPHERE, a_at @ poses, pose_a=a_at)
    np.testing.assert_allclose(moved.distance, so.distance_between(CUBE, SPHERE, poses).distance, atol=1e-9)
    np.testing.assert_array_equal(
        so.collide(CUBE, SPHERE, a_at @ poses, pose_a=a_at).hit, so.collide(CUBE, SPHERE, poses).hit
    )
