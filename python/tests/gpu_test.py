# SPDX-License-Identifier: Apache-2.0
"""Meshes in the memory of a real GPU, in arrays of torch, CuPy, numba and jax, against the CPU's bits. Without a GPU the
same tests run on small meshes with memory that is pretended, where that says something."""

from __future__ import annotations

import gc
import os
import threading
from types import SimpleNamespace as Thing

import numpy as np
import pytest
import shapes
import standoff as so
from gpu_libraries import expect_gpu, library

os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")  # jax would take most of the GPU
pytestmark = pytest.mark.filterwarnings("default")  # other libraries' are theirs

CUBE, WIDE = shapes.cube(), shapes.cube(2.0)
AROUND = {"grid": so.Grid((16, 16, 16), (-1.5, -1.5, -1.5), (0.2, 0.2, 0.2))}


@pytest.fixture(params=["pretended", "torch", "cupy", "numba"])
def lib(request):
    return library(request.param)


@pytest.fixture(params=["pretended", "torch", "cupy"])
def streaming(request):
    """A library with a current stream."""
    return library(request.param)


@pytest.fixture
def torch():
    return library("torch").torch


@pytest.fixture
def cupy():
    return library("cupy").cupy


def sphere_for(lib):
    return shapes.sphere(lib.rings)


def on_gpu(lib, vertices, faces):
    return lib.put(vertices), lib.put(faces)


def field_on(lib, mesh, **options):
    return so.field(mesh, **{"sign": None, "device": lib.device, **options})


def on_cpu(mesh, **options):
    return so.field(mesh, **{"sign": None, "device": "cpu", **options}).numpy()


def expect_bits(found, wanted):
    """One number says more than a page of differences."""
    assert found.shape == wanted.shape and found.dtype == wanted.dtype
    different = int((found.view(np.uint32) != wanted.view(np.uint32)).sum())
    assert different == 0, f"{different} of {found.size} samples differ, by up to {np.nanmax(np.abs(found - wanted))}"


def test_which_gpu():
    expect_gpu()
    first = so.devices()[0]
    print(f"\n{first.name}, {first.capability}, {first.memory_bytes} bytes")
    assert first.capability >= (7, 5) and first.memory_bytes > 1 << 30


# --- values

