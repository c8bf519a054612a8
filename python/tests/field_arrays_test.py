# SPDX-License-Identifier: Apache-2.0
"""The arrays of fields: one memory where the docstrings say so, and the same values in every form."""

import gc
import sys

import numpy as np
import pytest
import shapes
import standoff as so


def address(array):
    return array.__array_interface__["data"][0]


@pytest.fixture(scope="module")
def full():
    return so.field(shapes.sphere(6), shape=(12, 20, 9))


@pytest.fixture(scope="module")
def band():
    return so.field(shapes.sphere(6), resolution=60, band=2)


def test_a_full_field_is_one_array_in_fortran_order(full):
    first, second = full.numpy(), full.numpy()
    assert first.shape == full.shape == (12, 20, 9)
    assert first.dtype == np.float32
    assert first.flags.f_contiguous
    assert full.numpy().T.flags.c_contiguous
    assert address(first) == address(second) == address(np.asarray(full))
    assert not first.flags.writeable
    with pytest.raises(ValueError):
        first[0, 0, 0] = 1
    assert full.nbytes == first.nbytes


def test_a_band_gives_new_arrays(band):
    first, second = band.numpy(), band.numpy()
    assert first.flags.f_contiguous and first.flags.writeable
    assert not np.shares_memory(first, second)
    first[:] = 0
    np.testing.assert_array_equal(band.numpy(), second)


def test_out_is_where_the_values_are(band, full):
    for options in ({"band": 2}, {}):
        plain = so.field(shapes.sphere(6), resolution=20, **options)
        out = np.full(plain.shape, np.nan, np.float32, order="F")
        field = so.field(shapes.sphere(6), resolution=20, out=out, **options)
        assert address(field.numpy()) == address(out)
        assert out.flags.writeable
        np.testing.assert_array_equal(out, plain.numpy())
        assert field.provenance == plain.provenance
        assert field.thickness == plain.thickness


def test_out_may_be_a_part_of_a_larger_array():
    shape = so.field(shapes.cube(), resolution=9).shape
    batch = np.full((3, *shape[::-1]), 7, np.float32)
    so.field(shapes.cube(), resolution=9, out=batch[1].T)
    assert (batch[0] == 7).all() and (batch[2] == 7).all()
    np.testing.assert_array_equal(batch[1].T, so.field(shapes.cube(), resolution=9).numpy())


@pytest.mark.parametrize(
    "out, error",
    [
        (np.zeros((9, 9, 9), np.float32), ValueError),  # C order
        (np.zeros((9, 9, 9), np.float64, order="F"), ValueError),
        (np.zeros((9, 9, 8), np.float32, order="F"), ValueError),
        (np.zeros((9, 9), np.float32, order="F"), ValueError),
        (np.zeros((18, 9, 9), np.float32, order="F")[::2], ValueError),
        (np.zeros((9, 9, 9), ">f4", order="F"), ValueError),
        (np.broadcast_to(np.float32(0), (9, 9, 9)), ValueError),
        ([[[0.0]]], TypeError),
        (memoryview(b"123"), TypeError),
    ],
    ids=str,
)
def test_an_out_that_does_not_fit(out, error):
    with pytest.raises(error, match="^out: "):
        so.field(shapes.cube(), shape=(9, 9, 9), out=out)


def test_a_read_only_out():
    out = np.zeros((9, 9, 9), np.float32, order="F")
    out.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        so.field(shapes.cube(), shape=(9, 9, 9), out=out)
    with pytest.raises(ValueError, match="nearest"):
        so.field(shapes.cube(), shape=(9, 9, 9), out=np.zeros((9, 9, 9), np.float32, order="F"), nearest=True)


@pytest.mark.parametrize("options", [{"band": 2}, {}, {"nearest": True}], ids=str)
def test_tiles_and_their_coordinates_make_the_field(options):
    field = so.field(shapes.sphere(6), resolution=30, **options)
    values, coordinates = field.tiles()
    assert values.shape == (len(coordinates), 8, 8, 8)
    assert values.dtype == np.float32
    assert coordinates.shape == (len(values), 3)
    assert coordinates.dtype == np.int32
    assert len(np.unique(coordinates, axis=0)) == len(coordinates)
    dense = np.pad(field.numpy(), [(0, -n % 8) for n in field.shape], constant_values=field.thickness)
    covered = np.zeros(dense.shape, bool)
    for tile, (i, j, k) in zip(values, 8 * coordinates):
        np.testing.assert_array_equal(tile, dense[i : i + 8, j : j + 8, k : k + 8])
        covered[i : i + 8, j : j + 8, k : k + 8] = True
    assert (np.abs(dense[~covered]) == np.float32(field.thickness)).all()


