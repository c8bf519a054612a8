# SPDX-License-Identifier: Apache-2.0
"""Distances and winding numbers of a few points by looking at every triangle, in double precision: what fast answers are
compared with. Needs numpy."""

from pathlib import Path

import numpy as np


def read_mesh(folder):
    """What drivers save: vertices and triangles."""
    folder = Path(folder)
    return np.fromfile(folder / "vertices.f64").reshape(-1, 3), np.fromfile(folder / "triangles.u32", np.uint32).reshape(-1, 3)


def dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def segment_squares(p, a, b):
    """The squared distances of p from segments."""
    along = b - a
    length = dot(along, along)
    t = np.clip(np.divide(dot(p - a, along), length, out=np.zeros(len(a)), where=length > 0), 0, 1)
    off = p - (a + t[:, None] * along)
    return dot(off, off)


def distance(p, a, b, c):
    """Of p from the nearest of the triangles abc: from their edges, and from their planes where p is above the inside."""
    least = min(segment_squares(p, *edge).min() for edge in ((a, b), (b, c), (c, a)))
    normal = np.cross(b - a, c - a)
    square = dot(normal, normal)
    above = (square > 0) & (dot(np.cross(b - a, p - a), normal) >= 0) & (dot(np.cross(c - b, p - b), normal) >= 0) & (
        dot(np.cross(a - c, p - c), normal) >= 0)
    if above.any():
        least = min(least, (dot(p - a[above], normal[above]) ** 2 / square[above]).min())
    return np.sqrt(least)


def winding_number(p, a, b, c):
    """The sum of the signed solid angles of all triangles, of the full sphere."""
    a, b, c = a - p, b - p, c - p
    la, lb, lc = (np.sqrt(dot(v, v)) for v in (a, b, c))
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return np.arctan2(dot(a, np.cross(b, c)), below).sum() / (2 * np.pi)


def compare(vertices, triangles, points, answers, is_signed):
    """How far the answers are from the exact ones, as shares of the mesh's longest side, and how many signs are wrong:
    inside is where the winding number is above 1/2. {"largest_error", "wrong_signs", "compared"}"""
    corners = [vertices[triangles[:, n]] for n in range(3)]
    exact = np.array([distance(p, *corners) for p in points])
    found = {"largest_error": float(np.abs(np.abs(answers) - exact).max() / np.ptp(vertices, axis=0).max()),
             "compared": len(points), "wrong_signs": 0}
    if is_signed:
        inside = np.array([winding_number(p, *corners) for p in points])
        clear = np.abs(inside - 0.5) > 1e-9
        found["wrong_signs"] = int((((inside > 0.5) != (answers < 0)) & clear).sum())
    return found
