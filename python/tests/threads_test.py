# SPDX-License-Identifier: Apache-2.0
"""Threads: the interpreter's lock is free during work, and what is prepared may be used by many at once."""

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import shapes
import standoff as so

SOUP = so.Mesh(*shapes.soup(30_000, size=0.5))
RANDOM = np.random.default_rng(4)
POINTS = RANDOM.random((20_000, 3))
SPHERE, CUBE = so.Body(shapes.sphere(20)), so.Body(shapes.cube())
POSES = np.stack([shapes.pose(offset) for offset in RANDOM.uniform(-2, 2, (2000, 3))])
QUERY = so.MeshQuery(SOUP, sign=None)
SMALL = so.MeshQuery(shapes.sphere(12), sign="auto")
WORK = {
    "field": lambda: so.field(SOUP, resolution=80, sign=None),
    "query": lambda: so.MeshQuery(SOUP, sign=None),
    "distance": lambda: QUERY.distance(POINTS),
    "distance of few points": lambda: [QUERY.distance(POINTS[:1900]) for _ in range(5)],
    "body": lambda: so.Body(shapes.sphere(60)),
    "distance between": lambda: so.distance_between(SPHERE, SPHERE, POSES),
    "report": lambda: so.report(SOUP),
}


@pytest.mark.parametrize("work", WORK.values(), ids=WORK.keys())
def test_another_thread_goes_on_meanwhile(work):
    """Two threads that wait for each other in turns, one of them between the calls of the work."""
    inside, turns, done = threading.Event(), 0, threading.Event()

    def run():
        inside.set()
        work()
        done.set()

    for _ in range(20):
        inside.clear()
        done.clear()
        thread = threading.Thread(target=run)
        thread.start()
        inside.wait()
        while not done.is_set():
            turns += done.wait(0.0005) is False
        thread.join()
        if turns > 2:
            return
    pytest.fail("no other thread ran while the library worked")


@pytest.mark.parametrize("threads", [0, 1, 2])
def test_one_query_and_one_body_for_many_threads(threads):
    field = so.field(shapes.sphere(12), resolution=32, band=3)
    full = so.field(shapes.sphere(12), resolution=32)
    points = RANDOM.uniform(-1.5, 1.5, (3000, 3))
    asks = [
        lambda: SMALL.distance(points, threads=threads),
        lambda: SMALL.closest(points[:1000], threads=threads).point,
        lambda: SMALL.winding_number(points[:500], threads=threads),
        lambda: so.collide(SPHERE, CUBE, POSES[:200], threads=threads).hit,
        lambda: so.distance_between(CUBE, SPHERE, POSES[:100], threads=threads).distance,
        lambda: so.sweep(CUBE, SPHERE, POSES[:50], POSES[50:100], threads=threads).time,
        lambda: field(points, threads=threads),
        lambda: full.gradient(points, threads=threads),
        lambda: full.tiles()[0],
        lambda: field.numpy(),
    ]  # fmt: skip
    expected = [ask() for ask in asks]
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda n: asks[n % len(asks)](), range(4 * len(asks))))
    for n, answer in enumerate(found):
        np.testing.assert_array_equal(answer, expected[n % len(asks)])


def test_fields_side_by_side():
    with ThreadPoolExecutor(6) as pool:
        found = list(pool.map(lambda n: so.field(shapes.cube(1 + n % 3), resolution=16 + n % 3).numpy(), range(30)))
    for n, values in enumerate(found):
        np.testing.assert_array_equal(values, so.field(shapes.cube(1 + n % 3), resolution=16 + n % 3).numpy())


def test_errors_and_progress_in_other_threads():
    seen = []

    def work(n):
        if n % 3 == 0:
            with pytest.raises(so.MeshError):
                so.field((np.eye(3), [[0, 1, 9]]), resolution=8)
        elif n % 3 == 1:
            so.field(shapes.cube(), resolution=40, progress=lambda stage, fraction: seen.append(threading.get_ident()))
        else:
            with pytest.raises(ZeroDivisionError):
                so.field(shapes.cube(), resolution=40, progress=lambda stage, fraction: 1 / 0)
        return threading.get_ident()

    with ThreadPoolExecutor(6) as pool:
        workers = set(pool.map(work, range(30)))
    assert set(seen) <= workers
