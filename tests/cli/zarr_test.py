# SPDX-License-Identifier: Apache-2.0
"""Zarr stores in the program: every verb takes them, and none writes over what is not a store of its own."""

import filecmp
import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

STANDOFF = os.environ["STANDOFF"]


def run(*words, code=0):
    ran = subprocess.run([STANDOFF, *words], capture_output=True, text=True)
    assert ran.returncode == code, (words, ran.returncode, ran.stderr)
    return ran


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


def broken(store):
    os.truncate(f"{store}/0/c/0/0/0", 100)
    return run("verify", store, "scene:box", code=3)


if __name__ == "__main__":
    compute_and_convert()
    look_at_it()
    write_over()
