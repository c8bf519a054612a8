# SPDX-License-Identifier: Apache-2.0
"""Answers by a comparison with every triangle, in double precision: slow, and easy to see to be right."""

from __future__ import annotations

import numpy as np


def closest_on_triangle(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """The nearest point of each triangle (m, 3) to each point (n, 3): (n, m, 3)."""
    p = p[:, None, :]
    best = np.broadcast_to(a, np.broadcast_shapes(p.shape, a.shape)).copy()
    least = ((p - best) ** 2).sum(-1)

    def offer(candidate: np.ndarray, allowed: np.ndarray | bool = True) -> None:
        distance_sq = ((p - candidate) ** 2).sum(-1)
        nearer = (distance_sq < least) & allowed
        best[nearer] = np.broadcast_to(candidate, best.shape)[nearer]
        least[nearer] = distance_sq[nearer]

    for first, second in ((a, b), (b, c), (c, a)):
        along = second - first
        length_sq = (along**2).sum(-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            t = np.where(length_sq > 0, ((p - first) * along).sum(-1) / length_sq, 0)
        offer(first + np.clip(t, 0, 1)[..., None] * along)
    normal = np.cross(b - a, c - a)
    area_sq = (normal**2).sum(-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        foot = p - (((p - a) * normal).sum(-1) / area_sq)[..., None] * normal
    inside = area_sq > 0
    for first, second in ((a, b), (b, c), (c, a)):
        inside = inside & ((np.cross(second - first, foot - first) * normal).sum(-1) >= 0)
    offer(np.nan_to_num(foot), inside)
    return best


def distance(mesh: tuple[np.ndarray, np.ndarray], points: np.ndarray) -> np.ndarray:
    """(n,) unsigned distances of points (n, 3)."""
    return distances(mesh, points).min(axis=1)


def distances(mesh: tuple[np.ndarray, np.ndarray], points: np.ndarray) -> np.ndarray:
    """(n, m): of each point to each triangle."""
    vertices, faces = np.asarray(mesh[0], float), np.asarray(mesh[1])
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    parts = np.array_split(points, max(1, len(points) * len(faces) // 200_000))
    return np.concatenate([np.linalg.norm(q[:, None] - closest_on_triangle(q, a, b, c), axis=-1) for q in parts])


def winding_number(mesh: tuple[np.ndarray, np.ndarray], points: np.ndarray) -> np.ndarray:
    """(n,): the sum of the triangles' solid angles by Van Oosterom and Strackee, as part of the full one."""
    vertices, faces = np.asarray(mesh[0], float), np.asarray(mesh[1])
    a, b, c = (vertices[faces[:, k]][None] - points[:, None] for k in range(3))
    x, y, z = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    over = (a * np.cross(b, c)).sum(-1)
    under = x * y * z + (a * b).sum(-1) * z + (b * c).sum(-1) * x + (c * a).sum(-1) * y
    return (2 * np.arctan2(over, under)).sum(axis=1) / (4 * np.pi)
