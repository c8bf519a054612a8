# SPDX-License-Identifier: Apache-2.0
"""Fields in stores: what is asked for has the bits of the whole field, and nothing else is read."""

import itertools
import pickle

import numpy as np
import pytest
import shapes
import standoff as so
from standoff import _core

MESH = shapes.sphere(10)


@pytest.fixture(scope="module")
def whole():
    return so.field(MESH, shape=(200, 150, 131), band=4, nearest=True)


@pytest.fixture(scope="module", params=["folder", "memory"])
def stored(request, whole, tmp_path_factory):
    path = tmp_path_factory.mktemp("stored") / "a.zarr"
    whole.save(path)
    if request.param == "folder":
        return so.open(path)
    system = pytest.importorskip("fsspec").filesystem("memory")
    system.put(str(path), "/stored/a.zarr", recursive=True)
    return so.open("memory://stored/a.zarr")


def test_what_the_store_says(stored, whole):
    assert stored.grid == whole.grid and stored.thickness == whole.thickness
    assert stored.shape == whole.shape and stored.dtype == np.float32
    assert stored.signed and stored.has_nearest and stored.provenance == whole.provenance
    assert stored.shard == (128, 128, 128) and stored.chunk == (32, 32, 32)
    assert "StoredField" in repr(stored)


def test_windows(stored, whole):
    part = stored.window((100, 20, 7), (60, 110, 1))
    assert part.grid == whole.grid.window((100, 20, 7), (60, 110, 1))
    np.testing.assert_array_equal(part.numpy(), whole.numpy()[100:160, 20:130, 7:8])
    np.testing.assert_array_equal(part.nearest(), whole.nearest()[100:160, 20:130, 7:8])
    np.testing.assert_array_equal(stored.load().numpy(), whole.numpy())
    with pytest.raises(so.UsageError):
        stored.window((0, 0, 100), (1, 1, 32))


@pytest.mark.parametrize(
    "key",
    [
        (5, 6, 7),
        (-1, -150, 130),
        (slice(None), 3, slice(-40, None)),
        (slice(120, 140), slice(100, 2, -7), slice(0, 0)),
        (Ellipsis, 64),
        (17,),
        17,
        slice(150, 40, -13),
        (slice(5, 5), Ellipsis),
    ],
    ids=str,
)
def test_slices_are_those_of_numpy(key, stored, whole):
    np.testing.assert_array_equal(stored[key], whole.numpy()[key])


def test_slices_that_are_none(stored):
    for key in (200, (0, 0, -132), (0, 0, 0, 0), "x", (0, 1.5), [1, 2]):
        with pytest.raises(IndexError):
            stored[key]


def test_as_an_array(stored, whole):
    assert stored.ndim == 3
    np.testing.assert_array_equal(np.asarray(stored), whole.numpy())
    assert np.asarray(stored, dtype=np.float64).dtype == np.float64
    with pytest.raises(ValueError, match="no array to share"):
        stored.__array__(copy=False)


# Dask sends what it slices to its workers.
def test_pickled(stored, whole):
    again = pickle.loads(pickle.dumps(stored))
    assert again.grid == stored.grid and again.level == stored.level
    np.testing.assert_array_equal(again[100:110, 5], whole.numpy()[100:110, 5])


def test_levels_that_are_none(stored):
    with pytest.raises(ValueError, match="level: "):
        so.open(stored._target.url, level=2**40)


def test_values_between_samples(stored, whole):
    random = np.random.default_rng(1)
    low, high = whole.grid.bounds
    points = random.uniform(np.array(low) - 0.1, np.array(high) + 0.1, (3000, 3))
    points[:8] = list(itertools.product(*zip(low, high)))  # the corners
    points[8:200] = whole.grid.points()[random.integers(200, size=192), 63:66][:, 0, 64]  # where blocks meet
    for outside in ("nan", "border", "bound"):
        np.testing.assert_array_equal(stored(points, outside=outside), whole(points, outside=outside))
        np.testing.assert_array_equal(stored.gradient(points, outside=outside), whole.gradient(points, outside=outside))
    assert stored(points.reshape(30, 100, 3)).shape == (30, 100)
    assert isinstance(float(stored(points[9])), float)
    with pytest.raises((so.Error, ValueError)):
        stored([[np.nan, 0, 0]])


def test_nothing_else_is_read(whole, tmp_path):
    whole.save(tmp_path / "a.zarr")
    for path in (tmp_path / "a.zarr/0/c/1").rglob("*"):
        if path.is_file():
            path.write_bytes(b"torn")
    stored = so.open(tmp_path / "a.zarr")
    np.testing.assert_array_equal(stored[:128], whole.numpy()[:128])
    inside = whole.grid.points()[40, 70, 60]
    assert stored(inside) == whole(inside)
    with pytest.raises(so.InputError, match="0/c/1"):
        stored[128]


def test_levels(whole, tmp_path):
    path = tmp_path / "a.zarr"
    whole.save(path)
    store = _core.open_store(path, 0)
    store.begin_levels(3)
    for level, shape in ((1, (100, 75, 66)), (2, (50, 38, 33))):
        store.write_level(level, (0, 0, 0), shape, 0)
    assert so.open(path).levels == 1, "they are listed when all are complete"
    store.end_levels(3)
    system = pytest.importorskip("fsspec").filesystem("memory")
    system.put(str(path), "/levels/a.zarr", recursive=True)
    for url in (path, "memory://levels/a.zarr"):
        assert so.open(url).levels == 3 and so.open(url).level == 0
        for level in range(3):
            stored = so.open(url, level=level)
            step = 2**level
            np.testing.assert_array_equal(stored[:], whole.numpy()[::step, ::step, ::step])
            assert stored.level == level and stored.levels == 3 and f"level {level} of 3" in repr(stored)
            assert stored.grid.origin == whole.grid.origin and stored.thickness == whole.thickness
            assert tuple(stored.grid.spacing) == tuple(step * s for s in whole.grid.spacing)
            assert stored.has_nearest == (level == 0)
            sample = whole.grid.points()[64, 32, 16]
            assert stored(sample) == pytest.approx(whole(sample))
        for level in (3, -1):
            with pytest.raises(so.UsageError, match="it has levels 0 to 2"):
                so.open(url, level=level)
        with pytest.raises(TypeError, match="level: must be a whole number"):
            so.open(url, level=1.0)


def test_what_is_no_store(tmp_path):
    for name in (tmp_path / "none.zarr", tmp_path):
        with pytest.raises(so.Error):
            so.open(name)
    with pytest.raises(so.UsageError, match="no store"):
        so.open("memory://nowhere/a.zarr")
    with pytest.raises(TypeError, match="must be a path, a URL or a store of obstore"):
        so.open(3)
    with pytest.raises(so.UsageError, match="storage_options"):
        so.open(tmp_path, storage_options={"anon": True})
    assert _core.version
