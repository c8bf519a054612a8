# SPDX-License-Identifier: Apache-2.0
"""Every argument of every function, given what it cannot be: an error in the user's words, never nanobind's."""

import inspect
import math

import numpy as np
import pytest
import shapes
import standoff as so

MESH = so.Mesh(*shapes.tetrahedron())
BAND, BODY, QUERY = so.field(MESH, resolution=8, band=2), so.Body(MESH), so.MeshQuery(MESH, sign="winding")
POINT, POSE = np.array([0.1, 0.2, 2.0]), np.eye(4)
FULL = so.field(MESH, resolution=8)

# What is called, and the arguments that make it work.
CALLS = {
    "Body": (so.Body, {"mesh": MESH}),
    "Body.save": (BODY.save, {"path": "x.body"}),
    "DistanceField.__call__": (BAND.__call__, {"points": POINT}),
    "DistanceField.from_numpy": (so.DistanceField.from_numpy, {"values": FULL.numpy(), "grid": FULL.grid}),
    "DistanceField.gradient": (BAND.gradient, {"points": POINT}),
    "DistanceField.plot": (BAND.plot, {}),
    "DistanceField.save": (BAND.save, {"path": "x.npz"}),
    "DistanceField.show": (BAND.show, {}),
    "DistanceField.to_bytes": (BAND.to_bytes, {}),
    "Grid": (so.Grid, {"shape": (2, 2, 2), "origin": (0, 0, 0), "spacing": (1, 1, 1)}),
    "Grid.fit": (so.Grid.fit, {"bounds": ((0, 0, 0), (1, 1, 1)), "resolution": 8}),
    "Mesh.plot": (MESH.plot, {"width": 64, "height": 64}),
    "Mesh.save": (MESH.save, {"path": "x.ply"}),
    "Mesh.show": (MESH.show, {}),
    "MeshQuery": (so.MeshQuery, {"mesh": MESH}),
    "MeshQuery.closest": (QUERY.closest, {"points": POINT}),
    "MeshQuery.distance": (QUERY.distance, {"points": POINT}),
    "MeshQuery.save": (QUERY.save, {"path": "x.query"}),
    "MeshQuery.winding_number": (QUERY.winding_number, {"points": POINT}),
    "Picture.save": (MESH.plot(width=64, height=64).save, {"path": "x.png"}),
    "collide": (so.collide, {"a": BODY, "b": BODY, "poses": POSE}),
    "contacts": (so.contacts, {"a": BODY, "b": BODY, "pose": POSE}),
    "distance": (so.distance, {"mesh": MESH, "points": POINT}),
    "distance_between": (so.distance_between, {"a": BODY, "b": BODY, "poses": POSE}),
    "field": (so.field, {"mesh": MESH, "resolution": 8}),
    "load": (so.load, {"path": "x.npz"}),
    "read": (so.read, {"path": "x.ply"}),
    "report": (so.report, {"mesh": MESH}),
    "surface": (so.surface, {"source": BAND}),
    "surface of a mesh": (so.surface, {"source": MESH, "resolution": 8}),
    "sweep": (so.sweep, {"a": BODY, "b": BODY, "start": POSE, "end": POSE}),
    "verify": (so.verify, {"field": BAND, "mesh": MESH}),
}
SIGNS = [so.Sign(**{name: object()}) for name in inspect.signature(so.Sign).parameters]
WRONG = [object(), [], (), {}, "", "x", b"x", "nul\0", "\udcff", 10**6 * "x", 1.5, -1, 2**40, 2**63, 2**80, 10**400, True, None, 1j, math.nan,
         math.inf, lambda *_: None, int, np.array([1, 2]), np.zeros((2, 3), complex), np.float32(3), *SIGNS]  # fmt: skip


@pytest.mark.filterwarnings("ignore::standoff.SurfaceWarning")  # of levels at which nothing is left
@pytest.mark.parametrize("call, good", CALLS.values(), ids=CALLS.keys())
def test_errors_are_in_the_words_of_users(call, good, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for path in good.values():
        if isinstance(path, str):  # there for those that read
            (BAND if path.endswith("npz") else MESH).save(path) if call in (so.load, so.read) else None
    call(**good)
    for name in inspect.signature(call).parameters:
        for wrong in WRONG:
            try:
                call(**{**good, name: wrong})
            except (so.Error, TypeError, ValueError, OSError, ZeroDivisionError) as error:
                text = str(error)
                assert "incompatible function" not in text and "_core" not in text, (name, wrong)
                assert len(text) > 10, (name, wrong, text)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: so.field(MESH, nearest="no"), "^nearest: must be True or False, not 'no'"),
        (lambda: so.field(MESH, method=None), "^method: must be one of the names .* not None"),
        (lambda: so.field(MESH, sign=so.Sign(invert="no")), "^sign: its invert must be True or False, not 'no'"),
        (lambda: so.collide(BODY, BODY, POSE, containment=1), "^containment: must be True or False, not 1"),
        (lambda: so.distance(MESH, POINT, sign=None, closest="yes"), "^closest: must be True or False"),
        (lambda: so.surface(BAND, method=3), "^method: must be one of the names"),
        (lambda: so.report(MESH, most_components=2.5), "^most_components: must be a whole number, not 2.5"),
        (lambda: so.verify(BAND, MESH, samples="all"), "^samples: must be a whole number"),
        (lambda: so.fields([MESH], progress=1), "^progress: must be True or False"),
        (lambda: BAND.save("x.npz", compress=None), "^compress: must be True or False"),
        (lambda: BODY.save("x.body", overwrite=0), "^overwrite: must be True or False"),
        (lambda: BAND.save(3), "^path: must be a string or a pathlib.Path, not int"),
        (lambda: BAND.plot(axis=2), "^axis: must be one of the names"),
        (lambda: BAND.plot(pixels="512"), "^pixels: must be a whole number"),
        (lambda: MESH.plot(width=9.5), "^width: must be a whole number"),
        (lambda: MESH.plot(up=None), "^up: must be one of the names"),
    ],
)
def test_types(call, message):
    with pytest.raises(TypeError, match=message):
        call()


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: so.field(MESH, threads=2**40), "^threads: must have at most 32 bits"),
        (lambda: so.Grid((2**70, 1, 1), (0, 0, 0), (1, 1, 1)), "^shape: must have at most 64 bits"),
        (lambda: so.verify(BAND, MESH, seed=-1), "^seed: must be zero or more, not -1"),
        (lambda: so.surface(BAND, at=10**400), "^at: is too large"),
        (lambda: MESH.save("nul\0.ply"), "^path: holds a null character"),
        (lambda: BAND.plot(title="\udcff"), "^title: .* is no text that can be written"),
        (lambda: BAND.plot(title=201 * "x"), "the title has 201 characters"),
        (lambda: so.field(MESH, method="\udcff"), "^method: .* is no text"),
    ],
)
def test_values(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_flags_of_numpy_are_flags():
    assert so.field(MESH, resolution=8, nearest=np.bool_(True)).nearest().shape == FULL.shape
