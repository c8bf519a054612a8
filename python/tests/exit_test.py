# SPDX-License-Identifier: Apache-2.0
"""Interpreters: they start quietly, and end cleanly whatever is under way."""

import subprocess
import sys
import textwrap
import threading
from pathlib import Path

import numpy as np
import pytest
import shapes
import standoff as so

LIMIT = 60  # seconds; a process that hangs would take for ever


def run(code: str, *arguments: str) -> subprocess.CompletedProcess:
    text = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n" + textwrap.dedent(code)
    done = subprocess.run(
        [sys.executable, "-X", "dev", "-c", text, *arguments],
        check=False,
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
    return done


@pytest.mark.parametrize(
    "work",
    [
        "so.field(shapes.soup(50_000, size=3), resolution=400, sign=None)",
        "so.field(shapes.soup(50_000, size=3), resolution=400, sign=None, progress=lambda stage, fraction: None)",
        "list(so.fields(itertools.repeat(shapes.cube()), resolution=12, workers=2))",
        "[list(so.fields([shapes.cube()] * 3, resolution=4, workers=2)) for _ in itertools.count()]",
        "[so.distance(shapes.cube(), np.zeros((5, 3)), sign=None) for _ in itertools.count()]",
        "[field.numpy() for _ in itertools.count()]",
        "[field(np.zeros((1000, 3))) for _ in itertools.count()]",
        "[so.MeshQuery(shapes.sphere(20), sign=None) for _ in itertools.count()]",
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
    assert (
        "Traceback" not in done.stderr
    )  # the report of an error meets a stream that is going away, and aborts now and then


@pytest.mark.parametrize(
    "work, replaced",
    [
        ("so.field(soup, resolution=400, sign=None, progress=go_on_for_ever)", None),
        ("so.MeshQuery(soup, sign=None).closest(np.zeros((1_000_000, 3)), progress=go_on_for_ever)", None),
        ("so.field((np.eye(3), [[0, 1, 9]]), resolution=4)", "so._errors.make"),
        ("list(so.fields(itertools.repeat(shapes.cube()), resolution=4, workers=2, prepare=go_on))", None),
        ("so.fields(slow_meshes(), resolution=4, workers=2).__next__()", None),
    ],
    ids=["progress of a field", "progress of a query", "an error that is made", "prepare", "the iterable"],
)
def test_python_ends_while_a_daemon_thread_is_in_python_code_that_standoff_calls(work, replaced):
    """There CPython up to 3.13 ends the thread by unwinding it, through what called the code."""
    done = run(f"""
        import itertools, threading
        import numpy as np, shapes, standoff as so
        inside, soup = threading.Event(), so.Mesh(*shapes.soup(20_000, size=3))

        def go_on_for_ever(*arguments, **keywords):
            inside.set()
            while True:
                pass

        def go_on(mesh):
            inside.set()
            sum(range(100_000))
            return mesh

        def slow_meshes():
            go_on_for_ever()
            yield soup

        {f"{replaced} = go_on_for_ever" if replaced else ""}
        threading.Thread(target=lambda: {work}, daemon=True).start()
        inside.wait()
        print("end")
    """)
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr[-2000:]
    assert "Traceback" not in done.stderr


def test_fields_that_nobody_asks_for_any_more_do_not_keep_python_from_ending():
    """The workers are in work of minutes; their generator is alive until the very end."""
    done = run("""
        import itertools, threading
        import shapes, standoff as so
        long, begun = so.Mesh(*shapes.soup(20_000, size=3)), threading.Semaphore(0)

        def prepare(mesh):
            begun.release()
            return mesh

        options = {"resolution": 400, "sign": None, "prepare": prepare, "workers": 2}
        left = so.fields([None, *[long] * 20], ahead=3, **options)
        assert isinstance(next(left).error, TypeError)
        begun.acquire()
        print("end")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")


def test_fields_after_the_end_of_the_main_thread():
    """In a thread that Python waits for, and in functions of atexit: all fields are computed, of old and of new iterators."""
    done = run("""
        import atexit, threading
        import shapes, standoff as so
        options = {"resolution": 8, "workers": 2, "ahead": 3}
        meshes = [shapes.cube(1 + n) for n in range(12)]

        def check(results, expected):
            found = [(result.index, result.unwrap().numpy().shape) for result in results]
            assert [index for index, _ in found] == expected, found
            print("checked")

        def go_on():
            results = so.fields(meshes, **options)
            next(results)
            threading.main_thread().join()
            check(results, list(range(1, 12)))
            check(so.fields(meshes, **options), list(range(12)))

        left = so.fields(meshes, **options)
        next(left)
        atexit.register(lambda: (check(left, list(range(1, 12))), check(so.fields(meshes, **options), list(range(12)))))
        threading.Thread(target=go_on).start()
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "checked\n" * 4, "")


def test_fields_where_no_thread_can_be_started(monkeypatch):
    """The thread that asks does the work."""

    def refuse(thread):
        raise RuntimeError("can't start new thread")

    meshes = [shapes.cube(1 + n) for n in range(5)]
    monkeypatch.setattr(threading.Thread, "start", refuse)
    results = list(so.fields([*meshes, None], workers=2, resolution=8))
    assert [result.index for result in results] == list(range(6))
    assert isinstance(results[5].error, TypeError)
    for result, mesh in zip(results[:5], meshes):
        np.testing.assert_array_equal(result.unwrap().numpy(), so.field(mesh, resolution=8).numpy())


def test_nothing_is_left_when_python_ends():
    """nanobind names the objects that were not freed."""
    done = run("""
        import numpy as np, shapes, standoff as so
        kept = [so.field(shapes.cube(), resolution=20), so.MeshQuery(shapes.cube(), sign=None), so.Body(shapes.cube()), so.report(shapes.cube())]
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
