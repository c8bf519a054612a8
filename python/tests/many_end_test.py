# SPDX-License-Identifier: Apache-2.0
"""fields(): exceptions that are not a mesh's, an end at any time, and arguments that make no sense."""

import threading
import time

import numpy as np
import pytest
import shapes
import standoff as so

OPTIONS = {"resolution": 12, "band": 2}


def sized(count):
    return [shapes.cube(1 + n) for n in range(count)]


@pytest.mark.parametrize("error", [ZeroDivisionError, KeyError, AttributeError, KeyboardInterrupt, SystemExit])
def test_other_exceptions_end_it(error):
    def prepare(mesh):
        if mesh.bounds[1][0] > 2:
            raise error("on purpose")
        return mesh

    before = threading.active_count()
    results = so.fields(sized(20), workers=2, prepare=prepare, **OPTIONS)
    with pytest.raises(error, match="on purpose"):
        for result in results:
            assert result.error is None
    assert result.index == 3  # cubes of side 1 to 4 are small enough
    assert threading.active_count() <= before + 1


def test_an_iterable_that_fails():
    def meshes():
        yield shapes.cube()
        yield shapes.cube()
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        list(so.fields(meshes(), workers=2, ahead=2, **OPTIONS))


def test_closing_stops_the_work_that_is_under_way():
    def prepare(mesh):
        started.set()
        return mesh

    started = threading.Event()
    # Minutes of work, if nobody stopped it.
    options = {"resolution": 400, "sign": None, "prepare": prepare}
    results = so.fields([None, *[shapes.soup(100_000, size=3)] * 3], workers=2, ahead=2, **options)
    assert isinstance(next(results).error, TypeError)
    assert started.wait(60)
    began = time.monotonic()
    results.close()
    assert time.monotonic() - began < 60
    assert not [t for t in threading.enumerate() if t.name.startswith("standoff")]


def test_arguments_that_make_no_sense():
    for wrong in ({"workers": 0}, {"workers": -1}, {"ahead": 0}):
        with pytest.raises(ValueError):
            so.fields(sized(2), **wrong)
    for wrong in ({"resolutoin": 8}, {"out": np.zeros(3)}, {"mesh": 3}, {"workers": "2"}, {"workers": 1.5}):
        with pytest.raises(TypeError):
            list(so.fields(sized(2), **wrong))
    for single in ("bunny.obj", __file__, so.Mesh(*shapes.cube()), None, 3):
        with pytest.raises(TypeError):
            so.fields(single)
    bad = list(so.fields(sized(2), resolution=0))
    assert all(isinstance(r.error, so.UsageError) for r in bad)


def test_a_bar(capsys):
    assert len(list(so.fields(sized(3), progress=True, **OPTIONS))) == 3
    assert "3/3" in capsys.readouterr().err
