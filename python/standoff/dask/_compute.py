# SPDX-License-Identifier: Apache-2.0
"""Fields as lazy arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import dask.array
import numpy as np
from dask.delayed import delayed

from .._options import Grid, Sign
from ._job import Job, windows_of

# What needs only the triangles near a window, so that one process can decide the sign for all. Other signs and methods
# need the whole field, or decide nothing.
SIGNS_IN_WINDOWS = ("auto", "winding", "parity", "flood")
METHODS_IN_WINDOWS = ("tiles", "thesis", "fuhrmann")


def _decided(job: Job) -> Job:
    """The job with how its sign is decided: one process finds it out, and the others prepare the mesh faster."""
    return replace(job, decision=windows_of(job).decision)


def _decided_node(job: Job) -> Any:
    """The mesh as one node of a graph, and one more that decides its sign. It does not where that needs the whole field
    or nothing."""
    mesh = delayed(job, name=f"standoff-mesh-{job.token}", traverse=False)
    if Sign.of(job.sign).method not in SIGNS_IN_WINDOWS or job.method not in METHODS_IN_WINDOWS:
        return mesh
    return delayed(_decided)(mesh, dask_key_name=f"standoff-decided-{job.token}")


def _block(job: Job, block_info: Any = None) -> np.ndarray:
    place: list[tuple[int, int]] = block_info[None]["array-location"]
    first, shape = [at for at, _ in place], [end - at for at, end in place]
    return windows_of(job).field(first, shape).numpy()


def compute(
    mesh: Any,
    grid: Grid | None = None,
    *,
    window: int | Sequence[int] = 256,
    resolution: int | None = None,
    spacing: float | Sequence[float] | None = None,
    shape: Sequence[int] | None = None,
    padding: float | None = None,
    band: float | None = None,
    thickness: float | None = None,
    sign: str | Sign | None = "auto",
    method: str = "tiles",
    threads: int | None = None,
) -> dask.array.Array:
    """The field of a mesh as a lazy array ``[i, j, k]`` of float32, whose blocks are windows.

    Args:
        mesh: as for `standoff.field`. It travels once to each worker.
        grid, resolution, spacing, shape, padding, band, thickness: as for `standoff.field`.
        window: samples of a block, one number or one for each axis; multiples of 16.
        sign, method: as for `standoff.field`. Signs by ``"normal"`` and methods that spread values make each worker
            compute the whole field.
        threads: of each task; by default as many as the worker has.

    Raises:
        ValueError, TypeError, MeshError: as `standoff.field`; also a window that is no multiple of 16.
    """
    sizes = grid, resolution, spacing, shape, padding, band, thickness
    job = Job.of(mesh, window, sign, method, threads, sizes)
    chunks = tuple(tuple(min(side, n - at) for at in range(0, n, side)) for n, side in zip(job.grid.shape, job.window))
    array: dask.array.Array = dask.array.map_blocks(  # type: ignore[no-untyped-call]
        _block,
        job=_decided_node(job),
        dtype=np.float32,
        chunks=chunks,
        meta=np.empty((0, 0, 0), np.float32),
        name=f"standoff-field-{job.token}",
    )
    return array
