# SPDX-License-Identifier: Apache-2.0
"""Many meshes by a cluster."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterable
from typing import Any

from .._batch import BatchResult, merged
from .._batch import batch as batch_here
from .._checks import PathLike, whole_number
from .._errors import OutputError
from .._levels import threads_here


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
    count = whole_number(parts, "parts") if parts is not None else 8 * max(1, len(client.nthreads()))
    futures = [
        client.submit(_batch_part, listed, folder, part, count, options, pure=False) for part in range(1, count + 1)
    ]
    try:
        client.gather(futures)
    finally:
        with contextlib.suppress(Exception):
            client.cancel([future for future in futures if not future.done()])
    return merged(folder)
