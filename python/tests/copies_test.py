# SPDX-License-Identifier: Apache-2.0
"""Copies of what is not a field: queries, bodies, meshes, reports. They are equal, in every respect."""

import copy
import pickle

import numpy as np
import pytest
import shapes
import standoff as so


@pytest.mark.parametrize(
    "sign", [None, "auto", so.Sign("winding", rule="odd"), so.Sign("winding", invert=True), so.Sign(outer=True)]
)
def test_queries(sign, tmp_path):
    query = so.MeshQuery(shapes.sphere(6), sign=sign)
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (200, 3))
    query.save(tmp_path / "x.query")
    for again in (
        pickle.loads(pickle.dumps(query)),
        copy.copy(query),
        copy.deepcopy(query),
        so.MeshQuery.load(tmp_path / "x.query"),
    ):
        np.testing.assert_array_equal(again.distance(points), query.distance(points))
        np.testing.assert_array_equal(again.closest(points).triangle, query.closest(points).triangle)
        assert again.signed == query.signed
        assert repr(again) == repr(query)


def test_bodies(tmp_path):
    body = so.Body(shapes.cube())
    body.save(tmp_path / "x.body")
    poses = np.stack([shapes.pose((x, 0.1, 0), (1, 2, 3), x) for x in np.linspace(0, 3, 20)])
    for again in (
        pickle.loads(pickle.dumps(body)),
        copy.copy(body),
        copy.deepcopy(body),
        so.Body.load(tmp_path / "x.body"),
    ):
        np.testing.assert_array_equal(so.collide(again, body, poses).hit, so.collide(body, body, poses).hit)
        assert repr(again) == repr(body)
        assert (again.has_inside, again.bounds) == (body.has_inside, body.bounds)


def test_small_things():
    mesh = so.Mesh(*shapes.cube(), notes=("a note",))
    small = [mesh, so.Grid.fit(mesh), so.Sign("shell", shell=2), so.field(mesh, resolution=8).sign, so.report(mesh),
             so.verify(so.field(mesh, resolution=8), mesh)]  # fmt: skip
    for thing in small:
        assert pickle.loads(pickle.dumps(thing)) == thing
        assert copy.deepcopy(thing) == thing
    assert pickle.loads(pickle.dumps(mesh)).notes == mesh.notes
    assert copy.copy(mesh).vertices is mesh.vertices
    assert not np.shares_memory(copy.deepcopy(mesh).vertices, mesh.vertices)
    picture = mesh.plot(width=64, height=48)
    assert bytes(pickle.loads(pickle.dumps(picture))) == bytes(picture)
