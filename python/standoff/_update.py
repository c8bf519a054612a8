# SPDX-License-Identifier: Apache-2.0
"""Fields of meshes of which a part moves."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import numpy as np

from . import _core
from ._arrays import numbers
from ._checks import flag, name, runs_on
from ._errors import UsageError
from ._field import DistanceField
from ._mesh import Mesh, as_mesh
from ._options import Grid, Progress, Sign, SignReport, grid_of, memory_limit_of, progress_of, sign_report


def updated(
    field: DistanceField,
    mesh: Any,
    before: Any,
    changed: Any,
    moved: Any,
    sign: str | Sign | None,
    method: str,
    where: tuple[int, str],
    memory_limit: int | None,
    progress: Progress,
) -> DistanceField:
    """As `DistanceField.update`."""
    old, new = as_mesh(before), as_mesh(mesh)
    asked = Sign.of(sign)
    if changed is not None and moved is not None:
        raise ValueError("changed and moved: both name the triangles that changed; give one of these")
    triangles = None
    if changed is not None:
        triangles = indices(changed, "changed", max(len(old.faces), len(new.faces)))
    elif moved is not None:
        triangles = triangles_of(indices(moved, "moved", max(len(old.vertices), len(new.vertices))), old, new)
    with progress_of(progress, "update") as report:
        native, done = _core.update(
            field._native(),
            old.vertices,
            old.faces,
            new.vertices,
            new.faces,
            triangles,
            asked,
            name(method, "method"),
            *runs_on(*where),
            memory_limit_of(memory_limit),
            report,
        )
    signs = sign_report(done.pop("sign"), asked, stacklevel=3)
    return DistanceField._of_native(native, signs, done)


class LiveField:
    """A field that follows its mesh, whose vertices move again and again, bit for bit as `field` computes it.

    What updates have in common is kept, so that one takes the time of what changes, however large the mesh is.
    docs/update.md says what is computed again, and when all is. Takes some 90 bytes a triangle besides the field.

    Args:
        mesh: as for `field`; on the CPU. It is copied.
        resolution, spacing, shape, grid, padding, band, thickness: as for `field`. The grid does not follow the mesh: give
            it room.
        sign, nearest, method, device, threads, memory_limit: as for `field`; the limit counts what is kept.

    Raises:
        MeshError, UsageError, ValueError, TypeError, LimitError, DeviceError: as `field`.
    """

    _live: _core.Live
    _made: DistanceField | None  # of the mesh as it is

    def __init__(
        self,
        mesh: Any,
        *,
        resolution: int | None = None,
        spacing: float | Sequence[float] | None = None,
        shape: Sequence[int] | None = None,
        grid: Grid | None = None,
        padding: float | None = None,
        band: float | None = None,
        thickness: float | None = None,
        sign: str | Sign | None = "auto",
        nearest: bool = False,
        method: str = "tiles",
        device: str = "auto",
        threads: int = 0,
        memory_limit: int | None = None,
    ) -> None:
        found = as_mesh(mesh)
        self._grid, self._thickness = grid_of(
            lambda: found.bounds, grid, resolution, spacing, shape, padding, band, thickness
        )
        self._asked = Sign.of(sign)
        self._faces = np.array(found.faces)
        self._count = len(found.vertices)
        self._live = _core.Live(
            found.vertices,
            found.faces,
            self._grid._core(),
            self._thickness,
            self._asked,
            name(method, "method"),
            flag(nearest, "nearest"),
            *runs_on(threads, device),
            memory_limit_of(memory_limit),
        )
        sign_report(self._live.sign, self._asked, stacklevel=2)
        self._made = None
        self._calling = threading.RLock()  # else a copy could be kept that is older than the mesh
        self._moving = False

    @property
    def grid(self) -> Grid:
        """Where the samples are."""
        return self._grid

    @property
    def thickness(self) -> float:
        """Half-width of the band, world units; infinite for a full field."""
        return self._thickness

    @property
    def sign(self) -> SignReport:
        """How the sign was decided, of the mesh as it is now."""
        return SignReport(**self._live.sign)

    @property
    def mesh(self) -> Mesh:
        """A copy of the mesh as it is now."""
        return Mesh(self._live.vertices(), self._faces)

    @property
    def field(self) -> DistanceField:
        """The field of the mesh as it is now. A copy, made when it is first asked for: it does not change.

        Raises:
            UsageError: asked for by the `progress` of `move`.
        """
        with self._calling:
            self._not_in_progress()
            if self._made is None:
                self._made = DistanceField._of_native(self._live.field(), self.sign)
            return self._made

    def move(self, vertices: Any, positions: Any, *, progress: Progress = None) -> dict[str, Any]:
        """Moves vertices of the mesh, and updates the field.

        Args:
            vertices: indices of those that move, or True for each that does. Of one that is named more than once the
                last position counts.
            positions: where each is now, ``(n, 3)``, world units.
            progress: as for `field`.

        Returns:
            What was done: the keys ``anew`` (whether all was computed), ``why``, ``triangles_changed``, ``windows``,
            ``tiles_computed``, ``tiles_changed`` and ``seconds``.

        Raises:
            UsageError, ValueError, TypeError: `vertices` are no indices of the mesh, or there are other numbers of
                positions; or `progress` of a call that has not returned calls it.
            MeshError, LimitError: as `field`, of the mesh as it would be. The mesh and the field are then as before.
            KeyboardInterrupt: Ctrl-C, within 0.1 s. After it, and what `progress` raises, `mesh` says whether the
                vertices have moved: they have where the work was done already.
        """
        chosen = indices(vertices, "vertices", self._count)
        places = np.ascontiguousarray(numbers(positions, "positions"), dtype=np.float64)
        if places.size == 0 and len(chosen) == 0:
            places = places.reshape(0, 3)
        if places.shape != (len(chosen), 3):
            raise ValueError(
                f"positions: must have the shape ({len(chosen)}, 3), one for each vertex, not {places.shape}"
            )
        with self._calling:
            self._not_in_progress()
            self._moving = True
            try:
                with progress_of(progress, "update") as report:
                    self._made = None
                    done = self._live.move(chosen, places, report)
            finally:
                self._moving = False
        sign_report(done.pop("sign"), self._asked, stacklevel=2)
        return done

    def _not_in_progress(self) -> None:
        """The thread that moves comes through its own lock, when `progress` asks."""
        if self._moving:
            raise UsageError(
                "live field: `progress` of move() asked for field or move(); ask after move() has returned"
            )


def indices(chosen: Any, what: str, count: int) -> np.ndarray:
    """Indices below `count` of an array of them, or of one truth value for each."""
    array = np.asarray(chosen)
    if array.ndim != 1 or array.dtype.kind not in "biu" and array.size > 0:
        raise TypeError(
            f"{what}: must be indices, or True or False for each, in one row; not {chosen!r}; give a 1-D array of these"
        )
    if array.dtype.kind == "b":
        if len(array) > count:
            raise ValueError(f"{what}: {len(array)} truth values for {count}; give one for each")
        array = np.flatnonzero(array)
    if array.size > 0 and not 0 <= int(array.min()) <= int(array.max()) < count:
        raise ValueError(
            f"{what}: must be from 0 to {count - 1}, not {int(array.min())} to {int(array.max())}; "
            "give indices of the mesh"
        )
    return np.ascontiguousarray(array, dtype=np.uint32)


def triangles_of(vertices: np.ndarray, *meshes: Mesh) -> np.ndarray:
    """The triangles of any of the meshes with one of these vertices."""
    found = []
    for mesh in meshes:
        chosen = np.zeros(max(len(mesh.vertices), int(vertices.max(initial=0)) + 1), dtype=bool)
        chosen[vertices] = True
        found.append(np.flatnonzero(chosen[mesh.faces].any(axis=1)))
    return np.unique(np.concatenate(found)).astype(np.uint32)
