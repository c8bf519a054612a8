# SPDX-License-Identifier: Apache-2.0
"""Meshes, points and poses that script/pictures draws: read, moved, made and written."""

import random
from pathlib import Path

import numpy as np
from drawing import read_stl, standoff, write_obj


def corners_of(mesh):
    standoff("convert", mesh, "-o", "corners.stl")
    return read_stl("corners.stl")


def moved(corners, place, axis=(0, 0, 1), degrees=0.0):
    """Turned about an axis through the origin, then moved: a pose of the program."""
    x, y, z = np.array(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return corners @ (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross).T + place


def pose(place, axis=(0, 0, 1), degrees=0.0):
    return ",".join(f"{v:.17g}" for v in (*place, *axis, degrees))


def write_corners(path, corners):
    write_obj(path, corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3))


def write_points(path, points):
    np.savetxt(path, np.atleast_2d(points), delimiter=",", header="x,y,z", comments="", fmt="%.6g")


def write_boxes(path, boxes):
    """Boxes, each from its least to its greatest corner."""
    corner = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    square = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    faces = square[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    vertices = [np.asarray(least) + corner * (np.asarray(greatest) - least) for least, greatest in boxes]
    write_obj(path, np.concatenate(vertices).astype(float), np.concatenate([faces + 8 * n for n in range(len(boxes))]))


def write_maze(path, across, along, cell=6.4, wall=0.8, height=4.0, seed=4):
    """A labyrinth without a roof, small enough to see its fly; returns the ways between its cells."""
    chance, ways, seen, stack = random.Random(seed), set(), {(0, 0)}, [(0, 0)]
    while stack:
        x, z = stack[-1]
        beside = [(x + 1, z), (x - 1, z), (x, z + 1), (x, z - 1)]
        beside = [(a, b) for a, b in beside if 0 <= a < across and 0 <= b < along and (a, b) not in seen]
        if beside:
            stack.append(chance.choice(beside))
            ways.add(frozenset([(x, z), stack[-1]]))
            seen.add(stack[-1])
        else:
            stack.pop()
    half = wall / 2
    boxes = [((-half, -0.4, -half), (across * cell + half, 0, along * cell + half))]
    for axis, lines, length in ((0, across, along), (2, along, across)):
        for line in range(lines + 1):
            cells = [((line + side, k) if axis == 0 else (k, line + side)) for k in range(length) for side in (-1, 0)]
            closed = [frozenset(cells[2 * k : 2 * k + 2]) not in ways for k in range(length)] + [False]
            begin = None
            for k, is_closed in enumerate(closed):
                if is_closed and begin is None:
                    begin = k
                if not is_closed and begin is not None:
                    least, greatest = np.zeros(3), np.full(3, height)
                    least[axis], greatest[axis] = line * cell - half, line * cell + half
                    least[2 - axis], greatest[2 - axis] = begin * cell - half, k * cell + half
                    boxes.append((least, greatest))
                    begin = None
    write_boxes(path, boxes)
    return ways


def write_cloud(path, points, distances):
    """Points with their distances, as standoff points writes them."""
    head = "\n".join(["ply", "format ascii 1.0", f"element vertex {len(points)}", *(f"property float {c}" for c in "xyz"), "property float distance", "end_header"])
    Path(path).write_text(head + "\n" + "\n".join(f"{x:.6g} {y:.6g} {z:.6g} {d:.6g}" for (x, y, z), d in zip(points.tolist(), distances.tolist())) + "\n")


def write_faces(path, filled, origin, spacing):
    """The faces between voxels that are filled and those that are not."""
    padded = np.pad(filled, 1)
    quads = []
    for axis in range(3):
        for side in (0, 1):
            beside = np.roll(padded, 1 - 2 * side, axis)
            cells = np.argwhere(padded & ~beside) - 1
            low = np.zeros(3)
            low[axis] = side
            one, other = np.roll((1.0, 0, 0), (axis + 1) % 3), np.roll((1.0, 0, 0), (axis + 2) % 3)
            square = [low, low + one, low + one + other, low + other]
            square = square if side else square[::-1]
            quads.append(cells[:, None, :] - 0.5 + np.array(square))
    quads = origin + spacing * np.concatenate(quads)
    write_corners(path, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3, 3))


def dense(a, b):
    """Points of a line, as near as beads."""
    return np.linspace(a, b, 60)
