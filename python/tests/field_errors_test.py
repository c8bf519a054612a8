# SPDX-License-Identifier: Apache-2.0
"""Arguments that make no sense: the documented exceptions, with their data."""

import math

import numpy as np
import pytest
import shapes
import standoff as so

MESH = so.Mesh(*shapes.cube())
NAN, INF = math.nan, math.inf

USAGE = [
    {"resolution": 0}, {"resolution": 1}, {"resolution": -5}, {"spacing": 0}, {"spacing": -1}, {"spacing": NAN},
    {"spacing": INF}, {"spacing": (0.1, 0.1, 0)}, {"spacing": (1, 2)}, {"shape": (0, 8, 8)}, {"shape": (-1, 8, 8)},
    {"shape": (8, 8)}, {"shape": ()}, {"band": 0}, {"band": -1}, {"band": NAN}, {"band": INF}, {"thickness": 0},
    {"thickness": -1}, {"thickness": NAN}, {"padding": -1}, {"padding": NAN}, {"padding": INF}, {"padding": 1e300},
    {"threads": -1}, {"threads": 10**6}, {"threads": 2**40}, {"shape": (2**70, 8, 8)}, {"device": "tpu"}, {"device": "cuda:x"}, {"device": "cuda:-1"}, {"device": ""},
    {"method": "fast"}, {"sign": "positive"}, {"sign": so.Sign("shell")}, {"sign": so.Sign("shell", shell=NAN)},
    {"sign": so.Sign(rule="even")}, {"resolution": 8, "spacing": 1}, {"band": 1, "thickness": 1},
    {"resolution": 8, "shape": (8, 8, 8)}, {"spacing": 1, "shape": (8, 8, 8)},
    {"grid": so.Grid((8, 8, 8), (0, 0, 0), (1, 1, 1)), "resolution": 8},
    {"grid": so.Grid((8, 8, 8), (0, 0, 0), (1, 1, 1)), "padding": 1},
]  # fmt: skip

TYPE = [
    {"resolution": 8.0}, {"resolution": "8"}, {"resolution": True}, {"resolution": [8]}, {"spacing": "0.1"},
    {"spacing": True}, {"spacing": ("a", "b", "c")}, {"shape": 8}, {"shape": "888"}, {"shape": (8, 8, 8.0)},
    {"band": "3"}, {"band": [3]}, {"thickness": "3"}, {"thickness": 1j}, {"padding": "2"}, {"padding": None, "band": object()},
    {"grid": (8, 8, 8)}, {"grid": "fit"}, {"threads": "2"}, {"threads": 1.5}, {"device": None},
    {"device": 0}, {"method": None}, {"sign": True}, {"sign": 3}, {"sign": so.Sign(3)}, {"sign": so.Sign(invert="no")},
    {"sign": so.Sign("shell", shell=None)}, {"memory_limit": 1.5}, {"memory_limit": "1G"}, {"progress": 3},
    {"progress": "yes"}, {"resolutoin": 8},
]  # fmt: skip


@pytest.mark.parametrize("options", USAGE, ids=str)
def test_values_that_make_no_sense(options):
    with pytest.raises(ValueError) as caught:
        so.field(MESH, **options)
    assert not isinstance(caught.value, so.InputError)
    assert type(caught.value) in (ValueError, so.UsageError)
    assert len(str(caught.value)) > 15


@pytest.mark.parametrize("options", TYPE, ids=str)
def test_types_that_make_no_sense(options):
    with pytest.raises(TypeError):
        so.field(MESH, **options)


def test_errors_name_the_argument_and_not_the_compiled_function():
    cube = so.Body(shapes.cube())
    query, band, one = so.MeshQuery(MESH, sign=None), so.field(MESH, resolution=8, band=2), np.eye(4)
    for call in (
        lambda **options: so.field(MESH, resolution=8, **options),
        lambda **options: so.field(MESH, resolution=8, band=2, **options),
        lambda **options: so.distance(MESH, [0, 0, 0], **options),
        lambda **options: query.distance([0, 0, 0], **options),
        lambda **options: query.closest([0, 0, 0], **options),
        lambda **options: so.Body(MESH, **options),
        lambda **options: so.collide(cube, cube, one, **options),
        lambda **options: so.sweep(cube, cube, one, one, **options),
    ):
        with pytest.raises(TypeError, match="^threads: must be a whole number, not 1.5"):
            call(threads=1.5)
        with pytest.raises(TypeError, match="^device: must be 'auto', .* not 0"):
            call(device=0)
    for call in (
        lambda threads: band([0, 0, 0], threads=threads),
        lambda threads: band.gradient([0, 0, 0], threads=threads),
        lambda threads: band.save("never.npz", threads=threads),
        lambda threads: so.surface(band, threads=threads),
        lambda threads: so.surface(MESH, resolution=8, threads=threads),
        lambda threads: so.report(MESH, threads=threads),
        lambda threads: so.verify(band, MESH, threads=threads),
        lambda threads: so.distance_between(cube, cube, one, threads=threads),
    ):
        with pytest.raises(TypeError, match="^threads: must be a whole number, not True"):
            call(True)
    for band_width in (-1, np.inf):
        with pytest.raises(ValueError, match=f"^band: must be positive and finite, not {band_width}; leave it out"):
            so.field(MESH, resolution=8, band=band_width)
    with pytest.raises(ValueError, match="^spacing: is too large"):
        so.field(MESH, spacing=10**400)
    with pytest.raises(TypeError, match="^points: must be an array of real numbers, not NoneType"):
        band(None)


