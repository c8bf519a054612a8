# SPDX-License-Identifier: Apache-2.0
"""Points of every shape and type in, answers of the same shape and precision out; and points that are none."""

import numpy as np
import pytest
import shapes
import standoff as so

QUERY = so.MeshQuery(shapes.cube(), sign="auto")
FIELD = so.field(shapes.cube(), resolution=24)
BAND = so.field(shapes.cube(), resolution=24, band=3)
RANDOM = np.random.default_rng(5)
SCALARS = {
    "distance": QUERY.distance,
    "function": lambda points: so.distance(shapes.cube(), points),
    "winding": QUERY.winding_number,
    "closest distance": lambda points: QUERY.closest(points).distance,
    "field": FIELD,
    "band": BAND,
}
VECTORS = {
    "closest point": lambda points: QUERY.closest(points).point,
    "barycentric": lambda points: QUERY.closest(points).barycentric,
    "closest gradient": lambda points: QUERY.closest(points).gradient,
    "field gradient": FIELD.gradient,
    "band gradient": BAND.gradient,
}
every_answer = pytest.mark.parametrize("ask", (SCALARS | VECTORS).values(), ids=(SCALARS | VECTORS).keys())


@every_answer
@pytest.mark.parametrize("shape", [(), (1,), (5,), (2, 3), (4, 1, 2), (0,), (3, 0), (2, 0, 5)])
@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.int32, np.uint8])
def test_shapes_and_types(ask, shape, dtype):
    points = RANDOM.uniform(0, 3, (*shape, 3)).astype(dtype)
    answers = ask(points)
    single = np.dtype(dtype).kind == "f" and np.dtype(dtype).itemsize < 8
    assert isinstance(answers, np.ndarray)
    assert answers.shape == (shape if ask in SCALARS.values() else (*shape, 3))
    assert answers.dtype == (np.float32 if single else np.float64)
    flat = ask(points.reshape(-1, 3).astype(np.float64))
    np.testing.assert_array_equal(answers.reshape(flat.shape), flat.astype(answers.dtype))


@every_answer
def test_layouts(ask):
    points = RANDOM.uniform(-1, 1, (10, 3))
    expected = ask(points)
    wide = np.full((20, 7), np.nan)
    wide[::2, 1:6:2] = points
    memory = np.zeros(points.nbytes + 1, np.uint8)
    shifted = memory[1:].view(np.float64).reshape(points.shape)
    shifted[...] = points
    frozen = points.copy()
    frozen.flags.writeable = False
    layouts = (wide[::2, 1:6:2], np.asfortranarray(points), shifted, frozen, points[::-1][::-1], points.astype(">f8"),
               points.tolist(), tuple(map(tuple, points)), [np.array(p) for p in points], memoryview(points))  # fmt: skip
    for layout in layouts:
        np.testing.assert_array_equal(ask(layout), expected)
    np.testing.assert_array_equal(ask(np.broadcast_to(points[0], (4, 3))), np.stack([expected[0]] * 4))


@every_answer
@pytest.mark.parametrize(
    "points",
    [
        None, "points", b"points", 1.0, [], [1, 2], [[1, 2], [3, 4]], np.zeros((3, 4)), np.zeros((3, 2)), {}, object(), [[1, 2, 3], [1, 2]],
        [[None] * 3], [["1", "2", "3"]], [[1j, 2, 3]], [[True, False, True]], np.zeros((2, 3), np.longdouble),
        np.zeros((2, 3), "datetime64[s]"), np.ma.masked_array(np.zeros((2, 3)), [[1, 0, 0], [0, 0, 0]]), np.zeros((2, 3), object),
    ],
    ids=repr,
)  # fmt: skip
def test_what_are_no_points(ask, points):
    with pytest.raises((TypeError, ValueError), match="^points: "):
        ask(points)


