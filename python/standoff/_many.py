# SPDX-License-Identifier: Apache-2.0
"""Fields of many meshes, with all cores busy."""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sized
from dataclasses import dataclass
from inspect import signature
from typing import TYPE_CHECKING, Any

from ._checks import flag, whole_number
from ._compute import field
from ._errors import Error
from ._field import DistanceField
from ._mesh import as_mesh

if TYPE_CHECKING:
    from concurrent.futures import Future


@dataclass(frozen=True, eq=False)
class FieldResult:
    """One mesh of `fields`: its field, or the error that it met."""

    index: int
    """Its place among the meshes, from 0."""
    source: Any
    """What was passed: a path, a mesh."""
    field: DistanceField | None
    error: Exception | None

    def unwrap(self) -> DistanceField:
        """The field; raises the error if there is one."""
        if self.error is not None:
            raise self.error
        assert self.field is not None
        return self.field


def fields(
    meshes: Iterable[Any],
    *,
    workers: int | None = None,
    ahead: int | None = None,
    prepare: Callable[[Any], Any] | None = None,
    progress: bool = False,
    **options: Any,
) -> Iterator[FieldResult]:
    """Computes the fields of many meshes or files side by side, in their order.

    An iterator: results come as they are asked for, and at most `ahead` of them exist before. Errors of a mesh are in
    its result, and the others go on.

    Args:
        meshes: paths, or what `field` takes; any iterable, also one that never ends.
        workers: how many meshes are worked on at a time, each with one thread; by default two for each core, since one
            waits now and then: for its file, or for Python.
        ahead: how many results may wait; by default four for each worker.
        prepare: called with each mesh first, in a worker; returns what the field is computed of. For example to
            normalise the size.
        progress: True for a bar by tqdm.
        options: as for `field`: ``resolution=64, band=3``.

    Example:
        >>> for result in standoff.fields(paths, resolution=64, band=3):       # doctest: +SKIP
        ...     if result.error is None:
        ...         result.field.save(f"{result.index}.npz")
    """
    if isinstance(meshes, (str, os.PathLike)):
        raise TypeError("meshes: must be several, in a list or another iterable; a single one is for standoff.field")
    source = iter(meshes)
    for name in options:
        if name not in _OPTIONS:
            raise TypeError(f"fields() got an unexpected keyword argument {name!r}")
    if workers is None:
        workers = 2 * (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
    if whole_number(workers, "workers") < 1:
        raise ValueError("workers: must be at least 1")
    waiting = 4 * workers if ahead is None else whole_number(ahead, "ahead")
    if waiting < 1:
        raise ValueError("ahead: must be at least 1")
    options.setdefault("threads", 1)
    total = len(meshes) if isinstance(meshes, Sized) else None
    return _results(source, total, workers, waiting, prepare, flag(progress, "progress"), options)


_OPTIONS = set(signature(field).parameters) - {"mesh", "out", "progress"}


class _Closed(BaseException):
    """Nobody waits for the field any more."""


def _results(
    meshes: Iterable[Any],
    total: int | None,
    workers: int,
    waiting: int,
    prepare: Callable[[Any], Any] | None,
    progress: bool,
    options: dict[str, Any],
) -> Iterator[FieldResult]:
    closed = threading.Event()

    def watch(stage: str, fraction: float) -> None:
        if closed.is_set():
            raise _Closed

    def work(index: int, source: Any) -> FieldResult:
        try:
            mesh = source if prepare is None else prepare(as_mesh(source))
            return FieldResult(index, source, field(mesh, progress=watch, **options), None)
        except (Error, OSError, ValueError, TypeError, MemoryError) as error:
            return FieldResult(index, source, None, error)

    from concurrent.futures import ThreadPoolExecutor  # which takes a tenth of the package's time of import

    bar = None
    if progress:
        from tqdm.auto import tqdm

        bar = tqdm(total=total, desc="fields", unit="mesh")
    pending: deque[Future[FieldResult]] = deque()
    pool = ThreadPoolExecutor(workers, thread_name_prefix="standoff")
    try:
        source = enumerate(meshes)
        for index, mesh in source:
            pending.append(pool.submit(work, index, mesh))
            if len(pending) >= waiting:
                yield _next(pending, bar)
        while pending:
            yield _next(pending, bar)
    finally:
        closed.set()  # stops the fields that are being computed
        pool.shutdown(wait=True, cancel_futures=True)
        if bar is not None:
            bar.close()


def _next(pending: deque[Future[FieldResult]], bar: Any) -> FieldResult:
    result = pending.popleft().result()
    if bar is not None:
        bar.update()
    return result
