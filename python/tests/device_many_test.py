# SPDX-License-Identifier: Apache-2.0
"""Many meshes in a GPU's memory, which is pretended (pretended_gpu.py): fields() computes them together."""

import gc
import itertools
import sys
import threading
import weakref
from types import SimpleNamespace as Thing

import numpy as np
import pytest
import shapes
import standoff as so
from pretended_gpu import FACES, ON_GPU, VERTICES, Cuda, Dlpack, ListeningCore, Standard, expected
from standoff import _core, _device_compute

GRID = so.Grid((9, 8, 7), (-0.8, -0.7, -0.6), (0.2, 0.2, 0.2))


@pytest.fixture
def launches(monkeypatch):
    """The number of fields in each launch, and their streams: the one that works, and those that are waited for."""
    seen = []

    class Core(ListeningCore):
        def compute_on_device(self, fields, *rest):
            seen.append((len(fields), *self.streams[-1]))
            return _core.compute_on_device(fields, *rest)

    monkeypatch.setattr(_device_compute, "_core", Core())
    return seen


class Closed(Dlpack):
    def __dlpack__(self, **_):
        raise BufferError("it is mine")


def on_gpu(vertices=VERTICES, faces=FACES, **interface):
    return Standard(vertices, **interface), Standard(faces, **interface)


def test_fields_are_those_of_single_meshes_in_their_order(launches):
    raw = [shapes.sphere(n) for n in (4, 30, 8, 16)] + [shapes.cube(3), shapes.soup(50, size=1)]
    meshes = [on_gpu(v.astype(np.float32) if n % 2 else v, f.astype((np.int64, np.uint32)[n % 2]))
              for n, (v, f) in enumerate(raw)]  # fmt: skip
    for options in (
        {"resolution": 12, "band": 2},
        {"shape": (9, 8, 7)},
        {"grid": GRID, "thickness": 0.5},
    ):
        launches.clear()
        results = list(so.fields(meshes, ahead=6, **options, **ON_GPU))
        assert [r.index for r in results] == list(range(6))
        assert launches == [(6, 1, [])]
        for result, mesh, (vertices, faces) in zip(results, meshes, raw):
            assert result.source is mesh and isinstance(result.field, so.DeviceField)
            alone = so.field(mesh, **options, **ON_GPU)
            np.testing.assert_array_equal(result.field.values.array, alone.values.array)
            same = vertices.astype(np.float32) if result.index % 2 else vertices
            np.testing.assert_array_equal(result.field.values.array, expected(same, faces, **options))
            assert result.field.grid == alone.grid and result.field.provenance == alone.provenance
            assert result.field.computation.keys() == alone.computation.keys()
            assert result.field.computation["triangles"] == len(faces)
            assert not np.shares_memory(result.field.values.array, alone.values.array)


def test_what_is_up_stays_with_a_mesh_that_moves_to_the_gpu(launches):
    mesh = so.Mesh(VERTICES, FACES, up="y")
    for prepare, up in ((lambda _: on_gpu(), "y"), (None, "")):
        (result,) = so.fields([mesh if prepare else on_gpu()], prepare=prepare, resolution=8, **ON_GPU)
        assert result.unwrap().provenance["up"] == up


def test_errors_are_collected(launches):
    def broken(array, place, value):
        array = array.copy()
        array[place] = value
        return array

    meshes = {
        "good": on_gpu(),
        "not finite": on_gpu(broken(VERTICES, 7, np.nan)),
        "out of range": on_gpu(VERTICES, broken(FACES, (5, 1), 99)),
        "halves": on_gpu(VERTICES.astype(np.float16)),
        "half on the CPU": (Standard(VERTICES), FACES),
        "empty": on_gpu(VERTICES, FACES[:0]),
        "quads": on_gpu(VERTICES, FACES[:, :2]),
        "a library that makes no arrays": (Dlpack(VERTICES), Dlpack(FACES)),
        "nowhere": on_gpu(data=(0, False)),
        "a library that hands out nothing": (Closed(VERTICES), Closed(FACES)),
        "a path": "missing.obj",
        "nothing": None,
        "good too": on_gpu(2 * VERTICES),
    }
    kinds = [None, so.MeshError, so.MeshError, TypeError, so.DeviceError, so.UsageError, ValueError, so.DeviceError,
             so.UsageError, so.DeviceError, FileNotFoundError, TypeError, None]  # fmt: skip
    for options in ({"resolution": 12}, {"grid": GRID}):
        launches.clear()
        results = list(so.fields(meshes.values(), ahead=20, **options, **ON_GPU))
        for result, kind in zip(results, kinds, strict=True):
            assert (result.error is None) == (kind is None), result
            if kind:
                assert isinstance(result.error, kind) and result.field is None
        assert results[1].error.triangle == 2 and results[2].error.triangle == 5
        np.testing.assert_array_equal(results[0].field.values.array, expected(**options))
        np.testing.assert_array_equal(results[-1].field.values.array, expected(2 * VERTICES, **options))
        assert len(launches) == 1
    assert launches[0][0] == 6  # with a grid, nothing is known of the meshes before