@pytest.mark.parametrize(
    "options, needed",
    [
        ({"resolution": 64, "memory_limit": 1000}, 4 * 64**3),
        ({"resolution": 64, "band": 3, "memory_limit": 1000}, 1000),
    ],
)
def test_memory_limits_say_how_much_is_needed(options, needed):
    with pytest.raises(so.LimitError) as caught:
        so.field(MESH, **options)
    assert isinstance(caught.value, MemoryError)
    assert caught.value.bytes_limit == 1000
    assert caught.value.bytes_needed >= needed
    enough = {**options, "memory_limit": 2 * caught.value.bytes_needed}
    so.field(MESH, **enough)


@pytest.mark.parametrize("band", [None, 1])
@pytest.mark.parametrize("resolution", [10**5, 2**31, 2**62])
def test_fields_that_no_machine_holds(resolution, band):
    if band and resolution == 10**5:
        resolution = 10**7
    with pytest.raises(so.LimitError):
        so.field(MESH, resolution=resolution, band=band)


def test_no_limit_at_all():
    for options in ({}, {"band": 1}):
        so.field(MESH, resolution=8, memory_limit=-1, **options)


def test_signs_that_cannot_work():
    with pytest.raises(so.MeshError):
        so.field(shapes.sheet(), resolution=8, sign="parity")
    with pytest.raises(so.Error):
        so.MeshQuery(MESH, sign="flood")


def test_there_is_no_gpu_that_is_not_there():
    count = len(so.devices())
    with pytest.raises(so.DeviceError) as caught:
        so.field(MESH, resolution=8, device=f"cuda:{count}")
    assert isinstance(caught.value, RuntimeError)


@pytest.mark.parametrize(
    "make",
    [
        lambda: so.Grid((1, 1), (0, 0, 0), (1, 1, 1)),
        lambda: so.Grid((1, 1, 0), (0, 0, 0), (1, 1, 1)),
        lambda: so.Grid((1, 1, 1), (0, NAN, 0), (1, 1, 1)),
        lambda: so.Grid((1, 1, 1), (0, INF, 0), (1, 1, 1)),
        lambda: so.Grid((1, 1, 1), (0, 0, 0), (1, 0, 1)),
        lambda: so.Grid((1, 1, 1), (0, 0, 0), (1, -1, 1)),
        lambda: so.Grid((1, 1, 1), (0, 0, 0), (NAN, 1, 1)),
        lambda: so.Grid((1, 1, 1), (0, 0, 0), 1),
        lambda: so.Grid((1.0, 1, 1), (0, 0, 0), (1, 1, 1)),
        lambda: so.Grid(None, None, None),
        lambda: so.Grid((2**40, 2**40, 2**40), (0, 0, 0), (1, 1, 1)),
        lambda: so.Grid.fit(((1, 1, 1), (0, 0, 0))),
        lambda: so.Grid.fit(((0, 0, 0), (NAN, 1, 1))),
        lambda: so.Grid.fit(((0, 0, 0), (INF, 1, 1))),
        lambda: so.Grid.fit("no such mesh.obj"),
        lambda: so.Grid.fit(3),
        lambda: so.DistanceField(),
    ],
)
def test_grids_and_fields_that_cannot_be(make):
    with pytest.raises((ValueError, TypeError, so.LimitError, FileNotFoundError)):
        make()


def test_every_exception_is_one_of_ours_and_one_of_pythons():
    pythons = {so.UsageError: ValueError, so.InputError: ValueError, so.MeshError: so.InputError, so.DoubtError: so.MeshError,
               so.OutputError: OSError, so.LimitError: MemoryError, so.DeviceError: RuntimeError, so.VerifyError: ValueError}  # fmt: skip
    for ours, theirs in pythons.items():
        assert issubclass(ours, so.Error) and issubclass(ours, theirs)
        error = ours("what happened")
        assert str(error) == "what happened"
        assert [
            getattr(error, name) for name in ("triangle", "file", "line", "byte", "bytes_needed", "bytes_limit")
        ] == [None] * 6
    assert issubclass(so.SignWarning, UserWarning)


def test_errors_can_be_pickled():
    import pickle

    with pytest.raises(so.MeshError) as caught:
        so.field((shapes.cube()[0], np.array([[0, 1, 9]])))
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is so.MeshError and str(again) == str(caught.value) and again.triangle == 0


def test_a_field_is_made_by_a_function():
    values = np.zeros((4, 4, 4), np.float32)
    for make in (
        lambda: so.DistanceField(values, so.Grid((4, 4, 4), (0, 0, 0), (1, 1, 1))),
        lambda: so.DistanceField(),
        lambda: so.DistanceField(grid=1),
    ):
        with pytest.raises(
            TypeError, match=r"DistanceField\.from_numpy\(values, grid\).*standoff\.field.*standoff\.load"
        ):
            make()
