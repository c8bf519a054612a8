# SPDX-License-Identifier: Apache-2.0
"""Processes: workers that are forked or spawned after the parent computed, and interpreters that end meanwhile."""

import multiprocessing
import subprocess
import sys
import textwrap
import threading
import warnings
from pathlib import Path

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
    things = [mesh, so.MeshQuery(mesh, sign="auto"), so.Body(mesh), so.field(mesh, resolution=20), so.field(mesh, resolution=40, band=3)]
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
        so.distance(shapes.cube(), POINTS[:100])
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


def run(code: str, *arguments: str) -> subprocess.CompletedProcess:
    text = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n" + textwrap.dedent(code)
    done = subprocess.run([sys.executable, "-X", "dev", "-c", text, *arguments], capture_output=True, text=True, timeout=LIMIT)
    return done


@pytest.mark.parametrize(
    "work",
    [
        "so.field(shapes.soup(50_000, size=3), resolution=400, sign=None)",
        "so.field(shapes.soup(50_000, size=3), resolution=400, sign=None, progress=lambda stage, fraction: None)",
        "list(so.fields(itertools.repeat(shapes.cube()), resolution=12, workers=2))",
        "[so.distance(shapes.cube(), np.zeros((5, 3))) for _ in itertools.count()]",
        "[field.numpy() for _ in itertools.count()]",
        "[field(np.zeros((1000, 3))) for _ in itertools.count()]",
        "[so.MeshQuery(shapes.sphere(20)) for _ in itertools.count()]",
        "[so.collide(body, body, np.stack([np.eye(4)] * 300)) for _ in itertools.count()]",
        "[field.save(sys.argv[1]) for _ in itertools.count()]",
    ],
)
def test_python_ends_while_a_daemon_thread_computes(work, tmp_path):
    code = f"""
        import itertools, threading, time
        import numpy as np, shapes, standoff as so
        field, body = so.field(shapes.cube(), resolution=40, band=2), so.Body(shapes.cube())
        for _ in range(2):
            threading.Thread(target=lambda: {work}, daemon=True).start()
        time.sleep(0.3)
        print("end")
    """
    done = run(code, str(tmp_path / "field.npz"))
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr[-2000:]


def test_nothing_is_left_when_python_ends():
    """nanobind names the objects that were not freed."""
    done = run("""
        import numpy as np, shapes, standoff as so
        kept = [so.field(shapes.cube(), resolution=20), so.MeshQuery(shapes.cube()), so.Body(shapes.cube()), so.report(shapes.cube())]
        kept.append(kept[0].tiles())
        for _ in range(3):
            try:
                so.field((np.eye(3), [[0, 1, 7]]))
            except so.MeshError as error:
                kept.append(error)
            try:
                so.field(shapes.cube(), resolution=40, progress=lambda stage, fraction: 1 / 0)
            except ZeroDivisionError as error:
                kept.append(error)
        so._core.kept = kept  # until the very end
        so._core.kept = None
        del kept
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_import_is_quiet_and_needs_little():
    done = run("""
        import standoff
        heavy = {"torch", "trimesh", "pyvista", "vtk", "open3d", "meshio", "tqdm", "matplotlib", "scipy"} & set(sys.modules)
        print(sorted(heavy), standoff.__version__)
    """)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("[] ")
