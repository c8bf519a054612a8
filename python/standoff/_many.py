# SPDX-License-Identifier: Apache-2.0
"""Fields of many meshes, with all cores busy."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sized
from dataclasses import dataclass
from inspect import signature
from typing import Any

from ._checks import flag, whole_number
from ._compute import field
from ._device_many import OnGpu, compute_together
from ._errors import OF_A_MESH
from ._field import DistanceField
from ._mesh import Mesh, as_mesh
from ._workers import Task, Workers


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

    Meshes whose arrays lie on a GPU are computed there, up to `ahead` of them by one launch, on the stream of the thread
    that asks for the results; it is waited for. Their fields are those of `field`, each a `DeviceField`.

    Args:
        meshes: paths, or what `field` takes; any iterable, also one that never ends.
        workers: how many meshes are worked on at a time, each with one thread; by default two for each core, since one
            waits now and then: for its file, or for Python.
        ahead: how many results may wait; by default four for each worker.
        prepare: called with each mesh first, in a worker; returns what the field is computed of, in which the same axis
            points up unless it says another. For example to normalise the size, or to move the mesh to a GPU.
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


_DEFAULTS = {p.name: p.default for p in signature(field).parameters.values() if p.name != "mesh"}
_OPTIONS = _DEFAULTS.keys() - {"out", "progress"}


def _results(
    meshes: Iterable[Any],
    total: int | None,
    workers: int,
    waiting: int,
    prepare: Callable[[Any], Any] | None,
    progress: bool,
    options: dict[str, Any],
) -> Iterator[FieldResult]:
    def work(check: Callable[[], None], index: int, source: Any) -> FieldResult | OnGpu:
        try:
            mesh, up = source, ""
            if prepare is not None:
                given = as_mesh(source)
                mesh, up = prepare(given), given.up
            on_gpu = OnGpu.of(index, source, mesh, up)
            if on_gpu is None and up:
                mesh = as_mesh(mesh)
                mesh = Mesh(mesh.vertices, mesh.faces, up=mesh.up or up)
            return on_gpu or FieldResult(index, source, field(mesh, progress=lambda *_: check(), **options), None)
        except OF_A_MESH as error:
            return FieldResult(index, source, None, error)

    bar = None
    if progress:
        from tqdm.auto import tqdm

        bar = tqdm(total=total, desc="fields", unit="mesh")
    pending: deque[Task[FieldResult | OnGpu]] = deque()
    ready: deque[FieldResult] = deque()
    threads = Workers(workers, work)

    def next_result() -> FieldResult:
        if not ready:
            ready.extend(_finished(_next_group(pending, threads), {**_DEFAULTS, **options}))
        if bar is not None:
            bar.update()
        return ready.popleft()

    try:
        source = enumerate(meshes)
        for index, mesh in source:
            pending.append(threads.submit(index, mesh))
            if len(pending) + len(ready) >= waiting:
                yield next_result()
        while pending or ready:
            yield next_result()
    finally:
        threads.close()  # stops the fields that are being computed
        if bar is not None:
            bar.close()


def _next_group(
    pending: deque[Task[FieldResult | OnGpu]], threads: Workers[FieldResult | OnGpu]
) -> list[FieldResult | OnGpu]:
    """The next result; if that is a mesh on a GPU, with those behind it that are, and with errors between them."""
    group = [threads.result(pending.popleft())]
    # An error that is not a mesh's is raised in its turn.
    while isinstance(group[0], OnGpu) and pending and threads.error(pending[0]) is None:
        behind = threads.result(pending[0])
        if isinstance(behind, FieldResult) and behind.error is None:
            break
        group.append(behind)
        pending.popleft()
    return group


def _finished(group: list[FieldResult | OnGpu], options: dict[str, Any]) -> Iterator[FieldResult]:
    made = compute_together([each for each in group if isinstance(each, OnGpu)], options)
    for each in group:
        if isinstance(each, FieldResult):
            yield each
        else:
            answer = next(made)
            if isinstance(answer, Exception):
                yield FieldResult(each.index, each.source, None, answer)
            else:
                yield FieldResult(each.index, each.source, answer, None)
