# SPDX-License-Identifier: Apache-2.0
"""Surfaces out of fields and meshes."""

from __future__ import annotations

import warnings
from typing import Any, Literal

from . import _core
from ._checks import name, number, threads_of
from ._errors import SurfaceWarning
from ._field import DistanceField
from ._mesh import Mesh, as_mesh
from ._options import Box, Grid, Progress, Sign, grid_of, progress_of, sign_report


def surface(
    source: Any,
    *,
    at: float = 0.0,
    wall: float = 0.0,
    method: Literal["marching_cubes", "dual"] = "marching_cubes",
    resolution: int | None = None,
    spacing: Any = None,
    shape: Any = None,
    grid: Grid | None = None,
    padding: float | None = None,
    sign: str | Sign | None = "auto",
    threads: int = 0,
    progress: Progress = None,
) -> Mesh:
    """A watertight, oriented surface: all points of the value `at`.

    Args:
        source: a `DistanceField`, or a mesh as for `field`, whose field is then computed.
        at: world units; positive grows the solid, negative shrinks it. Of unsigned fields it must be positive.
        wall: hollow the solid: a second surface, this far inside, world units.
        method: ``"marching_cubes"`` is smooth; ``"dual"`` keeps the sharp edges of a mesh.
        resolution, spacing, shape, grid, padding, sign: as for `field`; for meshes alone.
        threads, progress: as for `field`.

    Returns:
        A closed manifold, whose triangles face outwards; without triangles if nothing is inside. A `SurfaceWarning`
        says if parts of the mesh are too thin for the grid, so that the surface shows nothing of them.
    """
    if isinstance(source, DistanceField):
        for option, value in dict(
            resolution=resolution, spacing=spacing, shape=shape, grid=grid, padding=padding
        ).items():
            if value is not None:
                raise ValueError(f"{option}: a field has its grid already; leave it out, or pass the mesh")
        if not source.signed and not at > 0:
            raise ValueError("at: this field has no sign, so that nothing is inside; give a positive distance")
        with progress_of(progress, "surface") as report:
            vertices, faces, _, _ = _core.surface_of_field(
                source._native(),
                number(at, "at"),
                number(wall, "wall"),
                name(method, "method"),
                threads_of(threads),
                report,
            )
        return Mesh(vertices, faces)
    found = as_mesh(source)
    where, _ = grid_of(
        lambda: _grown(found.bounds, number(at, "at")), grid, resolution, spacing, shape, padding, None, None
    )
    asked = Sign.of(sign)
    with progress_of(progress, "surface") as report:
        vertices, faces, signs, lost = _core.surface_of_mesh(
            found.vertices,
            found.faces,
            where._core(),
            asked,
            number(at, "at"),
            number(wall, "wall"),
            name(method, "method"),
            threads_of(threads),
            report,
        )
    sign_report(signs, asked, stacklevel=2)
    if lost:
        warnings.warn(lost, SurfaceWarning, stacklevel=2)
    return Mesh(vertices, faces)


def _grown(bounds: Box, at: float) -> Box:
    """The box of the surface at `at`: the mesh's, grown."""
    more = max(at, 0.0)
    low, high = bounds
    return (low[0] - more, low[1] - more, low[2] - more), (high[0] + more, high[1] + more, high[2] + more)
