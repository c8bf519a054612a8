# SPDX-License-Identifier: Apache-2.0
"""Meshes whose distances, sides, areas and volumes have closed forms."""

from __future__ import annotations

import numpy as np

CUBE_VERTICES = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
CUBE_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


def cube(side: float = 1.0, centre=(0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """12 triangles, facing outwards."""
    return (CUBE_VERTICES - 0.5) * side + np.asarray(centre, float), CUBE_FACES.copy()


def cube_distance(points: np.ndarray, side: float = 1.0) -> np.ndarray:
    """Signed, of the cube about the origin."""
    q = np.abs(points) - side / 2
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)


def tetrahedron() -> tuple[np.ndarray, np.ndarray]:
    """The corner x + y + z <= 1 of the first octant."""
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return vertices, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def in_tetrahedron(points: np.ndarray) -> np.ndarray:
    return (points > 0).all(axis=-1) & (points.sum(axis=-1) < 1)


def sphere(rings: int = 12, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """A closed polyhedron with its vertices on the sphere; within `sphere_error` of it."""
    across = 2 * rings
    up = np.pi * np.arange(1, rings) / rings
    around = 2 * np.pi * np.arange(across) / across
    ring = np.stack(
        [
            np.outer(np.sin(up), np.cos(around)),
            np.outer(np.sin(up), np.sin(around)),
            np.outer(np.cos(up), np.ones(across)),
        ],
        axis=-1,
    )
    vertices = np.concatenate([ring.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]]) * radius
    top, bottom = len(vertices) - 2, len(vertices) - 1
    faces = []
    for n in range(across):
        m = (n + 1) % across
        faces += [[top, n, m], [bottom, (rings - 2) * across + m, (rings - 2) * across + n]]
        for r in range(rings - 2):
            a, b, c, d = r * across + n, r * across + m, (r + 1) * across + n, (r + 1) * across + m
            faces += [[a, c, d], [a, d, b]]
    return vertices, np.array(faces)


def sphere_error(rings: int = 12, radius: float = 1.0) -> float:
    """How far the polyhedron lies inside the sphere at most: each face spans less than these angles."""
    return radius * (1 - np.cos(np.pi / rings / 2) * np.cos(np.pi / rings / 2))


def sheet() -> tuple[np.ndarray, np.ndarray]:
    """A square without thickness: it has no inside."""
    return np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]])


def soup(triangles: int, seed: int = 1, size: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """Random triangles in the unit cube."""
    random = np.random.default_rng(seed)
    corners = random.random((triangles, 1, 3)) + size * (random.random((triangles, 3, 3)) - 0.5)
    return corners.reshape(-1, 3), np.arange(3 * triangles).reshape(-1, 3)


def pose(translation=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0), angle: float = 0.0) -> np.ndarray:
    """A (4, 4) matrix, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix[:3, 3] = translation
    return matrix
