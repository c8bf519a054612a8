# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C: long work stops with KeyboardInterrupt, long before it would have ended, and leaves nothing behind."""

import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

SETUP = """
    import os, signal, sys, threading, time
    sys.path.insert(0, {folder!r})
    import numpy as np, shapes, standoff as so
    signal.signal(signal.SIGINT, signal.default_int_handler)
    random = np.random.default_rng(1)
    sphere = shapes.sphere(20)
    tangle = so.Mesh(*shapes.soup(100_000, size=3))

    def strike(seconds=0.3):
        threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()
"""
# Each would go on for much longer than a test may.
WORK = {
    "field": "so.field(tangle, resolution=500, sign=None)",
    "band": "so.field(tangle, resolution=500, band=30, sign=None)",
    "on one thread": "so.field(tangle, resolution=500, sign=None, threads=1)",
    "distance": "so.distance(shapes.soup(100_000, size=0.5), random.random((9_000_000, 3)), sign=None)",
    "closest": "so.MeshQuery(shapes.soup(100_000, size=0.5), sign=None).closest(random.random((9_000_000, 3)))",
    "fields": "list(so.fields([tangle] * 20, resolution=400, sign=None))",
    "collide": "so.distance_between(body, body, np.tile(np.eye(4), (1_000_000, 1, 1)) + lift)",
    "sweep": "so.sweep(body, body, np.tile(shapes.pose((9, 0.1, 0)), (500_000, 1, 1)), np.tile(np.eye(4), (500_000, 1, 1)))",
    "verify": "so.verify(so.field(sphere, resolution=200), tangle, samples=8_000_000)",
    "surface": "so.surface(tangle, resolution=500, at=0.01, sign=None)",
}


def run(code: str) -> str:
    text = textwrap.dedent(SETUP.format(folder=str(Path(__file__).parent))) + textwrap.dedent(code)
    # The time limit is far more than what starting takes, and far less than the work.
    done = subprocess.run(
        [sys.executable, "-X", "dev", "-W", "error", "-c", text],
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.mark.parametrize("work", WORK.values(), ids=WORK.keys())
def test_work_stops(work):
    out = run(f"""
    body = so.Body(sphere)
    lift = np.zeros((4, 4)); lift[:3, 3] = 3
    strike()
    try:
        {work}
    except KeyboardInterrupt:
        print("stopped")
    # And everything still works.
    assert so.field(sphere, resolution=8).numpy().min() < 0
    """)
    assert out == "stopped\n"


def test_files_stop(tmp_path):
    """Reading and writing end before they are through, and a file that was to be replaced is what it was."""
    out = run(f"""
    os.chdir({str(tmp_path)!r})
    with open("text.obj", "w") as text:
        text.write("v 0 0 0\\n" * 3 + "f 1 2 3\\n" * 6_000_000)
    with open("field.npz", "w") as old:
        old.write("precious")
    grid = so.Grid((250, 250, 250), (0, 0, 0), (1, 1, 1))
    noise = so.DistanceField.from_numpy(random.random(grid.shape, np.float32), grid)
    noise.save("dense.nrrd", compress=False)
    for work in (lambda: so.read("text.obj"), lambda: noise.save("field.npz"), lambda: so.load("dense.nrrd")):
        strike(0.05)
        try:
            work()
        except KeyboardInterrupt:
            print("stopped")
    print(open("field.npz").read(), len(os.listdir()))
    """)
    assert out == "stopped\nstopped\nstopped\nprecious 3\n"


def test_a_handler_of_ones_own():
    """Any exception of a signal's handler comes out, and a handler that raises nothing stops nothing."""
    out = run("""
    class Mine(Exception):
        pass

    def handler(number, frame):
        raise Mine("mine")

    signal.signal(signal.SIGUSR1, handler)
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGUSR1)).start()
    try:
        so.field(tangle, resolution=500, sign=None)
    except Mine as error:
        print(error)
    calls = []
    signal.signal(signal.SIGALRM, lambda *_: calls.append(1))
    signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
    expected = so.field(shapes.soup(20_000), resolution=120, sign=None)
    signal.setitimer(signal.ITIMER_REAL, 0)
    print(len(calls) > 0, np.array_equal(expected.numpy(), so.field(shapes.soup(20_000), resolution=120, sign=None).numpy()))
    """)
    assert out == "mine\nTrue True\n"


def test_values_at_many_points_let_handlers_run():
    out = run("""
    calls = []
    signal.signal(signal.SIGALRM, lambda *_: calls.append(1))
    field = so.field(sphere, resolution=64)
    points = random.random((3_000_000, 3))
    for work in (field._native().values, field._native().gradients):
        calls.clear()
        signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
        work(points, "nan", 1)
        signal.setitimer(signal.ITIMER_REAL, 0)
        print(len(calls) > 2)
    """)
    assert out == "True\nTrue\n"


def test_a_traceback_and_the_exit_code_of_the_shell():
    code = textwrap.dedent(SETUP.format(folder=str(Path(__file__).parent))) + "strike()\n" + WORK["field"]
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=60)
    assert done.returncode == -signal.SIGINT
    assert "KeyboardInterrupt" in done.stderr
