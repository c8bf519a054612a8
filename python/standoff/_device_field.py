# SPDX-License-Identifier: Apache-2.0
"""Fields of meshes in a GPU's memory."""

from __future__ import annotations

import math
from typing import Any, NoReturn

import numpy as np

from . import _core
from ._device_arrays import LEGACY_STREAM, DeviceArray
from ._errors import DeviceError
from ._field import DistanceField


class DeviceField(DistanceField):
    """A full or clamped field whose values lie in a GPU's memory, as an array of the library that the mesh came in.

    `field` makes it of a mesh whose arrays lie there. Values are distances without a sign. Nothing is copied to the
    CPU on the way: what needs the values there, files, pictures, interpolation, is a `DeviceError`; ``cpu()`` copies.
    """

    _values: DeviceArray
    _number: int
    _emulated: bool

    def _placed(self, values: DeviceArray, number: int, emulated: bool) -> DeviceField:
        self._values, self._number, self._emulated = values, number, emulated
        return self

    @property
    def values(self) -> Any:
        """The value of every sample, ``(nx, ny, nz)`` float32, indexed ``[i, j, k]``.

        A tensor of torch for tensors of torch, an array of cupy for those of cupy, and so on; or the ``out`` that was
        passed. x varies fastest in memory. The values are written when the field is there; do not change them.
        """
        return self._values.source

    @property
    def device(self) -> str:
        """Which GPU: ``"cuda:0"``."""
        return f"cuda:{self._number}"

    def cpu(self) -> DistanceField:
        """The field with a copy of its values in the memory of the CPU."""
        dense = np.empty(self.shape, np.float32, order="F")
        # Nothing is left to wait for, and the stream that worked may be gone: cupy destroys one with its object.
        default = _core.Stream(self._emulated, self._number, LEGACY_STREAM, [])
        _core.copy_to_host(self._values.pointer, dense, default)
        return DistanceField._make(
            self._grid, self._thickness, self._provenance, dense=dense, sign=self._sign, computation=self._computation
        )

    @property
    def nbytes(self) -> int:
        return 4 * math.prod(self.shape)

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        a = self._values
        return {"shape": a.shape, "typestr": "<f4", "data": (a.pointer, False), "strides": a.strides, "version": 3}

    def __dlpack__(self, **options: Any) -> Any:
        return self.values.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return (2, self._number)

    def to_torch(self, *, copy: bool | None = None) -> Any:
        """The values as a torch tensor on the same GPU, without a copy unless ``copy=True``."""
        import torch

        values = self.values
        if not isinstance(values, torch.Tensor):
            values = torch.as_tensor(self, device=self.device)
        return values.clone() if copy else values

    def __repr__(self) -> str:
        return super().__repr__().replace("DistanceField", "DeviceField")[:-1] + f" on {self.device}>"

    def numpy(self) -> NoReturn:
        self._refuse()

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NoReturn:
        self._refuse()

    def _native(self) -> NoReturn:
        self._refuse()

    def _refuse(self) -> NoReturn:
        raise DeviceError(
            f"the field's values lie on {self.device}; take field.cpu(), which copies them, or field.values"
        )

    def __reduce__(self) -> NoReturn:
        raise DeviceError(f"a field on {self.device} cannot be pickled; take field.cpu()")

    def __deepcopy__(self, memo: Any) -> DistanceField:
        return self  # nothing changes a field
