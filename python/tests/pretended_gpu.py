# SPDX-License-Identifier: Apache-2.0
"""A GPU's memory for tests without a GPU: numpy's memory plays it, the GPU's code runs on the CPU (device="emulated"),
and small classes offer that memory as the libraries for GPUs do."""

import ctypes
from types import SimpleNamespace as Thing

import numpy as np
import shapes
import standoff as so
from standoff import _core

VERTICES, FACES = shapes.cube()
ON_GPU = {"sign": None, "device": "emulated"}


class Cuda:
    """An array of the CUDA array interface alone, as numba's."""

    def __init__(self, array, **interface):
        self.array = array
        self.interface = interface

    @property
    def __cuda_array_interface__(self):
        return {**self.array.__array_interface__, "version": 3, **self.interface}


class DLTensor(ctypes.Structure):
    _fields_ = (
        ("data", ctypes.c_void_p),
        ("device_type", ctypes.c_int32),
        ("device_id", ctypes.c_int32),
        ("ndim", ctypes.c_int32),
        ("code", ctypes.c_uint8),
        ("bits", ctypes.c_uint8),
        ("lanes", ctypes.c_uint16),
        ("shape", ctypes.POINTER(ctypes.c_int64)),
        ("strides", ctypes.POINTER(ctypes.c_int64)),
        ("byte_offset", ctypes.c_uint64),
        ("manager", ctypes.c_void_p),
        ("deleter", ctypes.c_void_p),
    )


class Dlpack:
    """An array of DLPack alone, as jax's."""

    number = 0
    handed_out = []  # whose memory consumers read until they are done, and nothing tells when: all is kept

    def __init__(self, array):
        self.array = array
        self.streams = []

    def __dlpack_device__(self):
        return (2, self.number)

    def __dlpack__(self, *, stream=None, **_):
        self.streams.append(stream)
        a = self.array
        per_axis = ctypes.c_int64 * a.ndim
        shape, strides = per_axis(*a.shape), per_axis(*(s // a.itemsize for s in a.strides))
        code = "iuf".index(a.dtype.kind)
        tensor = DLTensor(a.ctypes.data, 2, self.number, a.ndim, code, 8 * a.itemsize, 1, shape, strides, 0, None, None)
        self.handed_out.append(tensor)
        new = ctypes.pythonapi.PyCapsule_New
        new.restype, new.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
        return new(ctypes.addressof(tensor), b"dltensor", None)


class Second(Dlpack):
    number = 1


class Standard(Cuda):
    """An array of a library that follows the array API."""

    device = "gpu"

    def __array_namespace__(self):
        return Thing(
            float32=np.float32,
            empty=lambda shape, dtype, device: Standard(np.full(shape, np.nan, dtype)) if device == "gpu" else None,
            permute_dims=lambda a, axes: Standard(a.array.transpose(axes)),
        )


class ListeningCore:
    """The compiled module, for tests to put in its place: it notes the streams that it is asked for."""

    def __init__(self):
        self.streams = []
        """The handle of the one that works, and of those that are waited for."""

    def __getattr__(self, name):
        return getattr(_core, name)

    def Stream(self, emulated, device, stream, after, *pool):  # noqa: N802
        self.streams.append((stream, after))
        return _core.Stream(emulated, device, stream, after, *pool)


def new_out(shape=(9, 9, 9), kind=Cuda):
    return kind(np.full(shape, np.nan, np.float32, order="F"))


def expected(vertices=VERTICES, faces=FACES, **options):
    return so.field((vertices, faces), sign=None, device="cpu", **options).numpy()
