# SPDX-License-Identifier: Apache-2.0
"""Exact answers at arbitrary points."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import Any, Literal, overload

import numpy as np

from . import _core
from ._arrays import Points
from ._bodies import Body
from ._checks import PathLike, flag, path_of, runs_on, threads_of
from ._errors import MeshError
from ._files import expect_file, packed, unpacked
from ._gradients import differentiable, tensor_of, wants_gradient
from ._mesh import Mesh, as_mesh
from ._options import Progress, Sign, SignReport, memory_text, progress_of, sign_report

FEATURES = ("face", "edge 0", "edge 1", "edge 2", "vertex 0", "vertex 1", "vertex 2")
"""What ``ClosestPoints.feature`` counts: edge n runs from corner n to the next one."""


@dataclass(frozen=True, eq=False)
class ClosestPoints:
    """The nearest point of a mesh's surface for each query point. Arrays have the shape of the points asked for."""

    distance: Any
    """``(...)``: world units, negative inside if there is a sign. Gradients of torch flow through it, and it alone."""
    point: Any
    """``(..., 3)``: on the surface."""
    triangle: Any
    """``(...)`` integers: the triangle that contains the point, the lowest index on ties."""
    feature: Any
    """``(...)`` integers: the part of the triangle that the point lies on, an index into `standoff.FEATURES`."""
    barycentric: Any
    """``(..., 3)``: the point's barycentric coordinates, in the order of the triangle's corners."""
    gradient: Any
    """``(..., 3)``: the unit direction in which the distance grows fastest."""


class MeshQuery:
    """A mesh prepared for many questions at points: build it once, ask often, from any thread.

    The nearest triangle is the one that a comparison with all triangles in double precision finds; answers have the
    same bits for any number of threads.

    Args:
        mesh: as for `field`.
        sign: how inside is decided, as for `field`; None for distances without sign. ``"flood"`` needs a grid and is
            an error here; where ``"auto"`` would take it there is no sign.
        threads: for building; 0 for all.

    Raises:
        MeshError: the mesh, or a sign's method that cannot work with it.
        UsageError, TypeError: arguments.
    """

    _query: _core.Query
    _sign: SignReport
    _vertices: Any = None  # the tensor that the mesh was made of, if gradients flow into it

    def __init__(self, mesh: Any, *, sign: str | Sign | None = "auto", threads: int = 0) -> None:
        found = as_mesh(mesh)
        asked = Sign.of(sign)
        self._vertices = found._tensor
        self._query = _core.build_query(found.vertices, found.faces, asked, threads_of(threads))
        self._sign = sign_report(self._query.sign, asked, stacklevel=2)

    @classmethod
    def load(cls, path: PathLike) -> MeshQuery:
        """Reads what `save` wrote, or ``standoff build -o x.query``."""
        expect_file(path)
        query = object.__new__(cls)
        query._query = _core.read_query(path)
        query._sign = SignReport(**query._query.sign)
        return query

    def save(self, path: PathLike, *, overwrite: bool = True) -> None:
        """Writes the query as a file, by convention with the extension ``.query``; it appears whole or not at all."""
        self._query.save(path_of(path), flag(overwrite, "overwrite"))

    @property
    def mesh(self) -> Mesh:
        """The query's own copy of the mesh; its arrays cannot be written to."""
        return Mesh(*self._query.mesh())

    @property
    def sign(self) -> SignReport:
        """How inside is decided."""
        return self._sign

    @property
    def signed(self) -> bool:
        """Whether distances inside are negative."""
        return self._sign.method != "none"

    @property
    def nbytes(self) -> int:
        """Memory that the query takes."""
        return self._query.memory_bytes

    def distance(self, points: Any, *, threads: int = 0, device: str = "auto", progress: Progress = None) -> Any:
        """The distance of each point ``(..., 3)``, world units: ``(...)``, negative inside if there is a sign.

        Gradients flow into tensors of torch: the points, and the vertices that the mesh was made of.
        """
        if wants_gradient(points) or self._flows_to_vertices():
            return self.closest(points, threads=threads, device=device, progress=progress).distance
        p = Points(points)
        with progress_of(progress, "distance") as report:
            return p.give(self._query.distances(p.array, *runs_on(threads, device), report))

    def closest(
        self, points: Any, *, threads: int = 0, device: str = "auto", progress: Progress = None
    ) -> ClosestPoints:
        """The closest point of the surface for each point ``(..., 3)``, with its triangle and barycentrics."""
        if self._flows_to_vertices() and type(points).__module__.partition(".")[0] != "torch":
            points = tensor_of(points)
        p = Points(points, gradient=True)
        with progress_of(progress, "closest") as report:
            distance, point, triangle, feature, barycentric, gradient = self._query.closest(
                p.array, *runs_on(threads, device), report
            )
        triangle = triangle.astype(np.int64)
        found = ClosestPoints(*map(p.give, (distance, point, triangle, feature, barycentric, gradient)))
        if self._flows_to_vertices():
            corners = self._query.mesh()[1][triangle]
            flowing = differentiable(found.distance, points, found.gradient, self._vertices, corners, found.barycentric)
        elif p.flows:
            flowing = differentiable(found.distance, points, found.gradient)
        else:
            return found
        return replace(found, distance=flowing)

    def _flows_to_vertices(self) -> bool:
        return wants_gradient(self._vertices)

    def contains(self, points: Any, *, threads: int = 0, progress: Progress = None) -> Any:
        """Whether each point ``(..., 3)`` is inside: ``(...)`` bool. A point on the surface is not.

        Raises:
            MeshError: the query has no sign, so that nothing is inside.
        """
        if not self.signed:
            raise MeshError(f"contains: the query has no sign: {self._sign.why or 'it was built with sign=None'}")
        p = Points(points)
        with progress_of(progress, "contains") as report:
            return p.give(self._query.distances(p.array, threads_of(threads), "auto", report) < 0)

    def winding_number(self, points: Any, *, threads: int = 0, progress: Progress = None) -> Any:
        """The generalised winding number of the mesh at each point ``(..., 3)``; whole if the mesh is closed.

        Raises:
            UsageError: the query's sign is by another method than winding: build it with ``sign="winding"``.
        """
        p = Points(points)
        with progress_of(progress, "winding number") as report:
            return p.give(self._query.winding_numbers(p.array, threads_of(threads), report))

    def __repr__(self) -> str:
        _, faces = self._query.mesh()
        sign = f"signed ({self._sign.method})" if self.signed else "unsigned"
        return f"<standoff.MeshQuery: {len(faces):,} triangles, {sign}, {memory_text(self.nbytes)}>"

    def __copy__(self) -> MeshQuery:
        return self  # nothing changes a query

    def __deepcopy__(self, memo: Any) -> MeshQuery:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (packed(lambda path: self.save(path), ".query"),)