LAYOUTS = {
    "in place": (np.float64, np.uint32),
    "floats": (np.float32, np.int32),
    "long indices": (np.float64, np.int64),
    "floats and long indices": (np.float32, np.int64),
    "unsigned long indices": (np.float64, np.uint64),
}
SIZES = {
    "thin band": lambda n: {"resolution": n, "band": 2},
    "thick band": lambda n: {"resolution": n, "band": 6},
    "full": lambda n: {"resolution": n},
    "unequal sides": lambda n: {"shape": (n, n - 1, n // 2), "thickness": 0.3},
    "spacings per axis": lambda n: {"spacing": (2 / n, 3 / n, 4 / n), "band": 3},
    "a grid": lambda n: {"grid": so.Grid((n, n, n), (-0.3, -1.2, -1.1), (2.2 / n,) * 3, first=(16, 0, 32))},
}


@pytest.mark.parametrize("types", LAYOUTS.values(), ids=LAYOUTS)
def test_types_have_the_bits_of_the_cpu(lib, types):
    vertices, faces = sphere_for(lib)
    vertices, faces = vertices.astype(types[0]), faces.astype(types[1])
    options = {"resolution": lib.resolution, "band": 2}
    field = field_on(lib, on_gpu(lib, vertices, faces), **options)
    expect_bits(lib.get(field.values), on_cpu((vertices, faces), **options))
    assert field.computation["backend"] == ("emulated" if lib.device == "emulated" else "cuda")
    assert field.computation["triangles"] == len(faces)


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_sizes_have_the_bits_of_the_cpu(lib, size):
    mesh, options = sphere_for(lib), size(lib.resolution)
    field = field_on(lib, on_gpu(lib, *mesh), **options)
    wanted = so.field(mesh, sign=None, device="cpu", **options)
    assert field.grid == wanted.grid and field.thickness == wanted.thickness
    expect_bits(lib.get(field.values), wanted.numpy())


@pytest.mark.parametrize("method", ["propagate", "jumpflood", "jumpflood+1"])
def test_other_methods_have_the_bits_of_the_cpu(streaming, method):
    mesh, options = sphere_for(streaming), {"resolution": streaming.resolution, "band": 2, "method": method}
    expect_bits(streaming.get(field_on(streaming, on_gpu(streaming, *mesh), **options).values), on_cpu(mesh, **options))


def test_the_thesis_skips_no_triangle_there(streaming):
    mesh, options = sphere_for(streaming), {"resolution": streaming.resolution, "band": 2}
    field = field_on(streaming, on_gpu(streaming, *mesh), method="thesis", **options)
    np.testing.assert_allclose(streaming.get(field.values), on_cpu(mesh, **options), atol=2e-6)


def test_rows_apart_and_backwards(streaming):
    vertices, faces = sphere_for(streaming)
    options = {"resolution": streaming.resolution, "band": 2}
    wanted, put, view = on_cpu((vertices, faces), **options), streaming.put, streaming.view
    columns = (
        view(put(np.hstack([vertices, vertices, vertices])), (slice(None), slice(3, 6))),
        view(put(np.hstack([-faces, faces])), (slice(None), slice(3, None))),
    )
    meshes = [columns, (put(vertices), view(put(np.repeat(faces, 2, axis=0)), slice(None, None, 2)))]
    if not hasattr(streaming, "torch"):  # which has no negative strides
        meshes.append((view(put(vertices[::-1]), slice(None, None, -1)), put(faces)))
    for mesh in meshes:
        expect_bits(streaming.get(field_on(streaming, mesh, **options).values), wanted)


def test_flat_indices_and_objects_of_other_libraries(lib):
    vertices, faces = CUBE
    wanted = on_cpu(CUBE, shape=(9, 8, 7))
    flat = lib.put(vertices), lib.put(faces.astype(np.int32).ravel())
    expect_bits(lib.get(field_on(lib, flat, shape=(9, 8, 7)).values), wanted)
    vertices, faces = on_gpu(lib, vertices, faces)
    trimesh = Thing(vertices=vertices, faces=faces)
    open3d = Thing(vertex=Thing(positions=vertices), triangle=Thing(indices=faces))
    for mesh in (trimesh, open3d):
        expect_bits(lib.get(field_on(lib, mesh, shape=(9, 8, 7)).values), wanted)


def test_a_large_field():
    lib = library("torch")
    mesh = shapes.sphere(200)
    field = field_on(lib, on_gpu(lib, *mesh), resolution=256, band=3)
    expect_bits(lib.get(field.values), on_cpu(mesh, resolution=256, band=3))


# --- the field as an array


def test_the_field_is_an_array_of_the_meshs_library(lib):
    field = field_on(lib, on_gpu(lib, *CUBE), shape=(9, 8, 7))
    assert isinstance(field, so.DeviceField) and field.device == "cuda:0"
    assert lib.is_own(field.values) and lib.get(field.values).shape == field.shape == (9, 8, 7)
    assert lib.strides(field.values) == (4, 36, 288)  # x varies fastest
    interface = field.__cuda_array_interface__
    assert interface["data"] == (lib.address(field.values), False)
    assert field.__dlpack_device__() == (2, 0)
    host = field.cpu()
    assert type(host) is so.DistanceField and host.grid == field.grid
    expect_bits(host.numpy(), on_cpu(CUBE, shape=(9, 8, 7)))
    with pytest.raises(so.DeviceError, match=r"cpu\(\)"):
        field.numpy()


def test_values_are_written_to_out(lib):
    out = lib.empty((9, 8, 7))
    field = field_on(lib, on_gpu(lib, *CUBE), shape=(9, 8, 7), out=out)
    assert field.values is out
    expect_bits(lib.get(out), on_cpu(CUBE, shape=(9, 8, 7)))
    for bad in (lib.empty((9, 8, 8)), lib.put(np.zeros((9, 8, 7), np.float32)), lib.put(np.zeros((9, 8, 7)))):
        with pytest.raises(ValueError, match="^out: must be"):
            field_on(lib, on_gpu(lib, *CUBE), shape=(9, 8, 7), out=bad)


def test_torch_and_cupy_read_each_others_fields_without_a_copy(torch, cupy):
    lib = library("torch")
    of_torch = field_on(lib, on_gpu(lib, *CUBE), shape=(9, 8, 7))
    of_cupy = field_on(library("cupy"), on_gpu(library("cupy"), *CUBE), shape=(9, 8, 7))
    for field, address in ((of_torch, of_torch.values.data_ptr()), (of_cupy, of_cupy.values.data.ptr)):
        assert torch.from_dlpack(field).data_ptr() == address
        assert torch.as_tensor(field, device="cuda").data_ptr() == address
        assert field.to_torch().data_ptr() == address
        assert field.to_torch(copy=True).data_ptr() != address
        assert cupy.from_dlpack(field).data.ptr == address
        assert cupy.asarray(field).data.ptr == address
        for read in (torch.from_dlpack(field).cpu().numpy(), cupy.asarray(field).get()):
            expect_bits(read, on_cpu(CUBE, shape=(9, 8, 7)))


def test_values_of_one_library_for_a_mesh_of_another(torch, cupy):
    out = library("cupy").empty((9, 8, 7))
    field = field_on(library("torch"), on_gpu(library("torch"), *CUBE), shape=(9, 8, 7), out=out)
    assert field.values is out
    expect_bits(out.get(), on_cpu(CUBE, shape=(9, 8, 7)))


def test_values_lie_in_the_pool_of_their_library(torch, cupy):
    lib = library("torch")
    mesh = on_gpu(lib, *CUBE)
    before = torch.cuda.memory_allocated()
    field = field_on(lib, mesh, shape=(64, 64, 64))
    assert torch.cuda.memory_allocated() - before == field.nbytes
    del field
    assert torch.cuda.memory_allocated() == before
    mesh, pool = on_gpu(library("cupy"), *CUBE), cupy.get_default_memory_pool()
    before = pool.used_bytes()
    field = field_on(library("cupy"), mesh, shape=(64, 64, 64))
    assert pool.used_bytes() - before == field.nbytes


# --- tensors of torch


def test_tensors_that_require_gradients_and_parameters(torch):
    lib = library("torch")
    vertices, faces = on_gpu(lib, *CUBE)
    for mesh in ((vertices.clone().requires_grad_(), faces), (torch.nn.Parameter(vertices.clone()), faces)):
        field = field_on(lib, mesh, shape=(9, 8, 7))
        assert lib.is_own(field.values) and not field.values.requires_grad
        expect_bits(lib.get(field.values), on_cpu(CUBE, shape=(9, 8, 7)))


def test_pinned_tensors_are_the_cpus(torch):
    mesh = tuple(torch.tensor(a).pin_memory() for a in CUBE)
    field = so.field(mesh, shape=(9, 8, 7), sign=None)
    assert field.device == "cpu"
    expect_bits(field.numpy(), on_cpu(CUBE, shape=(9, 8, 7)))


# --- streams. The wide cube's vertices are overwritten late: who does not wait sees the old ones.


def expect_the_cube(lib, field):
    expect_bits(lib.get(field.values), on_cpu(CUBE, **AROUND))


def test_the_write_is_late(streaming):
    """Else the next tests would say nothing."""
    if streaming.device == "emulated":
        pytest.skip("pretended memory is written at once")
    vertices, _ = on_gpu(streaming, *WIDE)
    stream, other = streaming.new_stream(), streaming.new_stream()
    streaming.synchronize()
    with streaming.current(stream):
        streaming.late_write(vertices, CUBE[0])
    with streaming.current(other):
        seen = streaming.get(vertices)
    streaming.synchronize()
    np.testing.assert_array_equal(seen, WIDE[0])
    np.testing.assert_array_equal(streaming.get(vertices), CUBE[0])


def test_work_on_the_current_stream_is_waited_for(streaming):
    for stream in (None, streaming.new_stream()):
        mesh = on_gpu(streaming, *WIDE)
        streaming.synchronize()
        if stream is None:
            streaming.late_write(mesh[0], CUBE[0])
            field = field_on(streaming, mesh, **AROUND)
        else:
            with streaming.current(stream):
                streaming.late_write(mesh[0], CUBE[0])
                field = field_on(streaming, mesh, **AROUND)
        expect_the_cube(streaming, field)


def test_work_on_the_stream_that_is_passed_is_waited_for(streaming):
    mesh, stream = on_gpu(streaming, *WIDE), streaming.new_stream()
    streaming.synchronize()
    with streaming.current(stream):
        streaming.late_write(mesh[0], CUBE[0])
    expect_the_cube(streaming, field_on(streaming, mesh, stream=stream, **AROUND))


def test_the_current_stream_is_waited_for_where_another_one_works(streaming):
    mesh, stream = on_gpu(streaming, *WIDE), streaming.new_stream()
    streaming.synchronize()
    streaming.late_write(mesh[0], CUBE[0])
    expect_the_cube(streaming, field_on(streaming, mesh, stream=stream, **AROUND))


def test_out_is_written_after_what_its_stream_still_writes(streaming):
    mesh, out, stream = on_gpu(streaming, *CUBE), streaming.empty((16, 16, 16)), streaming.new_stream()
    streaming.synchronize()
    if streaming.device != "emulated":
        streaming.late_write(out, np.zeros((16, 16, 16), np.float32))
    field = field_on(streaming, mesh, out=out, stream=stream, **AROUND)
    streaming.synchronize()
    expect_the_cube(streaming, field)


def test_a_handle_is_a_stream(torch):
    lib = library("torch")
    mesh, stream = on_gpu(lib, *WIDE), lib.new_stream()
    lib.synchronize()
    with lib.current(stream):
        lib.late_write(mesh[0], CUBE[0])
    expect_the_cube(lib, field_on(lib, mesh, stream=stream.cuda_stream, **AROUND))
    expect_the_cube(lib, field_on(lib, mesh, stream=0, **AROUND))


def test_a_field_outlives_its_stream(streaming):
    stream = streaming.new_stream()
    with streaming.current(stream):
        field = field_on(streaming, on_gpu(streaming, *CUBE), **AROUND)
    del stream
    gc.collect()
    expect_bits(field.cpu().numpy(), on_cpu(CUBE, **AROUND))


def test_vertices_that_are_changed_in_place(lib):
    vertices, faces = on_gpu(lib, *WIDE)
    first = field_on(lib, (vertices, faces), **AROUND)
    lib.write(vertices, CUBE[0])
    expect_the_cube(lib, field_on(lib, (vertices, faces), **AROUND))
    expect_bits(lib.get(first.values), on_cpu(WIDE, **AROUND))  # and the first field is as it was


def test_two_threads_with_streams_of_their_own(streaming):
    meshes = [shapes.sphere(4 + n) for n in range(4)]
    wanted = [on_cpu(mesh, **AROUND) for mesh in meshes]
    placed, errors = [on_gpu(streaming, *mesh) for mesh in meshes], []
    streaming.synchronize()

    def run(first):
        try:
            with streaming.current(streaming.new_stream()):
                for n in range(first, first + (2 if streaming.device == "emulated" else 20)):
                    field = field_on(streaming, placed[n % 4], **AROUND)
                    expect_bits(streaming.get(field.values), wanted[n % 4])
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=run, args=(n,)) for n in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors, errors


# --- many


def test_many_meshes_by_one_call(lib):
    count = 8 if lib.device == "emulated" else 100
    raw = [shapes.cube(1 + n / 10) if n % 3 else shapes.sphere(3 + n % 5) for n in range(count)]
    meshes = [on_gpu(lib, *mesh) for mesh in raw]
    options = {"resolution": 16, "band": 2}
    results = list(so.fields(meshes, ahead=count, sign=None, device=lib.device, **options))
    assert [result.index for result in results] == list(range(count))
    for result, mesh in zip(results, raw, strict=True):
        assert isinstance(result.unwrap(), so.DeviceField) and lib.is_own(result.field.values)
        expect_bits(lib.get(result.field.values), on_cpu(mesh, **options))


def test_bad_meshes_among_many(lib):
    broken, beyond = CUBE[0].copy(), CUBE[1].copy()
    broken[7], beyond[5, 1] = np.nan, 99
    meshes = [CUBE, (broken, CUBE[1]), (CUBE[0], beyond), WIDE, (CUBE[0], CUBE[1][:0])]
    results = list(so.fields([on_gpu(lib, *m) for m in meshes], ahead=9, sign=None, device=lib.device, **AROUND))
    kinds = [type(result.error) for result in results]
    assert kinds == [type(None), so.MeshError, so.MeshError, type(None), so.UsageError]
    assert results[1].error.triangle == 2 and results[2].error.triangle == 5
    for n in (0, 3):
        expect_bits(lib.get(results[n].field.values), on_cpu(meshes[n], **AROUND))


def test_meshes_that_workers_move_to_the_gpu(streaming):
    raw = [shapes.sphere(3 + n % 5) for n in range(6 if streaming.device == "emulated" else 40)]

    def late(mesh):
        vertices, faces = on_gpu(streaming, 2 * mesh.vertices, mesh.faces)
        streaming.late_write(vertices, mesh.vertices)
        return vertices, faces

    stream = streaming.new_stream()
    with streaming.current(stream):
        results = list(so.fields(raw, prepare=late, workers=4, ahead=16, sign=None, device=streaming.device, **AROUND))
    for result, mesh in zip(results, raw, strict=True):
        expect_bits(streaming.get(result.unwrap().values), on_cpu(mesh, **AROUND))


# --- errors


def test_bad_meshes_are_told(lib):
    for place, value in (((5, 1), 99), ((3, 0), -1), ((7, 2), 2**40)):
        faces = CUBE[1].astype(np.int64)
        faces[place] = value
        for options in ({"resolution": 8}, AROUND):
            with pytest.raises(so.MeshError) as raised:
                field_on(lib, on_gpu(lib, CUBE[0], faces), **options)
            assert raised.value.triangle == place[0]
    for value in (np.nan, np.inf):
        vertices = CUBE[0].copy()
        vertices[CUBE[1][7, 2], 1] = value
        for options in ({"resolution": 8}, AROUND):
            with pytest.raises(so.MeshError, match="triangle"):
                field_on(lib, on_gpu(lib, vertices, CUBE[1]), **options)


@pytest.mark.parametrize("sign", ["auto", "parity"])
def test_signs_are_those_of_the_cpu(lib, sign):
    (vertices, faces), (corners, walls) = sphere_for(lib), WIDE
    hollow = (np.concatenate([corners, vertices / 2]), np.concatenate([walls, faces[:, ::-1] + len(corners)]))
    for mesh in ((vertices, faces), (vertices, faces[:, ::-1].copy()), hollow, shapes.cube(1.0)):
        for options in (AROUND, {**AROUND, "thickness": 0.5}):
            made = field_on(lib, on_gpu(lib, *mesh), sign=sign, **options)
            expect_bits(lib.get(made.values), on_cpu(mesh, sign=sign, **options))
            assert made.signed


def test_types_and_shapes_are_told(lib):
    def fails(error, match, vertices, faces, **options):
        with pytest.raises(error, match=match):
            field_on(lib, on_gpu(lib, vertices, faces), **{**AROUND, **options})

    vertices, faces = CUBE
    fails(TypeError, "^vertices: must be float32", vertices.astype(np.float16), faces)
    fails(TypeError, "^vertices: must be float32", vertices.astype(np.int64), faces)
    fails(TypeError, "^faces: must be integers", vertices, faces.astype(float))
    fails(TypeError, "^faces: must be integers", vertices, faces.astype(np.int16))
    fails(ValueError, r"^faces: must have shape \(n, 3\)", vertices, faces[:, :2])
    fails(ValueError, "^vertices: must have shape", vertices[:, :2], faces)
    fails(so.UsageError, "0 triangles", vertices, faces[:0])
    fails(so.UsageError, "^nearest: ", vertices, faces, nearest=True)
    fails(so.UsageError, "^sign: 'normal'", vertices, faces, sign="normal")
    with pytest.raises(so.DeviceError, match="^faces: .*move"):
        field_on(lib, (lib.put(vertices), faces), **AROUND)
    with pytest.raises(so.DeviceError, match="^vertices: .*move"):
        field_on(lib, (vertices, lib.put(faces)), **AROUND)
    with pytest.raises(so.DeviceError, match="copy"):
        so.field(on_gpu(lib, *CUBE), sign=None, device="cpu", **AROUND)


def test_devices_by_number(torch):
    lib = library("torch")
    mesh = on_gpu(lib, *CUBE)
    for device in ("cuda", "cuda:0"):
        expect_bits(lib.get(so.field(mesh, sign=None, device=device, **AROUND).values), on_cpu(CUBE, **AROUND))
    with pytest.raises(so.DeviceError, match="cuda:1"):
        so.field(mesh, sign=None, device="cuda:1", **AROUND)


def test_other_functions_want_arrays_on_the_cpu(torch):
    mesh = on_gpu(library("torch"), *CUBE)
    for call in (lambda: so.Mesh(*mesh), lambda: so.Body(mesh), lambda: so.distance(CUBE, mesh[0])):
        with pytest.raises(so.DeviceError, match="copy"):
            call()


# --- memory


@pytest.mark.parametrize("name", ["torch", "cupy"])
def test_calls_leave_no_memory_behind(name):
    lib = library(name)
    mesh, bad = on_gpu(lib, *sphere_for(lib)), on_gpu(lib, CUBE[0], CUBE[1] + 1)

    def calls(count):
        for n in range(count):
            field_on(lib, mesh, resolution=32, band=2)
            if n % 4 == 0:
                list(so.fields([mesh, bad], sign=None, resolution=16))
        gc.collect()
        lib.synchronize()
        return lib.free_bytes()

    before = calls(20)
    assert before - calls(200) <= 2 << 20  # what CUDA hands out at least


# --- other libraries


def test_arrays_of_jax_that_are_still_computed():
    expect_gpu()
    jax = pytest.importorskip("jax")
    if jax.default_backend() != "gpu":
        pytest.skip("jax sees no GPU")
    vertices, faces = WIDE[0].astype(np.float32), CUBE[1].astype(np.int32)

    @jax.jit
    def shrunk(slow, corners):
        for _ in range(40):
            slow = slow @ slow / 4096  # of ones: it stays
        return corners * (slow[0, 0] / 2)

    slow = jax.numpy.ones((4096, 4096), jax.numpy.float32)
    shrunk(slow, vertices).block_until_ready()
    lib = library("torch")
    for _ in range(3):
        out = lib.empty((16, 16, 16))
        corners = shrunk(slow, vertices)
        so.field((corners, jax.numpy.asarray(faces)), sign=None, out=out, **AROUND)
        expect_bits(lib.get(out), on_cpu((np.asarray(corners), faces), **AROUND))
    with pytest.raises(so.DeviceError, match="out="):
        so.field((corners, jax.numpy.asarray(faces)), sign=None, **AROUND)


# --- meshes, points and poses of the CPU that a GPU works on

DEVICES = ["emulated", "cuda"]


@pytest.fixture(params=DEVICES)
def device(request):
    if request.param == "cuda":
        expect_gpu()
    return request.param


def test_fields_of_meshes_on_the_cpu(device):
    n = 12 if device == "emulated" else 100
    mesh = shapes.sphere(8 if device == "emulated" else 60)
    for options in ({"band": 2}, {"band": 2, "nearest": True}, {}, {"band": 2, "sign": None}):
        field = so.field(mesh, resolution=n, device=device, **options)
        wanted = so.field(mesh, resolution=n, device="cpu", **options)
        assert field.computation["backend"] == device and wanted.computation["backend"] == "cpu"
        expect_bits(field.numpy(), wanted.numpy())
        if options.get("nearest"):
            np.testing.assert_array_equal(field.nearest(), wanted.nearest())


def test_distances_of_points(device):
    query = so.MeshQuery(shapes.sphere(8 if device == "emulated" else 60))
    points = np.random.default_rng(3).uniform(-2, 2, (500 if device == "emulated" else 200_000, 3))
    np.testing.assert_array_equal(query.distance(points, device=device), query.distance(points, device="cpu"))
    found, wanted = (query.closest(points, device=where) for where in (device, "cpu"))
    for name in ("distance", "point", "triangle", "feature", "barycentric", "gradient"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name), err_msg=name)


def test_collisions_and_sweeps(device):
    count = 100 if device == "emulated" else 20_000
    a, b = so.Body(shapes.sphere(16)), so.Body(shapes.cube(0.7))
    random = np.random.default_rng(5)
    poses = np.stack([shapes.pose(at, axis, angle) for at, axis, angle in
                      zip(random.uniform(-2, 2, (count, 3)), random.normal(size=(count, 3)), random.uniform(0, 3, count))])  # fmt: skip
    found, wanted = (so.collide(a, b, poses, device=where).hit for where in (device, "cpu"))
    assert 0 < wanted.sum() < count
    np.testing.assert_array_equal(found, wanted)
    start, end = poses[: count // 10], poses[-(count // 10) :]
    found, wanted = (so.sweep(a, b, start, end, device=where) for where in (device, "cpu"))
    for name in ("hit", "time", "triangle_a", "triangle_b"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name), err_msg=name)
