# SPDX-License-Identifier: Apache-2.0
"""Meshes in a GPU's memory, and their fields."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import _core
from ._device_arrays import DeviceArray, current_stream, device_array, is_on_gpu, new_values, stream_of
from ._device_field import DeviceField
from ._errors import DeviceError, UsageError
from ._options import Box, Grid, SignReport

# The vertices and faces of those who may have them on a GPU, by their attributes.
_PARTS: tuple[tuple[str, str, Callable[[Any], tuple[Any, Any]]], ...] = (
    ("vertices", "faces", lambda m: (m.vertices, m.faces)),
    ("vertex", "triangle", lambda m: (m.vertex.positions, m.triangle.indices)),  # open3d.t.geometry
    ("verts_packed", "faces_packed", lambda m: (m.verts_packed(), m.faces_packed())),  # pytorch3d
    ("points", "indices", lambda m: (m.points, m.indices)),  # warp.Mesh
)


def mesh_on_device(mesh: Any, device: str, stream: Any) -> MeshOnDevice | None:
    """The mesh, if its arrays lie on a GPU: ``(vertices, faces)``, or an object of a library that has such."""
    parts = tuple(mesh) if isinstance(mesh, (tuple, list)) and len(mesh) == 2 else None
    for first, second, get in _PARTS:
        if parts is None and hasattr(mesh, first) and hasattr(mesh, second):
            parts = get(mesh)
    if parts is None or not any(map(is_on_gpu, parts)):
        return None
    vertices, faces = parts
    return MeshOnDevice(vertices, faces, device, stream)


class MeshOnDevice:
    """A mesh whose arrays lie on one GPU, and the stream that works on it."""

    def __init__(self, vertices: Any, faces: Any, device: str, stream: Any) -> None:
        for array, what, other in ((vertices, "vertices", "faces"), (faces, "faces", "vertices")):
            if not is_on_gpu(array):
                raise DeviceError(f"{what}: are in the memory of the CPU, the {other} on a GPU; move one of them")
        handle = stream_of(stream) if stream is not None else current_stream(vertices)
        corners = device_array(vertices, "vertices", handle)
        if handle is None:
            handle = stream_of(corners.stream or 0)
        indices = device_array(faces, "faces", handle).in_threes()
        self.source = vertices
        self.vertices = corners.rows("vertices", "f")
        self.faces = indices.rows("faces", "iu")
        self.number = _number_of(device, corners, indices)
        self._emulated = device == "emulated"
        self._handle = handle
        self._kept = (corners, indices)

    def stream(self, *outputs: DeviceArray) -> _core.Stream:
        """Their stream, which first waits for others that may still work on the mesh or on the outputs."""
        found = {stream_of(a.stream) for a in (*self._kept, *outputs) if a.stream is not None}
        for array in (*self._kept, *outputs):
            if (others := current_stream(array.source)) is not None:
                found.add(others)
        return _core.Stream(self._emulated, self.number, self._handle, sorted(found - {self._handle}))

    @property
    def bounds(self) -> Box:
        low, high = _core.device_bounds(self.vertices, self.faces, self.stream())
        return (low[0], low[1], low[2]), (high[0], high[1], high[2])

    def output(self, out: Any, grid: Grid) -> DeviceArray:
        """Where the values go: `out`, or a new array of the mesh's library."""
        if out is None:
            return device_array(new_values(self.source, grid.shape), "out", self._handle)
        if not is_on_gpu(out):
            raise DeviceError(f"out: must lie on the mesh's GPU, not be {type(out).__name__} in the memory of the CPU")
        found = device_array(out, "out", self._handle)
        if found.device is not None and found.device != self.number:
            raise DeviceError(f"out: is on cuda:{found.device}, the mesh on cuda:{self.number}; move one of them")
        if found.type != "f4" or found.shape != grid.shape:
            raise ValueError(f"out: must be float32 of shape {grid.shape}, not {found.type} of shape {found.shape}")
        if not found.writable:
            raise ValueError("out: is read-only")
        return found

    def field(self, grid: Grid, thickness: float, method: str, out: Any) -> DeviceField:
        values = self.output(out, grid)
        step, strides = 4, []
        for samples in grid.shape:
            strides.append(step)
            step *= samples
        if any(n > 1 and a != b for n, a, b in zip(grid.shape, values.strides, strides)):
            raise ValueError("out: must be in Fortran order, x fastest in memory, without gaps")
        stream = self.stream(values)
        done = _core.compute_on_device(
            self.vertices, self.faces, grid._core(), thickness, values.pointer, method, stream
        )
        sign, provenance = SignReport(**done.pop("sign")), done.pop("provenance")
        del done["method"]
        return DeviceField._make(grid, thickness, provenance, sign=sign, computation=done)._placed(
            values, self.number, stream
        )


def _number_of(device: str, *arrays: DeviceArray) -> int:
    if device == "cpu":
        raise DeviceError("device: the mesh lies on a GPU, and 'cpu' was asked for; copy it to the CPU first")
    known = sorted({array.device for array in arrays if array.device is not None})
    if len(known) > 1:
        raise DeviceError(f"mesh: its arrays are on cuda:{known[0]} and cuda:{known[1]}; move one of them")
    if device.startswith("cuda:"):
        named = device.removeprefix("cuda:")
        if not named.isdecimal():
            raise UsageError(f"device {device!r}: after 'cuda:' give the GPU's number, from 0")
        if known and known[0] != int(named):
            raise DeviceError(f"device: the mesh lies on cuda:{known[0]}, and {device!r} was asked for; move the mesh")
        return int(named)
    if device not in ("auto", "cuda", "emulated"):
        raise UsageError(f"device: there is no {device!r}; take 'auto', 'cuda', 'cuda:N' or 'emulated'")
    return known[0] if known and device != "emulated" else 0
