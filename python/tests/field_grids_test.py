# SPDX-License-Identifier: Apache-2.0
"""Where the samples are: as the docstrings say, and where the program puts them."""

import subprocess

import numpy as np
import pytest
import shapes
import standoff as so

BOX = ((0.0, 0.0, 0.0), (2.0, 1.0, 0.5))


@pytest.fixture
def slab(tmp_path):
    vertices, faces = shapes.cube()
    so.Mesh((vertices + 0.5) * BOX[1], faces).save(tmp_path / "slab.obj")
    return tmp_path / "slab.obj"


SAME = [
    ({"resolution": 20}, ["--resolution", "20"]),
    ({"resolution": 20, "band": 3}, ["--resolution", "20", "--thickness", "3s"]),
    ({"resolution": 40, "band": 2.5}, ["--resolution", "40", "--thickness", "2.5s"]),
    ({"spacing": 0.1}, ["--spacing", "0.1"]),
    ({"spacing": 0.1, "band": 2}, ["--spacing", "0.1", "--thickness", "2s"]),
    ({"spacing": 0.07, "thickness": 0.2}, ["--spacing", "0.07", "--thickness", "0.2"]),
    ({"spacing": (0.1, 0.2, 0.05)}, ["--spacing", "0.1,0.2,0.05"]),
    ({"resolution": 17, "padding": 4}, ["--resolution", "17", "--padding", "4"]),
    ({"resolution": 30, "thickness": 0.15}, ["--resolution", "30", "--thickness", "0.15"]),
    ({"resolution": 30, "thickness": 5.0}, ["--resolution", "30", "--thickness", "5"]),
    ({"shape": (20, 12, 9)}, ["--size", "20,12,9"]),
    (
        {"resolution": 20, "band": 2, "method": "thesis"},
        ["--resolution", "20", "--thickness", "2s", "--method", "thesis"],
    ),
    ({"resolution": 24, "band": 20}, ["--resolution", "24", "--thickness", "20s"]),
]


@pytest.mark.parametrize("options, arguments", SAME, ids=[" ".join(a) for _, a in SAME])
def test_the_grid_and_values_of_the_program(options, arguments, slab, program, tmp_path):
    out = tmp_path / "program.npz"
    subprocess.run([program, "compute", slab, "-o", out, *arguments], check=True, capture_output=True)
    ours, theirs = so.field(slab, **options), so.load(out)
    assert ours.grid == theirs.grid
    assert ours.thickness == theirs.thickness
    np.testing.assert_array_equal(ours.numpy(), theirs.numpy())
    assert ours.provenance == theirs.provenance


def test_resolution_counts_samples_on_the_longest_side():
    for resolution in (2, 3, 17, 64):
        assert max(so.field(shapes.cube(), resolution=resolution, padding=0).shape) == resolution
    assert so.Grid.fit(BOX).shape[0] == 256


def test_padding_and_spacing():
    grid = so.Grid.fit(BOX, spacing=0.25, padding=2)
    low, high = grid.bounds
    assert grid.spacing == (0.25,) * 3
    assert (np.array(low) <= np.array(BOX[0]) - 0.5 + 1e-12).all()
    assert (np.array(high) >= np.array(BOX[1]) + 0.5 - 1e-12).all()
    assert (np.array(high) - np.array(low) <= np.array(BOX[1]) + 1 + 2 * 0.25).all()
    shaped = so.Grid.fit(BOX, shape=(9, 5, 3), padding=0)
    assert shaped.bounds == BOX
    assert shaped.spacing == (0.25, 0.25, 0.25)


def test_bands_in_samples_and_in_world_units():
    field = so.field(shapes.cube(), spacing=(0.1, 0.2, 0.05), band=2)
    assert field.thickness == 0.4
    assert so.field(shapes.cube(), spacing=0.1, thickness=0.25).thickness == 0.25
    assert so.field(shapes.cube(), resolution=8).thickness == np.inf
    assert np.abs(field.numpy()).max() == np.float32(0.4)


def test_a_grid_says_where_its_samples_are():
    grid = so.Grid((2, 3, 4), (1, 2, 3), (0.5, 0.25, 2))
    points = grid.points()
    assert points.shape == (2, 3, 4, 3)
    for index in np.ndindex(2, 3, 4):
        np.testing.assert_array_equal(points[index], np.array(grid.origin) + np.array(grid.spacing) * index)
    assert grid.bounds == ((1, 2, 3), (1.5, 2.5, 9))
    assert grid == so.Grid(np.array([2, 3, 4]), np.float32([1, 2, 3]), [0.5, 0.25, 2])
    assert hash(grid) == hash(so.Grid([2, 3, 4], [1, 2, 3], [0.5, 0.25, 2]))
    with pytest.raises(AttributeError):
        grid.shape = (1, 1, 1)


def test_one_grid_for_several_fields():
    first = so.field(shapes.cube(), resolution=10)
    second = so.field(shapes.cube(0.5), grid=first.grid, band=2)
    assert second.grid == first.grid
    assert second.thickness == 2 * max(first.grid.spacing)
    assert so.Grid.fit(so.Mesh(*shapes.cube()), resolution=10) == so.Grid.fit(((-0.5,) * 3, (0.5,) * 3), resolution=10)
