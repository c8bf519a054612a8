# SPDX-License-Identifier: Apache-2.0
"""Options that several functions take: grids, signs, memory limits, progress."""

from __future__ import annotations

import math
import numbers
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from . import _core
from ._checks import number, triple, whole_number
from ._errors import SignWarning

SignMethod = Literal["auto", "none", "winding", "parity", "normal", "facet", "flood", "shell"]
Box = tuple[tuple[float, float, float], tuple[float, float, float]]
Progress = bool | Callable[[str, float], Any] | None


@dataclass(frozen=True)
class Sign:
    """How inside is decided. Functions take a method's name, or a ``Sign`` where it needs more.

    Attributes:
        method: ``"auto"`` takes what fits the mesh, or no sign if it has no inside. ``"winding"`` and ``"parity"`` go
            by crossings, ``"normal"`` by the nearest triangle's front (terrain), ``"facet"`` by its plane, which is
            wrong beside edges and for comparison only, ``"flood"`` by what cannot be reached from outside, ``"shell"``
            makes the surface a solid of the given thickness; ``"none"``: no sign.
        rule: which winding numbers are inside: ``"positive"``, ``"nonzero"`` or ``"odd"``.
        invert: exchange inside and outside, as for a room scanned from inside.
        strict: raise `DoubtError` where the sign is not certain.
        as_oriented: take triangles as they are oriented; by default the orientation is repaired first.
        outer: leave out triangles inside, so that distances are to the surface of the union of all parts.
        shell: thickness of the sheet, world units, for ``"shell"`` alone.
    """

    method: SignMethod = "auto"
    rule: Literal["positive", "nonzero", "odd"] = "positive"
    invert: bool = False
    strict: bool = False
    as_oriented: bool = False
    outer: bool = False
    shell: float = 0.0

    @staticmethod
    def of(sign: str | Sign | None) -> Sign:
        """The ``Sign`` that functions make of a name, a ``Sign``, or None for no sign."""
        if sign is None:
            return Sign("none")
        if isinstance(sign, Sign):
            return sign
        if isinstance(sign, str):
            return Sign(sign)  # type: ignore[arg-type]
        raise TypeError(f"sign: must be the name of a method or a standoff.Sign, not {type(sign).__name__}")


@dataclass(frozen=True)
class SignReport:
    """How the sign was decided."""

    method: str
    """The one that was used, never ``"auto"``; ``"none"`` if distances have no sign."""
    why: str
    """One sentence: why this method, and what was done to the mesh before."""
    sure: bool
    """Whether the mesh leaves no doubt what is inside."""
    flipped: int
    """Triangles that were taken in the opposite orientation."""
    left_out: int
    """Triangles that were left out: copies of others, inner walls."""
    boundary_edges: int
    """Edges whose triangles do not cancel each other after that: 0 if the mesh is closed."""
    internal: int
    """With ``outer``: triangles with inside on both sides, which were left out."""
    cut: int
    """With ``outer``: triangles that others divide, kept."""


def sign_report(found: dict[str, Any], asked: Sign, stacklevel: int) -> SignReport:
    """The report, with a warning if `auto` is not sure."""
    report = SignReport(**found)
    if asked.method == "auto" and not report.sure:
        warnings.warn(
            f"the sign is not certain: {report.why}. standoff.report(mesh) says more; "
            "name a method with sign=... if you know better, or sign=None for distances without one",
            SignWarning,
            stacklevel=stacklevel + 1,
        )
    return report


