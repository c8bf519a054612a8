# SPDX-License-Identifier: Apache-2.0
"""Distance fields on grids."""

from __future__ import annotations

import math
from typing import Any, Literal, TypeVar

import numpy as np

from . import _core
from ._arrays import Points, dlpack_of, numbers
from ._checks import PathLike, flag, name, number, path_of, text, threads_of, whole_number
from ._files import expect_file, packed
from ._gradients import differentiable
from ._options import Grid, Progress, Sign, SignReport, memory_limit_of, memory_text
from ._page import Page
from ._picture import Picture

_Made = TypeVar("_Made", bound="DistanceField")


class DistanceField:
    """The distance to the nearest triangle at every sample of a grid; `field` and `load` make it.

    Values are in world units, negative inside if the field has a sign. In a band they are clamped to `thickness`, and
    only tiles of 8x8x8 samples near the surface are stored. A full field is stored as one dense array.
    """

    _grid: Grid
    _thickness: float
    _native_field: _core.Field | None  # made of _dense when it is first needed; one of these two is always there
    _dense: np.ndarray | None
    _provenance: _core.Provenance
    _sign: SignReport | None
    _computation: dict[str, Any] | None

    def __init__(self, *arguments: Any, **named: Any) -> None:
        what = "of values and a grid with DistanceField.from_numpy(values, grid)"
        raise TypeError(f"make a DistanceField {what}, of a mesh with standoff.field, of a file with standoff.load")

    @classmethod
    def _make(
        cls: type[_Made],
        grid: Grid,
        thickness: float,
        provenance: _core.Provenance,
        *,
        native: _core.Field | None = None,
        dense: np.ndarray | None = None,
        sign: SignReport | None = None,
        computation: dict[str, Any] | None = None,
    ) -> _Made:
        field = object.__new__(cls)
        field._grid = grid
        field._thickness = thickness
        field._native_field = native
        field._dense = dense
        field._provenance = provenance
        field._sign = sign
        field._computation = computation
        return field

    @classmethod
    def _of_native(
        cls, native: _core.Field, sign: SignReport | None = None, computation: dict[str, Any] | None = None
    ) -> DistanceField:
        lists: Any = native.shape, native.origin, native.spacing, native.first  # Grid makes tuples of them
        grid = Grid(*lists)
        return cls._make(grid, native.thickness, native.provenance, native=native, sign=sign, computation=computation)

    @classmethod
    def from_numpy(cls, values: Any, grid: Grid, *, thickness: float = math.inf) -> DistanceField:
        """A field of values that you have, ``(nx, ny, nz)``. They are copied.

        Args:
            values: float32 distances, world units.
            grid: where the samples are.
            thickness: what distances are clamped to; tiles whose samples are all that far are not stored.
        """
        if not isinstance(grid, Grid):
            raise TypeError(f"grid: must be a standoff.Grid, not {type(grid).__name__}")
        with np.errstate(over="ignore"):  # what is too large for a float is infinitely far
            array = np.asfortranarray(numbers(values, "values"), dtype=np.float32)
        if array.shape != grid.shape:
            raise ValueError(f"values: must have the grid's shape {grid.shape}, not {array.shape}")
        if np.isnan(array).any():
            raise ValueError("values: some are not numbers; give samples without a distance the thickness")
        signed = "unknown" if bool((array < 0).any()) else ""
        provenance = _core.Provenance("", 0, _core.version, signed)
        return cls._of_native(_core.from_dense(grid._core(), number(thickness, "thickness"), array, provenance))

    # What it is.

    @property
    def grid(self) -> Grid:
        """Where the samples are."""
        return self._grid

    @property
    def device(self) -> str:
        """Where the values lie: ``"cpu"``, or of a `DeviceField` ``"cuda:0"``."""
        return "cpu"

    def cpu(self) -> DistanceField:
        """The field with its values in the memory of the CPU: itself, or a copy of a `DeviceField`."""
        return self

    @property
    def shape(self) -> tuple[int, int, int]:
        """Samples per axis."""
        return self._grid.shape

    @property
    def thickness(self) -> float:
        """Half-width of the band, world units: no value is larger in magnitude. Infinite for a full field."""
        return self._thickness

    @property
    def signed(self) -> bool:
        """Whether values inside are negative."""
        return bool(self._provenance.sign)

    @property
    def sign(self) -> SignReport | None:
        """How the sign was decided; None for a field from a file, whose `provenance` has the method."""
        return self._sign

    @property
    def provenance(self) -> dict[str, Any]:
        """Where the values come from; every file format keeps it.

        The keys are ``method``, ``mesh_hash``, ``version``, ``sign``, and ``up``: the axis of the mesh that points up,
        empty where that is unknown.
        """
        p = self._provenance
        return {"method": p.method, "mesh_hash": p.mesh_hash, "version": p.version, "sign": p.sign, "up": p.up}

    @property
    def computation(self) -> dict[str, Any] | None:
        """What computing it did; None if it was not computed here.

        The keys are ``backend``, ``device``, ``threads``, ``triangles``, ``samples_band``,
        ``samples_examined`` (distances between a sample and a triangle) and ``seconds``. With a cache also ``cached``:
        whether that was an earlier computation.
        """
        return self._computation

    @property
    def nbytes(self) -> int:
        """Memory that the values take."""
        dense = 0 if self._dense is None else self._dense.nbytes
        return dense + (0 if self._native_field is None else self._native_field.memory_bytes)

    def __repr__(self) -> str:
        size = " x ".join(map(str, self.shape))
        kind = "full" if math.isinf(self._thickness) else f"band of {self._thickness:.4g}"
        sign = f"signed ({self._provenance.sign})" if self.signed else "unsigned"
        return f"<standoff.DistanceField: {size}, {kind}, {sign}, {memory_text(self.nbytes)}>"

    # Its values as arrays.

    def numpy(self) -> np.ndarray:
        """The value of every sample, ``(nx, ny, nz)`` float32, indexed ``[i, j, k]``.

        Of a full field this is a view of its memory that cannot be written to; of a band a new array, 4 bytes per
        sample of the grid. x varies fastest in memory (Fortran order): ``.T`` is the C-ordered ``[k, j, i]``.
        """
        if self._dense is not None:
            view = self._dense.view()
            view.flags.writeable = False
            return view
        values = np.empty(self.shape, np.float32, order="F")
        self._native().copy_dense(values)
        return values

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        same = dtype is None or np.dtype(dtype) == np.float32
        if copy is False and (self._dense is None or not same):
            raise ValueError("a band, or another type than float32, cannot be had without a copy")
        values = self.numpy()
        if copy or not same:
            return np.array(values, dtype=dtype, order="K")
        return values

    def to_torch(self, *, copy: bool | None = None) -> Any:
        """The same as a torch tensor on the CPU, float32 ``[i, j, k]``.

        Args:
            copy: None copies a band, and shares the memory of a full field. torch knows no tensors that cannot be
                written to: do not, or the field is no longer that of its mesh. True gives a tensor of your own; False
                is a ValueError where there is nothing to share.
        """
        import torch

        values, _ = self._shared(copy)
        if not values.flags.writeable:  # of a pickle's buffer, say
            values = values.copy(order="K")
        return torch.from_numpy(values)

    def __dlpack__(
        self,
        *,
        stream: Any = None,
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> Any:
        try:
            values, shared = self._shared(copy)
        except ValueError as error:
            raise BufferError(str(error)) from None
        return dlpack_of(values, stream, max_version, dl_device, shared=shared, copy=copy)

    def __dlpack_device__(self) -> tuple[int, int]:
        return (1, 0)  # the CPU

    def _shared(self, copy: bool | None) -> tuple[np.ndarray, bool]:
        """The values, and whether they are the field's memory: as little as `copy`, in the array API's sense, allows."""
        if self._dense is None:
            if copy is False:
                raise ValueError(
                    "copy: the values of a band lie in tiles, and cannot be had as one array without a copy"
                )
            return self.numpy(), False
        return (self._dense.copy(order="K"), False) if copy else (self._dense, True)

    def tiles(self) -> tuple[np.ndarray, np.ndarray]:
        """The stored tiles, without a copy: values and where they are.

        Returns:
            The values, ``(n, 8, 8, 8)`` float32, indexed ``[tile, i, j, k]`` and read-only; samples beyond the grid have
            the thickness as their value. And the coordinates, ``(n, 3)`` int32; the first sample of a tile is
            ``8 * coordinates``. Which tile comes first depends on the threads that computed them;
            ``numpy.lexsort(coordinates.T)`` is an order that does not.
        """
        native = self._native()
        return native.tile_values(), native.tile_coordinates()

    def nearest(self) -> np.ndarray:
        """The index of the nearest triangle of every sample, ``(nx, ny, nz)`` uint32; 2**32 - 1 beyond the band.

        Raises:
            UsageError: the field was computed without ``nearest=True``.
        """
        return self._native().nearest().T

    # Its values anywhere.

    def __call__(self, points: Any, *, outside: str = "nan", threads: int = 0) -> Any:
        """The trilinear interpolation at points ``(..., 3)``, world units.

        Args:
            outside: what points outside of the grid get, of which the field knows nothing: ``"nan"``; with
                ``"border"`` the value at the nearest point of the grid; with ``"bound"`` a lower bound of the distance,
                which grows with the way to the grid, if the mesh lies in the grid's box and values outside are not
                negative.

        Returns:
            Values ``(...)``: float32 for float32 points, else float64; a torch tensor for a tensor. Gradients flow into
            one that requires them.
        """
        p = Points(points, gradient=True)
        values = p.give(self._native().values(p.array, name(outside, "outside"), threads_of(threads)))
        if not p.flows:
            return values
        return differentiable(values, points, p.give(self._slopes(p.array, outside, threads)))

    def _slopes(self, points: np.ndarray, outside: str, threads: int) -> np.ndarray:
        """The gradient of the values: of those at the border there is none along the axes on which a point is outside."""
        slopes = self._native().gradients(points, name(outside, "outside"), threads_of(threads))
        if outside == "border":
            low, high = self._grid.bounds
            slopes[(points < low) | (points > high)] = 0
        return slopes

    def gradient(self, points: Any, *, outside: str = "nan", threads: int = 0) -> Any:
        """The gradient of the interpolation at points ``(..., 3)``, as ``(..., 3)``; `outside` as for values."""
        p = Points(points)
        return p.give(self._native().gradients(p.array, name(outside, "outside"), threads_of(threads)))

    # Files, pictures, checks.

    def save(self, path: PathLike, *, compress: bool = True, overwrite: bool = True, threads: int = 0) -> None:
        """Writes the field in the format of the extension, such as .vti or .npz; docs/formats.md lists all.

        The file appears whole or not at all, and a band is never made dense in memory.

        Raises:
            OutputError: it cannot be written, or exists and `overwrite` is False.
            UsageError: no format has this extension, or it cannot carry nearest triangles.
        """
        self._native().save(
            path_of(path), flag(compress, "compress"), flag(overwrite, "overwrite"), threads_of(threads)
        )

    def to_bytes(self, format: str = "nvdb", *, compress: bool = True) -> bytes:
        """The content of the file that `save` writes in the format of this extension.

        ``warp.Volume.load_from_nvdb`` takes that of ``"nvdb"`` in a file object, as Newton does.
        """
        return packed(lambda path: self.save(path, compress=compress), "." + name(format, "format").removeprefix("."))

    def plot(
        self,
        kind: Literal["slice", "surface"] = "slice",
        *,
        axis: Literal["x", "y", "z"] | None = None,
        at: float | None = None,
        colormap: Literal["auto", "viridis", "diverging", "thesis"] = "auto",
        background: Literal["white", "dark"] = "white",
        interpolation: Literal["auto", "nearest", "linear"] = "auto",
        contours: bool = True,
        bare: bool = False,
        title: str = "",
        unit: str = "",
        legend: str = "",
        pixels: int = 512,
    ) -> Picture:
        """A picture, which notebooks show.

        Args:
            kind: a slice through the field, or its surface of value 0 (of unsigned fields of one spacing).
            axis: what the slice is perpendicular to; by default, of the plane that shows the most.
            at: where along the axis, from 0 to 1; by default, where the plane shows the most.
            colormap: by default red outside and blue inside for signed fields, else viridis.
            background: dark words on white, or light ones on dark.
            interpolation: what is shown between samples: values that are linear, or each sample as a square
                (``"nearest"``); by default squares where they are at least 12 pixels wide and high.
            contours: whether lines are drawn at the legend's round numbers, except across squares.
            bare: the slice alone, without words, legend, scales and margins.
            title: words above the slice.
            unit: the unit of lengths, beside the slice's scales.
            legend: what the numbers are, above the legend; by default "distance", with the unit.
            pixels: the least length of the picture's longer side.
        """
        if kind == "surface":
            from ._surface import surface

            return surface(self, at=0.0 if self.signed else max(self._grid.spacing)).plot()
        if kind != "slice":
            raise ValueError(f"kind: must be 'slice' or 'surface', not {kind!r}")
        native = self._native()
        place = None if axis is None else name(axis, "axis"), None if at is None else number(at, "at")
        look = name(colormap, "colormap"), name(background, "background"), name(interpolation, "interpolation")
        shown = flag(contours, "contours"), flag(bare, "bare")
        words = text(title, "title"), text(unit, "unit"), text(legend, "legend")
        size = whole_number(pixels, "pixels", bits=32)
        return Picture.drawn(lambda path: _core.write_slice(native, path, *place, *look, *shown, *words, size))

    def show(
        self,
        *others: DistanceField,
        mesh: Any = None,
        title: str = "",
        unit: str = "",
        up: str = "auto",
        height: int = 560,
        browser: bool | None = None,
    ) -> Page:
        """A page in which slices, isosurfaces and samples of the field can be looked at; notebooks show it.

        A script opens it in the browser.

        Args:
            others: other fields; the first is compared with this one.
            mesh: shown with the field; anything that `field` takes as a mesh.
            title: the page's title.
            unit: what the legend calls the unit of lengths: ``"mm"``.
            up: the axis that points up: x, y or z; auto: that of the mesh, or the one that the field was made of.
            height: of the frame in a notebook, pixels.
            browser: whether to open the page in a browser; None: where no notebook runs.
        """
        from ._mesh import as_mesh

        meshes = [] if mesh is None else [as_mesh(mesh)]
        return Page.showing(meshes, [self, *others], title=title, unit=unit, up=up, height=height, browser=browser)

    def _repr_png_(self) -> bytes:
        return bytes(self.plot())

    # Of a mesh that moves.

    def update(
        self,
        mesh: Any,
        *,
        before: Any,
        changed: Any = None,
        moved: Any = None,
        sign: str | Sign | None = "auto",
        method: str = "tiles",
        device: str = "auto",
        threads: int = 0,
        memory_limit: int | None = None,
        progress: Progress = None,
    ) -> DistanceField:
        """The field of a mesh that differs in part from this field's mesh, bit for bit as `field` computes it.

        Only tiles that can change are computed; docs/update.md says which these are, and when all are. The field
        itself does not change: the new one is a copy where nothing moved. Its `computation` has the keys ``anew``
        (whether all was computed), ``why``, ``triangles_changed``, ``windows``, ``tiles_computed``, ``tiles_changed``
        and ``seconds``.

        Args:
            mesh: as it is now; anything that `field` takes.
            before: as it was when this field was computed. Keep a copy if you move vertices in place.
            changed: indices of the triangles whose corners differ, or True for each that does; None compares the meshes.
                Where a triangle that moved is missing, the field is wrong.
            moved: the same by vertices: all triangles with one of these changed.
            sign, method, device, threads, memory_limit, progress: as for `field`, and those that this field was
                computed with.

        Raises:
            UsageError, ValueError: `changed` or `moved` are no indices of the mesh; `before` cannot be the field's mesh.
            MeshError, UsageError, ValueError, TypeError, LimitError: as `field`.
        """
        from ._update import updated  # late: it makes fields

        return updated(self, mesh, before, changed, moved, sign, method, (threads, device), memory_limit, progress)

    # Copies.

    def __reduce__(self) -> tuple[Any, ...]:
        from ._pickled import parts  # late: it makes fields

        return parts(self)

    def __copy__(self) -> DistanceField:
        return self  # nothing changes a field

    def __deepcopy__(self, memo: Any) -> DistanceField:
        if self._dense is None:
            return self
        values = self._dense.copy(order="F")  # the array may be the caller's
        return DistanceField._make(self._grid, self._thickness, self._provenance, dense=values, sign=self._sign)

    def _native(self) -> _core.Field:
        if self._native_field is None:
            assert self._dense is not None
            self._native_field = _core.from_dense(self._grid._core(), self._thickness, self._dense, self._provenance)
        return self._native_field


def load(path: PathLike, *, memory_limit: int | None = None) -> DistanceField:
    """Reads a field in any format of docs/formats.md, as written by `DistanceField.save` or the program.

    Raises:
        FileNotFoundError, PermissionError: as ``open`` does.
        InputError: the file is damaged, or no field.
        LimitError: it needs more than `memory_limit` bytes, by default 80 % of the machine's.
    """
    expect_file(path, ["." + known["extension"] for known in _core.field_formats() if known["folder"]])
    return DistanceField._of_native(_core.read_field(path, memory_limit_of(memory_limit)))
