# SPDX-License-Identifier: Apache-2.0
"""Progress: fractions that grow, exceptions that come out unchanged, a bar by tqdm."""

import subprocess
import sys

import numpy as np
import pytest
import shapes
import standoff as so

SOUP = so.Mesh(*shapes.soup(3000, size=0.3))
QUERY = so.MeshQuery(SOUP, sign=None)
CUBE, SPHERE = so.Body(shapes.cube()), so.Body(shapes.sphere(20))
RANDOM = np.random.default_rng(2)
POINTS = RANDOM.random((200_000, 3))
POSES = np.stack([shapes.pose(offset) for offset in RANDOM.uniform(-2, 2, (3000, 3))])
WORK = {
    "field": lambda **o: so.field(SOUP, resolution=120, sign=None, **o),
    "band": lambda **o: so.field(SOUP, resolution=200, band=3, sign=None, **o),
    "tiny": lambda **o: so.field(shapes.cube(), resolution=4, **o),
    "distance": lambda **o: so.distance(QUERY, POINTS, **o),
    "few points": lambda **o: so.distance(QUERY, POINTS[:5], **o),
    "no points": lambda **o: so.distance(QUERY, POINTS[:0], **o),
    "closest": lambda **o: QUERY.closest(POINTS, **o),
    "winding": lambda **o: so.MeshQuery(shapes.sphere(20), sign="winding").winding_number(POINTS, **o),
    "collide": lambda **o: so.collide(SPHERE, CUBE, POSES, **o),
    "distance between": lambda **o: so.distance_between(SPHERE, CUBE, POSES, **o),
    "sweep": lambda **o: so.sweep(SPHERE, CUBE, POSES, POSES[::-1], **o),
    "surface": lambda **o: so.surface(SOUP, resolution=60, at=0.02, sign=None, **o),
    "verify": lambda **o: so.verify(so.field(SOUP, resolution=30, sign=None), SOUP, samples=3000, **o),
}
every_work = pytest.mark.parametrize("work", WORK.values(), ids=WORK.keys())


@every_work
def test_fractions_grow_to_one(work):
    seen = []
    work(progress=lambda stage, fraction: seen.append((stage, fraction)))
    assert all(isinstance(stage, str) and stage and isinstance(fraction, float) for stage, fraction in seen)
    fractions = [fraction for _, fraction in seen]
    assert fractions == sorted(fractions)
    assert 0 <= fractions[0] and fractions[-1] == 1


@every_work
@pytest.mark.parametrize("error", [ZeroDivisionError, KeyboardInterrupt, SystemExit, so.LimitError, StopIteration])
def test_exceptions_come_out_unchanged(work, error):
    raised = error("mine")

    def progress(stage, fraction):
        raise raised

    with pytest.raises(error) as caught:
        work(progress=progress)
    assert caught.value is raised


def test_an_exception_stops_the_work():
    calls = 0

    def progress(stage, fraction):
        nonlocal calls
        calls += 1
        raise ValueError("enough")

    with pytest.raises(ValueError, match="enough"):  # minutes of work
        so.field(shapes.soup(50_000, size=3), resolution=400, sign=None, progress=progress)
    assert calls == 1


def test_values_do_not_depend_on_who_watches():
    for name in ("band", "distance", "few points"):
        watched, alone = WORK[name](progress=lambda stage, fraction: None), WORK[name]()
        np.testing.assert_array_equal(np.asarray(watched), np.asarray(alone))


@pytest.mark.parametrize("progress", [3, "yes", [], 1.5, object()])
@every_work
def test_what_is_no_progress(work, progress):
    with pytest.raises(TypeError, match="^progress: "):
        work(progress=progress)


def test_callbacks_may_compute():
    def progress(stage, fraction):
        so.field(shapes.cube(), resolution=6)
        so.distance(QUERY, POINTS[:3])

    WORK["field"](progress=progress)


def test_a_bar(capsys):
    for name in ("field", "few points"):
        WORK[name](progress=True)
        assert "100%" in capsys.readouterr().err
        for none in (None, False):
            WORK[name](progress=none)
            assert capsys.readouterr().err == ""


def test_without_tqdm():
    code = (
        "import sys; sys.modules['tqdm'] = None; sys.modules['tqdm.auto'] = None\nimport standoff as so, numpy as np\n"
    )
    code += "try:\n  so.field((np.eye(3), [[0, 1, 2]]), resolution=8, sign=None, progress=True)\n"
    code += "except ImportError as error:\n  print(error)"
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=60)
    assert "pip install tqdm" in done.stdout, done.stderr
