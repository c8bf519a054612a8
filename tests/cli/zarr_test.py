# SPDX-License-Identifier: Apache-2.0
"""Zarr stores in the program: every verb takes them, and none writes over what is not a store of its own."""

import filecmp
import json
import os
import shutil
from pathlib import Path

import numpy as np
from program import run


def files_of(store):
    return {path.relative_to(store): path.read_bytes() for path in Path(store).rglob("*") if path.is_file()}


def compute_and_convert():
    run("compute", "scene:box", "-r", "40", "-t", "3s", "-o", "a.vti")
    ran = json.loads(run("compute", "scene:box", "-r", "40", "-t", "3s", "-o", "a.zarr", "--json").stdout)
    assert ran["output"]["bytes"] == sum(map(len, files_of("a.zarr").values()))
    run("convert", "a.vti", "-o", "b.zarr")
    assert files_of("a.zarr") == files_of("b.zarr")
    run("convert", "b.zarr/", "-o", "b.npz")  # with a slash, as shells complete it
    run("convert", "a.vti", "-o", "a.npz")
    assert filecmp.cmp("a.npz", "b.npz", shallow=False)
    run("compute", "scene:box", "-r", "40", "-t", "3s", "--with", "nearest", "-o", "n.zarr")
    run("convert", "n.zarr", "-o", "n.npz")
    assert (np.load("n.npz")["nearest_triangle"] < 2**32 - 1).any()


def look_at_it():
    # Of a store info reads the metadata alone: nothing else need be there.
    shutil.copytree("a.zarr", "bare.zarr")
    shutil.rmtree("bare.zarr/0/c")
    full, bare, vti = (json.loads(run("info", name, "--json").stdout) for name in ("a.zarr", "bare.zarr", "a.vti"))
    for key in ("grid", "thickness", "mesh"):
        assert full[key] == bare[key] == vti[key]
    assert full["store"]["shard"] == [128, 128, 128] and full["store"]["chunk"] == [32, 32, 32]
    assert "shards of 128 x 128 x 128" in run("info", "a.zarr").stdout
    run("verify", "a.zarr", "scene:box")
    run("surface", "a.zarr", "-o", "a.ply")
    run("surface", "a.vti", "-o", "b.ply")
    assert filecmp.cmp("a.ply", "b.ply", shallow=False)
    # A plane that is named is read alone, and shows the same.
    for plane in (["--axis", "x", "--index", "7"], ["--axis", "z", "--at", "0.4"], ["--axis", "y"], []):
        run("slice", "a.zarr", "-o", "a.png", "-f", "--title", "box", *plane)
        run("slice", "a.vti", "-o", "b.png", "-f", "--title", "box", *plane)
        assert filecmp.cmp("a.png", "b.png", shallow=False), plane
    refused = [run("slice", name, "-o", "c.png", "--axis", "x", "--index", "400", code=2).stderr for name in ("a.zarr", "a.vti")]
    assert refused[0] == refused[1]


def write_over():
    before = files_of("a.zarr")
    assert "it exists; give -f" in run("compute", "scene:box", "-o", "a.zarr", code=2).stderr
    assert files_of("a.zarr") == before
    run("compute", "scene:box", "-r", "20", "-o", "a.zarr", "-f")
    assert files_of("a.zarr") != before
    os.makedirs("mine.zarr/data")
    Path("mine.zarr/data/notes").write_text("mine")
    ran = run("compute", "scene:box", "-r", "20", "-o", "mine.zarr", "-f", code=4)
    assert "a folder is there that is not a Zarr store of standoff" in ran.stderr
    assert Path("mine.zarr/data/notes").read_text() == "mine"
    assert "its index alone has" in broken("b.zarr").stderr
    assert not list(Path(".").glob(".standoff-*"))


