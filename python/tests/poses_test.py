# SPDX-License-Identifier: Apache-2.0
"""Poses as matrices and quaternions, in any shape; and poses that are none."""

import math

import numpy as np
import pytest
import shapes
import standoff as so

CUBE = so.Body(shapes.cube())
RANDOM = np.random.default_rng(11)
QUERIES = {
    "collide": lambda poses, **options: so.collide(CUBE, CUBE, poses, **options),
    "distance": lambda poses, **options: so.distance_between(CUBE, CUBE, poses, **options),
    "sweep to": lambda poses, **options: so.sweep(CUBE, CUBE, np.broadcast_to(np.eye(4), (*shape_of(poses), 4, 4)), poses, **options),
    "sweep from": lambda poses, **options: so.sweep(CUBE, CUBE, poses, np.broadcast_to(np.eye(4), (*shape_of(poses), 4, 4)), **options),
}  # fmt: skip
every_query = pytest.mark.parametrize("ask", QUERIES.values(), ids=QUERIES.keys())


def shape_of(poses):
    shape = np.shape(poses)
    return shape[:-2] if shape[-2:] == (4, 4) else shape[:-1]


def random_poses(count):
    """The same poses, as quaternions and as matrices."""
    quaternions = RANDOM.normal(size=(count, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    translations = RANDOM.uniform(-2, 2, (count, 3))
    angles = 2 * np.arctan2(np.linalg.norm(quaternions[:, :3], axis=1), quaternions[:, 3])
    matrices = np.zeros((count, 4, 4))
    for n in range(count):
        matrices[n] = shapes.pose(translations[n], quaternions[n, :3], angles[n])
    return np.concatenate([translations, quaternions], axis=1), matrices


@every_query
def test_quaternions_and_matrices_agree(ask):
    sevens, matrices = random_poses(60)
    first, second = ask(sevens), ask(matrices)
    np.testing.assert_array_equal(
        first.hit if hasattr(first, "hit") else 0, second.hit if hasattr(second, "hit") else 0
    )
    for name in ("distance", "time"):
        if hasattr(first, name):
            np.testing.assert_allclose(getattr(first, name), getattr(second, name), atol=1e-6)
    sevens[:, 3:] *= -1  # the same rotations
    np.testing.assert_array_equal(vars(ask(sevens))["triangle_a"].shape, (60,))


@every_query
@pytest.mark.parametrize("shape", [(), (1,), (5,), (2, 3), (0,), (2, 0)])
def test_answers_have_the_shape_of_the_poses(ask, shape):
    count = math.prod(shape)
    sevens, matrices = random_poses(count)
    flat = ask(matrices)
    for poses in (sevens.reshape(*shape, 7), matrices.reshape(*shape, 4, 4)):
        found = ask(poses)
        for name, value in vars(found).items():
            vector = name.startswith(("point", "normal"))
            assert value.shape == (*shape, 3) if vector else value.shape == shape, name
            if poses.shape[-1] == 4:
                np.testing.assert_array_equal(value.reshape(vars(flat)[name].shape), vars(flat)[name])


def test_types_and_layouts():
    _, matrices = random_poses(6)
    matrices = matrices.astype(np.float32).astype(float)
    expected = so.distance_between(CUBE, CUBE, matrices).distance
    padded = np.full((12, 5, 5), np.nan)
    padded[::2, :4, :4] = matrices
    for same in (
        padded[::2, :4, :4],
        matrices.astype(np.float32),
        matrices.tolist(),
        matrices.astype(">f8"),
        np.asfortranarray(matrices),
    ):
        np.testing.assert_allclose(so.distance_between(CUBE, CUBE, same).distance, expected, atol=1e-6)
    assert so.collide(CUBE, CUBE, np.eye(4, dtype=int)).hit
    assert so.collide(CUBE, CUBE, [0, 0, 0, 0, 0, 0, 1]).hit


SCALED, SHEARED, MIRRORED, TRANSPOSED, LAST = (np.eye(4) for _ in range(5))
SCALED[:3, :3] *= 2
SHEARED[0, 1] = 0.5
MIRRORED[2, 2] = -1
TRANSPOSED = shapes.pose((1, 2, 3)).T
LAST[3, 3] = 2
WRONG = {
    "scaled": SCALED, "sheared": SHEARED, "mirrored": MIRRORED, "transposed": TRANSPOSED, "last row": LAST, "zeros": np.zeros((4, 4)),
    "no rotation": [0, 0, 0, 0, 0, 0, 0], "not of unit length": [0, 0, 0, 1, 1, 0, 0], "far": [1e200, 0, 0, 0, 0, 0, 1], "huge": [1e308] * 7,
    "(3, 3)": np.eye(3), "(3, 4)": np.eye(4)[:3], "(6,)": np.zeros(6), "(2, 8)": np.zeros((2, 8)), "scalar": 1.0, "empty": [],
    "strings": "identity", "string numbers": np.eye(4).astype(str), "objects": np.eye(4).astype(object),
    "complex": np.eye(4).astype(complex), "bool": np.eye(4).astype(bool), "ragged": [[1, 2], [3]], "object": object(), "dict": {},
}  # fmt: skip
for value in (np.nan, np.inf):
    for at in ((0, 0), (1, 3), (3, 3), (3, 0)):
        matrix = np.eye(4)
        matrix[at] = value
        WRONG[f"{value} at {at}"] = matrix
    for at in (0, 6):
        seven = np.array([0.0, 0, 0, 0, 0, 0, 1])
        seven[at] = value
        WRONG[f"{value} at {at} of 7"] = seven


@pytest.mark.parametrize("poses", WRONG.values(), ids=WRONG.keys())
def test_what_are_no_poses(poses):
    for ask in (
        lambda: so.collide(CUBE, CUBE, poses),
        lambda: so.collide(CUBE, CUBE, np.eye(4), pose_a=poses),
        lambda: so.distance_between(CUBE, CUBE, poses),
        lambda: so.sweep(CUBE, CUBE, poses, poses),
        lambda: so.contacts(CUBE, CUBE, poses),
    ):
        with pytest.raises((TypeError, ValueError)) as caught:
            ask()
        assert "pose" in str(caught.value) or "start" in str(caught.value)


def test_a_wrong_pose_among_many_is_named():
    poses = np.stack([np.eye(4)] * 300)
    poses[217, 0, 0] = 2
    for ask in QUERIES.values():
        with pytest.raises(so.UsageError, match="pose 217"):
            ask(poses)
