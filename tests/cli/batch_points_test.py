# SPDX-License-Identifier: Apache-2.0
"""What NumPy reads of standoff batch: training points and fields."""

import json
import pathlib

import numpy as np
from program import run


def rows(folder):
    return [json.loads(line) for line in pathlib.Path(folder, "manifest.jsonl").read_text().splitlines()]


pathlib.Path("list.txt").write_text("scene:sphere:5000\nscene:terrain:5000\n")
run("batch", "list.txt", "-o", "points", "--points", "2000", "--normalize", "unit-sphere", "--near", "0.5", "--sigma", "0.1,0.01")
sphere, terrain = sorted(rows("points"), key=lambda row: row["index"])
made = np.load(pathlib.Path("points", sphere["output"]["file"]))
points, distances = made["points"], made["distances"]
assert points.shape == (2000, 3) and points.dtype == np.float32 and distances.shape == (2000,) and distances.dtype == np.float32
assert sphere["points"] == 2000 and made["sign"] == sphere["sign"]["method"] == "winding"
# A polyhedron inscribed in the unit sphere.
assert np.abs(distances - (np.linalg.norm(points, axis=1) - 1)).max() < 0.01
assert terrain["sign"]["method"] == "" and np.load(pathlib.Path("points", terrain["output"]["file"]))["sign"] == ""

run("batch", "list.txt", "-o", "fields", "-r", "32", "-t", "3s")
field = np.load(pathlib.Path("fields", sorted(rows("fields"), key=lambda row: row["index"])[0]["output"]["file"]))
assert field["distance"].shape == (32, 32, 32) and (field["distance"] < 0).any()
