# SPDX-License-Identifier: Apache-2.0
"""many_fields.py LIBRARY COUNT [FOLDER]: bands of 64 samples of COUNT meshes of 1,000 to 20,000 triangles, from files, on all
cores; one JSON line. LIBRARY is standoff, with its own fields(), or open3d, in a pool of processes with one thread each. The
meshes are made, or are those that batch.py has made in FOLDER. Returns 3 if this Python lacks the library."""

import json
import multiprocessing
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

RESOLUTION, BAND = 64, 3
LIMIT = 40  # seconds for Open3D; then what is done stands for all


def bumpy_ball(rng, rows):
    """A closed mesh of 4 * rows * (rows - 1) triangles: a sphere with random bumps."""
    columns = 2 * rows
    latitude = np.pi * np.arange(1, rows) / rows
    longitude = 2 * np.pi * np.arange(columns) / columns
    lat, lon = np.meshgrid(latitude, longitude, indexing="ij")
    points = np.stack([np.sin(lat) * np.cos(lon), np.sin(lat) * np.sin(lon), np.cos(lat)], axis=-1).reshape(-1, 3)
    points = np.concatenate([points, [[0, 0, 1], [0, 0, -1]]])
    for _ in range(6):
        points = points * (1 + 0.15 * np.sin(3 * points @ rng.normal(size=3) + rng.uniform(0, 6)))[:, None]
    north, south = len(points) - 2, len(points) - 1
    at = np.arange(rows - 1)[:, None] * columns + np.arange(columns)
    nxt = np.roll(at, -1, axis=1)
    faces = [np.stack([at[:-1], at[1:], nxt[1:]], -1), np.stack([at[:-1], nxt[1:], nxt[:-1]], -1),
             np.stack([np.full(columns, north), at[0], nxt[0]], -1), np.stack([np.full(columns, south), nxt[-1], at[-1]], -1)]
    return points, np.concatenate([f.reshape(-1, 3) for f in faces])


def write_meshes(folder, count, formats=("obj", "ply", "stl")):
    """Files of these formats in turns; the same for every library."""
    rng = np.random.default_rng(1)
    paths, triangles = [], 0
    for n in range(count):
        vertices, faces = bumpy_ball(rng, int(rng.integers(17, 72)))
        triangles += len(faces)
        path = Path(folder) / f"{n}.{formats[n % len(formats)]}"
        write(path, vertices, faces)
        paths.append(str(path))
    return paths, triangles


def write(path, vertices, faces):
    if path.suffix == ".obj":
        lines = ["v %.6g %.6g %.6g" % tuple(v) for v in vertices] + ["f %d %d %d" % tuple(f + 1) for f in faces]
        path.write_text("\n".join(lines) + "\n")
        return
    with open(path, "wb") as file:
        if path.suffix == ".ply":
            file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
                        f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode())
            file.write(vertices.astype("<f4").tobytes())
            rows = np.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
            rows["n"], rows["v"] = 3, faces
            file.write(rows.tobytes())
        elif path.suffix == ".glb":
            file.write(glb(vertices.astype("<f4"), faces.astype("<u4")))
        else:
            file.write(b"\0" * 80 + np.uint32(len(faces)).tobytes())
            rows = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
            rows["corners"] = vertices[faces]
            file.write(rows.tobytes())


def glb(vertices, faces):
    """Binary glTF of one mesh; its indices come first."""
    indices, positions = faces.tobytes(), vertices.tobytes()
    text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
                       "buffers": [{"byteLength": len(indices) + len(positions)}],
                       "bufferViews": [{"buffer": 0, "byteLength": len(indices)},
                                       {"buffer": 0, "byteOffset": len(indices), "byteLength": len(positions)}],
                       "accessors": [{"bufferView": 0, "componentType": 5125, "count": faces.size, "type": "SCALAR"},
                                     {"bufferView": 1, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                                      "min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()}]})
    chunks = b""
    for kind, data in ((b"JSON", text.encode() + b" " * (-len(text) % 4)), (b"BIN\0", indices + positions)):
        chunks += np.uint32(len(data)).tobytes() + kind + data
    return b"glTF" + np.uint32([2, 12 + len(chunks)]).tobytes() + chunks


def with_standoff(paths):
    import standoff

    return [result.unwrap().signed for result in standoff.fields(paths, resolution=RESOLUTION, band=BAND)]


def grid_points(low, high):
    """The samples of the same grid as ours, about."""
    side = (high - low).max()
    spacing = side / (RESOLUTION - 1 - 2 * BAND)
    axes = [np.arange(l - BAND * spacing, h + (BAND + 0.5) * spacing, spacing, dtype=np.float32) for l, h in zip(low, high)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def one_with_open3d(path):
    import open3d

    mesh = open3d.t.io.read_triangle_mesh(path)
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(mesh)
    low, high = (mesh.get_min_bound().numpy(), mesh.get_max_bound().numpy())
    values = scene.compute_signed_distance(open3d.core.Tensor(grid_points(low, high)), nthreads=1)
    return bool((values.numpy() < 0).any())


def with_open3d(paths):
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        began, done = time.perf_counter(), []
        for has_inside in pool.imap(one_with_open3d, paths):
            done.append(has_inside)
            if time.perf_counter() - began > LIMIT:
                break
        return done


def main():
    library, count = sys.argv[1], int(sys.argv[2])
    try:
        __import__(library)
    except ImportError:
        return 3
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) > 3:
            listing = json.loads(Path(sys.argv[3], "meshes.json").read_text())
            paths, triangles = listing["paths"][:count], listing["triangles"]
        else:
            paths, triangles = write_meshes(folder, count)
        began, before = time.perf_counter(), os.times()
        inside = {"standoff": with_standoff, "open3d": with_open3d}[library](paths)
        share = len(inside) / count
        seconds, after = time.perf_counter() - began, os.times()
    busy = sum(after[:4]) - sum(before[:4])
    print(json.dumps({"library": library, "meshes": count, "triangles": triangles, "done": len(inside), "with inside": sum(inside),
                      "s": round(seconds / share, 3), "processor s": round(busy / share, 3), "cores busy": f"{100 * busy / seconds / os.cpu_count():.0f} %",
                      "meshes per s": round(count * share / seconds, 2)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
