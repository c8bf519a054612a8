# SPDX-License-Identifier: Apache-2.0
"""Copies of everything: pickle, copy, files. They are equal, in every respect."""

import copy
import pickle

import numpy as np
import pytest
import shapes
import standoff as so

FIELDS = {
    "full": {"resolution": 20},
    "band": {"resolution": 40, "band": 2},
    "unsigned band": {"resolution": 40, "band": 2, "sign": None},
    "inverted": {"resolution": 20, "band": 2, "sign": so.Sign("winding", invert=True)},
    "nearest": {"resolution": 20, "band": 2, "nearest": True},
    "full with nearest": {"resolution": 12, "nearest": True},
    "one sample": {"shape": (1, 1, 1)},
    "flat": {"grid": so.Grid((17, 9, 1), (-1, -1, 0), (0.125, 0.25, 1))},
}
every_field = pytest.mark.parametrize("options", FIELDS.values(), ids=FIELDS.keys())


def expect_equal(field, original, *, sign=True):
    assert field.grid == original.grid
    assert field.thickness == original.thickness
    assert field.provenance == original.provenance
    assert field.signed == original.signed
    np.testing.assert_array_equal(field.numpy(), original.numpy())
    if sign:
        assert field.sign == original.sign


@every_field
@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickle(options, protocol):
    field = so.field(shapes.sphere(6), **options)
    again = pickle.loads(pickle.dumps(field, protocol))
    expect_equal(again, field)
    if options.get("nearest"):
        np.testing.assert_array_equal(again.nearest(), field.nearest())
    else:
        assert sorted(map(tuple, again.tiles()[1].tolist())) == sorted(map(tuple, field.tiles()[1].tolist()))
    expect_equal(pickle.loads(pickle.dumps(again)), field)


def test_pickles_have_the_same_bits_for_any_threads():
    pickles = {pickle.dumps(so.field(shapes.sphere(6), resolution=40, band=2, threads=n)) for n in (1, *[4] * 20)}
    assert len(pickles) == 1


@every_field
def test_copy(options):
    field = so.field(shapes.sphere(6), **options)
    expect_equal(copy.copy(field), field)
    expect_equal(copy.deepcopy(field), field)


def test_a_deep_copy_does_not_share_the_callers_array():
    out = np.empty(so.field(shapes.cube(), resolution=9).shape, np.float32, order="F")
    field = so.field(shapes.cube(), resolution=9, out=out)
    shared, deep = copy.copy(field), copy.deepcopy(field)
    before = out.copy()
    out[:] = 5
    assert (shared.numpy() == 5).all()
    np.testing.assert_array_equal(deep.numpy(), before)


@every_field
@pytest.mark.parametrize("extension", [".vti", ".nrrd", ".npz", ".vdb", ".nvdb"])
@pytest.mark.parametrize("compress", [True, False])
def test_files(options, extension, compress, tmp_path):
    field = so.field(shapes.sphere(6), **options)
    path = tmp_path / f"field{extension}"
    if options.get("nearest") and extension not in (".vti", ".npz"):
        with pytest.raises(so.UsageError):
            field.save(path)
        assert list(tmp_path.iterdir()) == []
        return
    field.save(path, compress=compress)
    loaded = so.load(str(path))
    expect_equal(loaded, field, sign=False)
    assert loaded.sign is None
    if options.get("nearest"):
        np.testing.assert_array_equal(loaded.nearest(), field.nearest())
    assert list(tmp_path.iterdir()) == [path]


def test_npz_is_readable_by_numpy(tmp_path):
    field = so.field(shapes.cube(), resolution=12)
    field.save(tmp_path / "field.npz")
    with np.load(tmp_path / "field.npz") as arrays:
        assert any(a.shape in (field.shape, field.shape[::-1]) and a.dtype == np.float32 for a in arrays.values())


def test_a_field_of_given_values():
    original = so.field(shapes.sphere(6), resolution=30, band=2)
    values = original.numpy()
    for array in (values, np.ascontiguousarray(values), values.astype(float), values.tolist(), values.astype(">f4")):
        field = so.DistanceField.from_numpy(array, original.grid, thickness=original.thickness)
        np.testing.assert_array_equal(field.numpy(), values)
        assert field.signed
        assert field.provenance["method"] == ""
    assert not np.shares_memory(so.DistanceField.from_numpy(values, original.grid).numpy(), values)
    assert not so.DistanceField.from_numpy(np.abs(values), original.grid).signed


@pytest.mark.parametrize("bad", [np.nan, 1j, "1", None, True])
def test_values_that_are_no_distances(bad):
    grid = so.Grid((2, 2, 2), (0, 0, 0), (1, 1, 1))
    with pytest.raises((TypeError, ValueError), match="^values: "):
        so.DistanceField.from_numpy(np.full((2, 2, 2), bad), grid)
    with pytest.raises(ValueError, match="^values: "):
        so.DistanceField.from_numpy(np.zeros((2, 2, 3)), grid)
    with pytest.raises(TypeError, match="^grid: "):
        so.DistanceField.from_numpy(np.zeros((2, 2, 2)), None)
