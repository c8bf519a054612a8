# SPDX-License-Identifier: Apache-2.0
"""Meshes in a GPU's memory, which is pretended (pretended_gpu.py)."""

import ctypes
import gc
import sys
import warnings
import weakref
from types import SimpleNamespace as Thing

import numpy as np
import pytest
import standoff as so
from pretended_gpu import FACES, ON_GPU, VERTICES, Cuda, Dlpack, ListeningCore, Second, Standard, expected, new_out
from standoff import _device_arrays, _device_compute, _device_field

LAYOUTS = {
    "doubles": (VERTICES, FACES.astype(np.uint32)),
    "floats": (VERTICES.astype(np.float32), FACES.astype(np.int32)),
    "rows apart": (np.hstack([VERTICES, VERTICES])[:, 3:], np.hstack([FACES, -FACES])[:, :3].astype(np.int64)),
    "backwards": (VERTICES[::-1], (len(VERTICES) - 1 - FACES).astype(np.uint64)[::-1]),
}


@pytest.mark.parametrize("vertices, faces", LAYOUTS.values(), ids=LAYOUTS)
@pytest.mark.parametrize("kind", [Cuda, Dlpack])
@pytest.mark.parametrize("options", [{"resolution": 12, "band": 2}, {"shape": (9, 8, 7)}], ids=str)
def test_fields_have_the_bits_of_the_cpu(vertices, faces, kind, options):
    values = expected(vertices, faces, **options)
    out = new_out(values.shape, kind)
    field = so.field((kind(vertices), kind(faces)), out=out, **options, **ON_GPU)
    np.testing.assert_array_equal(out.array, values)
    assert field.values is out
    assert field.shape == values.shape
    assert field.grid == so.field((vertices, faces), sign=None, **options).grid
    assert field.computation["backend"] == "emulated"
    assert field.computation["triangles"] == 12


SIGNS = ["auto", "winding", "parity", "flood", so.Sign("winding", rule="odd", invert=True)]


@pytest.mark.parametrize("sign", SIGNS, ids=str)
@pytest.mark.parametrize("damage", ["none", "inside out", "a hole"])
def test_signs_are_those_of_the_cpu(sign, damage):
    faces = {"none": FACES, "inside out": FACES[:, ::-1].copy(), "a hole": FACES[1:]}[damage]
    options = {"grid": so.Grid((13, 12, 11), (-0.7, -0.6, -0.6), (0.15, 0.15, 0.15)), "thickness": 0.4, "sign": sign}
    mesh = (Cuda(VERTICES), Cuda(faces))
    out = new_out((13, 12, 11))
    if (sign, damage) == ("parity", "a hole"):
        with pytest.raises(so.MeshError, match="not closed"):
            so.field(mesh, out=out, **{**ON_GPU, **options})
        return
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        field = so.field(mesh, out=out, **{**ON_GPU, **options})
        on_gpu = [str(each.message) for each in told]
        wanted = so.field((VERTICES, faces), device="cpu", **options)
    assert on_gpu == [str(each.message) for each in told[len(on_gpu) :]]
    np.testing.assert_array_equal(out.array.view(np.uint32), wanted.numpy().view(np.uint32))
    assert field.signed and field.sign == wanted.sign and field.provenance["sign"] == wanted.provenance["sign"]
    assert (out.array < 0).any() or (sign, damage) == ("flood", "a hole")  # through which it floods
    np.testing.assert_array_equal(field.cpu().numpy(), wanted.numpy())


def test_a_doubtful_sign_is_an_error_where_it_must_be_sure():
    mesh, sign = (Cuda(VERTICES), Cuda(FACES[1:])), so.Sign("winding", strict=True)
    with pytest.raises(so.DoubtError, match="strict"):
        so.field(mesh, shape=(9, 9, 9), out=new_out(), **{**ON_GPU, "sign": sign})


class Pooled(Standard):
    """An array of a library that says what it makes, and may have no more memory."""

    alive, made, most = weakref.WeakSet(), [], None

    def __array_namespace__(self):
        def empty(shape, dtype, device):
            if self.most is not None and np.prod(shape) > self.most:
                raise RuntimeError("out of memory")
            new = Pooled(np.full(shape, np.nan, dtype))
            self.made.append(new.array.size)
            self.alive.add(new)
            return new

        def permuted(array, axes):
            new = Pooled(array.array.transpose(axes))
            self.alive.add(new)
            return new

        return Thing(float32=np.float32, empty=empty, permute_dims=permuted)


