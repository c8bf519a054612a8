# SPDX-License-Identifier: Apache-2.0
"""Rigid bodies: collision, distance, contacts and sweeps."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from . import _core
from ._arrays import like, numbers, to_numpy
from ._checks import PathLike, flag, name, number, path_of, runs_on, triple, whole_number
from ._files import expect_file, packed, unpacked
from ._gradients import refuse_gradient
from ._mesh import as_mesh
from ._options import Progress, memory_text, progress_of

NO_TRIANGLE = 2**32 - 1
CONTAINMENTS = ("none", "b in a", "a in b", "partly")
"""What ``Collisions.containment`` counts."""


class Body:
    """A rigid body, prepared for queries: build it once, use it in many, from any thread.

    A body is its surface: any triangles, open or closed.

    Args:
        mesh: as for `field`.
        spacing: of the body's own field, world units; by default it is chosen from the mesh.
        threads, device: for building, as for `field`.
    """

    _body: _core.Body

    def __init__(self, mesh: Any, *, spacing: float | None = None, threads: int = 0, device: str = "auto") -> None:
        found = as_mesh(mesh)
        self._body = _core.build_body(
            found.vertices,
            found.faces,
            0.0 if spacing is None else number(spacing, "spacing"),
            *runs_on(threads, device),
        )

    @classmethod
    def load(cls, path: PathLike) -> Body:
        """Reads what `save` wrote, or ``standoff build``."""
        expect_file(path)
        body = object.__new__(cls)
        body._body = _core.read_body(path)
        return body

    def save(self, path: PathLike, *, overwrite: bool = True) -> None:
        """Writes the body; the file appears whole or not at all."""
        self._body.save(path_of(path), flag(overwrite, "overwrite"))

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The box around the body, in its own coordinates."""
        low, high = self._body.bounds
        return triple(low, "bounds"), triple(high, "bounds")

    @property
    def has_inside(self) -> bool:
        """Whether the body has an inside that is known: its mesh is closed as it is oriented. Nothing is repaired."""
        return self._body.has_inside

    @property
    def nbytes(self) -> int:
        """Memory that the body takes."""
        return self._body.memory_bytes

    def __repr__(self) -> str:
        kind = "with an inside" if self.has_inside else "without inside"
        return f"<standoff.Body: {self._body.triangles:,} triangles, {kind}, {memory_text(self.nbytes)}>"

    def __copy__(self) -> Body:
        return self  # nothing changes a body

    def __deepcopy__(self, memo: Any) -> Body:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (packed(lambda path: self.save(path), ".body"),)


def _rebuild(content: bytes) -> Body:
    return unpacked(content, Body.load, ".body")


@dataclass(frozen=True, eq=False)
class Collisions:
    """Whether the bodies intersect, for each pose."""

    hit: Any
    """``(...)`` bool: the surfaces intersect or are within the margin, or one body contains the other if that was
    asked for. In certified mode also False where ``ambiguous``."""
    ambiguous: Any
    """``(...)`` bool: certified mode alone: the fields cannot decide."""
    triangle_a: Any
    """``(...)`` integers: a triangle of a that is hit; `NO_TRIANGLE` if there is none."""
    triangle_b: Any
    """The same of b."""
    containment: Any
    """``(...)`` integers: an index into `standoff.CONTAINMENTS`."""


@dataclass(frozen=True, eq=False)
class Distances:
    """The least distance between the surfaces, for each pose."""

    distance: Any
    """``(...)`` world units: of the two points; infinite beyond the limit."""
    lower: Any
    """``(...)``: the distance is at least this; equal to `distance` but for the tolerance and rounding."""
    point_a: Any
    """``(..., 3)``: on a's surface, in the world."""
    point_b: Any
    """``(..., 3)``: on b's surface, in the world."""
    triangle_a: Any
    """``(...)`` integers."""
    triangle_b: Any
    """``(...)`` integers."""
    finished: Any
    """``(...)`` bool: False where the search ended after ``max_steps``: the distance still lies between `lower` and
    `distance`, but they may be farther apart than the tolerance."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """The pairs of triangles that intersect or are within the margin. Arrays are of the pose's library."""

    point: Any
    """``(n, 3)``: in the world."""
    normal: Any
    """``(n, 3)``: unit length, from a to b."""
    depth: Any
    """``(n,)``: how far b must move along the normal to separate this pair; minus the distance if it is apart."""
    triangle_a: Any
    """``(n,)`` integers."""
    triangle_b: Any
    """``(n,)`` integers."""
    overflow: bool
    """Whether there are more pairs than were asked for."""

    def __len__(self) -> int:
        return len(self.depth)


