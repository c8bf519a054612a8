# SPDX-License-Identifier: Apache-2.0
"""zarr-python and TensorStore as judges of our stores: they read what we write, and we what they write."""

import numpy as np
import pytest
import shapes
import standoff as so
from standoff import _core

zarr = pytest.importorskip("zarr")
tensorstore = pytest.importorskip("tensorstore")
codecs = pytest.importorskip("zarr.codecs")

ORIGIN, SPACING = (-1.0, 2.0, 3.0), (0.5, 0.25, 1.0)
FIELDS = {
    "band": {"thickness": 0.1},
    "full": {},
    "without sign": {"thickness": 0.1, "sign": None},
    "nearest": {"thickness": 0.1, "nearest": True},
}


@pytest.fixture(params=FIELDS)
def field(request):
    # More than a shard along two axes.
    return so.field(
        so.Mesh(*shapes.sphere(12)),
        grid=so.Grid((140, 30, 131), (-1.1, -1.1, -1.1), (0.017, 0.08, 0.017)),
        **FIELDS[request.param],
    )


def opened(path):
    return tensorstore.open({"driver": "zarr3", "kvstore": {"driver": "file", "path": str(path)}}).result()


def test_others_read_what_we_write(field, request, tmp_path):
    path = tmp_path / "a.zarr"
    for compress in (True, False):
        field.save(path, compress=compress)
        group = zarr.open_group(path, mode="r")
        for found in (group["0"][:], opened(path / "0").read().result()):
            np.testing.assert_array_equal(found, field.numpy())
        array = group["0"]
        about = array.attrs["standoff"]
        assert array.metadata.dimension_names == ("x", "y", "z")
        assert array.fill_value == np.float32(field.thickness)
        assert float(about["thickness"]) == field.thickness
        assert tuple(about["origin"]) == tuple(field.grid.origin)
        assert tuple(about["spacing"]) == tuple(field.grid.spacing)
        assert about["sign"] == field.provenance["sign"]
        assert ("nearest" in group) == ("nearest" in request.node.callspec.id)
        if "nearest" in group:
            np.testing.assert_array_equal(group["nearest"][:], field.nearest())
            np.testing.assert_array_equal(opened(path / "nearest").read().result(), field.nearest())


def test_what_we_write_is_ome_zarr(field, tmp_path):
    field.save(tmp_path / "a.zarr")
    ome = zarr.open_group(tmp_path / "a.zarr", mode="r").attrs["ome"]
    assert ome["version"] == "0.5"
    (image,) = ome["multiscales"]
    assert [axis["name"] for axis in image["axes"]] == ["x", "y", "z"]
    scale, translation = image["datasets"][0]["coordinateTransformations"]
    assert tuple(scale["scale"]) == tuple(field.grid.spacing)
    assert tuple(translation["translation"]) == tuple(field.grid.origin)


