# SPDX-License-Identifier: Apache-2.0
"""What all windows of a field share, and each worker's prepared meshes."""

from __future__ import annotations

import ctypes
import os
import sys
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from dask.base import tokenize

from .. import _core
from .._checks import triple
from .._levels import threads_here
from .._mesh import Mesh, as_mesh
from .._options import Grid, Sign, grid_of
from .._targets import Triple
from .._windows import FieldWindows

_MOST_PREPARED = 2  # meshes that a worker keeps prepared


@dataclass(frozen=True, eq=False)
class Job:
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
    decision: bytes | None = None

    @classmethod
    def of(
        cls,
        mesh: Any,
        window: int | Sequence[int],
        sign: Any,
        method: str,
        threads: int | None,
        sizes: Sequence[Any],
    ) -> Job:
        """`sizes`: what `grid_of` takes after the bounds."""
        found: Mesh = as_mesh(mesh)
        grid, thickness = grid_of(lambda: found.bounds, *sizes)
        side = sides(window, "window")
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
            decision=self.decision,
        )


def sides(samples: int | Sequence[int], what: str) -> Triple:
    return triple((samples, samples, samples) if isinstance(samples, int) else samples, what, whole=True)


_prepared: OrderedDict[str, FieldWindows] = OrderedDict()
_preparing = threading.Lock()


def windows_of(job: Job) -> FieldWindows:
    """The prepared mesh, of this process."""
    with _preparing:
        windows = _prepared.get(job.token)
        if windows is None:
            _keep_freed_memory()
            while len(_prepared) >= _MOST_PREPARED:
                _prepared.popitem(last=False)
            windows = _prepared[job.token] = job.prepare(job.threads or threads_here())
        _prepared.move_to_end(job.token)
        return windows


def _keep_freed_memory() -> None:
    """Undoes in a worker what Dask's nanny asks of glibc by default: to give memory back as soon as it is freed.

    Packing a shard would take new pages for each of its chunks, which costs more than all other work of a window.
    """
    if sys.platform != "linux" or os.environ.get("MALLOC_TRIM_THRESHOLD_") != "65536":
        return
    trim_threshold, mmap_threshold = -1, -3  # M_TRIM_THRESHOLD, M_MMAP_THRESHOLD
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(trim_threshold, 64 << 20)
        mallopt(mmap_threshold, 32 << 20)