@pytest.mark.parametrize(
    "ask", [SCALARS["distance"], SCALARS["winding"], VECTORS["closest point"]], ids=["distance", "winding", "closest"]
)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_points_that_are_not_finite(ask, value, dtype):
    points = np.zeros((7, 3), dtype)
    points[4, 1] = value
    with pytest.raises(so.UsageError, match="point 4"):
        ask(points)
    many = np.zeros((10_000, 3), dtype)
    many[9_000, 0] = value
    with pytest.raises(so.UsageError, match="point 9000"):
        ask(many)


def test_points_that_a_field_cannot_look_at():
    for field in (FIELD, BAND):
        for use in (field, field.gradient):
            for count in (20, 200_000):  # many are looked at in parts
                points = np.zeros((count, 3))
                points[count // 2 :, 1] = np.nan
                with pytest.raises(so.UsageError, match=f"point {count // 2} is not a number; leave it out"):
                    use(points)


def test_points_far_and_near():
    np.testing.assert_allclose(
        QUERY.distance([[1e100, 0, 0], [0.5 + 1e-12, 0, 0], [0, 0, 0]]), [1e100, 1e-12, -0.5], rtol=1e-3
    )
    assert QUERY.distance(np.float32([[3e38, 3e38, 3e38]])) == np.inf  # too far for a float
    with pytest.raises(so.LimitError):
        QUERY.distance([[1e300, 0, 0]])


def test_many_points_have_the_answers_of_few():
    points = RANDOM.uniform(-2, 2, (300_001, 3))
    for use in (FIELD, BAND.gradient):
        some = [0, 99_999, 100_000, 250_000, 300_000]
        np.testing.assert_array_equal(use(points)[some], use(points[some]))


def test_interpolation_between_samples():
    low, high = FIELD.grid.bounds
    points = RANDOM.uniform(np.array(low), np.array(high), (300, 3))
    at = (points - low) / np.array(FIELD.grid.spacing)
    cell = np.minimum(at.astype(int), np.array(FIELD.shape) - 2)
    part, values, expected = at - cell, FIELD.numpy().astype(float), 0
    for corner in np.ndindex(2, 2, 2):
        weight = np.where(corner, part, 1 - part).prod(axis=1)
        expected = expected + weight * values[tuple((cell + corner).T)]
    np.testing.assert_allclose(FIELD(points), expected, atol=1e-6)
    for index in [(0, 0, 0), (3, 4, 5), (23, 23, 23)]:
        assert FIELD(FIELD.grid.points()[index]) == pytest.approx(values[index], abs=1e-6)
    beyond = np.array([[9, 0, 0], [0, -9, 0]])
    assert np.isnan(FIELD(beyond)).all() and np.isnan(FIELD.gradient(beyond)).all()
    border = [[high[0], 0, 0], [0, low[1], 0]]
    np.testing.assert_array_equal(FIELD(beyond, outside="border"), FIELD(border))
    np.testing.assert_array_equal(FIELD.gradient(beyond, outside="border"), FIELD.gradient(border))
    bound, distance = FIELD(beyond, outside="bound"), so.distance(shapes.cube(), beyond)
    assert (bound <= distance).all() and (bound >= 0.8 * distance).all()
    np.testing.assert_array_equal(FIELD(border, outside="bound"), FIELD(border))
    assert np.isfinite(FIELD(FIELD.grid.points().astype(np.float32))).all()  # whose border is rounded
    with pytest.raises(ValueError, match="outside: .*nearest.*nan.*border.*bound"):
        FIELD(beyond, outside="nearest")
    step = 1e-4
    inner = points[(np.abs(part - 0.5) < 0.4).all(axis=1)]
    for axis in range(3):
        shift = step * np.eye(3)[axis]
        slope = (FIELD(inner + shift) - FIELD(inner - shift)) / (2 * step)
        np.testing.assert_allclose(FIELD.gradient(inner)[:, axis], slope, atol=1e-4)
