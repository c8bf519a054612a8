# SPDX-License-Identifier: Apache-2.0
"""Meshes in a GPU's memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from ._device_arrays import DeviceArray, current_stream, device_array, is_on_gpu, new_values, stream_of
from ._errors import DeviceError, UsageError
from ._options import Grid

# The vertices and faces of those who may have them on a GPU, by their attributes.
_PARTS: tuple[tuple[str, str, Callable[[Any], tuple[Any, Any]]], ...] = (
    ("vertices", "faces", lambda m: (m.vertices, m.faces)),
    ("vertex", "triangle", lambda m: (m.vertex.positions, m.triangle.indices)),  # open3d.t.geometry
    ("verts_packed", "faces_packed", lambda m: (m.verts_packed(), m.faces_packed())),  # pytorch3d
    ("points", "indices", lambda m: (m.points, m.indices)),  # warp.Mesh
)


def parts_on_gpu(mesh: Any) -> tuple[Any, Any] | None:
    """Vertices and faces, if they lie on a GPU: of ``(vertices, faces)``, or of an object of a library that has such."""
    parts = tuple(mesh) if isinstance(mesh, (tuple, list)) and len(mesh) == 2 else None
    for first, second, get in _PARTS:
        if parts is None and hasattr(mesh, first) and hasattr(mesh, second):
            parts = get(mesh)
    return parts if parts is not None and any(map(is_on_gpu, parts)) else None


class MeshOnDevice:
    """A mesh whose arrays lie on one GPU, and the stream that works on it."""

    def __init__(
        self,
        parts: tuple[Any, Any],
        device: str,
        stream: Any,
        written_on: Iterable[int] = frozenset(),
        up: str = "",
    ) -> None:
        """`written_on` are the handles of further streams that may still write the arrays."""
        vertices, faces = parts
        for array, what, other in ((vertices, "vertices", "faces"), (faces, "faces", "vertices")):
            if not is_on_gpu(array):
                raise DeviceError(f"{what}: are in the memory of the CPU, the {other} on a GPU; move one of them")
        handle = stream_of(stream) if stream is not None else current_stream(vertices)
        corners = device_array(vertices, "vertices", handle)
        if handle is None:
            handle = stream_of(corners.stream or 0)
        indices = device_array(faces, "faces", handle).in_threes()
        self.source = vertices
        self.up = up
        self.rows = corners.rows("vertices", "f"), indices.rows("faces", "iu")
        self.number = _number_of(device, corners, indices)
        self.emulated = device == "emulated"
        self.worker = self.emulated, self.number, handle
        """What works on it: meshes that agree here can share a launch."""
        self._handle = handle
        self._kept = (corners, indices)
        self._written_on = set(written_on)

    def other_streams(self, *outputs: DeviceArray) -> set[int]:
        """The streams that may still work on the mesh or on the outputs."""
        found = set(self._written_on)
        for array in (*self._kept, *outputs):
            found |= {stream for stream in (array.stream, current_stream(array.source)) if stream is not None}
        return {stream_of(stream) for stream in found} - {self._handle}

    def output(self, out: Any, grid: Grid) -> DeviceArray:
        """Where the values go: `out`, or a new array of the mesh's library."""
        if out is None:
            out = new_values(self.source, grid.shape)
        elif not is_on_gpu(out):
            raise DeviceError(f"out: must lie on the mesh's GPU, not be {type(out).__name__} in the memory of the CPU")
        found = device_array(out, "out", self._handle)
        if found.device is not None and found.device != self.number:
            raise DeviceError(f"out: is on cuda:{found.device}, the mesh on cuda:{self.number}; move one of them")
        if found.type != "f4" or found.shape != grid.shape:
            raise ValueError(f"out: must be float32 of shape {grid.shape}, not {found.type} of shape {found.shape}")
        if not found.writable:
            raise ValueError("out: is read-only")
        step, strides = 4, []
        for samples in grid.shape:
            strides.append(step)
            step *= samples
        if any(n > 1 and a != b for n, a, b in zip(grid.shape, found.strides, strides)):
            raise ValueError("out: must be in Fortran order, x fastest in memory, without gaps")
        return found


def _number_of(device: str, *arrays: DeviceArray) -> int:
    if device == "cpu":
        raise DeviceError("device: the mesh lies on a GPU, and 'cpu' was asked for; copy it to the CPU first")
    known = sorted({array.device for array in arrays if array.device is not None})
    if len(known) > 1:
        raise DeviceError(f"mesh: its arrays are on cuda:{known[0]} and cuda:{known[1]}; move one of them")
    if device.startswith("cuda:"):
        named = device.removeprefix("cuda:")
        if not named.isdecimal():
            raise UsageError(f"device {device!r}: after 'cuda:' give one GPU's number, from 0")
        if known and known[0] != int(named):
            raise DeviceError(f"device: the mesh lies on cuda:{known[0]}, and {device!r} was asked for; move the mesh")
        return int(named)
    if device not in ("auto", "cuda", "emulated"):
        raise UsageError(f"device: there is no {device!r}; take 'auto', 'cuda', 'cuda:N' or 'emulated'")
    return known[0] if known and device != "emulated" else 0
