# SPDX-License-Identifier: Apache-2.0
"""Gradients of distances into torch. It is imported only where a tensor asks for a gradient."""

from __future__ import annotations

import sys
from functools import cache
from typing import Any

import numpy as np


def wants_gradient(array: Any) -> bool:
    """Whether the array is a tensor of torch that a gradient is to flow into."""
    if getattr(array, "requires_grad", False) is not True or type(array).__module__.partition(".")[0] != "torch":
        return False
    return bool(sys.modules["torch"].is_grad_enabled())


def refuse_gradient(array: Any, what: str) -> None:
    """An error where a gradient is to flow into a tensor that an answer has no gradient of."""
    if wants_gradient(array):
        raise TypeError(
            f"{what}: the tensor requires a gradient, and none flows through this answer; pass {what}.detach()"
        )


def tensor_of(points: Any) -> Any:
    """Points of another library, or lists, as a tensor of torch: float32 for float32, else float64."""
    import torch

    found = np.asarray(points)
    return torch.from_numpy(np.array(found, dtype=np.float32 if found.dtype == np.float32 else np.float64))


# Of the distance d of a point p to the point c of a triangle that is closest, signed or not. Its gradient in p is the unit
# vector g in which d grows fastest. c is the mean of the triangle's corners with its barycentric weights, and moves d by
# -g; that the weights change too moves c along the surface, where d has no slope.


def _forward(ctx: Any, values: Any, points: Any, slopes: Any, vertices: Any, corners: Any, weights: Any) -> Any:
    ctx.save_for_backward(slopes, corners, weights)
    ctx.points = None if points is None else points.dtype
    ctx.vertices = None if vertices is None else (vertices.shape, vertices.dtype)
    return values.clone()


def _backward(ctx: Any, grad: Any) -> Any:
    slopes, corners, weights = ctx.saved_tensors
    along = grad.unsqueeze(-1) * slopes
    to_points = along.to(ctx.points) if ctx.needs_input_grad[1] else None
    to_vertices = None
    if ctx.needs_input_grad[3]:
        shape, dtype = ctx.vertices
        shares = -(weights.unsqueeze(-1) * along.unsqueeze(-2)).reshape(-1, 3).to(dtype)
        to_vertices = shares.new_zeros(shape).index_add(0, corners.reshape(-1), shares)
    return None, to_points, None, to_vertices, None, None


@cache
def _function() -> Any:
    import torch
    from torch.autograd.function import once_differentiable

    functions = {"forward": staticmethod(_forward), "backward": staticmethod(once_differentiable(_backward))}
    return type("Distance", (torch.autograd.Function,), functions)


def differentiable(
    values: Any,
    points: Any,
    slopes: Any,
    vertices: Any = None,
    corners: np.ndarray | None = None,
    weights: Any = None,
) -> Any:
    """The tensor `values` ``(...)``, with a gradient.

    Args:
        points: the tensor ``(..., 3)`` that values were asked for, or anything where no gradient flows into it.
        slopes: a tensor ``(..., 3)``: the gradient of the values in the points.
        vertices: a tensor ``(n, 3)``, of a mesh whose distance the values are; None where there is none.
        corners: ``(..., 3)``: indices of the vertices of the triangles with the closest points.
        weights: a tensor ``(..., 3)``: the closest points' barycentric coordinates.
    """
    import torch

    given = points if wants_gradient(points) else None
    indices = None if corners is None else torch.from_numpy(corners.astype(np.int64))
    return _function().apply(values, given, slopes, vertices, indices, weights)
