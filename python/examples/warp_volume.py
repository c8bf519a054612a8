# SPDX-License-Identifier: Apache-2.0
"""Hands a field to NVIDIA Warp as a sparse volume, and samples it in a kernel. Needs warp-lang; runs on its CPU or a GPU.

    python warp_volume.py bunny.obj

Newton takes the same volume: newton.SDF.create_from_data(sparse_volume=volume, ...).
"""

from __future__ import annotations

import io
import sys

import numpy as np
import standoff as so
import warp as wp


@wp.kernel
def sample(volume: wp.uint64, points: wp.array(dtype=wp.vec3), out: wp.array(dtype=float)):
    n = wp.tid()
    place = wp.volume_world_to_index(volume, points[n])
    out[n] = wp.volume_sample_f(volume, place, wp.Volume.LINEAR)


def main(path: str) -> float:
    wp.init()
    mesh = so.read(path)
    field = so.field(mesh, resolution=128, band=4)
    volume = wp.Volume.load_from_nvdb(io.BytesIO(field.to_bytes("nvdb")))

    corners = np.asarray(mesh.vertices)[np.asarray(mesh.faces[:1000])]
    points = corners.mean(axis=1) + np.random.default_rng(1).normal(scale=field.grid.spacing[0], size=(1000, 3))
    asked = wp.array(points.astype(np.float32), dtype=wp.vec3)
    out = wp.empty(len(points), dtype=float)
    wp.launch(sample, len(points), inputs=[volume.id, asked, out])
    difference = float(np.abs(out.numpy() - field(points)).max())
    print(f"largest difference between Warp and standoff: {difference / field.grid.spacing[0]:.1e} spacings")
    return difference / field.grid.spacing[0]


if __name__ == "__main__":
    main(sys.argv[1])
