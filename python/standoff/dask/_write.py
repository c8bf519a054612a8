# SPDX-License-Identifier: Apache-2.0
"""Fields into stores, by this process or by a cluster."""

from __future__ import annotations

import contextlib
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .._checks import flag
from .._errors import Error, UsageError
from .._levels import level_count, threads_here, write_levels
from .._options import Grid, Progress, Sign, progress_of
from .._targets import Target, Triple
from .._windows import FieldWindows
from ._job import Job, sides, windows_of

Window = tuple[Triple, Triple]  # first sample and shape

# A task costs the scheduler and the client milliseconds, as much as some windows. So a task has several of them, while
# there are tasks enough for all threads to end at one time.
TASKS_OF_A_THREAD, MOST_OF_A_TASK = 32, 16


@dataclass(frozen=True)
class Written:
    """What `write` did."""

    shards: int
    """Of the grid."""
    computed: int
    """Windows that were computed, and their shards written."""
    kept: int
    """Windows that were there already."""
    empty: int
    """Windows whose values are all the thickness, outside: they have no shards."""
    seconds: float


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
        block: samples of a window, by default a shard; multiples of `shard`. Two tasks must not write one shard: one of
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
    shards, chunks = sides(shard, "shard"), sides(chunk, "chunk")
    blocks = shards if block is None else sides(block, "block")
    if any(b < 1 or b % s for b, s in zip(blocks, shards)):
        raise ValueError(
            f"block: must be multiples of the shard, not {blocks} where that is {shards}: two tasks that write parts of "
            "one shard would lose one of both without a word"
        )
    sizes = grid, resolution, spacing, shape, padding, band, thickness
    job = Job.of(mesh, blocks, sign, method, threads, sizes)
    count_of_levels = level_count(levels, job.grid.shape)
    target = Target(url, storage_options)
    here = windows_of(job)
    job = replace(job, decision=here.decision)
    _make(target, here, job, shards, chunks, flag(resume, "resume"), flag(overwrite, "overwrite"))
    count_of_levels = max(count_of_levels, target.open().levels)  # a call for fewer takes none away
    existing = target.shards()
    todo: list[Window] = []
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
        written = 0
        for count in _by_client(client, job, target, todo) if client is not None else _here(job, target, todo):
            written += count
            if report is not None:
                report("write", written / len(todo))
    write_levels(target, count_of_levels, job.grid.shape, shards, job.threads, client, len(todo))
    count = int(np.prod([-(-n // s) for n, s in zip(job.grid.shape, shards)], dtype=np.int64))
    return Written(count, len(todo), kept, empty, time.monotonic() - began)


def _windows_in(shape: Sequence[int], side: Triple) -> Iterator[Window]:
    for k in range(0, shape[2], side[2]):
        for j in range(0, shape[1], side[1]):
            for i in range(0, shape[0], side[0]):
                first = (i, j, k)
                size = [min(n, all_of - at) for at, n, all_of in zip(first, side, shape)]
                yield first, (size[0], size[1], size[2])


def _make(
    target: Target, here: FieldWindows, job: Job, shard: Triple, chunk: Triple, resume: bool, overwrite: bool
) -> None:
    """Makes the store, unless it is there and is to be resumed."""
    if target.exists() and not overwrite:
        if not resume:
            raise UsageError(f"{target.url}: the store exists; resume it, overwrite it, or name another")
        return _expect_same(target, here, job, shard, chunk)
    target.create(here._windows, job.grid, job.thickness, shard, chunk, overwrite)


def _expect_same(target: Target, here: FieldWindows, job: Job, shard: Triple, chunk: Triple) -> None:
    store, made = target.open(), here._windows.provenance
    theirs, grid = store.provenance, (tuple(store.shape), tuple(store.origin), tuple(store.spacing))
    same = {
        "grid": (job.grid.shape, job.grid.origin, job.grid.spacing) == grid,
        "thickness": job.thickness == store.thickness,
        "mesh": made.mesh_hash == theirs.mesh_hash,
        "sign": made.sign == theirs.sign,
        "method": made.method == theirs.method,
        "version": made.version == theirs.version,
        "shard": shard == tuple(store.shard),
        "chunk": chunk == tuple(store.chunk),
    }
    other = [name for name, is_same in same.items() if not is_same]
    if other:
        raise UsageError(
            f"{target.url}: the store is another field's ({', '.join(other)}); overwrite it, or name another"
        )


def _write_window(job: Job, target: Target, first: Triple, shape: Triple) -> None:
    windows = windows_of(job)
    target.write(first, windows.field(first, shape), job.threads or threads_here())


def _write_windows(windows: Sequence[Window], job: Job, target: Target) -> int:
    for first, shape in windows:
        _write_window(job, target, first, shape)
    return len(windows)


def _here(job: Job, target: Target, todo: list[Window]) -> Iterator[int]:
    for first, shape in todo:
        _write_window(job, target, first, shape)
        yield 1


def _identity(job: Job) -> Job:
    return job


def tasks_of(todo: list[Window], threads: int) -> list[list[Window]]:
    """Windows that lie side by side, as they do in the list."""
    count = min(MOST_OF_A_TASK, max(1, len(todo) // (TASKS_OF_A_THREAD * max(1, threads))))
    return [todo[at : at + count] for at in range(0, len(todo), count)]


def _by_client(client: Any, job: Job, target: Target, todo: list[Window]) -> Iterator[int]:
    """How many windows were written, again and again."""
    from distributed import KilledWorker, as_completed

    # A task that gives the mesh, not scattered data: it can be had again after the workers that held it died.
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Sending large graph", UserWarning)  # once, not with every task
        held = client.submit(_identity, job, key=f"standoff-mesh-{job.token}")

    def submit(tasks: list[list[Window]], turn: int) -> list[Any]:
        keys = [f"standoff-write-{job.token}-{turn}-{windows[0][0]}" for windows in tasks]
        futures: list[Any] = client.map(_write_windows, tasks, job=held, target=target, key=keys, pure=False)
        return futures

    tasks = tasks_of(todo, sum(client.nthreads().values()))
    futures = dict(zip(submit(tasks, 0), tasks))
    suspects: list[Window] = []
    killers: list[Triple] = []
    try:
        for future in as_completed(futures):  # type: ignore[no-untyped-call]
            try:
                yield future.result()
            except KilledWorker:
                suspects += futures[future]
        # Windows that waited on a worker when it died, or were in a task with one that killed it, are blamed, too: one
        # after the other, only the guilty ones die.
        for window in suspects:
            try:
                yield submit([[window]], 1)[0].result()
            except KilledWorker:
                killers.append(window[0])
    finally:
        with contextlib.suppress(Exception):  # the cluster may be gone
            client.cancel([future for future in futures if not future.done()])
    if killers:
        raise Error(
            f"{target.url}: {len(killers)} of {len(todo)} windows killed the workers that computed them, the first one at "
            f"sample {killers[0]}; give workers more memory, or a smaller block, and call again: the others are kept"
        )
