# SPDX-License-Identifier: Apache-2.0
"""One array of many fields, as zarr-python and tensorstore read it."""

import numpy as np
import pytest
import standoff as so

zarr = pytest.importorskip("zarr")
MESHES = [f"scene:sphere:{200 + 40 * n}" for n in range(4)] + ["missing.obj", "scene:box"]
SHAPE = (24, 20, 22)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("array") / "out"
    return so.batch(MESHES, out, shape=SHAPE, band=3, format="array"), out


def fields(out):
    """The field of each mesh, by compute; None for what cannot be read."""
    alone = so.batch(MESHES, out, shape=SHAPE, band=3)
    return [row["output"] and so.load(out / row["output"]["file"]) for row in alone.rows()]


def test_zarr_reads_it(made, tmp_path):
    result, out = made
    group = zarr.open_group(out / "fields.zarr", mode="r")
    distance = group["distance"]
    assert distance.shape == (6, *SHAPE) and distance.dtype == np.float32 and distance.chunks == (1, *SHAPE)
    assert distance.metadata.dimension_names == ("mesh", "x", "y", "z") and np.isnan(distance.fill_value)
    values, code = distance[:], group["code"][:]
    assert values[0].flags.c_contiguous and code.tolist() == [0, 0, 0, 0, 3, 0]
    for n, (field, row) in enumerate(zip(fields(tmp_path / "alone"), result.rows(), strict=True)):
        if field is None:
            assert np.isnan(values[n]).all() and np.isnan(group["thickness"][n]) and row["output"] is None
            continue
        assert row["output"]["row"] == n
        assert np.ascontiguousarray(field.numpy()).tobytes() == values[n].tobytes()
        assert tuple(group["origin"][n]) == field.grid.origin and tuple(group["spacing"][n]) == field.grid.spacing
        assert group["thickness"][n] == field.thickness


def test_tensorstore_reads_it(made):
    ts = pytest.importorskip("tensorstore")
    _, out = made

    def opened(name):
        spec = {"driver": "zarr3", "kvstore": {"driver": "file", "path": str(out / "fields.zarr" / name)}}
        return ts.open(spec, open=True).result().read().result()

    group = zarr.open_group(out / "fields.zarr", mode="r")
    for name in ("distance", "origin", "spacing", "thickness", "code"):
        assert opened(name).tobytes() == group[name][:].tobytes(), name


def test_parts_make_the_same(made, tmp_path):
    _, out = made
    for part in (1, 2):
        so.batch(MESHES, tmp_path / "parts", shape=SHAPE, band=3, format="array", shard=(part, 2))
    from standoff._batch import merged

    merged(str(tmp_path / "parts"))
    files = {path.relative_to(out): path.read_bytes() for path in (out / "fields.zarr").rglob("*") if path.is_file()}
    assert files == {
        path.relative_to(tmp_path / "parts"): path.read_bytes()
        for path in (tmp_path / "parts/fields.zarr").rglob("*")
        if path.is_file()
    }


def test_shapes_must_be_equal(tmp_path):
    with pytest.raises(so.UsageError, match="its rows have one shape"):
        so.batch(MESHES, tmp_path / "out", resolution=16, format="array")