def test_none_and_only_bad_ones():
    assert list(so.fields([], resolution=8, **ON_GPU)) == []
    bad = on_gpu(VERTICES, FACES + 1)  # one vertex too far
    for count in (1, 5):
        results = list(so.fields([bad] * count, resolution=8, **ON_GPU))
        assert [r.error.triangle for r in results] == count * [next(n for n, f in enumerate(FACES) if 7 in f)]


@pytest.mark.parametrize(
    "options",
    [{"sign": "normal"}, {"nearest": True}, {"method": "magic"}, {"band": -1}, {"device": "cpu"}, {"stream": "x"}],
)
def test_options_that_do_not_fit_are_every_meshs_error(options):
    results = list(so.fields([on_gpu()] * 3, **{"resolution": 8, **ON_GPU, **options}))
    assert [r.index for r in results] == [0, 1, 2]
    assert all(isinstance(r.error, (so.Error, ValueError, TypeError)) for r in results)


@pytest.mark.parametrize("workers, ahead", [(1, 1), (2, 3), (4, 8)])
def test_an_endless_iterable_is_read_as_far_as_needed(launches, workers, ahead):
    last, alive, most = -1, weakref.WeakSet(), 0

    def meshes():
        nonlocal last
        for last in itertools.count():  # noqa: B007
            yield on_gpu()

    results = so.fields(meshes(), workers=workers, ahead=ahead, resolution=8, **ON_GPU)
    for n, result in zip(range(20), results):
        assert result.index == n
        assert last <= n + ahead
        alive.add(result.field)
        most = max(most, len(alive))
        del result
    results.close()
    assert {count for count, *_ in launches} == {ahead}
    assert most <= 2
    assert not [t for t in threading.enumerate() if t.name.startswith("standoff")]


def test_meshes_of_the_cpu_between_them(launches):
    meshes = [on_gpu(VERTICES * k) if k % 3 else (VERTICES * k, FACES) for k in range(1, 9)]
    results = list(so.fields(meshes, workers=2, ahead=8, resolution=8, **ON_GPU))
    for k, result in enumerate(results, 1):
        assert result.index == k - 1 and isinstance(result.unwrap(), so.DeviceField) == bool(k % 3)
        values = result.field.values.array if k % 3 else result.field.numpy()
        np.testing.assert_array_equal(values, expected(VERTICES * k, resolution=8))
    assert [count for count, *_ in launches] == [2, 2, 2]


def test_meshes_on_other_streams_have_launches_of_their_own(launches):
    results = list(so.fields([on_gpu(VERTICES * (n + 1), stream=5 + n % 2) for n in range(6)], resolution=8, **ON_GPU))
    for n, result in enumerate(results):
        np.testing.assert_array_equal(result.field.values.array, expected(VERTICES * (n + 1), resolution=8))
    assert launches == [(3, 5, []), (3, 6, [])]
    launches.clear()
    list(so.fields([on_gpu(stream=5 + n % 2) for n in range(6)], resolution=8, stream=9, **ON_GPU))
    assert launches == [(6, 9, [5, 6])]


def test_the_stream_is_that_of_the_callers_thread(launches, monkeypatch):
    def tensor(array):
        made = Tensor(array)
        made.permute = lambda *axes: tensor(array.transpose(axes))
        return made

    class Tensor(Cuda):
        device = "cuda"

    Tensor.__module__ = "torch"
    caller = threading.get_ident()
    torch = Thing(
        float32=np.float32,
        empty=lambda shape, dtype, device: tensor(np.empty(shape, dtype)),
        cuda=Thing(current_stream=lambda device: Thing(cuda_stream=77 if threading.get_ident() == caller else 0)),
    )
    monkeypatch.setitem(sys.modules, "torch", torch)
    moved = []

    def to_gpu(mesh):
        moved.append(threading.get_ident())
        return Tensor(mesh.vertices), Tensor(mesh.faces)

    results = list(so.fields([(VERTICES, FACES)] * 4, prepare=to_gpu, resolution=8, **ON_GPU))
    assert launches == [(4, 77, [1])]  # what prepare has put on a worker's stream is waited for
    assert len(moved) == 4 and caller not in moved
    for result in results:
        np.testing.assert_array_equal(result.field.values.array, expected(resolution=8))


def test_other_exceptions_come_in_their_turn():
    def prepare(mesh):
        if mesh.bounds[1][0] > 2:
            raise ZeroDivisionError("on purpose")
        return on_gpu(mesh.vertices, mesh.faces)

    results = so.fields([shapes.cube(1 + n) for n in range(9)], prepare=prepare, resolution=8, **ON_GPU)
    with pytest.raises(ZeroDivisionError, match="on purpose"):
        for result in results:
            assert result.error is None
    assert result.index == 3  # cubes of side 1 to 4 are small enough


def test_an_error_keeps_no_other_mesh():
    closed = Closed(VERTICES), Closed(FACES)
    meshes = [on_gpu(), on_gpu(VERTICES.astype(np.float16)), on_gpu(VERTICES, FACES + 1), closed]
    gone = [weakref.ref(part) for part in meshes[0]]
    results = list(so.fields(meshes, resolution=8, **ON_GPU))
    errors = [result.error for result in results[1:]]
    assert all(errors)
    gc.disable()
    try:
        del meshes, results
        assert [part() for part in gone] == [None, None]
    finally:
        gc.enable()
