# SPDX-License-Identifier: Apache-2.0
"""Processes: workers that are forked or spawned after the parent computed, and interpreters that end meanwhile."""

import multiprocessing
import threading
import warnings

import numpy as np
import pytest
import shapes
import standoff as so

LIMIT = 60  # seconds; a worker that hangs would take for ever
POINTS = np.random.default_rng(1).uniform(-1, 1, (5000, 3))


def answers(thing):
    """A bit of everything, in a worker; `thing` came through pickle."""
    if isinstance(thing, so.MeshQuery):
        return thing.distance(POINTS)
    if isinstance(thing, so.Body):
        return so.distance_between(thing, thing, np.stack([shapes.pose((x, 0, 0)) for x in (2, 3)])).distance
    if isinstance(thing, so.DistanceField):
        return thing(POINTS)
    field = so.field(thing, resolution=40)
    list(so.fields([thing] * 3, resolution=12, workers=2))
    return field.numpy()


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_workers_after_the_parent_computed(method):
    mesh = so.Mesh(*shapes.sphere(12))
    things = [
        mesh,
        so.MeshQuery(mesh, sign="auto"),
        so.Body(mesh),
        so.field(mesh, resolution=20),
        so.field(mesh, resolution=40, band=3),
    ]
    expected = [answers(thing) for thing in things]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python warns of forks with threads
        with multiprocessing.get_context(method).Pool(2) as pool:
            found = pool.map_async(answers, things * 2).get(LIMIT)
    for n, answer in enumerate(found):
        np.testing.assert_array_equal(answer, expected[n % len(things)])


def ask_after_fork():
    """In the child: an answer, or an error that says what to do; no waiting for threads that are not there."""
    try:
        so.distance(shapes.cube(), POINTS[:100], sign=None)
    except so.UsageError as error:
        assert "spawn" in str(error)


def fork(work):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        child = multiprocessing.get_context("fork").Process(target=work)
        child.start()
        child.join(LIMIT)
        if child.is_alive():
            child.kill()
            pytest.fail("the forked worker hangs")
    return child.exitcode


def test_a_fork_while_another_thread_computes():
    stop = threading.Event()

    def keep_busy():
        while not stop.is_set():
            so.field(shapes.sphere(12), resolution=40)

    thread = threading.Thread(target=keep_busy)
    thread.start()
    try:
        codes = [fork(ask_after_fork) for _ in range(5)]
    finally:
        stop.set()
        thread.join()
    assert codes == [0] * 5
