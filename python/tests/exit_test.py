# SPDX-License-Identifier: Apache-2.0
"""Interpreters: they start quietly, and end cleanly whatever is under way."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

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