def test_workspace_comes_from_the_pool_of_the_library(monkeypatch):
    vertices, faces = VERTICES.astype(np.float32), FACES.astype(np.int64)
    field = so.field((Pooled(vertices), Pooled(faces)), shape=(9, 9, 9), **ON_GPU)
    np.testing.assert_array_equal(field.values.array, expected(vertices, faces, shape=(9, 9, 9)))
    assert len(Pooled.made) >= 3  # for the box, the field, and the work
    gc.collect()
    assert len(Pooled.alive) == 1  # only the field is left
    monkeypatch.setattr(Pooled, "most", 800)  # enough for the field
    with pytest.raises(so.Error, match="allocator"):
        so.field((Pooled(vertices), Pooled(faces)), grid=field.grid, **ON_GPU)
    del field
    gc.collect()
    assert not len(Pooled.alive)


def test_the_field_is_an_array_on_the_gpu():
    out = new_out()
    field = so.field((Cuda(VERTICES), Cuda(FACES)), shape=(9, 9, 9), out=out, **ON_GPU)
    assert isinstance(field, so.DeviceField) and isinstance(field, so.DistanceField)
    assert field.device == "cuda:0"
    assert field.__dlpack_device__() == (2, 0)
    interface = field.__cuda_array_interface__
    assert interface["data"] == (out.array.ctypes.data, False)
    assert interface["strides"] == out.array.strides and interface["shape"] == (9, 9, 9)
    assert field.nbytes == out.array.nbytes
    assert not field.signed and field.sign.method == "none"
    assert repr(field) == "<standoff.DeviceField: 9 x 9 x 9, full, unsigned, 2.92 kB on cuda:0>"
    host = field.cpu()
    assert host.device == "cpu" and host.cpu() is host
    np.testing.assert_array_equal(host.numpy(), expected(shape=(9, 9, 9)))
    assert not np.shares_memory(host.numpy(), out.array)
    assert host.grid == field.grid and host.provenance == field.provenance


def test_what_needs_the_cpu_says_so(tmp_path):
    import copy
    import pickle

    field = so.field((Cuda(VERTICES), Cuda(FACES)), shape=(9, 9, 9), band=2, out=new_out(), **ON_GPU)
    for use in (
        field.numpy,
        field.tiles,
        field.nearest,
        field.plot,
        field.show,
        lambda: np.asarray(field),
        lambda: field((0, 0, 0)),
        lambda: field.gradient((0, 0, 0)),
        lambda: field.save(tmp_path / "field.npz"),
        lambda: so.surface(field, at=0.1),
        lambda: so.verify(field, (VERTICES, FACES)),
        lambda: pickle.dumps(field),
    ):
        with pytest.raises(so.DeviceError, match=r"cpu\(\)"):
            use()
    assert copy.copy(field) is field and copy.deepcopy(field) is field
    assert not list(tmp_path.iterdir())


def test_the_meshs_library_makes_the_values():
    field = so.field((Standard(VERTICES), Standard(FACES)), resolution=12, band=2, **ON_GPU)
    assert type(field.values) is Standard
    np.testing.assert_array_equal(field.values.array, expected(resolution=12, band=2))


def test_torch_and_cupy_make_the_values(monkeypatch):
    def tensor(array):
        made = Torch(array)
        made.permute = lambda *axes: tensor(array.transpose(axes))
        return made

    class Torch(Cuda):
        device = "cuda"

    class Cupy(Cuda):
        class device:  # noqa: N801, as cupy's attribute
            def __enter__(self):
                return self

            def __exit__(self, *_):
                entered.append(True)

        device = device()

    entered = []
    Torch.__module__, Cupy.__module__ = "torch", "cupy._core.core"
    torch = Thing(
        float32=np.float32,
        empty=lambda shape, dtype, device: tensor(np.empty(shape, dtype)),
        cuda=Thing(current_stream=lambda device: Thing(cuda_stream=77)),
    )
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.setitem(
        sys.modules, "cupy", Thing(float32=np.float32, empty=lambda *a, order: Cupy(np.empty(*a, order=order)))
    )
    for kind in (Torch, Cupy):
        field = so.field((kind(VERTICES), kind(FACES)), shape=(9, 8, 7), **ON_GPU)
        assert type(field.values) is kind
        np.testing.assert_array_equal(field.values.array, expected(shape=(9, 8, 7)))
    assert len(entered) > 1  # for the field, and for the work


MESHES = {
    "trimesh": lambda v, f: Thing(vertices=v(VERTICES), faces=f(FACES)),
    "open3d tensor": lambda v, f: Thing(vertex=Thing(positions=v(VERTICES)), triangle=Thing(indices=f(FACES))),
    "pytorch3d": lambda v, f: Thing(verts_packed=lambda: v(VERTICES), faces_packed=lambda: f(FACES)),
    "warp": lambda v, f: Thing(points=v(VERTICES), indices=f(FACES.astype(np.int32).ravel())),
}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
def test_objects_of_other_libraries(mesh):
    out = new_out()
    so.field(mesh(Cuda, Cuda), shape=(9, 9, 9), out=out, **ON_GPU)
    np.testing.assert_array_equal(out.array, expected(shape=(9, 9, 9)))


