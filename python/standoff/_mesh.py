# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes: files, arrays, and the mesh objects of other libraries."""

from __future__ import annotations

import os
from collections.abc import Callable
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arrays import numbers, to_numpy
from ._checks import PathLike, flag, name, number, path_of, triple, whole_number
from ._errors import MeshError
from ._files import expect_file
from ._gradients import wants_gradient
from ._options import Box

if TYPE_CHECKING:
    from ._field import DistanceField
    from ._options import Progress, Sign
    from ._page import Page
    from ._picture import Picture
    from ._report import Report

_VERTEX_TYPES = (np.dtype(np.float32), np.dtype(np.float64))
_FACE_TYPES = tuple(np.dtype(t) for t in (np.uint32, np.int32, np.uint64, np.int64))


class Mesh:
    """Triangles over shared vertices.

    Any triangles are allowed: open, nonmanifold, self-intersecting, degenerate. The arrays are the caller's where
    their memory fits (float32 or float64, integers of 32 or 64 bits, rows of three adjacent numbers); do not change
    them while a function works on them.

    Args:
        vertices: ``(n, 3)`` coordinates, world units. Gradients of `distance` and `MeshQuery.distance` flow into a tensor
            of torch that requires them.
        faces: ``(m, 3)`` indices into the vertices.
        up: the axis that points up, if that is known.

    Raises:
        TypeError, ValueError: types or shapes that are no mesh's.
    """

    __slots__ = ("_source", "faces", "notes", "up", "vertices")

    vertices: np.ndarray
    """``(n, 3)`` float32 or float64."""
    faces: np.ndarray
    """``(m, 3)`` integers."""
    notes: tuple[str, ...]
    """What reading a file did to its coordinates, as sentences; mostly empty."""
    up: str
    """The axis that points up in pictures, ``"x"``, ``"y"`` or ``"z"``, as the file's format has it; empty: unknown."""

    def __init__(self, vertices: Any, faces: Any, *, notes: tuple[str, ...] = (), up: str = "") -> None:
        self.vertices = _vertices(vertices)
        # The tensor of the vertices, and the array that it gave: the attribute may be set to another one.
        self._source = (vertices, self.vertices) if wants_gradient(vertices) else None
        self.faces = _faces(faces)
        self.notes = tuple(notes)
        if up not in ("", "x", "y", "z"):
            raise ValueError(f"up: must be x, y, z or empty, not {up!r}")
        self.up = up

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The box around all triangles: its least and its greatest corner.

        Raises:
            MeshError: a face out of range, a corner that is not finite, or no triangle at all.
        """
        low, high = _core.bounds(self.vertices, self.faces)
        return triple(low, "bounds"), triple(high, "bounds")

    @property
    def _tensor(self) -> Any:
        """The tensor into which gradients of the vertices flow, or None."""
        return self._source[0] if self._source is not None and self._source[1] is self.vertices else None

    # What trimesh's users look for. Each asks anew, for the arrays may have changed: keep what you need.

    @property
    def area(self) -> float:
        """The area of all triangles, world units squared. Raises: MeshError, as `report`."""
        return self._report().area

    @property
    def volume(self) -> float:
        """The volume, as `report` has it: holes are closed, cavities are negative. Raises: MeshError."""
        return self._report().volume

    @property
    def is_watertight(self) -> bool:
        """Whether the mesh has no boundary once it is oriented: ``report(mesh).closed``. Raises: MeshError."""
        return self._report().closed

    def contains(self, points: Any, *, sign: str | Sign = "auto", threads: int = 0, progress: Progress = None) -> Any:
        """Whether each point ``(..., 3)`` is inside; for many calls ask a `MeshQuery`, which is prepared once.

        Args:
            points, threads, progress: as for `distance`.
            sign: how inside is decided, as for `field`.

        Returns:
            ``(...)`` bool. A point on the surface is not inside.

        Raises:
            MeshError: nothing decides what is inside.
            UsageError, ValueError, TypeError: as `distance`.
        """
        from ._points import MeshQuery

        return MeshQuery(self, sign=sign, threads=threads).contains(points, threads=threads, progress=progress)

    def to_trimesh(self) -> Any:
        """The same as a ``trimesh.Trimesh``, of which nothing is merged or removed. Raises: ImportError."""
        import trimesh

        return trimesh.Trimesh(self.vertices, self.faces, process=False)

    def _report(self) -> Report:
        from ._report import report

        return report(self, most_components=0, most_intersections=0)

    def save(self, path: PathLike, *, overwrite: bool = True) -> None:
        """Writes the mesh in the format of the extension; the file appears whole or not at all.

        Raises:
            OutputError: it cannot be written, or exists and `overwrite` is False.
            UsageError: no format has this extension.
        """
        _core.write_mesh(path_of(path), self.vertices, self.faces, flag(overwrite, "overwrite"))

    def plot(
        self, *, width: int = 960, height: int = 720, azimuth: float = 35, elevation: float = 25, up: str = "auto"
    ) -> Picture:
        """A picture of the mesh, which notebooks show; see `Picture`.

        Args:
            width, height: of the picture, pixels.
            azimuth, elevation: of the camera, degrees.
            up: the axis that points up: x, y or z; auto: `Mesh.up`, or that of the flattest base.
        """
        from ._picture import Picture

        size = whole_number(width, "width", bits=32), whole_number(height, "height", bits=32)
        view = number(azimuth, "azimuth"), number(elevation, "elevation")
        above = upwards(up, [self])
        return Picture.drawn(lambda path: _core.write_picture(self.vertices, self.faces, path, *size, *view, above))

    def show(
        self,
        *fields: DistanceField,
        title: str = "",
        unit: str = "",
        up: str = "auto",
        height: int = 560,
        browser: bool | None = None,
    ) -> Page:
        """A page in which the mesh, with fields if any are given, can be turned and cut; notebooks show it.

        A script opens it in the browser.

        Args:
            fields: shown with the mesh; two are compared.
            title: the page's title.
            unit: what the legend calls the unit of lengths: ``"mm"``.
            up: the axis that points up: x, y or z; auto: `Mesh.up`, or that of the flattest base.
            height: of the frame in a notebook, pixels.
            browser: whether to open the page in a browser; None: where no notebook runs.
        """
        from ._page import Page

        return Page.showing([self], list(fields), title=title, unit=unit, up=up, height=height, browser=browser)

    def __repr__(self) -> str:
        return f"<standoff.Mesh: {len(self.vertices):,} vertices, {len(self.faces):,} triangles>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        return np.array_equal(self.vertices, other.vertices) and np.array_equal(self.faces, other.faces)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self.vertices, self.faces, self.notes, self.up)


def _rebuild(vertices: np.ndarray, faces: np.ndarray, notes: tuple[str, ...], up: str = "") -> Mesh:
    return Mesh(vertices, faces, notes=notes, up=up)


def upwards(up: str, meshes: list[Mesh]) -> str:
    """The axis that a picture or page is told; empty: the library finds it."""
    return next((mesh.up for mesh in meshes if mesh.up), "") if name(up, "up") == "auto" else up


def read(path: PathLike, *, scale: float = 1.0) -> Mesh:
    """Reads a mesh in any format of docs/formats.md, also compressed by gzip. Its content and its name say which.

    Equal vertices are welded exactly, and polygons are triangulated. `scale` multiplies all coordinates.

    Raises:
        FileNotFoundError, PermissionError: as ``open`` does.
        InputError: the file is damaged or of no format that is known; ``file``, ``line`` and ``byte`` say where.
        LimitError: the mesh does not fit into memory.
    """
    expect_file(path)
    vertices, faces, notes, up = _core.read_mesh(path, number(scale, "scale"))
    return Mesh(vertices, faces, notes=tuple(notes), up=up)


def as_mesh(mesh: Any) -> Mesh:
    """A mesh from what users have: a `Mesh`, a path, ``(vertices, faces)``, or an object of trimesh, pyvista, Open3D,
    meshio, pytorch3d or warp, which are known by their attributes: none of these packages is imported."""
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, (str, os.PathLike)):
        return read(mesh)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return Mesh(*mesh)
    for fits, convert in _CONVERSIONS:
        if fits(mesh):
            return convert(mesh)
    raise TypeError(
        f"mesh: {type(mesh).__name__} is none that standoff knows; pass a path, (vertices, faces), or an object of "
        "trimesh, pyvista, Open3D, meshio, pytorch3d or warp"
    )


def bounds_of(bounds: Any) -> Box:
    """The corners of a box, or of the box around a mesh."""
    if not isinstance(bounds, (Mesh, str, os.PathLike)) and not hasattr(bounds, "faces"):
        try:
            corners = np.asarray(bounds)
        except (TypeError, ValueError):  # of different lengths
            corners = np.empty(0)
        if corners.dtype.kind in "fiu" and corners.shape == (2, 3):
            return triple(corners[0], "bounds"), triple(corners[1], "bounds")
    return as_mesh(bounds).bounds


def _rows(array: np.ndarray, kinds: tuple[np.dtype[Any], ...], other: type) -> np.ndarray:
    """The array if the library reads its memory as it lies, else a copy that fits."""
    if array.dtype not in kinds or not array.dtype.isnative:
        array = array.astype(other)
    fits = array.size == 0 or (array.strides[1] == array.itemsize and array.strides[0] % array.itemsize == 0)
    if not fits or not array.flags.aligned:
        array = np.require(array, requirements=["C_CONTIGUOUS", "ALIGNED"])
    return array


def _vertices(vertices: Any) -> np.ndarray:
    found = numbers(vertices, "vertices")
    if found.ndim != 2 or found.shape[1] != 3:
        raise ValueError(f"vertices: must have shape (n, 3), not {found.shape}")
    return _rows(found, _VERTEX_TYPES, np.float64)


def _faces(faces: Any) -> np.ndarray:
    found = to_numpy(faces, "faces")
    if found.size == 0 and found.dtype.kind in "fiu":
        found = np.empty((0, 3), np.uint32)
    if found.dtype.kind not in "iu":
        raise TypeError(f"faces: must be integers, not {found.dtype}; convert with .astype(numpy.int64)")
    if found.ndim != 2 or found.shape[1] != 3:
        what = "; split quads into triangles first" if found.ndim == 2 and found.shape[1] == 4 else ""
        raise ValueError(f"faces: must have shape (n, 3), not {found.shape}{what}")
    return _rows(found, _FACE_TYPES, np.int64)


def _has(*names: str) -> Callable[[Any], bool]:
    return lambda mesh: all(hasattr(mesh, name) for name in names)


def _of_pyvista(mesh: Any) -> Mesh:
    if not hasattr(mesh, "regular_faces"):  # a grid of cells: its surface
        extract = mesh.extract_surface
        # pyvista warns of a changing default unless this is passed.
        mesh = extract(algorithm=None) if "algorithm" in signature(extract).parameters else extract()
    if not mesh.is_all_triangles:
        mesh = mesh.triangulate()
    return Mesh(mesh.points, mesh.regular_faces)


def _of_meshio(mesh: Any) -> Mesh:
    cells = mesh.cells_dict
    parts = [np.asarray(cells["triangle"])] if "triangle" in cells else []
    if "quad" in cells:
        quads = np.asarray(cells["quad"])
        parts += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    if not parts:
        raise MeshError(
            f"mesh: it has no triangles or quads, only {', '.join(cells) or 'nothing'}; extract its surface"
        )
    points = np.asarray(mesh.points)
    if points.ndim == 2 and points.shape[1] == 2:
        raise ValueError("mesh: its points have two coordinates, not three")
    return Mesh(points, np.concatenate(parts))


def _of_packed(mesh: Any) -> Mesh:
    return Mesh(mesh.verts_packed(), mesh.faces_packed())


def _of_warp(mesh: Any) -> Mesh:
    return Mesh(mesh.points, to_numpy(mesh.indices, "indices").reshape(-1, 3))  # flat


# What tells an object's library, and how it becomes a mesh; the first that fits is taken.
_CONVERSIONS: tuple[tuple[Callable[[Any], bool], Callable[[Any], Mesh]], ...] = (
    (_has("to_geometry", "geometry"), lambda scene: as_mesh(scene.to_geometry())),  # trimesh.Scene
    (_has("vertices", "faces"), lambda m: Mesh(m.vertices, m.faces)),  # trimesh.Trimesh
    (_has("vertex", "triangle"), lambda m: Mesh(m.vertex.positions, m.triangle.indices)),  # open3d.t.geometry
    (_has("vertices", "triangles"), lambda m: Mesh(np.asarray(m.vertices), np.asarray(m.triangles))),  # open3d.geometry
    (_has("verts_packed", "faces_packed"), _of_packed),  # pytorch3d
    (_has("points", "is_all_triangles"), _of_pyvista),  # pyvista.PolyData
    (_has("points", "extract_surface"), _of_pyvista),  # other pyvista data sets; some have cells_dict too
    (_has("points", "cells_dict"), _of_meshio),  # meshio
    (_has("points", "indices"), _of_warp),  # warp.Mesh
)
