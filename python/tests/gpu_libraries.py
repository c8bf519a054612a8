# SPDX-License-Identifier: Apache-2.0
"""The libraries that gpu_test.py takes its arrays from, and numpy's memory, which plays a GPU's (pretended_gpu.py)."""

from __future__ import annotations

import contextlib
import importlib

import numpy as np
import pytest
import standoff as so
from pretended_gpu import Standard


class Pretended:
    """Runs everywhere, on small meshes."""

    device = "emulated"
    rings, resolution = 8, 10

    def put(self, array):
        return Standard(np.array(array, order="C"))

    def view(self, array, index):
        return Standard(array.array[index])

    def get(self, array):
        return array.array

    def write(self, array, values):
        array.array[...] = values

    def address(self, array):
        return array.array.ctypes.data

    def strides(self, array):
        return array.array.strides

    def empty(self, shape):
        return Standard(np.full(shape, np.nan, np.float32, order="F"))

    def is_own(self, array):
        return type(array) is Standard

    def late_write(self, array, values):
        self.write(array, values)

    def new_stream(self):
        return 5

    def current(self, stream):
        return contextlib.nullcontext()

    def synchronize(self):
        pass


class OnGpu:
    device = "auto"
    rings, resolution = 60, 48


class Torch(OnGpu):
    def __init__(self):
        self.torch = importlib.import_module("torch")
        if not self.torch.cuda.is_available():
            pytest.skip("torch sees no GPU")

    def put(self, array):
        return self.torch.tensor(np.ascontiguousarray(array), device="cuda")

    def view(self, array, index):
        return array[index]

    def get(self, array):
        return array.cpu().numpy()

    def write(self, array, values):
        array.copy_(self.torch.as_tensor(values))

    def address(self, array):
        return array.data_ptr()

    def strides(self, array):
        return tuple(array.element_size() * step for step in array.stride())

    def empty(self, shape):
        return self.torch.full(shape[::-1], np.nan, device="cuda").permute(2, 1, 0)

    def is_own(self, array):
        return type(array) is self.torch.Tensor and array.is_cuda

    def late_write(self, array, values):
        """Puts a write on the current stream that only begins after some 50 ms."""
        new = self.put(values)
        self.torch.cuda.current_stream().synchronize()
        self.torch.cuda._sleep(100_000_000)
        array.copy_(new)

    def new_stream(self):
        return self.torch.cuda.Stream()

    def current(self, stream):
        return self.torch.cuda.stream(stream)

    def synchronize(self):
        self.torch.cuda.synchronize()

    def free_bytes(self):
        return self.torch.cuda.mem_get_info()[0]


SPIN = r"""
extern "C" __global__ void spin(long long cycles) {
  const long long began = clock64();
  while (clock64() - began < cycles) {}
}
"""


class Cupy(OnGpu):
    def __init__(self):
        self.cupy = importlib.import_module("cupy")
        if not self.cupy.cuda.is_available():
            pytest.skip("cupy sees no GPU")
        self.spin = self.cupy.RawKernel(SPIN, "spin")

    def put(self, array):
        return self.cupy.asarray(np.ascontiguousarray(array))

    def view(self, array, index):
        return array[index]

    def get(self, array):
        return array.get()

    def write(self, array, values):
        array.set(np.ascontiguousarray(values, array.dtype))

    def address(self, array):
        return array.data.ptr

    def strides(self, array):
        return array.strides

    def empty(self, shape):
        made = self.cupy.empty(shape, np.float32, order="F")
        made.fill(np.nan)
        return made

    def is_own(self, array):
        return type(array) is self.cupy.ndarray

    def late_write(self, array, values):
        """The same. Both are of one layout in memory."""
        new = self.put(values)
        self.cupy.cuda.get_current_stream().synchronize()
        self.spin((1,), (1,), (np.int64(100_000_000),))
        array.data.copy_from_device_async(new.data, new.nbytes, self.cupy.cuda.get_current_stream())
        self.kept = new  # until the copy is done

    def new_stream(self):
        return self.cupy.cuda.Stream(non_blocking=True)

    def current(self, stream):
        return stream

    def synchronize(self):
        self.cupy.cuda.Device().synchronize()

    def free_bytes(self):
        return self.cupy.cuda.Device().mem_info[0]


class Numba(OnGpu):
    """It has no current stream."""

    def __init__(self):
        self.cuda = importlib.import_module("numba.cuda")
        if not self.cuda.is_available():
            pytest.skip("numba sees no GPU")

    def synchronize(self):
        self.cuda.synchronize()

    def put(self, array):
        return self.cuda.to_device(np.ascontiguousarray(array))

    def view(self, array, index):
        return array[index]

    def get(self, array):
        return array.copy_to_host()

    def write(self, array, values):
        array.copy_to_device(np.ascontiguousarray(values, array.dtype))

    def address(self, array):
        return array.__cuda_array_interface__["data"][0]

    def strides(self, array):
        return array.strides

    def empty(self, shape):
        return self.cuda.to_device(np.full(shape, np.nan, np.float32, order="F"))

    def is_own(self, array):
        return self.cuda.is_cuda_array(array) and type(array).__module__.startswith("numba")


LIBRARIES = {"pretended": Pretended, "torch": Torch, "cupy": Cupy, "numba": Numba}


def library(name):
    """The library, made once; skips the test without it, or without a GPU."""
    found = _made.get(name)
    if found is None:
        if name != "pretended":
            expect_gpu()
            pytest.importorskip("numba.cuda" if name == "numba" else name)
        found = _made[name] = LIBRARIES[name]()
    return found


_made: dict[str, object] = {}


def expect_gpu():
    if not so.devices():
        pytest.skip("no GPU that standoff can use: so.devices() is empty")
