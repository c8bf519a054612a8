# SPDX-License-Identifier: Apache-2.0
"""so.field(cache=): fields that were computed before are the same, and lie where the program looks for them."""

import json
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import standoff as so
from standoff._program import PROGRAM

WAYS = [
    {"resolution": 32},
    {"resolution": 32, "band": 3},
    {"shape": (20, 18, 22), "thickness": 0.02, "sign": so.Sign("winding", invert=True)},
]


def same(a, b):
    assert np.array_equal(a.numpy(), b.numpy()) and a.grid == b.grid and a.thickness == b.thickness
    assert a.provenance == b.provenance and a.sign == b.sign


@pytest.mark.parametrize("way", WAYS)
def test_it_is_the_same_field(bunny_path, tmp_path, way):
    plain = so.field(bunny_path, **way)
    first = so.field(bunny_path, **way, cache=tmp_path / "kept")
    again = so.field(bunny_path, **way, cache=tmp_path / "kept")
    assert first.computation["cached"] is False and again.computation["cached"] is True
    assert "cached" not in plain.computation
    same(first, plain)
    same(again, plain)
    for n, field in enumerate((plain, first, again)):
        field.save(tmp_path / f"{n}.vti")
    assert len({(tmp_path / f"{n}.vti").read_bytes() for n in range(3)}) == 1


def test_the_program_and_python_share_it(bunny_path, tmp_path):
    def program(output, *options):
        words = [
            PROGRAM,
            "compute",
            bunny_path,
            "-o",
            tmp_path / output,
            "--cache",
            tmp_path / "kept",
            "--json",
            "-q",
            *options,
        ]
        return json.loads(subprocess.run(words, capture_output=True, check=True, timeout=60).stdout)["cached"]

    def python(**options):
        return so.field(bunny_path, cache=tmp_path / "kept", **options).computation["cached"]

    assert not program("a.npz", "-r", "24", "-t", "3s") and python(resolution=24, band=3)
    assert not python(resolution=25, sign=so.Sign("winding", invert=True)) and program(
        "b.npz", "-r", "25", "--sign", "winding", "--invert"
    )
    result = so.batch([bunny_path], tmp_path / "out", resolution=26, band=2, cache=tmp_path / "kept")
    assert not next(result.rows())["cached"] and python(resolution=26, band=2)
    field = so.field(bunny_path, resolution=25, sign=so.Sign("winding", invert=True))
    assert np.array_equal(so.load(tmp_path / "b.npz").numpy(), field.numpy())


def test_a_damaged_entry_is_made_anew_and_told_once(bunny_path, tmp_path, recwarn):
    options = {"resolution": 20, "band": 3, "cache": tmp_path / "kept"}
    plain = so.field(bunny_path, **options)
    [kept] = tmp_path.glob("kept/*/*.npz")
    [about] = tmp_path.glob("kept/*/*.json")
    for path in (kept, about):
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
        with pytest.warns(RuntimeWarning, match="is damaged; the field is computed and kept anew"):
            same(so.field(bunny_path, **options), plain)
        assert path.read_bytes() == whole
        assert so.field(bunny_path, **options).computation["cached"] is True
    kept.unlink()
    assert so.field(bunny_path, **options).computation["cached"] is False
    assert len(recwarn) == 0


def test_many_writers(bunny_path, tmp_path):
    with ThreadPoolExecutor(8) as pool:
        fields = list(
            pool.map(
                lambda _: so.field(bunny_path, resolution=24, band=3, threads=1, cache=tmp_path / "kept"), range(16)
            )
        )
    for field in fields:
        same(field, fields[0])
    assert len([path for path in tmp_path.rglob("kept/*/*")]) == 2


def test_what_cannot_be(bunny_path, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(so.OutputError, match="a file is in the way|cannot make the folder of the cache"):
        so.field(bunny_path, resolution=16, cache=tmp_path / "file")
    for other in ({"nearest": True}, {"out": np.empty((3, 3, 3), np.float32, order="F")}):
        with pytest.raises(ValueError, match="cache: it keeps distances"):
            so.field(bunny_path, resolution=16, cache=tmp_path / "kept", **other)
    with pytest.raises(TypeError, match="cache: must be a string"):
        so.field(bunny_path, resolution=16, cache=3)
    # A cache that cannot be written takes no field away.
    (tmp_path / "kept").mkdir(exist_ok=True)
    Path(tmp_path, "full").mkdir()
    for n in range(256):
        Path(tmp_path, "full", f"{n:02x}").write_text("")
    with pytest.warns(RuntimeWarning, match="the field is not kept in the cache"):
        assert so.field(bunny_path, resolution=16, cache=tmp_path / "full").computation["cached"] is False
