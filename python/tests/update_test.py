# SPDX-License-Identifier: Apache-2.0
"""An updated field is the field of the new mesh."""

import threading
import warnings

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


def test_live_field_follows(meshes):
    (vertices, faces), (after, _), moved = meshes
    live = so.LiveField((vertices, faces), nearest=True, **OPTIONS)
    first = live.field
    kept = first.numpy()
    assert live.field is first and live.sign.method == "winding"
    assert same(first, so.field((vertices, faces), grid=live.grid, thickness=live.thickness, nearest=True))
    mask = np.zeros(len(vertices), bool)
    mask[moved] = True
    for chosen in (moved, mask, list(moved)):
        done = live.move(chosen, after[moved])
        assert done["anew"] is False and done["why"] == "" and "sign" not in done
        assert done["tiles_changed"] <= done["tiles_computed"]
        anew = so.field((after, faces), grid=live.grid, thickness=live.thickness, nearest=True)
        assert same(live.field, anew) and np.array_equal(live.field.nearest(), anew.nearest())
        assert np.array_equal(live.mesh.vertices, after) and np.array_equal(live.mesh.faces, faces)
    assert np.array_equal(first.numpy(), kept)  # nothing changes a field
    live.move(moved, vertices[moved])
    assert same(live.field, first)
    assert live.move([], [])["triangles_changed"] == 0


def test_live_field_errors(meshes):
    (vertices, faces), (after, _), moved = meshes
    live = so.LiveField((vertices, faces), **OPTIONS)
    before = live.field
    with pytest.raises(ValueError, match="vertices: must be from 0"):
        live.move([len(vertices)], [[0, 0, 0]])
    with pytest.raises(ValueError, match="positions: must have the shape"):
        live.move(moved, after)
    with pytest.raises(so.MeshError, match="not finite"):
        live.move(moved[:1], [[np.nan, 0, 0]])
    with pytest.raises(TypeError, match="vertices"):
        live.move([0.5], [[0, 0, 0]])
    assert np.array_equal(live.mesh.vertices, vertices) and same(live.field, before)
    with pytest.raises(ZeroDivisionError):
        live.move(moved, after[moved], progress=lambda stage, fraction: 1 // 0)
    assert same(live.field, so.field(live.mesh, grid=live.grid, thickness=live.thickness))
    live.move(moved, vertices[moved])
    assert same(live.field, before)
    with pytest.raises(so.LimitError):
        so.LiveField((vertices, faces), memory_limit=1000, **OPTIONS)


@pytest.mark.parametrize("again", [lambda live: live.field, lambda live: live.move([], [])], ids=["field", "move"])
def test_live_field_in_its_own_progress(meshes, again):
    (vertices, faces), (after, _), moved = meshes
    live = so.LiveField((vertices, faces), **OPTIONS)
    with pytest.raises(so.UsageError, match="after move\\(\\) has returned"):
        live.move(moved, after[moved], progress=lambda stage, fraction: again(live))
    assert same(live.field, so.field(live.mesh, grid=live.grid, thickness=live.thickness))


def test_live_field_sign_after_a_late_error(meshes):
    (vertices, faces), _, _ = meshes
    corners = np.arange(faces.size).reshape(faces.shape)  # each triangle has its own, so that it can be moved away
    live = so.LiveField((vertices[faces.ravel()], corners), **OPTIONS)
    before = live.sign

    def late(stage, fraction):
        if stage == "done":
            raise ZeroDivisionError

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", so.SignWarning)
        with pytest.raises(ZeroDivisionError):
            live.move(np.arange(300), vertices[faces.ravel()][:300] + 0.2, progress=late)
        now = so.field(live.mesh, grid=live.grid, thickness=live.thickness)
    assert now.sign != before
    assert live.sign == now.sign and live.field.sign == now.sign


def test_live_field_moves_while_another_thread_asks(meshes):
    (vertices, faces), (after, _), moved = meshes
    live = so.LiveField((vertices, faces), **OPTIONS)
    mover = threading.Thread(target=live.move, args=(moved, after[moved]))
    native = live._live

    class Slow:  # the other thread would have the time to move the mesh before the copy is stored
        def field(self):
            made = native.field()
            mover.start()
            mover.join(0.5)
            return made

        def __getattr__(self, name):
            return getattr(native, name)

    live._live = Slow()
    _ = live.field
    live._live = native
    mover.join()
    assert same(live.field, so.field((after, faces), grid=live.grid, thickness=live.thickness))
