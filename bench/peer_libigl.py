# SPDX-License-Identifier: Apache-2.0
"""peer_libigl.py MESH SIDE QUERIES: libigl's fast winding number at samples of a cubic grid around a mesh, and its exact
winding number at fewer of them: a JSON line. Needs a Python with libigl and numpy (pip install libigl)."""

import json
import sys
import time

import igl
import numpy as np


def read(path):
    vertices, faces = igl.read_triangle_mesh(path)
    return np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64)


def rate(call, points):
    began = time.perf_counter()
    values = call(points)
    return len(points) / (time.perf_counter() - began), values


def main():
    path, side, queries = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    vertices, faces = read(path)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    spacing = (high - low).max() / (side - 1)
    origin = (low + high) / 2 - spacing * (side - 1) / 2
    random = np.random.default_rng(1)
    points = origin + spacing * random.integers(0, side, size=(queries, 3))
    igl.fast_winding_number(vertices, faces, points[:1])
    fast_rate, fast = rate(lambda p: igl.fast_winding_number(vertices, faces, p), points)
    few = points[: max(1, queries // 100)]
    exact_rate, exact = rate(lambda p: igl.winding_number(vertices, faces, p), few)
    clear = np.abs(exact - 0.5) > 1e-6
    wrong = int(((fast[: len(few)] > 0.5) != (exact > 0.5))[clear].sum())
    print(json.dumps({"driver": "libigl", "fast_per_s": fast_rate, "exact_per_s": exact_rate, "queries": len(points),
                      "compared": len(few), "fast_wrong": wrong}))


if __name__ == "__main__":
    main()