@dataclass(frozen=True)
class Grid:
    """A regular grid: sample ``[i, j, k]`` is at ``origin + spacing * (first + (i, j, k))``.

    A grid may be a window of a larger one (`window`): its samples have the coordinates that they have there, bit for
    bit.
    """

    shape: tuple[int, int, int]
    """Samples per axis."""
    origin: tuple[float, float, float]
    """Position of sample ``[0, 0, 0]`` of the whole grid, world units."""
    spacing: tuple[float, float, float]
    """Distance between neighbouring samples per axis, world units."""
    first: tuple[int, int, int] = (0, 0, 0)
    """Of a window: the sample of the whole grid that is sample ``[0, 0, 0]`` here."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", triple(self.shape, "shape", whole=True))
        object.__setattr__(self, "origin", triple(self.origin, "origin"))
        object.__setattr__(self, "spacing", triple(self.spacing, "spacing"))
        object.__setattr__(self, "first", triple(self.first, "first", whole=True))
        self._core()

    @classmethod
    def fit(
        cls,
        bounds: Any,
        *,
        resolution: int | None = None,
        spacing: float | Sequence[float] | None = None,
        shape: Sequence[int] | None = None,
        padding: float = 2,
    ) -> Grid:
        """A grid around a box.

        Args:
            bounds: ``((x, y, z), (x, y, z))``, the box's least and greatest corner; or a mesh.
            resolution: samples on the longest side, 256 if nothing is given.
            spacing: distance between samples, one for all axes or one for each, world units.
            shape: samples per axis; the outermost ones lie on the padded box.
            padding: samples beyond the box on each side.
        """
        from ._mesh import bounds_of

        return _fit(
            bounds_of(bounds), resolution, spacing, shape, _core.Padding(0, number(padding, "padding"), 0, math.inf)
        )

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The first and the last sample's position."""
        low, high = (
            [o + s * (f + at) for o, s, f, at in zip(self.origin, self.spacing, self.first, ends)]
            for ends in ((0, 0, 0), tuple(n - 1 for n in self.shape))
        )
        return (low[0], low[1], low[2]), (high[0], high[1], high[2])

    def window(self, first: Sequence[int], shape: Sequence[int]) -> Grid:
        """A part of this grid.

        Args:
            first: its first sample.
            shape: its samples per axis.
        """
        begin, size = triple(first, "first", whole=True), triple(shape, "shape", whole=True)
        for axis, (at, n, whole) in enumerate(zip(begin, size, self.shape)):
            if at < 0 or n < 1 or at + n > whole:
                raise ValueError(
                    f"window: samples {at} to {at + n - 1} along axis {axis} are not all in the grid, which has {whole}"
                )
        at = tuple(mine + more for mine, more in zip(self.first, begin))
        return Grid(size, self.origin, self.spacing, (at[0], at[1], at[2]))

    def points(self) -> np.ndarray:
        """The position of every sample, ``(nx, ny, nz, 3)`` doubles."""
        axes = [o + s * np.arange(f, f + n) for o, s, f, n in zip(self.origin, self.spacing, self.first, self.shape)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def _core(self) -> _core.Grid:
        return _core.Grid(self.shape, self.origin, self.spacing, self.first)


def _fit(
    box: Box,
    resolution: int | None,
    spacing: float | Sequence[float] | None,
    shape: Sequence[int] | None,
    padding: _core.Padding,
) -> Grid:
    low, high = box
    given = [
        name
        for name, value in (("resolution", resolution), ("spacing", spacing), ("shape", shape))
        if value is not None
    ]
    if len(given) > 1:
        raise ValueError(f"{' and '.join(given)}: give one of these, each decides the grid")
    lists: Any  # which Grid makes tuples of
    if shape is not None:
        lists = _core.fit_size(low, high, triple(shape, "shape", whole=True), padding)
    elif spacing is not None:
        lists = _core.fit_spacing(low, high, _spacing(spacing), padding)
    else:
        samples = _core.DEFAULT_RESOLUTION if resolution is None else whole_number(resolution, "resolution")
        lists = _core.fit_resolution(low, high, samples, padding)
    return Grid(*lists)


def _spacing(spacing: Any) -> tuple[float, float, float]:
    if isinstance(spacing, numbers.Real) and not isinstance(spacing, bool):
        found = number(spacing, "spacing")
        return (found, found, found)
    return triple(spacing, "spacing")


def grid_of(
    bounds: Callable[[], Box],
    grid: Grid | None,
    resolution: int | None,
    spacing: float | Sequence[float] | None,
    shape: Sequence[int] | None,
    padding: float | None,
    band: float | None,
    thickness: float | None,
) -> tuple[Grid, float]:
    """The grid and the band's half-width in world units: as `field` promises, and as the program chooses them."""
    if band is not None and thickness is not None:
        raise ValueError("band and thickness: give one of these; band counts in samples, thickness in world units")
    if band is not None:
        band = number(band, "band")
        if not 0 < band < math.inf:
            raise ValueError(f"band: must be positive and finite, not {band:g}; leave it out for a full field")
    if thickness is not None:
        thickness = number(thickness, "thickness")
    if grid is not None:
        for name, value in (("resolution", resolution), ("spacing", spacing), ("shape", shape), ("padding", padding)):
            if value is not None:
                raise ValueError(f"grid and {name}: give one of these, the grid is complete")
        if not isinstance(grid, Grid):
            raise TypeError(f"grid: must be a standoff.Grid, not {type(grid).__name__}")
    else:
        if padding is not None:
            room = _core.Padding(0, number(padding, "padding"), 0, math.inf)
        elif band is not None and spacing is None:
            room = _core.padding_for_samples(band)
        elif band is not None:
            room = _core.padding_for(band * max(_spacing(spacing)))
        else:
            room = _core.padding_for(math.inf if thickness is None else thickness)
        grid = _fit(bounds(), resolution, spacing, shape, room)
    if thickness is None:
        thickness = math.inf if band is None else band * max(grid.spacing)
    return grid, thickness


def memory_text(count: int) -> str:
    """A number of bytes, to be read."""
    amount = float(count)
    for unit in ("bytes", "kB", "MB", "GB"):
        if amount < 1000 or unit == "GB":
            break
        amount /= 1000
    return f"{amount:.0f} {unit}" if unit == "bytes" else f"{amount:.3g} {unit}"


def memory_limit_of(limit: int | None) -> int:
    """As the compiled module takes it: 0 for 80 % of the machine's memory, negative for no limit."""
    return 0 if limit is None else whole_number(limit, "memory_limit")


@contextmanager
def progress_of(progress: Progress, name: str) -> Iterator[Callable[[str, float], Any] | None]:
    """What the compiled module calls: the user's function, or a bar by tqdm if `progress` is True."""
    if progress is None or progress is False:
        yield None
        return
    if callable(progress):
        yield progress
        return
    if progress is not True:
        raise TypeError(f"progress: must be True or a function of stage and fraction, not {type(progress).__name__}")
    try:
        from tqdm.auto import tqdm
    except ImportError as error:
        raise ImportError("progress=True draws its bar with tqdm; pip install tqdm, or pass a function") from error
    with tqdm(
        total=1000, desc=name, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}{postfix}"
    ) as bar:

        def show(stage: str, fraction: float) -> None:
            bar.set_postfix_str(stage, refresh=False)
            bar.update(round(1000 * fraction) - bar.n)

        yield show
