# SPDX-License-Identifier: Apache-2.0
"""Arrays of any library in, and out again as what came in."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from ._errors import DeviceError
from ._gradients import refuse_gradient, wants_gradient

_CPU_DEVICES = (1, 3)  # kDLCPU, kDLCUDAHost


def to_numpy(array: Any, what: str) -> np.ndarray:
    """`array` as numpy sees it, without a copy where it lies in the memory of the CPU."""
    if isinstance(array, np.ma.MaskedArray) and np.ma.is_masked(array):
        raise TypeError(f"{what}: some entries are masked; leave them out, or fill them with .filled()")
    if isinstance(array, np.ndarray):
        return np.asarray(array)  # of a subclass the plain array: what it does with indices and operators is its own
    if getattr(array, "requires_grad", False):
        array = array.detach()
    device_of = getattr(array, "__dlpack_device__", None)
    if device_of is not None:
        kind, number = device_of()
        kind = int(getattr(kind, "value", kind))  # an enumeration, of Open3D one that is no int
        if kind not in _CPU_DEVICES:
            raise DeviceError(
                f"{what}: the array is on device {number} of DLPack's kind {kind}, not in the memory of the CPU; "
                "copy it first, for example with .cpu()"
            )
        try:
            return np.from_dlpack(array)
        except (BufferError, RuntimeError, TypeError):  # types that DLPack or numpy does not know: as below
            pass
    if hasattr(array, "__cuda_array_interface__"):
        raise DeviceError(f"{what}: the array is in a GPU's memory; copy it to the CPU first, for example with .get()")
    try:
        return np.asarray(array)
    except (ValueError, TypeError) as error:
        raise TypeError(f"{what}: no array can be made of {type(array).__name__}: {error}") from error


def numbers(array: Any, what: str) -> np.ndarray:
    """The same, checked to hold real numbers."""
    found = to_numpy(array, what)
    if found.dtype.kind == "O":
        raise TypeError(f"{what}: must be an array of real numbers, not {type(array).__name__} of objects")
    if found.dtype.kind not in "fiu":
        raise TypeError(f"{what}: must be real numbers, not {found.dtype}; convert with .astype(float)")
    if found.dtype.itemsize > 8:
        raise TypeError(f"{what}: {found.dtype} would lose digits; convert with .astype(float)")
    return found


def doubles(array: Any, what: str, shape: str, *, last: int) -> np.ndarray:
    """(..., last) numbers, as doubles in C order; a copy unless they are that already."""
    found = numbers(array, what)
    if found.ndim == 0 or found.shape[-1] != last:
        raise ValueError(f"{what}: must have shape {shape}, not {found.shape}")
    return np.require(found, np.float64, ["C_CONTIGUOUS", "ALIGNED"])


def dlpack_of(
    array: np.ndarray,
    stream: Any,
    max_version: tuple[int, int] | None,
    dl_device: tuple[int, int] | None,
    *,
    shared: bool,
    copy: bool | None,
) -> Any:
    """The capsule of an array. One that is `shared` must not be written to: consumers before DLPack 1.0, and numpy
    before 2.1, have no word for that and get a copy, unless `copy` forbids it."""
    if stream is not None:
        raise BufferError("stream: the values are in the memory of the CPU, which has no streams; pass None")
    if dl_device is not None and tuple(map(int, dl_device)) != (1, 0):
        raise BufferError(f"dl_device: the values are on the CPU, (1, 0); copy them to {dl_device} afterwards")
    knows = max_version is not None and max_version >= (1, 0) and np.lib.NumpyVersion(np.__version__) >= "2.1.0"
    if not knows:
        if shared and copy is False:
            raise BufferError("copy: who asks has no word for memory that must not be written to; allow a copy")
        return (array.copy(order="K") if shared else array).__dlpack__()
    view = array.view()
    view.flags.writeable = not shared
    return view.__dlpack__(max_version=max_version)


def single(dtype: Any) -> bool:
    """Whether an array's numbers are floats of 32 bits or fewer, so that answers are float32 too."""
    kind = np.dtype(dtype)
    return bool(kind.kind == "f" and kind.itemsize < 8)


def like(source: Any) -> Callable[[np.ndarray], Any]:
    """What turns a numpy array into the kind of array that `source` is: numpy's for lists, torch's for tensors."""
    convert: Callable[[np.ndarray], Any]
    if type(source).__module__.partition(".")[0] == "torch":
        convert = sys.modules["torch"].from_numpy
        return convert
    namespace = getattr(source, "__array_namespace__", None)
    if namespace is not None and not isinstance(source, np.ndarray):
        convert = namespace().asarray
        return convert
    return lambda array: array


class Points:
    """Points (..., 3) that a user passed: as doubles, and how answers go back in their shape, type and library."""

    def __init__(self, points: Any, what: str = "points", *, gradient: bool = False) -> None:
        """With `gradient` the answers have one that may flow into a tensor of points; else such tensors are refused."""
        if not gradient:
            refuse_gradient(points, what)
        self.source = points
        self.flows = wants_gradient(points)
        found = numbers(points, what)
        self.array = doubles(found, what, "(..., 3)", last=3).reshape(-1, 3)
        self._shape = found.shape[:-1]
        self._single = single(found.dtype)
        self._wrap = like(points)

    def give(self, answers: np.ndarray) -> Any:
        """Answers, one row for each point: floats get the points' precision; one point gives an array without axes."""
        if self._single and answers.dtype == np.float64:
            with np.errstate(over="ignore"):  # infinite, then
                answers = answers.astype(np.float32)
        return self._wrap(answers.reshape(self._shape + answers.shape[1:]))
