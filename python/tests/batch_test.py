# SPDX-License-Identifier: Apache-2.0
"""Files of many meshes by standoff.batch: what the program makes, and what becomes of its errors."""

import os
from pathlib import Path

import numpy as np
import pytest
import standoff as so

SPHERES = [f"scene:sphere:{100 + 20 * n}" for n in range(5)]


def test_fields_are_those_of_field(bunny_path, tmp_path):
    result = so.batch([bunny_path], tmp_path / "out", resolution=24, band=3, format="vti")
    [row] = result.rows()
    stored = so.load(tmp_path / "out" / row["output"]["file"])
    field = so.field(bunny_path, resolution=24, band=3)
    assert np.array_equal(stored.numpy(), field.numpy()) and stored.grid == field.grid
    assert result.summary["counts"] == {"ok": 1}
    assert result.failures() == []


def test_a_list_may_be_an_iterator_a_file_or_a_folder(bunny_path, tmp_path):
    options = {"resolution": 16, "threads": 1}
    assert len(list(so.batch(iter(SPHERES), tmp_path / "a", **options).rows())) == 5
    (tmp_path / "list.txt").write_text("\n".join(SPHERES))
    assert [row["path"] for row in so.batch(tmp_path / "list.txt", tmp_path / "b", **options).rows()] == SPHERES
    (tmp_path / "meshes").mkdir()
    name = os.fsdecode(b"line\nend \xff.obj")
    (tmp_path / "meshes" / name).write_bytes(Path(bunny_path).read_bytes())
    for meshes in (tmp_path / "meshes", [tmp_path / "meshes" / name]):
        [row] = so.batch(meshes, tmp_path / f"out-{isinstance(meshes, list)}", **options).rows()
        assert row["status"] == "ok"


def test_failures_are_rows_and_resume_goes_on(bunny_path, tmp_path):
    bad = tmp_path / "bad.obj"
    bad.write_text("no mesh")
    result = so.batch([bunny_path, bad], tmp_path / "out", resolution=16)
    assert [row["status"] for row in result.failures()] == ["input"]
    assert "bad.obj" in result.failures()[0]["message"]
    bad.write_bytes(Path(bunny_path).read_bytes())
    again = so.batch([bunny_path, bad], tmp_path / "out", resolution=16, resume=True)
    assert again.summary["skipped"] == 1 and again.failures() == []


def test_options_reach_the_program(tmp_path):
    def row(name, **options):
        return next(so.batch(SPHERES[:1], tmp_path / name, **options).rows())

    assert row("shape", shape=(9, 10, 11))["grid"]["size"] == [9, 10, 11]
    assert row("spacing", spacing=0.5, padding=1)["grid"]["spacing"] == [0.5, 0.5, 0.5]
    assert row("thick", resolution=16, thickness=0.25)["thickness"] == 0.25
    assert row("none", resolution=16, sign=None)["sign"]["method"] == ""
    shell = row("shell", resolution=16, sign=so.Sign("shell", shell=0.5), normalize="unit-sphere")
    assert shell["sign"]["method"] == "shell" and shell["normalization"]["kind"] == "unit-sphere"
    assert row("kept", resolution=16, cache=tmp_path / "cache")["cached"] is False
    assert row("again", resolution=16, cache=tmp_path / "cache")["cached"] is True
    made = row("points", points=100, near=1.0, sigma=(0.0, 0.0), seed=3)
    stored = np.load(tmp_path / "points" / made["output"]["file"])
    assert stored["points"].shape == (100, 3) and np.abs(stored["distances"]).max() < 1e-6
    parts = [so.batch(SPHERES, tmp_path / "parts", resolution=16, shard=(n, 2), memory_limit=10**9) for n in (1, 2)]
    assert [len(list(part.rows())) for part in parts] == [3, 2]


@pytest.mark.parametrize(
    ("error", "part", "meshes", "options"),
    [
        (so.InputError, "there is no mesh in it", [], {}),
        (so.UsageError, "it exists; give --resume", SPHERES[:1], {"out": "there"}),
        (so.OutputError, "cannot make the folder", SPHERES[:1], {"out": "file"}),
        (so.UsageError, "--format", SPHERES[:1], {"format": "png"}),
        (ValueError, "band and thickness", SPHERES[:1], {"band": 3, "thickness": 1.0}),
        (TypeError, "resolution", SPHERES[:1], {"resolution": "many"}),
        (TypeError, "sign", SPHERES[:1], {"sign": 3}),
    ],
)
def test_errors(error, part, meshes, options, tmp_path):
    (tmp_path / "file").write_text("")
    so.batch(SPHERES[:1], tmp_path / "there", resolution=8)
    with pytest.raises(error, match=part):
        so.batch(meshes, tmp_path / options.pop("out", "out"), **{"resolution": 8, **options})


def test_an_iterable_that_fails_stops_the_program(tmp_path):
    def paths():
        yield SPHERES[0]
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        so.batch(paths(), tmp_path / "out", resolution=8)
    assert so.batch(SPHERES, tmp_path / "out", resolution=8, resume=True).failures() == []
