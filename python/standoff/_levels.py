# SPDX-License-Identifier: Apache-2.0
"""Levels of stores: every second sample of the level before, made shard by shard by this process or a cluster."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

from ._checks import whole_number
from ._errors import Error
from ._targets import Target, Triple


def threads_here() -> int:
    """The threads of this worker of Dask; of no worker, all."""
    try:
        from distributed import get_worker

        return int(get_worker().state.nthreads)
    except (ImportError, ValueError):
        return 0


def level_count(levels: Any, shape: Triple) -> int:
    """Errors: ValueError, more levels than a grid has."""
    count, most = whole_number(levels, "levels"), (max(shape) - 1).bit_length() + 1
    if not 1 <= count <= most:
        raise ValueError(f"levels: must be 1 to {most} of this grid, not {count}")
    return count


def _parts(target: Target, level: int, shape: Triple, shard: Triple) -> Iterator[tuple[Triple, Triple]]:
    """The windows of the shards of a level that are missing, and have something to be made of."""
    there, below = target.shards(level), target.shards(level - 1)
    size = [-(-n // 2**level) for n in shape]
    for i, j, k in sorted({(i // 2, j // 2, k // 2) for i, j, k in below} - there):
        first = (i * shard[0], j * shard[1], k * shard[2])
        of = [min(side, n - at) for side, n, at in zip(shard, size, first)]
        yield first, (of[0], of[1], of[2])


def write_levels(
    target: Target, levels: int, shape: Triple, shard: Triple, threads: int | None, client: Any, computed: int
) -> None:
    """Makes the levels of a complete level 0 and lists them. Shards that are there stay: they are of the same samples.

    Args:
        threads: of each task; None: as many as its worker has.
        computed: windows of level 0 that were written just now.
    """
    is_listed = computed == 0 and target.open().levels >= levels
    if is_listed and not any(next(_parts(target, level, shape, shard), None) for level in range(1, levels)):
        return
    target.begin_levels(levels)
    for level in range(1, levels):
        parts = list(_parts(target, level, shape, shard))
        if client is None:
            for first, size in parts:
                _write(target, level, first, size, threads)
        else:
            _by_client(target, level, parts, threads, client)
    target.end_levels(levels)


def _write(target: Target, level: int, first: Triple, shape: Triple, threads: int | None) -> None:
    target.write_level(level, first, shape, threads or threads_here())


def _by_client(
    target: Target, level: int, parts: list[tuple[Triple, Triple]], threads: int | None, client: Any
) -> None:
    from distributed import KilledWorker

    futures = [client.submit(_write, target, level, *part, threads, pure=False) for part in parts]
    try:
        client.gather(futures)
    except KilledWorker as error:
        raise Error(
            f"{target.url}: workers died while they made level {level}; give them more memory, and call again: what is "
            "there is kept"
        ) from error
    finally:
        with contextlib.suppress(Exception):  # the cluster may be gone
            client.cancel([future for future in futures if not future.done()])
