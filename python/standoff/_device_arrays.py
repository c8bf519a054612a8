# SPDX-License-Identifier: Apache-2.0
"""Arrays in a GPU's memory, of any library: by ``__cuda_array_interface__`` or DLPack, without a copy."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from . import _core
from ._errors import DeviceError

_CUDA_KINDS = (2, 13)  # DLPack's kDLCUDA, kDLCUDAManaged
LEGACY_STREAM = 1  # CUDA's number for the stream that is meant where none is


@dataclass(frozen=True)
class DeviceArray:
    """Where an array lies."""

    pointer: int
    type: str
    """As numpy writes it, without the byte order: ``"f4"``."""
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    """Bytes."""
    device: int | None
    """The GPU's number, if the array tells."""
    stream: int | None
    """Of which CUDA's handle is known that it may still write the array."""
    writable: bool
    source: Any
    """What was passed."""
    owner: Any = None
    """What keeps the memory besides."""

    def rows(self, what: str, kinds: str) -> tuple[int, str, int, int]:
        """The array (n, 3), as the compiled module takes it."""
        if self.type[0] not in kinds or self.type[1:] not in ("4", "8"):
            numbers = "float32 or float64" if kinds == "f" else "integers of 32 or 64 bits"
            raise TypeError(f"{what}: must be {numbers} in a GPU's memory, not {self.type}; convert them there")
        if len(self.shape) != 2 or self.shape[1] != 3:
            raise ValueError(f"{what}: must have shape (n, 3), not {self.shape}")
        if self.shape[0] and self.strides[1] != int(self.type[1:]):
            raise ValueError(
                f"{what}: the three numbers of a row must be adjacent in a GPU's memory; pass a C-ordered copy"
            )
        return self.pointer, self.type, self.shape[0], self.strides[0]

    def in_threes(self) -> DeviceArray:
        """A flat array of indices as rows of three."""
        if len(self.shape) != 1 or self.shape[0] % 3 or self.strides[0] != int(self.type[1:]):
            return self
        step = self.strides[0]
        return DeviceArray(**{**vars(self), "shape": (self.shape[0] // 3, 3), "strides": (3 * step, step)})


def _detached(array: Any) -> Any:
    return array.detach() if getattr(array, "requires_grad", False) is True else array


def is_on_gpu(array: Any) -> bool:
    """Whether an array says that it lies in the memory of an NVIDIA GPU."""
    device_of = getattr(array, "__dlpack_device__", None)
    if device_of is not None and not isinstance(array, type):
        kind = device_of()[0]
        return int(getattr(kind, "value", kind)) in _CUDA_KINDS
    return not isinstance(array, type) and hasattr(array, "__cuda_array_interface__")


def device_array(array: Any, what: str, stream: int | None = None) -> DeviceArray:
    """Where an array on a GPU lies. By DLPack its library is asked to have it ready for `stream`."""
    array = _detached(array)
    number = int(array.__dlpack_device__()[1]) if hasattr(array, "__dlpack_device__") else None
    interface = getattr(array, "__cuda_array_interface__", None)
    if interface is not None:
        found = _of_interface(interface, number, array, what)
        knows_stream = found.stream is not None or _library(array) == "torch"  # see current_stream
        if knows_stream or not hasattr(array, "__dlpack__"):
            return found
        # Of jax, Warp: their work on the array may be under way, on a stream that only they know.
        return replace(found, owner=_imported(array, what, stream))
    imported = _imported(array, what, stream)
    return DeviceArray(
        imported.pointer,
        imported.type,
        tuple(imported.shape),
        tuple(imported.strides),
        number,
        None,
        True,
        array,
        imported,
    )


def _imported(array: Any, what: str, stream: int | None) -> Any:
    try:
        return _core.ImportedArray(array.__dlpack__(stream=LEGACY_STREAM if stream is None else stream))
    except (BufferError, TypeError) as error:
        raise DeviceError(f"{what}: its library does not hand out the memory: {error}; copy it to the CPU") from error


def _of_interface(interface: dict[str, Any], number: int | None, array: Any, what: str) -> DeviceArray:
    if interface.get("mask") is not None:
        raise TypeError(f"{what}: some entries may be masked; pass an array without a mask")
    kind = str(interface["typestr"])
    if kind[0] == (">" if sys.byteorder == "little" else "<"):
        raise TypeError(f"{what}: {kind} is in the other byte order; convert it")
    shape = tuple(int(n) for n in interface["shape"])
    strides = interface.get("strides")
    if strides is None:  # C order
        item = int(kind[2:])
        strides = [item * math.prod(shape[axis + 1 :]) for axis in range(len(shape))]
    pointer, read_only = interface["data"]
    made_on = interface.get("stream")
    return DeviceArray(
        int(pointer or 0),
        kind[1:],
        shape,
        tuple(int(n) for n in strides),
        number,
        None if made_on is None else int(made_on),
        not read_only,
        array,
    )


def stream_of(stream: Any) -> int:
    """The handle of a stream: a number, or an object of torch, cupy, numba, Warp or cuda.core."""
    if isinstance(stream, int) and not isinstance(stream, bool):
        handle = stream
    elif hasattr(stream, "__cuda_stream__"):
        protocol = stream.__cuda_stream__
        handle = int((protocol() if callable(protocol) else protocol)[1])
    else:
        for name in ("cuda_stream", "ptr", "handle"):  # torch and Warp, cupy, numba
            if hasattr(stream, name):
                found = getattr(stream, name)
                handle = int(getattr(found, "value", found) or 0)
                break
        else:
            raise TypeError(
                "stream: must be CUDA's handle as a number, or a stream of torch, cupy, numba or Warp, "
                f"not {type(stream).__name__}"
            )
    if handle < 0:
        raise ValueError(f"stream: {handle} is no handle of a stream")
    return handle or LEGACY_STREAM


def current_stream(array: Any) -> int | None:
    """The stream that torch puts work on, of a tensor's device; other libraries say it with the array."""
    if _library(array) != "torch":
        return None
    return stream_of(sys.modules["torch"].cuda.current_stream(array.device))


def new_values(like: Any, shape: Sequence[int]) -> Any:
    """A float32 array [i, j, k] in Fortran order, by the library of `like` on its device."""
    backwards = tuple(reversed(shape))
    library = _library(like)
    if library == "torch":
        torch = sys.modules["torch"]
        return torch.empty(backwards, dtype=torch.float32, device=like.device).permute(2, 1, 0)
    if library == "cupy":
        cupy = sys.modules["cupy"]
        with like.device:
            return cupy.empty(tuple(shape), cupy.float32, order="F")
    if library == "numba":
        return sys.modules["numba"].cuda.device_array(tuple(shape), "float32", order="F")
    if library == "warp":
        warp = sys.modules["warp"]
        return warp.empty(backwards, dtype=warp.float32, device=like.device).transpose((2, 1, 0))
    if not _makes_arrays(like):
        raise DeviceError(
            f"out: standoff cannot make arrays of {type(like).__module__}.{type(like).__name__} on a GPU; "
            f"pass out=, float32 of shape {tuple(shape)} in Fortran order"
        )
    xp = like.__array_namespace__()
    return xp.permute_dims(xp.empty(backwards, dtype=xp.float32, device=like.device), (2, 1, 0))


def _makes_arrays(like: Any) -> bool:
    """Whether the library of an array makes arrays that may be written to."""
    library = _library(like)
    known = library in ("torch", "cupy", "numba", "warp")
    return known or (hasattr(like, "__array_namespace__") and library not in ("jax", "jaxlib"))


class Pool:
    """Gives workspace as arrays of a library, which come from its pool."""

    def __init__(self, like: Any, stream: int) -> None:
        self._like = like
        self._stream = stream
        self._taken: dict[int, Any] = {}

    @staticmethod
    def of(like: Any, stream: int) -> Pool | None:
        """That of the library of an array, if it makes arrays. `stream` is the one that works."""
        return Pool(like, stream) if _makes_arrays(like) else None

    def allocate(self, size: int) -> int:
        """The address of so many bytes, a multiple of 256."""
        array = new_values(self._like, (-(-size // 4) + 64, 1, 1))
        start = device_array(array, "workspace", self._stream).pointer
        start += -start % 256
        self._taken[start] = array
        return start

    def release(self, start: int) -> None:
        del self._taken[start]


def _library(array: Any) -> str:
    return type(array).__module__.partition(".")[0]
