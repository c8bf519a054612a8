# SPDX-License-Identifier: Apache-2.0
"""Fields by Dask: windows of a grid are the tasks of a cluster (docs/scale.md).

Needs the extra ``standoff[dask]``. Every window has the bits that it has in the whole field, so neither the cluster nor
the order of its work can be seen in the result.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import threading
import time
import warnings
from collections import OrderedDict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from . import _core
from ._batch import BatchResult, merged
from ._batch import batch as batch_here
from ._checks import PathLike, flag, triple, whole_number
from ._errors import Error, OutputError, UsageError
from ._levels import level_count, threads_here, write_levels
from ._mesh import Mesh, as_mesh
from ._options import Grid, Progress, Sign, grid_of, progress_of
from ._targets import Target, Triple
from ._windows import FieldWindows

try:
    import dask.array
    from dask.base import tokenize
    from dask.delayed import delayed
except ImportError as error:
    raise ImportError(
        f"standoff.dask needs {error.name}, which is not installed; pip install 'standoff[dask]'", name=error.name
    ) from None

_MOST_PREPARED = 2  # meshes that a worker keeps prepared
_IN_WINDOWS = ("tiles", "thesis", "fuhrmann")  # methods that do not spread values


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
    decision: bytes | None = None

    @classmethod
    def of(
        cls, mesh: Any, window: int | Sequence[int], sign: Any, method: str, threads: int | None, **sizes: Any
    ) -> _Job:
        found: Mesh = as_mesh(mesh)
        order = ("grid", "resolution", "spacing", "shape", "padding", "band", "thickness")
        grid, thickness = grid_of(lambda: found.bounds, *(sizes.pop(name, None) for name in order))
        if sizes:
            raise TypeError(f"there is no argument {', '.join(sizes)}; the sizes are {', '.join(order)}")
        side = _sides(window, "window")
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


def _sides(samples: int | Sequence[int], what: str) -> Triple:
    return triple((samples, samples, samples) if isinstance(samples, int) else samples, what, whole=True)


_prepared: OrderedDict[str, FieldWindows] = OrderedDict()
_preparing = threading.Lock()


def _windows_of(job: _Job) -> FieldWindows:
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


def _decided(job: _Job) -> _Job:
    """The job with how its sign is decided: one process finds it out, and the others prepare the mesh faster."""
    return replace(job, decision=_windows_of(job).decision)


def _decided_node(job: _Job) -> Any:
    """The mesh as one node of a graph, and one more that decides its sign. It does not where that needs the whole field
    or nothing."""
    mesh = delayed(job, name=f"standoff-mesh-{job.token}", traverse=False)
    if Sign.of(job.sign).method not in ("auto", "winding", "parity", "flood") or job.method not in _IN_WINDOWS:
        return mesh
    return delayed(_decided)(mesh, dask_key_name=f"standoff-decided-{job.token}")


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


# Stores.


@dataclass(frozen=True)
class Written:
    """What `write` did."""

    shards: int
    """Of the grid."""
    computed: int
    """Tasks that computed a window and wrote its shards."""
    kept: int
    """Windows that were there already."""
    empty: int
    """Windows whose values are all the thickness, outside: they have no shards."""
    seconds: float


def _write_window(job: _Job, target: Target, first: Triple, shape: Triple) -> Triple:
    windows = _windows_of(job)
    target.write(first, windows.field(first, shape), job.threads or threads_here())
    return first


def _identity(job: _Job) -> _Job:
    return job


def write(
    url: Any,
    mesh: Any,
    grid: Grid | None = None,
    *,
    resolution: int | None = None,
    spacing: float | Sequence[float] | None = None,
    shape: Sequence[int] | None = None,
    padding: float | None = None,
    band: float | None = None,
    thickness: float | None = None,
    sign: str | Sign | None = "auto",
    method: str = "tiles",
    shard: int | Sequence[int] = 256,
    chunk: int | Sequence[int] = 32,
    block: int | Sequence[int] | None = None,
    levels: int = 1,
    client: Any = None,
    threads: int | None = None,
    resume: bool = True,
    overwrite: bool = False,
    storage_options: dict[str, Any] | None = None,
    progress: Progress = None,
) -> Written:
    """Computes a field into a Zarr store, window by window, by this process or by a cluster.

    The store has the same bytes however it came about: by one process or many, in any order, after workers or clients
    that were killed. Each shard appears whole or not at all. A window that no triangle reaches, outside, costs some
    microseconds and has no file.

    Args:
        url: a folder, a URL that fsspec knows (``"s3://bucket/field.zarr"``), or a store of obstore.
        mesh, grid, resolution, spacing, shape, padding, band, thickness, sign, method: as for `compute`.
        shard: samples of a shard, which is one file; multiples of 16 and of `chunk`.
        chunk: samples of a chunk, which is what readers unpack; multiples of 8.
        block: samples of a task, by default a shard; multiples of `shard`. Two tasks must not write one shard: one of
            both would be lost without a word.
        levels: how many the store has: the field, and others of every second sample of the one before. They are made
            when the field is complete, and listed when they are.
        client: of Dask; without one this process does the work.
        threads: of each task; by default as many as the worker has.
        resume: keep the shards of an earlier call with the same mesh and arguments. Without it, a store that exists is
            an error.
        overwrite: remove a store that is there first. Only what standoff wrote is removed.
        storage_options: for fsspec.
        progress: as for `standoff.field`.

    Raises:
        UsageError, ValueError: arguments; a store of another field.
        OutputError: the disk is full, for example; the shards that were written stay, and the next call goes on.
        Error: a window whose workers died again and again; all others are written.
    """
    began = time.monotonic()
    shards, chunks = _sides(shard, "shard"), _sides(chunk, "chunk")
    blocks = shards if block is None else _sides(block, "block")
    if any(b < 1 or b % s for b, s in zip(blocks, shards)):
        raise ValueError(
            f"block: must be multiples of the shard, not {blocks} where that is {shards}: two tasks that write parts of "
            "one shard would lose one of both without a word"
        )
    sizes = {
        "grid": grid,
        "resolution": resolution,
        "spacing": spacing,
        "shape": shape,
        "padding": padding,
        "band": band,
        "thickness": thickness,
    }
    job = _Job.of(mesh, blocks, sign, method, threads, **sizes)
    count_of_levels = level_count(levels, job.grid.shape)
    target = Target(url, storage_options)
    here = _windows_of(job)
    job = replace(job, decision=here.decision)
    _make(target, here, job, shards, chunks, flag(resume, "resume"), flag(overwrite, "overwrite"))
    count_of_levels = max(count_of_levels, target.open().levels)  # a call for fewer takes none away
    existing = target.shards()
    todo: list[tuple[Triple, Triple]] = []
    kept = empty = 0
    for first, size in here:
        parts = {tuple((at + n) // s for at, n, s in zip(first, part, shards)) for part, _ in _windows_in(size, shards)}
        if parts <= existing:
            kept += 1
        elif here.is_empty(first, size):
            empty += 1
        else:
            todo.append((first, size))
    with progress_of(progress, "write") as report:
        done = _by_client(client, job, target, todo) if client is not None else _here(job, target, todo)
        for count, _ in enumerate(done, start=1):
            if report is not None:
                report("write", count / len(todo))
    write_levels(target, count_of_levels, job.grid.shape, shards, job.threads, client, len(todo))
    count = int(np.prod([-(-n // s) for n, s in zip(job.grid.shape, shards)], dtype=np.int64))
    return Written(count, len(todo), kept, empty, time.monotonic() - began)


def _windows_in(shape: Sequence[int], side: Triple) -> Iterator[tuple[Triple, Triple]]:
    for k in range(0, shape[2], side[2]):
        for j in range(0, shape[1], side[1]):
            for i in range(0, shape[0], side[0]):
                first = (i, j, k)
                size = [min(n, all_of - at) for at, n, all_of in zip(first, side, shape)]
                yield first, (size[0], size[1], size[2])


def _make(
    target: Target, here: FieldWindows, job: _Job, shard: Triple, chunk: Triple, resume: bool, overwrite: bool
) -> None:
    """Makes the store, unless it is there and is to be resumed."""
    if target.exists() and not overwrite:
        if not resume:
            raise UsageError(f"{target.url}: the store exists; resume it, overwrite it, or name another")
        return _expect_same(target, here, job, shard, chunk)
    target.create(here._windows, job.grid, job.thickness, shard, chunk, overwrite)


def _expect_same(target: Target, here: FieldWindows, job: _Job, shard: Triple, chunk: Triple) -> None:
    store, made = target.open(), here._windows.provenance
    mine = {
        "grid": (job.grid.shape, job.grid.origin, job.grid.spacing),
        "thickness": job.thickness,
        "mesh": made.mesh_hash,
        "sign": made.sign,
        "method": made.method,
        "version": made.version,
        "shard": shard,
        "chunk": chunk,
    }
    theirs = {
        "grid": (tuple(store.shape), tuple(store.origin), tuple(store.spacing)),
        "thickness": store.thickness,
        "mesh": store.provenance.mesh_hash,
        "sign": store.provenance.sign,
        "method": store.provenance.method,
        "version": store.provenance.version,
        "shard": tuple(store.shard),
        "chunk": tuple(store.chunk),
    }
    other = [name for name, value in mine.items() if theirs[name] != value]
    if other:
        raise UsageError(
            f"{target.url}: the store is another field's ({', '.join(other)}); overwrite it, or name another"
        )


def _here(job: _Job, target: Target, todo: list[tuple[Triple, Triple]]) -> Iterator[Triple]:
    for first, size in todo:
        yield _write_window(job, target, first, size)


def _by_client(client: Any, job: _Job, target: Target, todo: list[tuple[Triple, Triple]]) -> Iterator[Triple]:
    from distributed import KilledWorker, as_completed

    # A task that gives the mesh, not scattered data: it can be had again after the workers that held it died.
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Sending large graph", UserWarning)  # once, not with every task
        held = client.submit(_identity, job, key=f"standoff-mesh-{job.token}")

    def submit(first: Triple, size: Triple, turn: int) -> Any:
        key = f"standoff-write-{job.token}-{turn}-{first}"
        return client.submit(_write_window, held, target, first, size, key=key, pure=False)

    futures = {submit(first, size, 0): (first, size) for first, size in todo}
    suspects: list[tuple[Triple, Triple]] = []
    killers: list[Triple] = []
    try:
        for future in as_completed(futures):  # type: ignore[no-untyped-call]
            try:
                yield future.result()
            except KilledWorker:
                suspects.append(futures[future])
        # Windows that waited on a worker when it died are blamed, too: one after the other, only the guilty ones die.
        for first, size in suspects:
            try:
                yield submit(first, size, 1).result()
            except KilledWorker:
                killers.append(first)
    finally:
        with contextlib.suppress(Exception):  # the cluster may be gone
            client.cancel([future for future in futures if not future.done()])
    if killers:
        raise Error(
            f"{target.url}: {len(killers)} of {len(todo)} windows killed the workers that computed them, the first one at "
            f"sample {killers[0]}; give workers more memory, or a smaller block, and call again: the others are kept"
        )


# Many meshes.


def _batch_part(meshes: str, out: str, part: int, parts: int, options: dict[str, Any]) -> int:
    options = {"threads": threads_here()} | options
    while True:
        try:
            batch_here(meshes, out, shard=(part, parts), resume=True, **options)
            return part
        except OutputError as error:
            # A worker was killed, and the program that it had started works on: what it does need not be done again.
            if "is writing it" not in str(error):
                raise
            time.sleep(1)


def batch(
    meshes: PathLike | Iterable[PathLike],
    out: PathLike,
    *,
    client: Any,
    parts: int | None = None,
    **options: Any,
) -> BatchResult:
    """`standoff.batch` by a cluster: the same results and the same manifest, whose parts workers take in turn.

    What is done already is kept, as with ``resume=True``. A mesh that ends its process costs itself; a worker that dies
    costs the meshes that it was at.

    Args:
        meshes, out: as for `standoff.batch`, on a file system that all workers share.
        client: of Dask.
        parts: how many tasks the meshes are divided into, by default eight for each worker there is now. A later call
            for the same folder must name the same number.
        options: those of `standoff.batch`, but ``shard`` and ``resume``; ``threads`` by default as many as a worker has.

    Raises:
        Error, ValueError, TypeError: as `standoff.batch`; the results of the parts that came to their end are kept.
    """
    for name in ("shard", "resume"):
        if name in options:
            raise TypeError(f"{name}: the cluster's business; leave it out")
    folder = os.path.abspath(os.fspath(out))
    if isinstance(meshes, (str, os.PathLike)):
        listed = os.path.abspath(os.fspath(meshes))
    else:
        os.makedirs(folder, exist_ok=True)
        listed = os.path.join(folder, "list.txt")
        with open(listed + ".part", "wb") as file:
            for mesh in meshes:
                path = os.path.abspath(os.fsencode(mesh))
                if b"\n" in path:
                    raise ValueError(
                        f"meshes: {path!r} has an end of line in its name, which lists of lines cannot hold"
                    )
                file.write(path + b"\n")
        os.replace(listed + ".part", listed)
    count = whole_number(parts, "parts") if parts is not None else 8 * max(1, len(client.scheduler_info()["workers"]))
    futures = [
        client.submit(_batch_part, listed, folder, part, count, options, pure=False) for part in range(1, count + 1)
    ]
    try:
        client.gather(futures)
    finally:
        with contextlib.suppress(Exception):
            client.cancel([future for future in futures if not future.done()])
    return merged(folder)
