# SPDX-License-Identifier: Apache-2.0
"""Memory: many small calls need no more of it, and inputs are let go."""

import gc
import sys
from functools import partial

import numpy as np
import pytest
import shapes
import standoff as so
from pretended_gpu import FACES, ON_GPU, VERTICES, Standard

MESH = so.Mesh(*shapes.tetrahedron())
QUERY, BODY, FIELD = so.MeshQuery(MESH, sign="auto"), so.Body(MESH), so.field(MESH, resolution=8, band=2)
POINT, POSE = np.array([0.1, 0.2, 2.0]), np.eye(4)
GPU_MESHES = [(Standard(VERTICES), Standard(FACES)), (Standard(VERTICES), Standard(FACES + 1))]  # good and bad
BROKEN = so.Mesh(MESH.vertices, np.array([[0, 1, 9]]))


def fails(call):
    try:
        call()
    except (so.Error, ValueError, TypeError, ZeroDivisionError):
        return
    pytest.fail("it should have failed")


def raising(stage, fraction):
    raise ZeroDivisionError


# Calls, and how often in the test.
SMALL = {
    "distance": (lambda: QUERY.distance(POINT), 40_000),
    "closest": (lambda: QUERY.closest(POINT), 10_000),
    "interpolation": (lambda: FIELD(POINT), 20_000),
    "tiles": (lambda: FIELD.tiles(), 10_000),
    "mesh": (lambda: so.Mesh(MESH.vertices, MESH.faces), 10_000),
    "field": (lambda: so.field(MESH, resolution=4), 1500),
    "field of tiles": (lambda: so.field(MESH, resolution=8, band=1), 1500),
    "field on one thread": (lambda: so.field(MESH, resolution=4, threads=1), 1500),
    "field on three threads": (lambda: so.field(MESH, resolution=4, threads=3), 1500),
    "query": (lambda: so.MeshQuery(MESH, sign=None), 1500),
    "collide": (lambda: so.collide(BODY, BODY, POSE), 1500),
    "collide many": (lambda: so.collide(BODY, BODY, np.stack([POSE] * 40)), 1500),
    "fields on a GPU": (lambda: list(so.fields(GPU_MESHES, workers=1, resolution=4, **ON_GPU)), 500),
    "wrong face": (lambda: fails(lambda: BROKEN.bounds), 5000),
    "wrong point": (lambda: fails(lambda: QUERY.distance([np.nan, 0, 0])), 5000),
    "wrong type": (lambda: fails(lambda: QUERY.distance(POINT, threads="x")), 5000),
    "wrong file": (lambda: fails(lambda: so.read(__file__)), 2000),
    "wrong option": (lambda: fails(lambda: so.field(MESH, resolution=4, device="x")), 2000),
    "raising": (lambda: fails(lambda: so.field(MESH, resolution=4, progress=raising)), 1500),
}


def memory_in_use() -> int:
    with open("/proc/self/statm", encoding="ascii") as text:
        return int(text.read().split()[1]) * 4096


@pytest.mark.parametrize("call, times", SMALL.values(), ids=SMALL.keys())
def test_many_calls_need_no_more_memory(call, times):
    """In total 10^5 calls. A leak of 32 bytes in the 40,000, or of one object in any, is more than the bound."""
    for _ in range(max(100, times // 10)):
        call()
    gc.collect()
    before = memory_in_use()
    for _ in range(times):
        call()
    gc.collect()
    assert memory_in_use() - before < 1_000_000 + 16 * times


def test_inputs_are_let_go():
    vertices, faces = MESH.vertices.astype(np.float32), MESH.faces.astype(np.int32)
    points, poses, out = np.zeros((9, 3)), np.stack([np.eye(4)] * 3), np.empty((6, 6, 6), np.float32, order="F")

    def progress(stage, fraction):
        pass

    things = [vertices, faces, points, poses, out, progress]
    before = [sys.getrefcount(thing) for thing in things]
    for _ in range(3):
        mesh = so.Mesh(vertices, faces)
        results = [
            so.field(mesh, shape=(6, 6, 6), out=out, progress=progress),
            so.MeshQuery(mesh, sign=None),
            so.Body(mesh),
            so.report(mesh),
        ]
        results += [
            results[1].closest(points, progress=progress),
            so.collide(results[2], results[2], poses, progress=progress),
        ]
        results += [
            so.surface(results[0]),
            so.verify(results[0], mesh, samples=9),
            results[0].tiles(),
            results[0].numpy(),
        ]
        fails(partial(so.field, mesh, shape=(6, 6, 6), out=out, device="x"))
        fails(partial(results[1].distance, points, threads=-1))
        del mesh, results
    gc.collect()
    assert [sys.getrefcount(thing) for thing in things] == before
