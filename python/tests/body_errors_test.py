# SPDX-License-Identifier: Apache-2.0
"""Queries between bodies: arguments that make no sense, besides poses."""

import numpy as np
import pytest
import shapes
import standoff as so

CUBE = so.Body(shapes.cube())


def test_other_arguments_that_make_no_sense():
    one = np.eye(4)
    for call in (
        lambda: so.contacts(CUBE, CUBE, np.stack([one, one])),
        lambda: so.sweep(CUBE, CUBE, one, np.stack([one, one])),
        lambda: so.sweep(CUBE, CUBE, one, one, center=(0, 0)),
        lambda: so.sweep(CUBE, CUBE, one, one, center=(np.nan, 0, 0)),
        lambda: so.sweep(CUBE, CUBE, one, one, tolerance=-1),
        lambda: so.collide(CUBE, CUBE, one, mode="fast"),
        lambda: so.collide(CUBE, CUBE, one, margin=-1),
        lambda: so.collide(CUBE, CUBE, one, margin=np.nan),
        lambda: so.collide(CUBE, CUBE, one, margin=np.inf),
        lambda: so.distance_between(CUBE, CUBE, one, tolerance=-1),
        lambda: so.distance_between(CUBE, CUBE, one, limit=-1),
        lambda: so.contacts(CUBE, CUBE, one, most=0),
        lambda: so.contacts(CUBE, CUBE, one, most=-3),
        lambda: so.Body(shapes.cube(), spacing=-1),
        lambda: so.Body(shapes.cube(), spacing=np.nan),
        lambda: so.collide(CUBE, CUBE, one, threads=-1),
    ):
        with pytest.raises(ValueError):
            call()
    for call in (
        lambda: so.collide(5, CUBE, one),
        lambda: so.collide(CUBE, None, one),
        lambda: so.collide(CUBE, object(), one),
        lambda: so.distance_between(CUBE, shapes.cube()[0], one),
        lambda: so.collide(CUBE, CUBE, one, margin="1"),
        lambda: so.collide(CUBE, CUBE, one, containment="yes"),
        lambda: so.contacts(CUBE, CUBE, one, most=1.5),
        lambda: so.sweep(CUBE, CUBE, one, one, center="abc"),
    ):
        with pytest.raises((TypeError, ValueError)):
            call()


def test_meshes_and_files_are_bodies(tmp_path):
    mesh, other = so.Mesh(*shapes.cube()), shapes.cube(1, (3, 0, 0))
    mesh.save(tmp_path / "mesh.obj")
    CUBE.save(tmp_path / "cube.body")
    for a in (mesh, shapes.cube(), tmp_path / "mesh.obj", str(tmp_path / "cube.body"), CUBE):
        assert so.collide(a, CUBE).hit.shape == () and so.collide(a, mesh).hit
        assert not so.collide(a, other).hit
        assert so.distance_between(a, other).distance == 2
        assert len(so.contacts(other, a)) == 0 and len(so.contacts(a, CUBE)) > 0
        assert so.sweep(a, other, np.eye(4), np.eye(4)).time == 1
    with pytest.raises(FileNotFoundError):
        so.collide(CUBE, "absent.body")
    with pytest.raises(FileNotFoundError):
        so.collide("absent.obj", CUBE)


def test_no_pose_is_where_the_mesh_lies():
    there, other = np.eye(4), so.Body(shapes.cube(1, (0.75, 0, 0)))
    assert so.collide(CUBE, other).triangle_a == so.collide(CUBE, other, there).triangle_a
    assert so.collide(CUBE, other).hit and not so.collide(CUBE, other, pose_a=[-1, 0, 0, 0, 0, 0, 1]).hit