class Protocol:
    def __cuda_stream__(self):
        return (0, 9)


STREAMS = {
    "handle": (7, 7),
    "none named": (0, 1),
    "protocol": (Protocol(), 9),
    "torch": (Thing(cuda_stream=11), 11),
    "torch's default": (Thing(cuda_stream=0), 1),
    "cupy": (Thing(ptr=13), 13),
    "numba": (Thing(handle=ctypes.c_void_p(15)), 15),
    "numba's default": (Thing(handle=ctypes.c_void_p(0)), 1),
}


@pytest.fixture
def asked(monkeypatch):
    """What streams the compiled module got: the one that works, and those that are waited for."""
    core = ListeningCore()
    monkeypatch.setattr(_device_compute, "_core", core)
    return core.streams


@pytest.mark.parametrize("stream, handle", STREAMS.values(), ids=STREAMS)
def test_work_goes_to_the_callers_stream(asked, stream, handle):
    so.field((Cuda(VERTICES), Cuda(FACES)), shape=(9, 9, 9), out=new_out(), stream=stream, **ON_GPU)
    assert asked == 2 * [(handle, [])]  # for the mesh's bounds, and for its field
    vertices = Dlpack(VERTICES)
    so.field((vertices, Cuda(FACES)), shape=(9, 9, 9), out=new_out(), stream=stream, **ON_GPU)
    assert vertices.streams == [handle]


def test_streams_that_still_write_the_arrays_are_waited_for(asked):
    def run(vertices, faces, out, stream=None):
        arrays = [Cuda(a, stream=n) for a, n in ((VERTICES, vertices), (FACES, faces))]
        out = Cuda(np.zeros((9, 9, 9), np.float32, order="F"), stream=out)
        so.field(tuple(arrays), shape=(9, 9, 9), out=out, stream=stream, **ON_GPU)
        return asked.pop()

    assert run(5, 5, 5) == (5, [])
    assert run(5, 6, 7) == (5, [6, 7])
    assert run(None, 6, None) == (1, [6])
    assert run(5, None, 1, stream=9) == (9, [1, 5])
    assert run(1, 1, 1, stream=0) == (1, [])


def test_a_library_that_names_no_stream_is_asked_to_have_its_arrays_ready():
    class Asked(Cuda, Dlpack):  # as jax's and Warp's
        def __init__(self, array, **interface):
            Dlpack.__init__(self, array)
            Cuda.__init__(self, array, **interface)

    silent, named, out = Asked(VERTICES), Asked(FACES, stream=5), Asked(new_out().array)
    so.field((silent, named), shape=(9, 9, 9), out=out, stream=7, **ON_GPU)
    assert (silent.streams, named.streams, out.streams) == ([7], [], [7])
    np.testing.assert_array_equal(out.array, expected(shape=(9, 9, 9)))
    read_only = Asked(new_out().array, data=(64, True))
    fails(ValueError, "^out: is read-only", out=read_only)


def test_a_copy_to_the_cpu_needs_no_stream_that_may_be_gone(monkeypatch):
    field = so.field((Cuda(VERTICES), Cuda(FACES)), shape=(9, 9, 9), out=new_out(), stream=7, **ON_GPU)
    core = ListeningCore()
    monkeypatch.setattr(_device_field, "_core", core)
    np.testing.assert_array_equal(field.cpu().numpy(), expected(shape=(9, 9, 9)))
    assert core.streams == [(1, [])]


def fails(error, match, mesh=None, **options):
    mesh = mesh or (Cuda(VERTICES), Cuda(FACES))
    out = new_out()
    with pytest.raises(error, match=match):
        so.field(mesh, **{"shape": (9, 9, 9), "out": out, **ON_GPU, **options})
    assert np.isnan(out.array).all()


