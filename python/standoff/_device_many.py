# SPDX-License-Identifier: Apache-2.0
"""Meshes of `fields` that lie on a GPU: as many as wait are computed by one launch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ._checks import runs_on
from ._device_arrays import current_stream, device_array
from ._device_compute import fields_on_gpu
from ._device_field import DeviceField
from ._device_mesh import MeshOnDevice, parts_on_gpu
from ._errors import OF_A_MESH, without_frames

_SIZES = ("grid", "resolution", "spacing", "shape", "padding", "band", "thickness")


@dataclass(frozen=True, eq=False)
class OnGpu:
    """A mesh that waits for its launch."""

    index: int
    source: Any
    parts: tuple[Any, Any]
    up: str
    written_on: frozenset[int]
    """The streams that the arrays' library works on in the thread that prepared them."""

    @staticmethod
    def of(index: int, source: Any, mesh: Any, up: str) -> OnGpu | None:
        """The mesh, if it lies on a GPU. Call it in the thread that made its arrays."""
        parts = parts_on_gpu(mesh)
        if parts is None:
            return None
        return OnGpu(index, source, parts, up, frozenset(filter(None, map(_stream_here, parts))))


def compute_together(waiting: Sequence[OnGpu], options: Mapping[str, Any]) -> Iterator[DeviceField | Exception]:
    """Their fields, or errors, in their order. `options` are all those of `field`.

    On the caller's thread: libraries have a current stream for each thread, and it is the caller's that is meant.
    """
    answers: dict[int, DeviceField | Exception] = {}
    groups: dict[Any, list[tuple[int, MeshOnDevice]]] = {}
    for place, one in enumerate(waiting):
        mesh = _placed(one, options)
        if isinstance(mesh, Exception):
            answers[place] = mesh
        else:
            groups.setdefault(mesh.worker, []).append((place, mesh))
    for group in groups.values():
        answers.update(zip((place for place, _ in group), _launched([mesh for _, mesh in group], options)))
    return (answers[place] for place in range(len(waiting)))


def _placed(one: OnGpu, options: Mapping[str, Any]) -> MeshOnDevice | Exception:
    try:
        device = runs_on(options["threads"], options["device"])[1]
        return MeshOnDevice(one.parts, device, options["stream"], one.written_on, one.up)
    except OF_A_MESH as error:
        return without_frames(error)


def _launched(meshes: Sequence[MeshOnDevice], options: Mapping[str, Any]) -> Sequence[DeviceField | Exception]:
    sizes = [options[name] for name in _SIZES]
    try:
        return fields_on_gpu(meshes, sizes, options["sign"], options["nearest"], options["method"])
    except OF_A_MESH as error:
        return [without_frames(error)] * len(meshes)


def _stream_here(array: Any) -> int | None:
    found = current_stream(array)
    if found is None and hasattr(array, "__cuda_array_interface__"):
        found = device_array(array, "array").stream
    return found
