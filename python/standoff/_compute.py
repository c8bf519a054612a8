# SPDX-License-Identifier: Apache-2.0
"""Fields of meshes."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np

from . import _core
from ._checks import PathLike, flag, name, path_of, runs_on
from ._device_compute import fields_on_gpu
from ._device_mesh import MeshOnDevice, parts_on_gpu
from ._errors import make
from ._field import DistanceField
from ._mesh import as_mesh
from ._options import Grid, Progress, Sign, grid_of, memory_limit_of, memory_text, progress_of, sign_report


def field(
    mesh: Any,
    *,
    resolution: int | None = None,
    spacing: float | Sequence[float] | None = None,
    shape: Sequence[int] | None = None,
    grid: Grid | None = None,
    padding: float | None = None,
    band: float | None = None,
    thickness: float | None = None,
    sign: str | Sign | None = "auto",
    nearest: bool = False,
    method: Literal["tiles", "thesis", "fuhrmann", "propagate", "jumpflood", "jumpflood+1"] = "tiles",
    out: Any = None,
    device: str = "auto",
    stream: Any = None,
    threads: int = 0,
    memory_limit: int | None = None,
    cache: PathLike | None = None,
    progress: Progress = None,
) -> DistanceField:
    """Computes the distance field of a mesh. Values are exact up to rounding to float32.

    Args:
        mesh: a path, a `Mesh`, ``(vertices, faces)``, or an object of trimesh, pyvista, Open3D, meshio, ... If its
            arrays lie on a GPU, of torch, cupy, numba, Warp or any with ``__cuda_array_interface__`` or DLPack, the
            field is computed there, and a `DeviceField` is returned.
        resolution: samples on the longest side, 256 by default. Or give one of:
        spacing: distance between samples, world units, one for all axes or one for each;
        shape: samples per axis;
        grid: a `Grid`, for example that of another field.
        padding: samples beyond the mesh on each side; by default the band's width, at most a tenth of the mesh's
            longest side, at least 2 samples.
        band: half-width of the band in samples; or
        thickness: the same in world units. Without either every sample gets its distance.
        sign: ``"auto"`` makes values inside negative by what fits the mesh, and warns if that is not certain
            (`SignWarning`). Another method's name, a `Sign`, or None for distances without sign.
        nearest: also store the index of each sample's nearest triangle.
        method: ``"tiles"``, which is exact. The others are for comparison: Algorithm 1 of the 2008 thesis, and
            algorithms of others, which are not exact (docs/methods.md).
        out: float32 array ``(nx, ny, nz)`` in Fortran order that the values are written to; the field keeps it. For a
            mesh on a GPU one there; by default the library that the vertices came in makes it.
        device: ``"auto"``, ``"cpu"``, ``"cuda"``, ``"cuda:N"`` or ``"emulated"``; ``"cuda:0,1"`` shares the field among
            GPUs, by ``"tiles"`` alone.
        stream: for a mesh on a GPU, the CUDA stream that works on it: a stream of torch, cupy, numba or Warp, an object
            with ``__cuda_stream__``, or the handle as a number. By default torch's current stream, or the one that the
            vertices name. It is waited for.
        threads: 0 for all. Values do not depend on it.
        memory_limit: bytes of the CPU's memory; by default 80 % of the machine's, or of its control group's; negative
            for no limit.
        cache: a folder of fields that were computed before, which many processes may share, and the program's
            ``--cache``: the field is taken from there, or computed and kept there as ``.npz``. An entry that is damaged
            is computed anew, with a warning. For distances alone: without `nearest` and `out`, and on the CPU's memory.
        progress: True for a bar by tqdm, or a function of stage and fraction. What it raises ends the work.

    Raises:
        MeshError: the mesh is empty, has a face out of range or a corner that is not finite, or the sign's method
            cannot work with it.
        UsageError, ValueError, TypeError: arguments.
        LimitError: more memory than `memory_limit`.
        DeviceError: there is no such GPU, or arrays lie on several devices.
        OutputError: the folder of `cache` cannot be made.
        KeyboardInterrupt: Ctrl-C, within 0.1 s.
    """
    parts = parts_on_gpu(mesh)
    if cache is not None and (parts is not None or nearest or out is not None):
        raise ValueError(
            "cache: it keeps distances in the CPU's memory alone; leave it out, or nearest, out and arrays on a GPU"
        )
    if parts is not None:
        on_gpu = MeshOnDevice(parts, runs_on(threads, device)[1], stream)
        sizes = (grid, resolution, spacing, shape, padding, band, thickness)
        with progress_of(progress, "field") as report:
            [made] = fields_on_gpu([on_gpu], sizes, sign, nearest, method, out)
            if isinstance(made, Exception):
                raise made
            if report is not None:
                report("done", 1.0)
        return made
    if stream is not None:
        raise ValueError("stream: the mesh is in the memory of the CPU, which has no streams; leave it out")
    found = as_mesh(mesh)
    where, half_width = grid_of(lambda: found.bounds, grid, resolution, spacing, shape, padding, band, thickness)
    asked = Sign.of(sign)
    limit = memory_limit_of(memory_limit)
    nearest = flag(nearest, "nearest")
    dense = None
    if out is not None:
        if nearest:
            raise ValueError("out and nearest: nearest triangles are stored in tiles; leave out one of these")
        dense = _checked_out(out, where)
    elif math.isinf(half_width) and not nearest and cache is None:
        mesh_and_grid = found.vertices, found.faces, where._core()
        dense = _new_dense(where, limit, lambda: _core.dense_bytes(*mesh_and_grid, half_width, asked))
    settings = (asked, name(method, "method"))
    with progress_of(progress, "field") as report:
        if cache is not None:
            native, done = _core.compute_cached(
                found.vertices,
                found.faces,
                where._core(),
                half_width,
                *settings,
                *runs_on(threads, device),
                limit,
                found.up,
                path_of(cache, "cache"),
                report,
            )
            problem = done.pop("problem")
            if problem:
                warnings.warn(problem, RuntimeWarning, stacklevel=2)
        elif dense is None:
            native, done = _core.compute(
                found.vertices,
                found.faces,
                where._core(),
                half_width,
                *settings,
                nearest,
                *runs_on(threads, device),
                limit,
                found.up,
                report,
            )
        if dense is None:
            signs = sign_report(done.pop("sign"), asked, stacklevel=2)
            del done["provenance"], done["method"]
            return DistanceField._of_native(native, signs, done)
        done = _core.compute_dense(
            found.vertices,
            found.faces,
            where._core(),
            half_width,
            dense,
            *settings,
            *runs_on(threads, device),
            limit,
            report,
        )
    signs = sign_report(done.pop("sign"), asked, stacklevel=2)
    made = done.pop("provenance")
    del done["method"]
    hashed = _core.content_hash(found.vertices, found.faces)
    provenance = _core.Provenance(made.method, hashed, made.version, made.sign, found.up)
    return DistanceField._make(where, half_width, provenance, dense=dense, sign=signs, computation=done)


def _checked_out(out: Any, grid: Grid) -> np.ndarray:
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: must be a numpy array, not {type(out).__name__}; of a torch tensor t pass t.numpy()")
    if out.dtype != np.float32 or out.shape != grid.shape:
        raise ValueError(f"out: must be float32 of shape {grid.shape}, not {out.dtype} of shape {out.shape}")
    if not out.flags.f_contiguous:
        raise ValueError("out: must be in Fortran order: numpy.empty(shape, numpy.float32, order='F')")
    if not out.flags.writeable:
        raise ValueError("out: is read-only")
    return out


def _new_dense(grid: Grid, limit: int, needed_for: Callable[[], int]) -> np.ndarray:
    limit = limit or _core.default_memory_limit()
    if 0 < limit < 4 * math.prod(grid.shape):
        needed = needed_for()
        raise make(
            "limit",
            f"a full field of {' x '.join(map(str, grid.shape))} samples takes {memory_text(needed)}, and the limit is "
            f"{memory_text(limit)}; take a band (band=3), a lower resolution, or raise memory_limit",
            bytes_needed=needed,
            bytes_limit=limit,
        )
    return np.empty(grid.shape, np.float32, order="F")