def levels():
    run("compute", "scene:box", "-r", "100", "-t", "3s", "-o", "l.zarr", "--levels", "3")
    run("compute", "scene:box", "-r", "100", "-t", "3s", "-o", "l.npz")
    run("convert", "l.npz", "-o", "m.zarr/", "--levels", "3")  # a new one, with a slash
    assert files_of("l.zarr") == files_of("m.zarr")
    field = np.load("l.npz")["distance"]
    for level in range(3):
        run("convert", "l.zarr", "--level", str(level), "-o", f"l{level}.npz")
        np.testing.assert_array_equal(np.load(f"l{level}.npz")["distance"], field[:: 2**level, :: 2**level, :: 2**level])
        run("verify", "l.zarr", "scene:box", "--level", str(level))
    assert json.loads(run("info", "l.zarr", "--json").stdout)["store"]["levels"][1]["size"] == [50, *(-(-n // 2) for n in field.shape[1:])]
    assert "levels        3: " in run("info", "l.zarr").stdout
    # The array of a level is a store, too.
    for words in (["l.zarr", "--level", "2"], ["l.zarr/2"], ["l.zarr/2/"]):
        run("slice", *words, "-o", "l.png", "-f", "--axis", "z", "--index", "3", "--title", "l")
        run("surface", *words, "-o", "l.ply", "-f")
        found = Path("l.png").read_bytes(), Path("l.ply").read_bytes(), json.loads(run("info", *words, "--json").stdout)["grid"]
        assert words == ["l.zarr", "--level", "2"] or found == before
        before = found
    # What is looked at is the finest level that the memory allows.
    ran = run("view", "l.zarr", "-o", "l.html", "--memory-limit", "2M")
    assert "l.zarr: level 1, 50 x" in ran.stderr, ran.stderr
    assert "need more than" in run("view", "l.zarr", "-o", "l.html", "-f", "--memory-limit", "1K", code=5).stderr
    assert "is no .zarr store" in run("slice", "l.npz", "-o", "n.png", "--level", "1", code=2).stderr
    assert "is no store; write .zarr" in run("compute", "scene:box", "-o", "n.vti", "--levels", "2", code=2).stderr
    assert "there is no level 3; it has levels 0 to 2; give one that it has" in run("info", "l.zarr", "--level", "3", code=2).stderr
    assert "9 levels; of this grid give 1 to 8" in run("convert", "l.npz", "-o", "o.zarr", "--levels", "9", code=2).stderr


def verify_in_parts():
    # Fields whose tiles are more than the limit allows together, and not in parts; the answers are those without it.
    run("compute", "scene:sphere:2000", "-r", "300", "-t", "2s", "-o", "v.vti")
    run("convert", "v.vti", "-o", "raw.vti", "--uncompressed")
    run("convert", "v.vti", "-o", "v.zarr")
    limit = ["--memory-limit", "12M"]
    assert "more than" in run("convert", "v.vti", "-o", "w.vdb", *limit, code=5).stderr
    seen = []
    for name, some in (("v.vti", []), ("v.vti", limit), ("raw.vti", limit), ("v.zarr", limit)):
        checked = json.loads(run("verify", name, "scene:sphere:2000", "--json", *some).stdout)
        del checked["field"]
        run("surface", name, "-o", "v.ply", "-f", "--memory-limit", "48M")
        run("convert", name, "-o", "w.vti", "-f", *some)
        run("slice", name, "-o", "v.png", "-f", "--axis", "z", "--at", "0.4", "--title", "v", *some)
        seen.append((checked, *(Path(made).read_bytes() for made in ("v.ply", "w.vti", "v.png"))))
        for one, first in zip(seen[-1], seen[0]):
            assert one == first, name
    assert seen[0][0]["ok"] and seen[0][2] == Path("v.vti").read_bytes()


def broken(store):
    os.truncate(f"{store}/0/c/0/0/0", 100)
    return run("verify", store, "scene:box", code=3)


if __name__ == "__main__":
    compute_and_convert()
    look_at_it()
    levels()
    verify_in_parts()
    write_over()
