#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What others do with signs: the tables of docs/sign_peers.md.

    "$STANDOFF_PEER_PYTHON" bench/sign_peers.py STANDOFF

STANDOFF is the program. The Python needs numpy, libigl, open3d, trimesh and rtree (pip install them into an environment).
All ask the same 21^3 samples about small bodies whose inside has a closed form. A mesh that is damaged stands for the body
it was made from. Samples on the surface of that body, or within 1e-6 of its extent, do not count."""

import importlib.metadata
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import igl
import numpy as np
import open3d as o3d
import trimesh

SIDE = 21


def cube(low, high):
    box = trimesh.creation.box(bounds=[[low] * 3, [high] * 3])
    return np.array(box.vertices), np.array(box.faces, dtype=np.int64)


def within(*boxes):
    return lambda p: np.any([((p > low) & (p < high)).all(axis=1) for low, high in boxes], axis=0)


def behind_all_faces(vertices, faces):
    """The inside of a convex body."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return lambda p: (p @ normals.T < (normals * corners[:, 0]).sum(axis=1)).all(axis=1)


def two_cubes():
    (a, faces), (b, _) = cube(0, 1), cube(0.5, 1.5)
    return np.vstack([a, b]), np.vstack([faces, faces + len(a)])


def cases():
    """(what, vertices, faces, faces of the body, inside, least and largest coordinate of the samples)."""
    v, f = cube(0, 1)
    unit = within((0, 1)), -0.5, 1.5
    ball = trimesh.creation.icosphere(3)
    bv, bf = np.array(ball.vertices), np.array(ball.faces, dtype=np.int64)
    lid = (v[f][:, :, 2] == 1).all(axis=1)
    return [
        ("cube", v, f, f, *unit),
        ("ball of 1280 triangles", bv, bf, bf, behind_all_faces(bv, bf), -1.5, 1.5),
        ("cube of side 1e-6", v * 1e-6, f, f, within((0, 1e-6)), -0.5e-6, 1.5e-6),
        ("two cubes that overlap", *two_cubes(), two_cubes()[1], within((0, 1), (0.5, 1.5)), -0.5, 2),
        ("cube, inside out", v, f[:, ::-1].copy(), f, *unit),
        ("cube, one triangle flipped", v, np.vstack([f[:1, ::-1], f[1:]]), f, *unit),
        ("cube, one triangle twice", v, np.vstack([f, f[:1]]), f, *unit),
        ("the same, opposite", v, np.vstack([f, f[:1, ::-1]]), f, *unit),
        ("cube, one triangle missing", v, f[1:], f, *unit),
        ("cube without a lid", v, f[~lid], f, *unit),
    ]


def write_obj(path, vertices, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    path.write_text("\n".join(lines) + "\n")


def standoff(program, vertices, faces, low, high):
    """The samples' positions, x slowest, and the values of `compute --sign auto`."""
    with tempfile.TemporaryDirectory() as folder:
        mesh, field = Path(folder) / "mesh.obj", Path(folder) / "field.npz"
        write_obj(mesh, vertices, faces)
        bounds = ",".join(repr(float(c)) for c in [low] * 3 + [high] * 3)
        done = subprocess.run([program, "compute", str(mesh), "--sign", "auto", "-q", "--json", "-o", str(field),
                               f"--bounds={bounds}", "--size", f"{SIDE},{SIDE},{SIDE}"], stdout=subprocess.PIPE, text=True)
        if done.returncode:
            raise SystemExit("sign_peers: standoff failed")
        grid = json.loads(done.stdout)["grid"]
        axes = [origin + spacing * np.arange(SIDE) for origin, spacing in zip(grid["origin"], grid["spacing"])]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        return points, np.load(field)["distance"].reshape(-1)


def by_libigl(kind):
    return lambda points, v, f: igl.signed_distance(points, v, f, getattr(igl.SignedDistanceType, f"SIGNED_DISTANCE_TYPE_{kind}"))[0]


def by_open3d(rays):
    def ask(points, v, f):
        scene = o3d.t.geometry.RaycastingScene()
        scene.add_triangles(o3d.core.Tensor(v.astype(np.float32)), o3d.core.Tensor(f.astype(np.uint32)))
        return scene.compute_signed_distance(o3d.core.Tensor(points.astype(np.float32)), nsamples=rays).numpy()
    return ask


def of_trimesh(v, f):
    return trimesh.Trimesh(v, f, process=False)


PEERS = {
    "libigl, pseudonormal": by_libigl("PSEUDONORMAL"),
    "libigl, winding number": by_libigl("WINDING_NUMBER"),
    "libigl, fast winding number": by_libigl("FAST_WINDING_NUMBER"),
    "Open3D, 1 ray": by_open3d(1),
    "Open3D, vote of 11 rays": by_open3d(11),
    "trimesh, signed_distance": lambda points, v, f: -trimesh.proximity.signed_distance(of_trimesh(v, f), points),
    "trimesh, contains": lambda points, v, f: np.where(of_trimesh(v, f).contains(points), -np.inf, np.inf),
}


def distance_to(points, v, f):
    return np.sqrt(igl.point_mesh_squared_distance(points, v, f)[0])


def shown(value, distance, inside, counts, extent):
    """Samples on the wrong side, and the largest error of a magnitude as a share of the extent, where there is one."""
    wrong = int(((value < 0) != inside)[counts].sum())
    if not np.isfinite(value).all():
        return str(wrong)
    error = np.abs(np.abs(value) - distance).max() / extent
    return f"{wrong}" if error < 1e-5 else f"{wrong}; {100 * error:{'.0f' if error > 0.1 else '.2g'}} %"


def markdown(rows):
    keys = list(rows[0])
    lines = ["| " + " | ".join(keys) + " |", "|---|" + "---:|" * (len(keys) - 1)]
    print("\n".join(lines + ["| " + " | ".join(row.values()) + " |" for row in rows]) + "\n")


def sides(program):
    rows = []
    for what, v, f, body, inside_of, low, high in cases():
        points, ours = standoff(program, v, f, low, high)
        extent = float(np.ptp(v, axis=0).max())
        distance = distance_to(points, v, f)
        inside, counts = inside_of(points), distance_to(points, v, body) > 1e-6 * extent
        row = {"mesh": what, "samples": str(counts.sum()), "standoff, auto": shown(ours, distance, inside, counts, extent)}
        rows.append(row | {name: shown(ask(points, v, f), distance, inside, counts, extent) for name, ask in PEERS.items()})
    markdown(rows)


def overlap():
    points = np.array([(0.25, 0.25, 0.25), (0.6, 0.7, 0.8), (0.75, 0.75, 0.75), (1.2, 1.2, 1.2), (2, 2, 2)])
    v, f = two_cubes()
    asked = {name: ask(points, v, f) for name, ask in PEERS.items() if "contains" not in name}
    winding, distance = igl.winding_number(v, f, points), distance_to(points, v, f)
    markdown([{"point": ", ".join(f"{c:g}" for c in p), "w": f"{winding[n]:.0f}", "distance": f"{distance[n]:.4g}"} |
              {name: f"{values[n]:.4g}" for name, values in asked.items()} for n, p in enumerate(points)])


if __name__ == "__main__":
    print(", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("libigl", "open3d", "trimesh", "rtree")) + "\n")
    sides(sys.argv[1])
    overlap()
