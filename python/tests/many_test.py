# SPDX-License-Identifier: Apache-2.0
"""fields(): order, errors, laziness, and an end at any time."""

import itertools
import threading

import numpy as np
import pytest
import shapes
import standoff as so

OPTIONS = {"resolution": 12, "band": 2}


def sized(count):
    return [shapes.cube(1 + n) for n in range(count)]


@pytest.mark.parametrize("workers", [None, 1, 2, 3, 4])
@pytest.mark.parametrize("ahead", [None, 1, 2, 100])
def test_results_come_in_order(workers, ahead):
    # The first are the slowest.
    meshes = [shapes.sphere(12), shapes.sphere(8), *sized(9)]
    results = list(so.fields(meshes, workers=workers, ahead=ahead, **OPTIONS))
    assert [r.index for r in results] == list(range(11))
    for result, mesh in zip(results, meshes):
        assert result.source is mesh and result.error is None
        np.testing.assert_array_equal(result.field.numpy(), so.field(mesh, **OPTIONS).numpy())
        assert result.unwrap() is result.field


def test_paths_and_errors_are_collected(tmp_path):
    so.Mesh(*shapes.cube()).save(tmp_path / "good.stl")
    (tmp_path / "bad.obj").write_text("v 0 0 x\n")
    (tmp_path / "empty.obj").write_text("")
    broken = (shapes.cube()[0], np.array([[0, 1, 99]]))
    meshes = [tmp_path / "good.stl", tmp_path / "bad.obj", tmp_path / "none.stl", broken, str(tmp_path / "good.stl"), tmp_path,
              tmp_path / "empty.obj", None, 3, shapes.cube()]  # fmt: skip
    results = list(so.fields(meshes, workers=2, **OPTIONS))
    expected = [
        None,
        so.InputError,
        FileNotFoundError,
        so.MeshError,
        None,
        IsADirectoryError,
        so.InputError,
        TypeError,
        TypeError,
        None,
    ]
    for result, kind in zip(results, expected, strict=True):
        assert (result.field is None) == (kind is not None)
        if kind is not None:
            assert isinstance(result.error, kind)
            with pytest.raises(kind):
                result.unwrap()
    assert results[3].error.triangle == 0
    assert results[1].error.line == 1
    assert list(so.fields([], **OPTIONS)) == []


@pytest.mark.parametrize("workers, ahead", [(1, 1), (2, 1), (2, 3), (4, 8)])
def test_an_endless_iterable_is_read_as_far_as_needed(workers, ahead):
    taken = itertools.count()
    last = -1

    def meshes():
        nonlocal last
        for last in taken:  # noqa: B007
            yield shapes.cube()

    results = so.fields(meshes(), workers=workers, ahead=ahead, **OPTIONS)
    assert last == -1  # nothing is done before the first is asked for
    for n, result in zip(range(20), results):
        assert result.index == n
        assert last <= n + ahead
    results.close()
    assert last <= 20 + ahead
    assert list(results) == []


def test_results_do_not_pile_up():
    import weakref

    alive = weakref.WeakSet()

    def prepare(mesh):
        made = so.Mesh.__new__(Traced)
        made.__init__(mesh.vertices, mesh.faces)
        alive.add(made)
        return made

    class Traced(so.Mesh):
        pass

    most = 0
    for _ in so.fields((shapes.cube() for _ in range(60)), workers=2, ahead=4, prepare=prepare, **OPTIONS):
        most = max(most, len(alive))
    assert most <= 4 + 2 + 1


def test_fields_remember_what_is_up():
    mesh = so.Mesh(*shapes.cube(), up="y")
    for prepare in (None, lambda mesh: (mesh.vertices * 2, mesh.faces), lambda mesh: mesh):
        for options in (OPTIONS, {"resolution": 12}):
            (result,) = so.fields([mesh], prepare=prepare, **options)
            assert result.unwrap().provenance["up"] == "y"
    (turned,) = so.fields([mesh], prepare=lambda mesh: so.Mesh(mesh.vertices, mesh.faces, up="z"), **OPTIONS)
    assert turned.unwrap().provenance["up"] == "z"


def test_prepare():
    seen = []

    def prepare(mesh):
        seen.append(threading.get_ident())
        assert isinstance(mesh, so.Mesh)
        return so.Mesh(mesh.vertices / np.abs(mesh.vertices).max(), mesh.faces)

    results = list(so.fields(sized(8), workers=2, prepare=prepare, **OPTIONS))
    for result in results:
        np.testing.assert_array_equal(result.unwrap().numpy(), so.field(shapes.cube(2), **OPTIONS).numpy())
    assert len(seen) == 8 and threading.get_ident() not in seen
    for wrong in (
        lambda mesh: None,
        lambda mesh: 1 / 0 if False else int("x"),
        lambda mesh: mesh.nothing.at_all and None,
    ):
        error = None
        try:
            error = next(iter(so.fields(sized(1), prepare=wrong, **OPTIONS))).error
        except AttributeError:
            continue  # a mistake in the caller's own function is raised
        assert isinstance(error, (TypeError, ValueError))