def test_others_read_levels(field, tmp_path):
    path = tmp_path / "a.zarr"
    field.save(path)
    store = _core.open_store(path, 0)
    shape = store.shape
    store.begin_levels(4)
    for level in range(1, 4):
        shape = [-(-n // 2) for n in shape]
        store.write_level(level, (0, 0, 0), shape, 0)
    store.end_levels(4)
    group = zarr.open_group(path, mode="r")
    (image,) = group.attrs["ome"]["multiscales"]
    assert [one["path"] for one in image["datasets"]] == ["0", "1", "2", "3"]
    for level, one in enumerate(image["datasets"]):
        step = 2**level
        wanted = field.numpy()[::step, ::step, ::step]
        for found in (group[one["path"]][:], opened(path / one["path"]).read().result()):
            np.testing.assert_array_equal(found, wanted)
        scale, translation = one["coordinateTransformations"]
        assert tuple(scale["scale"]) == tuple(step * s for s in field.grid.spacing)
        assert tuple(translation["translation"]) == tuple(field.grid.origin)


def attributes(thickness):
    return {"standoff": {"format": 1, "origin": ORIGIN, "spacing": SPACING, "thickness": thickness, "sign": "winding"}}


def wanted(thickness=4.0):
    i, j, k = np.meshgrid(*(np.arange(n) for n in (70, 41, 33)), indexing="ij")
    distance = np.sqrt((i - 30) ** 2 + (j - 20) ** 2 + (k - 10) ** 2) - 9
    return np.clip(distance, -thickness, thickness).astype(np.float32)


X_FASTEST = [codecs.TransposeCodec(order=(2, 1, 0))]
BLOSC = {
    name: codecs.BloscCodec(cname=name, clevel=5, shuffle="bitshuffle") for name in ("lz4", "lz4hc", "zlib", "blosclz")
}
WAYS = {
    "ours": {
        "shards": (64, 64, 64),
        "chunks": (32, 32, 32),
        "filters": X_FASTEST,
        "compressors": [codecs.BloscCodec(), codecs.Crc32cCodec()],
    },
    "before checksums": {
        "shards": (64, 64, 64),
        "chunks": (32, 32, 32),
        "filters": X_FASTEST,
        "compressors": [codecs.BloscCodec()],
    },
    "checksums alone": {"chunks": (32, 32, 32), "compressors": [codecs.Crc32cCodec()]},
    "z fastest": {"shards": (64, 64, 64), "chunks": (32, 32, 32), "compressors": [codecs.BloscCodec()]},
    "odd chunks": {
        "shards": (45, 22, 36),
        "chunks": (15, 11, 9),
        "compressors": [codecs.BloscCodec(shuffle="noshuffle")],
    },
    "no shards": {"chunks": (16, 20, 24), "filters": X_FASTEST, "compressors": [codecs.BloscCodec()]},
    "one chunk": {"chunks": (70, 41, 33), "compressors": None},
    "other keys": {
        "chunks": (32, 32, 32),
        "compressors": None,
        "chunk_key_encoding": {"name": "default", "separator": "."},
    },
    **{name: {"chunks": (32, 32, 32), "compressors": [codec]} for name, codec in BLOSC.items()},
}


@pytest.mark.parametrize("way", WAYS)
def test_we_read_what_zarr_python_writes(way, tmp_path):
    values = wanted()
    group = zarr.create_group(tmp_path / "a.zarr")
    array = group.create_array(
        "0", shape=values.shape, dtype="float32", fill_value=4.0, attributes=attributes(4.0), **WAYS[way]
    )
    array[:] = values
    field = so.load(tmp_path / "a.zarr")
    np.testing.assert_array_equal(field.numpy(), values)
    assert tuple(field.grid.origin) == ORIGIN and tuple(field.grid.spacing) == SPACING
    assert field.thickness == 4.0 and field.provenance["sign"] == "winding"
    assert len(field.tiles()[1]) < 9 * 6 * 5 / 2, "tiles that are clamped are not stored"


@pytest.mark.parametrize("index_location", ["start", "end"])
def test_we_read_what_tensorstore_writes(index_location, tmp_path):
    values = wanted()
    zarr.create_group(tmp_path / "a.zarr")
    inner = [{"name": "transpose", "configuration": {"order": [2, 1, 0]}},
             {"name": "bytes", "configuration": {"endian": "little"}},
             {"name": "blosc", "configuration": {"cname": "zstd", "clevel": 4, "shuffle": "shuffle", "typesize": 4}},
            {"name": "crc32c"}]  # fmt: skip
    sharding = {"chunk_shape": [16, 16, 16], "codecs": inner, "index_location": index_location}
    store = tensorstore.open({
        "driver": "zarr3", "kvstore": {"driver": "file", "path": str(tmp_path / "a.zarr" / "0")}, "create": True,
        "metadata": {"shape": values.shape, "data_type": "float32", "fill_value": 4.0, "attributes": attributes(4.0),
                     "dimension_names": ["x", "y", "z"],
                     "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [32, 32, 32]}},
                     "codecs": [{"name": "sharding_indexed", "configuration": sharding}]},
    }).result()  # fmt: skip
    store.write(values).result()
    np.testing.assert_array_equal(so.load(tmp_path / "a.zarr").numpy(), values)


def test_without_our_attributes_those_of_ome_zarr_count(tmp_path):
    values = wanted()
    transformations = [{"type": "scale", "scale": SPACING}, {"type": "translation", "translation": ORIGIN}]
    image = {"axes": [{"name": name, "type": "space"} for name in "xyz"],
             "datasets": [{"path": "level", "coordinateTransformations": transformations}]}  # fmt: skip
    group = zarr.create_group(tmp_path / "a.zarr", attributes={"ome": {"version": "0.5", "multiscales": [image]}})
    group.create_array("level", shape=values.shape, dtype="float32", chunks=(32, 32, 32), compressors=None)[:] = values
    field = so.load(tmp_path / "a.zarr")
    np.testing.assert_array_equal(field.numpy(), values)
    assert tuple(field.grid.origin) == ORIGIN and field.thickness == np.inf
    bare = zarr.create_group(tmp_path / "b.zarr")
    bare.create_array("0", shape=values.shape, dtype="float32", chunks=(32, 32, 32), compressors=None)
    with pytest.raises(so.InputError, match="where its samples are is not known"):
        so.load(tmp_path / "b.zarr")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"compressors": [codecs.ZstdCodec()]}, "codec 'zstd' is not read here; standoff reads"),
        ({"compressors": [codecs.GzipCodec()]}, "codec 'gzip' is not read here; standoff reads"),
        ({"compressors": None, "serializer": codecs.BytesCodec(endian="big")}, "'big' endian bytes are not read"),
        ({"compressors": None, "dtype": "float64"}, "samples of type 'float64' are not read; write float32"),
        ({"compressors": None, "dimension_names": ("z", "y", "x")}, "axes are read in the order x, y, z"),
    ],
)
def test_what_is_not_read_says_what_is(options, words, tmp_path):
    group = zarr.create_group(tmp_path / "a.zarr")
    group.create_array(
        "0", shape=(8, 8, 8), chunks=(8, 8, 8), attributes=attributes(4.0), **{"dtype": "float32", **options}
    )
    with pytest.raises(so.InputError, match=words.replace("'", ".")):
        so.load(tmp_path / "a.zarr")


def test_a_store_is_a_folder(tmp_path):
    field = so.field(so.Mesh(*shapes.sphere(6)), resolution=20)
    with pytest.raises(so.UsageError, match="such a field is a folder of files"):
        field.to_bytes("zarr")
    field.save(tmp_path / "a.zarr")
    with pytest.raises(so.OutputError, match="somebody has written it"):
        field.save(tmp_path / "a.zarr", overwrite=False)
    np.testing.assert_array_equal(so.load(str(tmp_path / "a.zarr") + "/").numpy(), field.numpy())
    (tmp_path / "b.vti").mkdir()
    with pytest.raises(IsADirectoryError):
        so.load(tmp_path / "b.vti")