@dataclass(frozen=True, eq=False)
class Sweeps:
    """When the moving body b first touches a, for each motion."""

    hit: Any
    """``(...)`` bool."""
    time: Any
    """``(...)``: from 0 to 1; the bodies do not intersect before. 1 if there is no hit and the sweep is finished."""
    point: Any
    """``(..., 3)``: where they touch, in the world."""
    normal: Any
    """``(..., 3)``: unit length, from a to b; zero if they intersect at the start."""
    triangle_a: Any
    """``(...)`` integers."""
    triangle_b: Any
    """``(...)`` integers."""
    finished: Any
    """``(...)`` bool: False where the sweep ended after ``max_steps``, without a hit; what comes after `time` is not
    known."""


@dataclass(frozen=True, eq=False)
class PathSweep:
    """When a body that moves along a path first touches another one."""

    motion: int
    """The motion in which the sweep ended: that from pose ``motion`` to the next one. The last one if there is no
    hit."""
    sweep: Sweeps
    """The answer in that motion, without dimensions; its time is from 0 to 1."""


class _Poses:
    """Poses that a user passed: (n, 12) doubles, and how answers go back in their shape and library."""

    def __init__(self, poses: Any, what: str) -> None:
        refuse_gradient(poses, what)
        found = numbers(poses, what)
        if found.ndim >= 2 and found.shape[-2:] == (4, 4):
            self.shape = found.shape[:-2]
            self.array = _of_matrices(found.reshape(-1, 4, 4).astype(np.float64), what)
        elif found.ndim >= 1 and found.shape[-1] == 7:
            self.shape = found.shape[:-1]
            self.array = _of_quaternions(found.reshape(-1, 7).astype(np.float64), what)
        else:
            raise ValueError(
                f"{what}: must have shape (..., 4, 4), matrices, or (..., 7), x y z and a quaternion x y z w; "
                f"not {found.shape}"
            )
        self._wrap = like(poses)

    def give(self, answers: np.ndarray) -> Any:
        return self._wrap(answers.reshape(self.shape + answers.shape[1:]))

    def give_one(self, answers: np.ndarray) -> Any:
        return self._wrap(answers.reshape(answers.shape[1:]))


def _of_matrices(matrices: np.ndarray, what: str) -> np.ndarray:
    wrong = ~(np.abs(matrices[:, 3] - (0, 0, 0, 1)).max(axis=1, initial=0) <= 1e-6)
    if wrong.any():
        n = int(wrong.argmax())
        raise ValueError(f"{what}: matrix {n} ends with the row {matrices[n, 3]}, not (0, 0, 0, 1); transpose it?")
    return np.ascontiguousarray(np.concatenate([matrices[:, :3, :3].reshape(-1, 9), matrices[:, :3, 3]], axis=1))


