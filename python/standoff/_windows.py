# SPDX-License-Identifier: Apache-2.0
"""Fields in windows: parts of a grid, each computed without the rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, Literal

from . import _core
from ._checks import flag, name, runs_on, triple
from ._field import DistanceField
from ._mesh import as_mesh
from ._options import Grid, Progress, Sign, SignReport, grid_of, memory_limit_of, progress_of, sign_report


class FieldWindows:
    """Parts of a field, with the values that `field` gives the whole grid, bit for bit.

    For fields that are larger than memory, or that processes and machines share. The mesh is prepared once. A window
    looks only at triangles that reach it. Signs by ``"normal"`` and methods that spread values need the whole field
    first: then it is computed here, and windows are cut out of it.

    Args:
        mesh: as for `field`; on the CPU.
        window: samples per axis of the largest window that will be asked for; multiples of 16 are fastest.
        resolution, spacing, shape, grid, padding, band, thickness: of the whole field, as for `field`.
        sign, nearest, method, device, threads: as for `field`.
        memory_limit: bytes of the CPU's memory, as for `field`; it counts the largest window.
        decision: `decision` of other windows of this mesh, with this sign, from any process: then how the sign is
            decided is not found out again. It is of one grid if the sign is a flood, else of any.

    Raises:
        MeshError, UsageError, ValueError, TypeError, LimitError, DeviceError: as `field`.
    """

    _windows: _core.Windows
    _grid: Grid
    _thickness: float
    _window: tuple[int, int, int]
    _sign: SignReport

    def __init__(
        self,
        mesh: Any,
        *,
        window: int | Sequence[int] = 256,
        resolution: int | None = None,
        spacing: float | Sequence[float] | None = None,
        shape: Sequence[int] | None = None,
        grid: Grid | None = None,
        padding: float | None = None,
        band: float | None = None,
        thickness: float | None = None,
        sign: str | Sign | None = "auto",
        nearest: bool = False,
        method: Literal["tiles", "thesis", "fuhrmann", "propagate", "jumpflood", "jumpflood+1"] = "tiles",
        device: str = "auto",
        threads: int = 0,
        memory_limit: int | None = None,
        decision: bytes | None = None,
    ) -> None:
        found = as_mesh(mesh)
        self._grid, self._thickness = grid_of(
            lambda: found.bounds, grid, resolution, spacing, shape, padding, band, thickness
        )
        sides = (window, window, window) if isinstance(window, int) else window
        self._window = triple(sides, "window", whole=True)
        self._asked = Sign.of(sign)
        self._windows = _core.Windows(
            found.vertices,
            found.faces,
            self._grid._core(),
            self._thickness,
            self._window,
            self._asked,
            name(method, "method"),
            flag(nearest, "nearest"),
            *runs_on(threads, device),
            memory_limit_of(memory_limit),
            _bytes_or_none(decision),
        )
        self._sign = sign_report(self._windows.sign, self._asked, stacklevel=2)

    @property
    def grid(self) -> Grid:
        """Of the whole field."""
        return self._grid

    @property
    def thickness(self) -> float:
        """Half-width of the band, world units; infinite for a full field."""
        return self._thickness

    @property
    def sign(self) -> SignReport:
        """How the sign was decided, for all windows."""
        return self._sign

    @property
    def decision(self) -> bytes:
        """How the sign was decided, in few bytes: give them to other windows of the same mesh."""
        return self._windows.decision

    @property
    def is_whole(self) -> bool:
        """Whether the whole field had to be computed first."""
        return self._windows.is_whole

    def field(self, first: Sequence[int], shape: Sequence[int], *, progress: Progress = None) -> DistanceField:
        """Computes a window. Its grid is ``grid.window(first, shape)``.

        Args:
            first: its first sample.
            shape: its samples per axis, at most those of the largest window.
            progress: as for `field`.

        Raises:
            UsageError, ValueError: no window of the grid.
            KeyboardInterrupt: Ctrl-C, within 0.1 s.
        """
        at, size = triple(first, "first", whole=True), triple(shape, "shape", whole=True)
        with progress_of(progress, "window") as report:
            native, done = self._windows.field(at, size, report)
        del done["provenance"], done["method"], done["sign"]
        return DistanceField._of_native(native, self._sign, done)

    def is_reached(self, first: Sequence[int], shape: Sequence[int]) -> bool:
        """Whether some triangle may be within the thickness of a window. If not, all its values are clamped."""
        return self._windows.is_reached(triple(first, "first", whole=True), triple(shape, "shape", whole=True))

    def is_empty(self, first: Sequence[int], shape: Sequence[int]) -> bool:
        """Whether no triangle reaches a window and all of it is outside, so that all its values are the thickness."""
        return self._windows.is_empty(triple(first, "first", whole=True), triple(shape, "shape", whole=True))

    def __iter__(self) -> Iterator[tuple[tuple[int, int, int], tuple[int, int, int]]]:
        """First sample and shape of the windows that make up the grid, x fastest."""
        starts = [range(0, n, side) for n, side in zip(self._grid.shape, self._window)]
        for k, j, i in product(*reversed(starts)):
            first = (i, j, k)
            yield first, _clipped(first, self._window, self._grid.shape)


def _bytes_or_none(decision: Any) -> bytes | None:
    if decision is not None and not isinstance(decision, bytes):
        raise TypeError(f"decision: give the bytes of FieldWindows.decision, not {type(decision).__name__}")
    return decision


def _clipped(first: tuple[int, int, int], side: tuple[int, int, int], whole: Any) -> tuple[int, int, int]:
    size = [min(n, all_of - at) for at, n, all_of in zip(first, side, whole)]
    return size[0], size[1], size[2]
