# SPDX-License-Identifier: Apache-2.0
"""peer_warp.py [--once] FILE.bin...: NVIDIA Warp's mesh_query_point at the jobs that `measure --export` wrote.

A thread a sample asks Warp's tree of the mesh for the closest point, no farther than the thickness, and writes the
distance: device memory to device memory, the median of some runs by CUDA events (on a machine without a GPU Warp runs on
its CPU, to try this). The tree is built before; how long that takes stands apart. A CSV line for each job and query, with
how far Warp's distances are from ours at most.
"""

import sys
import time

import numpy as np
import peer_jobs
import warp as wp


@wp.func
def position(n: int, origin: wp.vec3, spacing: wp.vec3, nx: int, ny: int):
    return origin + wp.cw_mul(spacing, wp.vec3(float(n % nx), float((n // nx) % ny), float(n // (nx * ny))))


@wp.func
def distance(mesh: wp.uint64, p: wp.vec3, found: wp.MeshQueryPoint, thickness: float):
    d = thickness
    if found.result:
        d = wp.min(thickness, wp.length(wp.mesh_eval_position(mesh, found.face, found.u, found.v) - p))
    return d


@wp.kernel
def query_unsigned(mesh: wp.uint64, origin: wp.vec3, spacing: wp.vec3, nx: int, ny: int, thickness: float,
                   values: wp.array(dtype=float)):
    p = position(wp.tid(), origin, spacing, nx, ny)
    values[wp.tid()] = distance(mesh, p, wp.mesh_query_point_no_sign(mesh, p, thickness), thickness)


@wp.kernel
def query_signed(mesh: wp.uint64, origin: wp.vec3, spacing: wp.vec3, nx: int, ny: int, thickness: float,
                 values: wp.array(dtype=float)):
    p = position(wp.tid(), origin, spacing, nx, ny)
    values[wp.tid()] = distance(mesh, p, wp.mesh_query_point(mesh, p, thickness), thickness)


# Warp's tree, built as Warp chooses and by NVIDIA's cuBQL, where this Warp has that.
TREES = {"": {}, " cubql": {"bvh_constructor": "cubql"}}
QUERIES = {"mesh_query_point_no_sign": query_unsigned, "mesh_query_point": query_signed}


def milliseconds(launch, on_gpu):
    """How long one launch takes."""
    if not on_gpu:
        began = time.perf_counter()
        launch()
        return 1e3 * (time.perf_counter() - began)
    start, end = wp.Event(enable_timing=True), wp.Event(enable_timing=True)
    wp.record_event(start)
    launch()
    wp.record_event(end)
    return wp.get_event_elapsed_time(start, end)


def measure(job, once, csv):
    points = wp.array(job["vertices"].astype(np.float32), dtype=wp.vec3)
    indices = wp.array(job["triangles"].astype(np.int32), dtype=wp.int32)
    for tree, options in TREES.items():
        began = time.perf_counter()
        try:
            mesh = wp.Mesh(points=points, indices=indices, **options)
            wp.synchronize()
        except Exception as error:  # an older Warp, or one built without cuBQL
            if not options:
                raise
            print(f"{job['name']}: Warp makes no tree by{tree}: {error}", file=sys.stderr)
            continue
        measure_queries(job, mesh, tree, 1e3 * (time.perf_counter() - began), once, csv)


def measure_queries(job, mesh, tree, build_ms, once, csv):
    nx, ny, nz = job["size"]
    thickness = min(job["thickness"], 1e30)
    on_gpu = wp.get_preferred_device().is_cuda
    values = wp.zeros(nx * ny * nz, dtype=float)
    inputs = [mesh.id, wp.vec3(*job["origin"]), wp.vec3(*job["spacing"]), nx, ny, thickness]
    for name, kernel in QUERIES.items():
        def launch(kernel=kernel):
            wp.launch(kernel, dim=nx * ny * nz, inputs=inputs, outputs=[values])
        runs = peer_jobs.repeated(lambda launch=launch: milliseconds(launch, on_gpu), once)
        peer = f"warp {wp.config.version} on {wp.get_preferred_device()}"
        peer_jobs.print_row(csv, job, f"{name}{tree}", runs, f"{build_ms:.1f}", values.numpy(), peer)


if __name__ == "__main__":
    peer_jobs.main(measure)