def _rebuild(content: bytes) -> MeshQuery:
    return unpacked(content, MeshQuery.load, ".query")


@overload
def distance(
    mesh: Any,
    points: Any,
    *,
    sign: str | Sign | None = ...,
    closest: Literal[False] = ...,
    threads: int = ...,
    device: str = ...,
    progress: Progress = ...,
) -> Any: ...


@overload
def distance(
    mesh: Any,
    points: Any,
    *,
    sign: str | Sign | None = ...,
    closest: Literal[True],
    threads: int = ...,
    device: str = ...,
    progress: Progress = ...,
) -> ClosestPoints: ...


def distance(
    mesh: Any,
    points: Any,
    *,
    sign: str | Sign | None = "auto",
    closest: bool = False,
    threads: int = 0,
    device: str = "auto",
    progress: Progress = None,
) -> Any:
    """The exact distance of each point to a mesh.

    Args:
        mesh: as for `field`; or a `MeshQuery`, whose sign is then taken.
        points: ``(..., 3)``, world units; numpy, torch, lists.
        sign: how inside is decided, as for `field`: distances inside are negative. None for distances without sign.
        closest: also return the closest points, triangles, features, barycentrics and gradients.
        threads, device, progress: as for `field`.

    Returns:
        ``(...)`` distances, float32 for float32 points, else float64, as a torch tensor for a tensor; or `ClosestPoints`.
        Gradients of torch flow from the distances into points, and into vertices ``mesh = (vertices, faces)``, that
        require them: that of a point is the unit vector from the closest point, times the sign.

    Raises:
        UsageError: a point that is not finite. Others as `field`.
    """
    if isinstance(mesh, MeshQuery):
        query = mesh
        if sign != "auto":
            raise ValueError("sign: a MeshQuery has its sign already; leave it out, or pass the mesh")
    elif isinstance(mesh, Body) or isinstance(points, (Body, Mesh, str, os.PathLike)):
        raise TypeError(
            "points: must be points; the distance of two bodies or meshes is standoff.distance_between(a, b)"
        )
    else:
        query = MeshQuery(mesh, sign=sign, threads=threads)
    ask = query.closest if flag(closest, "closest") else query.distance
    return ask(points, threads=threads, device=device, progress=progress)
