# SPDX-License-Identifier: Apache-2.0
"""Fields by Dask: windows of a grid are the tasks of a cluster (docs/scale.md).

Needs the extra ``standoff[dask]``. Every window has the bits that it has in the whole field, so neither the cluster nor
the order of its work can be seen in the result.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from ._checks import triple
from ._field import DistanceField
from ._mesh import Mesh, as_mesh
from ._options import Grid, Sign, grid_of
from ._windows import FieldWindows

try:
    import dask.array
    from dask import delayed
    from dask.base import tokenize
except ImportError as error:
    raise ImportError(
        f"standoff.dask needs {error.name}, which is not installed; pip install 'standoff[dask]'", name=error.name
    ) from None

_MOST_PREPARED = 2  # meshes that a worker keeps prepared

Triple = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class _Job:
    """What all windows of a field share: it travels once to each worker, which prepares it once."""

    vertices: np.ndarray
    faces: np.ndarray
    grid: Grid
    thickness: float
    window: Triple
    sign: str | Sign | None
    method: str
    threads: int | None
    token: str

    @classmethod
    def of(
        cls, mesh: Any, window: int | Sequence[int], sign: Any, method: str, threads: int | None, **sizes: Any
    ) -> _Job:
        found: Mesh = as_mesh(mesh)
        order = ("grid", "resolution", "spacing", "shape", "padding", "band", "thickness")
        grid, thickness = grid_of(lambda: found.bounds, *(sizes.pop(name, None) for name in order))
        if sizes:
            raise TypeError(f"there is no argument {', '.join(sizes)}; the sizes are {', '.join(order)}")
        sides = (window, window, window) if isinstance(window, int) else window
        side = triple(sides, "window", whole=True)
        if any(n < 1 or n % 16 for n in side):
            raise ValueError(f"window: must be multiples of 16 samples, not {side}: windows begin and end at bricks")
        Sign.of(sign)  # raises what is wrong with it
        content = _core.content_hash(found.vertices, found.faces)
        token = tokenize(content, grid, thickness, side, sign, method, _core.version)
        return cls(found.vertices, found.faces, grid, thickness, side, sign, method, threads, token)

    def prepare(self, threads: int) -> FieldWindows:
        return FieldWindows(
            (self.vertices, self.faces),
            window=self.window,
            grid=self.grid,
            thickness=self.thickness,
            sign=self.sign,
            method=self.method,  # type: ignore[arg-type]
            device="auto" if self.threads is None else "cpu",
            threads=threads,
        )


_prepared: OrderedDict[str, FieldWindows] = OrderedDict()
_preparing = threading.Lock()


def _windows_of(job: _Job) -> FieldWindows:
    """The prepared mesh, of this process."""
    with _preparing:
        windows = _prepared.get(job.token)
        if windows is None:
            while len(_prepared) >= _MOST_PREPARED:
                _prepared.popitem(last=False)
            windows = _prepared[job.token] = job.prepare(job.threads or _threads_here())
        _prepared.move_to_end(job.token)
        return windows


def _threads_here() -> int:
    """The threads of this worker; of no worker, all."""
    try:
        from distributed import get_worker

        return int(get_worker().state.nthreads)
    except (ImportError, ValueError):
        return 0


def _block(job: _Job, block_info: Any = None) -> np.ndarray:
    place: list[tuple[int, int]] = block_info[None]["array-location"]
    first, shape = [at for at, _ in place], [end - at for at, end in place]
    return _windows_of(job).field(first, shape).numpy()


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
    job = _Job.of(
        mesh,
        window,
        sign,
        method,
        threads,
        grid=grid,
        resolution=resolution,
        spacing=spacing,
        shape=shape,
        padding=padding,
        band=band,
        thickness=thickness,
    )
    chunks = tuple(
        tuple(min(side, n - at) for at in range(0, n, side)) for n, side in zip(job.grid.shape, job.window)
    )
    return dask.array.map_blocks(
        _block,
        job=delayed(job, name=f"standoff-mesh-{job.token}", traverse=False),
        dtype=np.float32,
        chunks=chunks,
        meta=np.empty((0, 0, 0), np.float32),
        name=f"standoff-field-{job.token}",
    )
