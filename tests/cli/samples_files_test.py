# SPDX-License-Identifier: Apache-2.0
"""What `crossings`, `voxels` and `compute --with` write, as numpy and a plain binvox reader see it."""

import csv

import numpy as np
from program import run


def crossings():
    run("crossings", "scene:box", "-r", "20", "--sign", "auto", "-o", "a.npz")
    run("crossings", "scene:box", "-r", "20", "--sign", "auto", "-o", "a.csv")
    data = np.load("a.npz")
    sample, axis, place = data["sample"], data["axis"], data["place"]
    assert sample.dtype == np.int64 and axis.dtype == np.uint8 and data["triangle"].dtype == np.uint32
    assert data["normal"].dtype == np.float32 and data["enters"].dtype == np.bool_ and place.dtype == np.float64
    assert len(sample) > 500 and (sample >= 0).all() and ((0 <= place) & (place <= 1)).all()
    position = data["origin"] + data["spacing"] * sample
    rows = np.arange(len(axis))
    position[rows, axis] += data["spacing"][axis] * place
    # On the faces of the box, whose normals point away from its middle.
    low, high = position.min(axis=0), position.max(axis=0)
    assert np.isclose(np.minimum(position - low, high - position).min(axis=1), 0, atol=1e-9).all()
    assert np.allclose(np.linalg.norm(data["normal"], axis=1), 1, atol=1e-6)
    assert (np.einsum("ij,ij->i", data["normal"], position - (low + high) / 2) > 0).all()
    assert ((data["normal"][rows, axis] < 0) == data["enters"]).all()
    assert data["enters"].sum() * 2 == len(axis)  # it is convex

    with open("a.csv", newline="") as file:
        table = list(csv.DictReader(file))
    assert len(table) == len(axis)
    for n in (0, len(table) // 2, len(table) - 1):
        row = table[n]
        assert [int(row[c]) for c in "ijk"] == list(sample[n]) and int(row["axis"]) == axis[n]
        assert float(row["place"]) == place[n] and int(row["triangle"]) == data["triangle"][n]
        assert np.allclose([float(row[c]) for c in "xyz"], position[n], atol=1e-12)
        assert row["enters"] == str(int(data["enters"][n]))


def read_binvox(name):
    """By the format's own page: y runs fastest, then z, then x."""
    with open(name, "rb") as file:
        assert file.readline().startswith(b"#binvox 1")
        dims = [int(word) for word in file.readline().split()[1:]]
        translate = [float(word) for word in file.readline().split()[1:]]
        scale = float(file.readline().split()[1])
        assert file.readline() == b"data\n"
        runs = np.frombuffer(file.read(), np.uint8).reshape(-1, 2)
    assert (runs[:, 1] > 0).all()
    voxels = np.repeat(runs[:, 0], runs[:, 1]).reshape(dims[0], dims[1], dims[2])  # x, z, y
    return voxels.transpose(0, 2, 1), translate, scale


def raw_after(name, marker, shape):
    with open(name, "rb") as file:
        data = file.read()
    start = data.index(marker) + len(marker)
    return np.frombuffer(data[start:start + np.prod(shape)], np.uint8).reshape(shape, order="F")


def voxels():
    options = ["scene:sphere:3000", "-r", "37", "--padding", "3"]
    counts = {}
    for kind in ("--solid", "--surface", "--both"):
        for extension in ("npz", "nrrd", "vti", "binvox"):
            run("voxels", *options, kind, "-o", f"v.{extension}", "-f")
        data = np.load("v.npz")
        array, origin, spacing = data["voxels"], data["origin"], data["spacing"]
        assert array.dtype == np.uint8 and array.max() == 1
        assert (raw_after("v.nrrd", b"\n\n", array.shape) == array).all()
        assert (raw_after("v.vti", b"<AppendedData encoding=\"raw\">\n_", (8,)).view("<u8") == array.size).all()
        with open("v.vti", "rb") as file:
            text = file.read()
        start = text.index(b"\n_") + 2 + 8
        assert (np.frombuffer(text[start:start + array.size], np.uint8).reshape(array.shape, order="F") == array).all()
        cube, translate, scale = read_binvox("v.binvox")
        side = max(array.shape)
        assert cube.shape == (side, side, side)
        nx, ny, nz = array.shape
        assert (cube[:nx, :ny, :nz] == array).all() and cube.sum() == array.sum()
        assert np.allclose(translate, origin - spacing / 2) and np.isclose(scale, spacing[0] * side)
        counts[kind] = array
    assert ((counts["--solid"] | counts["--surface"]) == counts["--both"]).all()
    middle = tuple(n // 2 for n in counts["--solid"].shape)
    assert counts["--solid"][middle] and not counts["--surface"][middle]
    # A flat grid: fewer slices than the cube has.
    run("voxels", "scene:box", "--size", "9,12,5", "--surface", "-o", "flat.binvox", code=2)  # no cubes
    run("voxels", "scene:box", "--spacing", "0.2", "--bounds", "-1,-1,0,1,1,0.5", "--solid", "-o", "flat.binvox")
    run("voxels", "scene:box", "--spacing", "0.2", "--bounds", "-1,-1,0,1,1,0.5", "--solid", "-o", "flat.npz")
    array = np.load("flat.npz")["voxels"]
    cube = read_binvox("flat.binvox")[0]
    assert cube[:array.shape[0], :array.shape[1], :array.shape[2]].sum() == array.sum() == cube.sum() > 0


def sidecars():
    run("compute", "scene:sphere:3000", "-r", "40", "-t", "2s", "--sign", "auto", "-o", "s.npz",
        "--with", "nearest,closest,barycentric,feature,gradient")
    data = np.load("s.npz")
    nearest = data["nearest_triangle"]
    band = nearest != 0xFFFFFFFF
    at = np.stack(np.meshgrid(*[np.arange(n) for n in nearest.shape], indexing="ij"), axis=-1)
    at = data["origin"] + data["spacing"] * at

    def vectors(name):
        array = data[name]
        return np.moveaxis(array, 0, -1) if array.shape[0] == 3 and array.shape[-1] != 3 else array

    closest, gradient, weights = vectors("closest_point"), vectors("gradient"), vectors("barycentric")
    distance = data["distance"][..., None]
    assert np.abs(at - closest - gradient * distance)[band].max() < 1e-5
    assert np.abs(np.linalg.norm(gradient, axis=-1)[band] - 1).max() < 1e-6
    assert np.abs(weights.sum(axis=-1)[band] - 1).max() < 1e-6
    assert (np.einsum("...i,...i", gradient, at)[band] > 0).all()  # the ball is around the origin
    assert data["feature"].dtype == np.uint8 and data["feature"].max() <= 6 and (data["feature"][band] == 0).any()
    for array in (closest, gradient, weights):
        assert (array[~band] == 0).all()
    # verify finds a single number that is off.
    run("verify", "s.npz", "scene:sphere:3000")
    arrays = dict(data)
    off = tuple(np.argwhere(band)[100])
    gradient = arrays["gradient"].copy()
    gradient[off] = -gradient[off]
    np.savez("wrong.npz", **{**arrays, "gradient": np.asfortranarray(gradient)})
    failed = run("verify", "wrong.npz", "scene:sphere:3000", code=7)
    assert "wrong in 1 place" in failed.stderr, failed.stderr
    # Without nearest triangles, and what cannot carry them.
    run("compute", "scene:sphere:3000", "-r", "20", "-t", "2s", "-o", "f.npz", "--with", "feature")
    assert "nearest_triangle" not in np.load("f.npz").files and "feature" in np.load("f.npz").files
    assert "only carry distances" in run("compute", "scene:box", "-o", "a.nrrd", "--with", "gradient", code=2).stderr
    assert "gradient" in run("compute", "scene:box", "-o", "b.npz", "--with", "colour", code=2).stderr


crossings()
voxels()
sidecars()
