# SPDX-License-Identifier: Apache-2.0
"""An updated field is the field of the new mesh."""

import numpy as np
import pytest
import standoff as so
from shapes import sphere


def dented(vertices):
    moved = vertices.copy()
    near = np.linalg.norm(vertices - vertices[0], axis=1) < 0.3
    moved[near] *= 0.9
    return moved, np.flatnonzero(near)


@pytest.fixture
def meshes():
    vertices, faces = sphere()
    after, moved = dented(vertices)
    return (vertices, faces), (after, faces), moved


OPTIONS = {"resolution": 64, "band": 2.0}


def same(a, b):
    return np.array_equal(a.numpy().view(np.uint32), b.numpy().view(np.uint32)) and a.provenance == b.provenance


def test_equals_computing_anew(meshes):
    before, after, moved = meshes
    field = so.field(before, **OPTIONS)
    kept = field.numpy()
    changed = np.flatnonzero(np.isin(after[1], moved).any(axis=1))
    mask = np.zeros(len(after[1]), bool)
    mask[changed] = True
    anew = so.field(after, grid=field.grid, thickness=field.thickness)
    for given in ({}, {"changed": changed}, {"changed": mask}, {"moved": moved}, {"moved": list(moved)}):
        made = field.update(after, before=before, **given)
        assert same(made, anew)
        assert made.computation["anew"] is False and made.computation["why"] == ""
        assert made.computation["triangles_changed"] == len(changed)
        assert 0 < made.computation["tiles_changed"] <= made.computation["tiles_computed"]
        assert made.sign.method == "winding"
    assert np.array_equal(field.numpy(), kept)  # nothing changes a field
    assert same(anew.update(before, before=after), field)


def test_nearest_and_no_sign(meshes):
    before, after, moved = meshes
    field = so.field(before, nearest=True, sign=None, **OPTIONS)
    made = field.update(after, before=before, moved=moved, sign=None)
    anew = so.field(after, grid=field.grid, thickness=field.thickness, nearest=True, sign=None)
    assert same(made, anew) and np.array_equal(made.nearest(), anew.nearest())


def test_full_fields_are_computed_anew(meshes):
    before, after, _ = meshes
    field = so.field(before, resolution=24)
    made = field.update(after, before=before)
    assert made.computation["anew"] and made.computation["why"]
    assert same(made, so.field(after, grid=field.grid))


def test_errors(meshes):
    before, after, moved = meshes
    field = so.field(before, **OPTIONS)
    with pytest.raises(ValueError, match="give one of these"):
        field.update(after, before=before, changed=[0], moved=moved)
    with pytest.raises(ValueError, match="must be from 0 to"):
        field.update(after, before=before, changed=[len(before[1])])
    with pytest.raises(TypeError, match="must be indices"):
        field.update(after, before=before, changed=[0.5])
    with pytest.raises(TypeError, match="before"):
        field.update(after)
    # The mesh was changed in its place, and is given twice.
    with pytest.raises(so.UsageError, match="not that of the mesh before"):
        field.update(after, before=after)
    broken = after[0].copy()
    broken[moved[0]] = np.nan
    with pytest.raises(so.MeshError, match="not finite"):
        field.update((broken, after[1]), before=before)
