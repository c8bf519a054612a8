# SPDX-License-Identifier: Apache-2.0
"""The real pyvista, Open3D and torch, where requirements-peers.txt is installed: each test runs if its package is there."""

import importlib.util
import pickle

import numpy as np
import pytest
import shapes
import standoff as so

POINTS = np.random.default_rng(1).uniform(-1, 1, (50, 3))


def needs(package):
    return pytest.mark.skipif(importlib.util.find_spec(package) is None, reason=f"{package} is not installed")


def is_cube(mesh, accuracy=1e-12):
    np.testing.assert_allclose(so.distance(mesh, POINTS), shapes.cube_distance(POINTS), atol=accuracy)
    assert so.report(mesh).volume == pytest.approx(1)


@needs("pyvista")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_pyvista():
    import pyvista

    vertices, faces = shapes.cube()
    is_cube(pyvista.Cube())  # of quads
    is_cube(pyvista.Cube().triangulate())
    is_cube(pyvista.PolyData.from_regular_faces(vertices, faces))
    is_cube(pyvista.ImageData(dimensions=(3, 3, 3), spacing=(0.5,) * 3, origin=(-0.5,) * 3))
    is_cube(pyvista.Cube().cast_to_unstructured_grid())
    with pytest.raises((ValueError, TypeError)):
        so.Mesh(pyvista.Cube().triangulate().points, pyvista.Cube().triangulate().faces)  # padded
    sphere = pyvista.Sphere()
    assert so.report(sphere).volume == pytest.approx(sphere.volume, rel=1e-5)


@needs("pyvista")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_pyvista_reads_our_fields(tmp_path):
    import pyvista

    for options in ({}, {"band": 2}):
        field = so.field(shapes.cube(), shape=(12, 9, 7), **options)
        field.save(tmp_path / "field.vti")
        grid = pyvista.read(tmp_path / "field.vti")
        assert grid.dimensions == field.shape
        np.testing.assert_allclose(grid.origin, field.grid.origin)
        np.testing.assert_allclose(grid.spacing, field.grid.spacing)
        values = np.asarray(grid.active_scalars).reshape(field.shape, order="F")
        np.testing.assert_array_equal(values, field.numpy())


@needs("open3d")
@pytest.mark.filterwarnings("ignore")
def test_open3d():
    import open3d

    vertices, faces = shapes.cube()
    legacy = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(vertices), open3d.utility.Vector3iVector(faces))
    is_cube(legacy)
    is_cube(open3d.t.geometry.TriangleMesh.from_legacy(legacy), 1e-6)
    scene = open3d.t.geometry.RaycastingScene()
    sphere = open3d.t.geometry.TriangleMesh.create_sphere()
    scene.add_triangles(sphere)
    theirs = scene.compute_signed_distance(POINTS.astype(np.float32)).numpy()
    np.testing.assert_allclose(so.distance(sphere, POINTS), theirs, atol=1e-5)


@needs("torch")
def test_torch_tensors_in_and_out():
    import torch

    vertices, faces = shapes.cube()
    mesh = (torch.from_numpy(vertices), torch.from_numpy(faces))
    is_cube(mesh)
    is_cube((mesh[0].clone().requires_grad_(), mesh[1].int()))
    made = so.Mesh(*mesh)
    assert made.vertices.__array_interface__["data"][0] == mesh[0].data_ptr()
    assert made.faces.__array_interface__["data"][0] == mesh[1].data_ptr()
    field = so.field(mesh, resolution=12)
    for dtype, expected in (
        (torch.float32, torch.float32),
        (torch.float64, torch.float64),
        (torch.int64, torch.float64),
    ):
        points = torch.from_numpy(POINTS).to(dtype)
        for ask in (
            lambda p: so.distance(mesh, p, sign=None),
            lambda p: so.distance(mesh, p, sign=None, closest=True).point,
            field,
            field.gradient,
        ):
            answers = ask(points)
            assert isinstance(answers, torch.Tensor) and answers.dtype == expected
            assert torch.equal(answers, torch.from_numpy(np.ascontiguousarray(ask(points.numpy()))))
    assert so.distance(mesh, torch.zeros(3), sign=None).shape == ()
    assert so.distance(mesh, torch.zeros(0, 3), sign=None).shape == (0,)
    bodies = so.Body(mesh), so.Body(mesh)
    for value in vars(so.collide(*bodies, torch.eye(4).expand(5, 4, 4))).values():
        assert isinstance(value, torch.Tensor) and value.shape == (5,)
    touching = so.contacts(*bodies, torch.eye(4))
    for name in ("point", "normal", "depth", "triangle_a", "triangle_b"):
        assert isinstance(getattr(touching, name), torch.Tensor) and len(getattr(touching, name)) == len(touching)
    for wrong in (
        torch.zeros(2, 3, dtype=torch.bfloat16),
        torch.zeros(2, 3, dtype=torch.complex64),
        torch.zeros(2, 3).to_sparse(),
    ):
        with pytest.raises((TypeError, ValueError)):
            so.distance(mesh, wrong, sign=None)


@needs("torch")
def test_fields_as_tensors():
    import torch

    full, band = so.field(shapes.cube(), resolution=12), so.field(shapes.cube(), resolution=12, band=2)
    memory = full.numpy().__array_interface__["data"][0]
    assert full.to_torch().data_ptr() == full.to_torch(copy=False).data_ptr() == memory
    assert full.to_torch(copy=True).data_ptr() != memory
    with pytest.raises(ValueError, match="^copy: "):
        band.to_torch(copy=False)
    for field in (full, band, pickle.loads(pickle.dumps(full))):
        tensor = field.to_torch()
        assert tensor.dtype == torch.float32 and tuple(tensor.shape) == field.shape
        np.testing.assert_array_equal(tensor.numpy(), field.numpy())
        np.testing.assert_array_equal(torch.from_dlpack(field).numpy(), field.numpy())
    out = torch.empty(12, 12, 12)
    so.field(shapes.cube(), shape=(12, 12, 12), out=out.numpy().T)
    np.testing.assert_array_equal(out.numpy().T, so.field(shapes.cube(), shape=(12, 12, 12)).numpy())
    with pytest.raises(TypeError):
        so.field(shapes.cube(), shape=(12, 12, 12), out=out)