def test_tiles_share_the_memory_of_the_field(band):
    first, again = band.tiles()[0], band.tiles()[0]
    assert address(first) == address(again)
    assert first.strides == (2048, 4, 32, 256)
    assert not first.flags.writeable
    assert first.nbytes < band.nbytes < 4 * np.prod(band.shape)


def test_arrays_keep_the_memory_alive():
    tiles, coordinates = so.field(shapes.sphere(6), resolution=30, band=2).tiles()
    values = so.field(shapes.sphere(6), resolution=30).numpy()
    gc.collect()
    again = so.field(shapes.sphere(6), resolution=30, band=2)
    values_again, coordinates_again = again.tiles()
    order, order_again = np.lexsort(coordinates.T), np.lexsort(coordinates_again.T)
    np.testing.assert_array_equal(tiles[order], values_again[order_again])
    np.testing.assert_array_equal(coordinates[order], coordinates_again[order_again])
    del values_again, coordinates_again
    np.testing.assert_array_equal(values, so.field(shapes.sphere(6), resolution=30).numpy())
    count = sys.getrefcount(again)
    views = [again.tiles() for _ in range(10)]
    del views
    assert sys.getrefcount(again) == count


def test_as_an_array(full, band):
    assert np.asarray(full).dtype == np.float32
    assert np.asarray(full, dtype=np.float64).dtype == np.float64
    np.testing.assert_array_equal(np.abs(full), np.abs(full.numpy()))
    assert not np.shares_memory(np.array(full, copy=True), full.numpy())
    if np.lib.NumpyVersion(np.__version__) >= "2.0.0":
        assert np.shares_memory(np.array(full, copy=False), full.numpy())
        for field, dtype in ((band, None), (full, np.float64)):
            with pytest.raises(ValueError):
                np.array(field, dtype=dtype, copy=False)


@pytest.mark.skipif(np.lib.NumpyVersion(np.__version__) < "2.1.0", reason="numpy knows no versions of DLPack")
def test_dlpack_shares_a_full_field_and_copies_a_band(full, band):
    for field in (full, band):
        array = np.from_dlpack(field)
        np.testing.assert_array_equal(array, field.numpy())
        assert field.__dlpack_device__() == (1, 0)
    assert address(np.from_dlpack(full)) == address(full.numpy())
    assert not np.from_dlpack(full).flags.writeable
    mine = np.from_dlpack(full, copy=True)
    assert not np.shares_memory(mine, full.numpy())
    assert mine.flags.writeable and np.from_dlpack(band).flags.writeable
    with pytest.raises(BufferError, match="^copy: the values of a band"):
        np.from_dlpack(band, copy=False)


def test_dlpack_for_those_who_cannot_be_told_not_to_write(full):
    class Old:
        """A consumer of DLPack before 1.0."""

        def __dlpack__(self, **_):
            return full.__dlpack__()

        def __dlpack_device__(self):
            return full.__dlpack_device__()

    array = np.from_dlpack(Old())
    np.testing.assert_array_equal(array, full.numpy())
    assert not np.shares_memory(array, full.numpy())
    for refused in ({"copy": False}, {"stream": 1}, {"dl_device": (2, 0)}):
        with pytest.raises(BufferError, match=f"^{next(iter(refused))}: "):
            full.__dlpack__(**refused)


def test_arrays_of_dlpack_keep_the_memory_alive():
    array = np.from_dlpack(so.field(shapes.sphere(6), resolution=30))
    gc.collect()
    np.testing.assert_array_equal(array, so.field(shapes.sphere(6), resolution=30).numpy())


def test_repr_says_size_memory_and_sign(full, band):
    assert repr(full) == "<standoff.DistanceField: 12 x 20 x 9, full, signed (winding), 8.64 kB>"
    assert f"band of {band.thickness:.4g}, signed (winding)" in repr(band)
    assert "unsigned" in repr(so.field(shapes.cube(), resolution=8, sign=None))
