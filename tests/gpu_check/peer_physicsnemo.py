# SPDX-License-Identifier: Apache-2.0
"""peer_physicsnemo.py [--once] FILE.bin...: PhysicsNeMo's signed_distance_field at the jobs that `measure --export` wrote.

It takes tensors of vertices, triangles and points, and searches no farther than the thickness: device memory to device
memory, the median of some runs by CUDA events (on a machine without a GPU PhysicsNeMo runs on the CPU, to try this). The
points of the grid are made before. Each call builds Warp's tree of the mesh anew, and finds closest points, faces and
signs too: all of that is in the time, so no time of the tree stands apart. A CSV line for each job, with how far
PhysicsNeMo's distances, by magnitude, are from ours at most.
"""

import time

import numpy as np
import peer_jobs
import torch
import warp as wp
from physicsnemo.core.version_check import get_installed_version
from physicsnemo.nn.functional import signed_distance_field


def points_of(job, device):
    """A row a sample, x fastest."""
    x, y, z = (
        torch.from_numpy((origin + spacing * np.arange(n)).astype(np.float32)).to(device)
        for origin, spacing, n in zip(job["origin"], job["spacing"], job["size"])
    )
    zs, ys, xs = torch.meshgrid(z, y, x, indexing="ij")
    return torch.stack([xs, ys, zs], dim=-1).reshape(-1, 3)


def measure(job, once, csv):
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    vertices = torch.from_numpy(job["vertices"].astype(np.float32)).to(device)
    triangles = torch.from_numpy(job["triangles"].astype(np.int32)).to(device)
    points = points_of(job, device)
    found = None

    def call():
        nonlocal found
        found = None  # its memory is free for the next
        found = signed_distance_field(vertices, triangles, points, max_dist=min(job["thickness"], 1e30))

    def milliseconds():
        if device.type == "cpu":
            began = time.perf_counter()
            call()
            return 1e3 * (time.perf_counter() - began)
        start, end = torch.cuda.Event(enable_timing=True), torch.cuda.Event(enable_timing=True)
        start.record()
        call()
        end.record()
        end.synchronize()
        return start.elapsed_time(end)

    runs = peer_jobs.repeated(milliseconds, once)
    # Beyond the thickness there is no number.
    values = found[0].nan_to_num(nan=float("inf")).cpu().numpy()
    peer = f"physicsnemo {get_installed_version('nvidia-physicsnemo')} with warp {wp.config.version} on {device}"
    peer_jobs.print_row(csv, job, "signed_distance_field", runs, "", values, peer)


if __name__ == "__main__":
    peer_jobs.main(measure)