def _of_quaternions(poses: np.ndarray, what: str) -> np.ndarray:
    x, y, z, w = poses[:, 3:].T
    with np.errstate(over="ignore"):
        length = np.sqrt(x * x + y * y + z * z + w * w)
    wrong = ~(np.abs(length - 1) <= 1e-3)
    if wrong.any():
        n = int(wrong.argmax())
        raise ValueError(f"{what}: the quaternion of pose {n} has length {length[n]:.6g}, not 1")
    x, y, z, w = x / length, y / length, z / length, w / length
    rotation = [
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return np.ascontiguousarray(np.stack([*rotation, *poses[:, :3].T], axis=1))


_UNMOVED = np.eye(4)
_IDENTITY = np.array([[1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]])


def _one(pose: Any, what: str) -> np.ndarray:
    if pose is None:
        return _IDENTITY
    found = _Poses(pose, what)
    if found.shape != ():
        raise ValueError(f"{what}: must be one pose, (4, 4) or (7,)")
    return found.array


def _pair(a: Any, pose_a: Any, b: Any) -> tuple[Any, np.ndarray, Any]:
    """Both bodies, and where a is."""
    return _body(a, "a"), _one(pose_a, "pose_a"), _body(b, "b")


def _body(given: Any, what: str) -> Any:
    """The body of a `Body`, of a file that `Body.save` wrote, or of what `field` takes as a mesh."""
    if isinstance(given, Body):
        return given._body
    if isinstance(given, (str, os.PathLike)) and os.fspath(given).lower().endswith(".body"):
        return Body.load(given)._body
    if given is None or isinstance(given, (bool, int, float)):
        raise TypeError(f"{what}: must be a standoff.Body, or a mesh, not {type(given).__name__}")
    return Body(given)._body


def collide(
    a: Any,
    b: Any,
    poses: Any = None,
    *,
    pose_a: Any = None,
    margin: float = 0.0,
    containment: bool = False,
    mode: Literal["exact", "certified"] = "exact",
    threads: int = 0,
    device: str = "auto",
    progress: Progress = None,
) -> Collisions:
    """Whether two bodies intersect, as they lie or for many poses of b.

    Args:
        a, b: the bodies: each a `Body`, or the name of a file of one; or a mesh as for `field`, of which a body is made
            for this call alone. For many calls make it once.
        poses: of b: ``(..., 4, 4)`` matrices, or ``(..., 7)``: position x y z, then a unit quaternion x y z w. None: one
            pose, where its mesh is.
        pose_a: of a, one pose; by default a is where its mesh is.
        margin: bodies within this distance are a hit, world units.
        containment: whether a body inside one that has an inside is a hit too.
        mode: ``"certified"`` answers from the bodies' fields alone, faster, and may be ambiguous.
        threads, device, progress: as for `field`.

    Raises:
        UsageError: a pose that is not rigid or not finite, other arguments.
        MeshError, InputError, FileNotFoundError: a mesh, as for `Body` and `read`.
    """
    if name(mode, "mode") not in ("exact", "certified"):
        raise ValueError(f"mode: must be 'exact' or 'certified', not {mode!r}")
    pair = _pair(a, pose_a, b)
    p = _Poses(_UNMOVED if poses is None else poses, "poses")
    with progress_of(progress, "collide") as report:
        verdict, triangle_a, triangle_b, inside = _core.collide(
            *pair,
            p.array,
            number(margin, "margin"),
            flag(containment, "containment"),
            mode == "certified",
            *runs_on(threads, device),
            report,
        )
    return Collisions(*map(p.give, (verdict == 1, verdict == 2, *_triangles(triangle_a, triangle_b), inside)))


def distance_between(
    a: Any,
    b: Any,
    poses: Any = None,
    *,
    pose_a: Any = None,
    tolerance: float = 0.0,
    limit: float = float("inf"),
    max_steps: int = 0,
    threads: int = 0,
    device: str = "auto",
    progress: Progress = None,
) -> Distances:
    """The least distance between the surfaces of two bodies, as they lie or for many poses of b.

    Args:
        a, b, poses, pose_a: as for `collide`.
        tolerance: the largest allowed error, world units; 0 for the exact distance.
        limit: the search stops at this distance, world units.
        max_steps: about the most steps of a pose, pairs of BVH nodes or of triangles; a search that needs more is not
            finished and returns bounds. 0: no limit.
        threads, device, progress: as for `field`. A GPU takes neither a tolerance nor ``max_steps``.

    Raises:
        UsageError: a pose that is not rigid or not finite, a negative tolerance, limit or ``max_steps``; a tolerance or
            ``max_steps`` on a GPU.
    """
    pair = _pair(a, pose_a, b)
    p = _Poses(_UNMOVED if poses is None else poses, "poses")
    with progress_of(progress, "distance") as report:
        lower, upper, point_a, point_b, triangle_a, triangle_b, finished = _core.distance(
            *pair,
            p.array,
            number(tolerance, "tolerance"),
            number(limit, "limit"),
            whole_number(max_steps, "max_steps"),
            *runs_on(threads, device),
            report,
        )
    triangles = _triangles(triangle_a, triangle_b)
    return Distances(*map(p.give, (upper, lower, point_a, point_b, *triangles, finished == 1)))


def sweep(
    a: Any,
    b: Any,
    start: Any,
    end: Any,
    *,
    pose_a: Any = None,
    center: Any = (0.0, 0.0, 0.0),
    tolerance: float = 0.0,
    max_steps: int = 0,
    threads: int = 0,
    device: str = "auto",
    progress: Progress = None,
) -> Sweeps:
    """When the moving body b first touches the resting body a. No hit is missed, at any speed.

    b turns by the shorter rotation, at most 180 degrees. `sweep_screw` turns it further, and `sweep_path` moves it
    through many poses.

    Args:
        a, b, pose_a: as for `collide`.
        start, end: poses of b at time 0 and 1, as for `collide`, equally many.
        center: the point of b, in its own coordinates, that moves on a straight line while b turns about it.
        tolerance: surfaces within this distance count as touching, world units; 0: a small part of the bodies' size.
        max_steps: the most steps of a sweep, of about a microsecond each; a sweep that needs more is not finished. 0: no
            limit.
        threads, device, progress: as for `field`.
    """
    pair = _pair(a, pose_a, b)
    first, last = _Poses(start, "start"), _Poses(end, "end")
    if first.shape != last.shape:
        raise ValueError(f"start and end: must have equally many poses, not {first.shape} and {last.shape}")
    point = triple(to_numpy(center, "center"), "center")
    with progress_of(progress, "sweep") as report:
        found = _core.sweep(
            *pair,
            first.array,
            last.array,
            point,
            number(tolerance, "tolerance"),
            whole_number(max_steps, "max_steps"),
            *runs_on(threads, device),
            report,
        )
    return _sweeps(first.give, *found)


def sweep_screw(
    a: Any,
    b: Any,
    start: Any,
    *,
    axis: Any,
    angle_rad: float,
    along: float = 0.0,
    point: Any = (0.0, 0.0, 0.0),
    pose_a: Any = None,
    tolerance: float = 0.0,
    max_steps: int = 0,
    threads: int = 0,
    device: str = "auto",
    progress: Progress = None,
) -> Sweeps:
    """As `sweep`, for a body that turns about an axis, any number of turns, and moves along it like a screw.

    Args:
        a, b, pose_a: as for `collide`.
        start: poses of b at time 0, as for `collide`.
        axis: the direction of the axis, in the world, of any length but zero.
        angle_rad: how far b turns, right-handed about the axis, in radians; -1e7 to 1e7.
        along: how far b moves in the direction of the axis, world units.
        point: a point that the axis goes through, in the world.
        tolerance, max_steps, threads, device, progress: as for `sweep`.

    Raises:
        ValueError: an axis without direction, an angle outside its range, or a number that is not finite.
    """
    pair = _pair(a, pose_a, b)
    first = _Poses(start, "start")
    with progress_of(progress, "sweep") as report:
        found = _core.sweep_screw(
            *pair,
            first.array,
            triple(to_numpy(point, "point"), "point"),
            triple(to_numpy(axis, "axis"), "axis"),
            number(angle_rad, "angle_rad"),
            number(along, "along"),
            number(tolerance, "tolerance"),
            whole_number(max_steps, "max_steps"),
            *runs_on(threads, device),
            report,
        )
    return _sweeps(first.give, *found)


def sweep_path(
    a: Any,
    b: Any,
    poses: Any,
    *,
    pose_a: Any = None,
    center: Any = (0.0, 0.0, 0.0),
    tolerance: float = 0.0,
    max_steps: int = 0,
) -> PathSweep:
    """When the body b, that moves from pose to pose, first touches the resting body a.

    Between two poses b moves as in `sweep`. The first motion that hits is found; those after it are not looked at.

    Args:
        a, b, pose_a: as for `collide`.
        poses: of b, two or more, as for `collide`.
        center, tolerance: as for `sweep`.
        max_steps: as for `sweep`, of all motions together.

    Raises:
        ValueError: fewer than two poses, or poses with more than one dimension.
    """
    pair = _pair(a, pose_a, b)
    way = _Poses(poses, "poses")
    if len(way.shape) != 1 or way.shape[0] < 2:
        raise ValueError(f"poses: must be a list of two poses or more, one after the other, not of shape {way.shape}")
    motion, found = _core.sweep_path(
        *pair,
        way.array,
        triple(to_numpy(center, "center"), "center"),
        number(tolerance, "tolerance"),
        whole_number(max_steps, "max_steps"),
    )
    return PathSweep(motion, _sweeps(way.give_one, *found))


def _sweeps(
    give: Any, hit: Any, time: Any, point: Any, normal: Any, triangle_a: Any, triangle_b: Any, finished: Any
) -> Sweeps:
    triangles = _triangles(triangle_a, triangle_b)
    return Sweeps(*map(give, (hit == 1, time, point, normal, *triangles, finished == 1)))


def contacts(a: Any, b: Any, pose: Any = None, *, pose_a: Any = None, most: int = 100, margin: float = 0.0) -> Contacts:
    """The pairs of triangles of two bodies that intersect or are within the margin.

    Args:
        a, b, pose_a: as for `collide`.
        pose: of b, one pose; None: where its mesh is.
        most: the largest number of contacts; if there are more, the result is spread over the contact area.
        margin: world units.
    """
    pair = _pair(a, pose_a, b)
    point, normal, depth, triangle_a, triangle_b, overflow = _core.contacts(
        *pair, _one(pose, "pose"), whole_number(most, "most"), number(margin, "margin")
    )
    first, second = _triangles(triangle_a, triangle_b)
    give = like(pose)
    return Contacts(give(point), give(normal), give(depth), give(first), give(second), overflow)


def _triangles(*indices: np.ndarray) -> list[np.ndarray]:
    return [index.astype(np.int64) for index in indices]
