# SPDX-License-Identifier: Apache-2.0
"""Gradients of distances in torch, compared with finite differences."""

import copy
import pickle

import numpy as np
import pytest
import shapes
import standoff as so

torch = pytest.importorskip("torch", reason="torch is not installed: nothing has a gradient to flow into")
# torch before 2 warns of numpy's newer types.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

VERTICES, FACES = shapes.sphere(8)
MESH = so.Mesh(VERTICES, FACES)
FIELD = so.field(MESH, resolution=24)


def points(count=20, size=1.0, **options):
    found = np.random.default_rng(5).uniform(-size, size, (count, 3))
    return torch.tensor(found, requires_grad=True, **options)


def vertices(**options):
    return torch.tensor(VERTICES, requires_grad=True, **options)


@pytest.mark.parametrize("sign", ["auto", None])
def test_gradients_of_points(sign):
    query = so.MeshQuery(MESH, sign=sign)
    for ask in (
        lambda p: so.distance(MESH, p, sign=sign),
        lambda p: so.distance(MESH, p, sign=sign, closest=True).distance,
        query.distance,
        lambda p: query.closest(p).distance,
    ):
        assert torch.autograd.gradcheck(ask, (points(),))
    p = points()
    d = query.distance(p)
    np.testing.assert_array_equal(d.detach().numpy(), query.distance(p.detach().numpy()))
    d.sum().backward()
    # The unit vector from the closest point, times the sign.
    way = p.detach() - query.closest(p.detach()).point
    expected = way / d.detach()[:, None]
    np.testing.assert_allclose(p.grad, expected, atol=1e-9)
    np.testing.assert_allclose(p.grad.norm(dim=1), 1, atol=1e-12)


def test_gradients_of_vertices():
    p = points().detach()
    for asked in (p, p.numpy(), p.tolist()):
        assert torch.autograd.gradcheck(lambda v, asked=asked: so.distance((v, FACES), asked), (vertices(),))
    assert torch.autograd.gradcheck(lambda v, q: so.MeshQuery(so.Mesh(v, FACES)).distance(q), (vertices(), points()))
    assert torch.autograd.gradcheck(lambda v: so.distance((v, torch.tensor(FACES)), p, sign=None), (vertices(),))
    # A mesh that moves as a whole has the gradient of points that move the other way.
    v, q = vertices(), points()
    so.distance((v, FACES), q).sum().backward()
    np.testing.assert_allclose(v.grad.sum(dim=0), -q.grad.sum(dim=0), atol=1e-12)


def test_a_descent_finds_the_sphere():
    p = points(50)
    optimizer = torch.optim.SGD([p], lr=0.5)
    query = so.MeshQuery(MESH)
    for _ in range(60):
        optimizer.zero_grad()
        query.distance(p).square().sum().backward()
        optimizer.step()
    assert abs(so.distance(MESH, p.detach().numpy())).max() < 1e-6


@pytest.mark.parametrize("outside", ["border", "bound"])
def test_gradients_of_fields(outside, tmp_path):
    assert torch.autograd.gradcheck(FIELD, (points(),))
    far = points(40, 3.0)
    assert torch.autograd.gradcheck(lambda p: FIELD(p, outside=outside), (far,))
    FIELD.save(tmp_path / "field.zarr")
    stored = so.open(tmp_path / "field.zarr")
    assert torch.autograd.gradcheck(lambda p: stored(p, outside=outside), (far,))


def test_precision_shape_and_graph():
    p = points(dtype=torch.float32)
    assert so.distance(MESH, p).dtype == torch.float32
    so.distance(MESH, p).sum().backward()
    assert p.grad.dtype == torch.float32 and p.grad.shape == p.shape
    v = vertices(dtype=torch.float32)
    one = so.distance((v, FACES), p[0])
    assert one.shape == ()
    one.backward()
    assert v.grad.dtype == torch.float32 and (v.grad != 0).any(dim=1).sum() <= 3
    with torch.no_grad():
        assert not so.distance((v, FACES), p).requires_grad
    assert not so.distance(MESH, p.detach()).requires_grad
    (slope,) = torch.autograd.grad(so.distance(MESH, p).sum(), p, create_graph=True)
    with pytest.raises(RuntimeError):
        slope.sum().backward()


def test_a_mesh_forgets_the_tensor_with_its_array():
    mesh = so.Mesh(vertices(), FACES)
    assert so.distance(mesh, points().detach()).requires_grad
    for other in (copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
        assert not so.distance(other, points().detach()).requires_grad
    mesh.vertices = VERTICES
    assert not so.distance(mesh, points().detach()).requires_grad


def test_answers_without_a_gradient_say_so():
    query, body = so.MeshQuery(MESH), so.Body(MESH)
    pose = torch.eye(4, requires_grad=True)
    for ask in (
        lambda: query.winding_number(points()),
        lambda: query.contains(points()),
        lambda: FIELD.gradient(points()),
        lambda: so.collide(body, body, pose),
        lambda: so.distance_between(body, body, pose),
    ):
        with pytest.raises(TypeError, match=r"(points|pose)s?: .*none flows through this answer; pass \w+\.detach"):
            ask()