def test_arguments_that_do_not_fit():
    fails(so.UsageError, "^sign: 'normal' .*copy", sign="normal")
    fails(so.UsageError, "^sign: 'outer' .*copy", sign=so.Sign("winding", outer=True))
    fails(so.UsageError, "^nearest: ", nearest=True)
    fails(so.DeviceError, "^device: .*copy", device="cpu")
    fails(so.UsageError, "^device: there is no 'gpu'", device="gpu")
    fails(so.UsageError, "GPU's number", device="cuda:x")
    fails(so.DeviceError, "cuda:1", mesh=(Second(VERTICES), Cuda(FACES)), device="cuda:0")
    fails(so.DeviceError, "cuda:0 and cuda:1", mesh=(Second(VERTICES), Dlpack(FACES)))
    fails(so.DeviceError, "^faces: .*move", mesh=(Cuda(VERTICES), FACES))
    fails(so.DeviceError, "^vertices: .*move", mesh=(VERTICES, Cuda(FACES)))
    fails(TypeError, "^stream: ", stream="main")
    fails(TypeError, "^stream: ", stream=True)
    fails(ValueError, "^stream: ", stream=-1)
    fails(so.UsageError, "method", method="magic")
    fails(so.UsageError, "thickness", thickness=-1, padding=2)
    with pytest.raises(ValueError, match="^stream: .*leave it out"):
        so.field((VERTICES, FACES), resolution=8, stream=1)
    if not so.devices():
        fails(so.DeviceError, "^cuda: ", device="auto")


def test_outs_that_do_not_fit():
    fails(so.DeviceError, "^out: ", out=np.zeros((9, 9, 9), np.float32, order="F"))
    fails(so.DeviceError, "^out: .*cuda:1", out=Second(np.zeros((9, 9, 9), np.float32, order="F")))
    fails(so.DeviceError, "^out: .*pass out=", out=None)
    fails(ValueError, "^out: must be float32", out=Cuda(np.zeros((9, 9, 9), order="F")))
    fails(ValueError, "^out: must be float32", out=Cuda(np.zeros((9, 9, 8), np.float32, order="F")))
    fails(ValueError, "^out: must be in Fortran order", out=Cuda(np.zeros((9, 9, 9), np.float32)))
    fails(ValueError, "^out: is read-only", out=Cuda(np.zeros((9, 9, 9), np.float32, order="F"), data=(64, True)))
    with pytest.raises(TypeError, match="^out: "):
        so.field((VERTICES, FACES), shape=(9, 9, 9), out=new_out())


def test_meshes_that_do_not_fit():
    for vertices in (VERTICES.astype(np.float16), VERTICES.astype(int), VERTICES.astype(complex)):
        fails(TypeError, "^vertices: must be float32", mesh=(Cuda(vertices), Cuda(FACES)))
    fails(TypeError, "^vertices: must be float32", mesh=(Dlpack(VERTICES.astype(np.float16)), Cuda(FACES)))
    fails(TypeError, "byte order", mesh=(Cuda(VERTICES.astype(">f8")), Cuda(FACES)))
    fails(TypeError, "mask", mesh=(Cuda(VERTICES, mask=Cuda(VERTICES)), Cuda(FACES)))
    fails(TypeError, "^faces: must be integers", mesh=(Cuda(VERTICES), Cuda(FACES.astype(float))))
    fails(ValueError, r"^faces: must have shape \(n, 3\)", mesh=(Cuda(VERTICES), Cuda(FACES.ravel()[:-1])))
    fails(ValueError, "^vertices: must have shape", mesh=(Cuda(VERTICES[:, :2]), Cuda(FACES)))
    fails(ValueError, "^vertices: .*C-ordered", mesh=(Cuda(np.asfortranarray(VERTICES)), Cuda(FACES)))
    fails(so.UsageError, "0 triangles", mesh=(Cuda(VERTICES), Cuda(FACES[:0])))
    for index in (-1, 8, 2**32, 2**40 + 1):
        faces = FACES.copy()
        faces[5, 1] = index
        for grid in ({}, {"shape": None, "out": None, "resolution": 8}):
            with pytest.raises(so.MeshError) as raised:
                so.field((Standard(VERTICES), Standard(faces)), **{"shape": (9, 9, 9), **grid, **ON_GPU})
            assert raised.value.triangle == 5
    broken = VERTICES.copy()
    broken[FACES[7, 2], 1] = np.nan
    fails(so.MeshError, "triangle", mesh=(Cuda(broken), Cuda(FACES)))


def test_memory_that_a_library_keeps_to_itself():
    class Closed(Dlpack):
        def __dlpack__(self, **_):
            raise BufferError("it is mine")

    fails(so.DeviceError, "it is mine; copy", mesh=(Closed(VERTICES), Cuda(FACES)))


def test_arrays_know_where_they_lie():
    assert not _device_arrays.is_on_gpu(VERTICES)
    assert not _device_arrays.is_on_gpu(Cuda)
    assert not _device_arrays.is_on_gpu([1, 2, 3])
    assert _device_arrays.is_on_gpu(Cuda(VERTICES)) and _device_arrays.is_on_gpu(Dlpack(VERTICES))
