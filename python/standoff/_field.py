# SPDX-License-Identifier: Apache-2.0
"""Distance fields on grids."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np

from . import _core
from ._arrays import Points, numbers
from ._files import PathLike, expect_file, packed, unpacked
from ._mesh import as_mesh
from ._options import (
    Grid,
    Progress,
    Sign,
    SignReport,
    grid_of,
    memory_limit_of,
    memory_text,
    number,
    progress_of,
    runs_on,
    sign_report,
    threads_of,
)
from ._picture import Picture


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

    def __init__(self) -> None:
        raise TypeError("make a DistanceField with standoff.field, standoff.load or DistanceField.from_numpy")

    @classmethod
    def _make(
        cls,
        grid: Grid,
        thickness: float,
        provenance: _core.Provenance,
        *,
        native: _core.Field | None = None,
        dense: np.ndarray | None = None,
        sign: SignReport | None = None,
        computation: dict[str, Any] | None = None,
    ) -> DistanceField:
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
        lists: Any = native.shape, native.origin, native.spacing  # Grid makes tuples of them
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
        """Where the values come from: ``method``, ``mesh_hash``, ``version`` and ``sign``; every file format keeps it."""
        p = self._provenance
        return {"method": p.method, "mesh_hash": p.mesh_hash, "version": p.version, "sign": p.sign}

    @property
    def computation(self) -> dict[str, Any] | None:
        """What computing it did; None if it was not computed here.

        The keys are ``backend``, ``device``, ``threads``, ``triangles``, ``samples_band``,
        ``samples_examined`` (distances between a sample and a triangle) and ``seconds``.
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

    def to_torch(self) -> Any:
        """The same as a torch tensor on the CPU: a copy of a band, the memory of a full field: do not write to that."""
        import torch

        values = self._dense if self._dense is not None else self.numpy()
        if not values.flags.writeable:
            values = values.copy(order="K")
        return torch.from_numpy(values)

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

    def __call__(self, points: Any, *, threads: int = 0) -> Any:
        """The trilinear interpolation at points ``(..., 3)``, world units; outside of the grid, at its nearest point.

        Returns:
            Values ``(...)``: float32 for float32 points, else float64; a torch tensor for a tensor.
        """
        p = Points(points)
        return p.give(self._native().values(p.array, threads_of(threads)))

    def gradient(self, points: Any, *, threads: int = 0) -> Any:
        """The gradient of the interpolation at points ``(..., 3)``, as ``(..., 3)``."""
        p = Points(points)
        return p.give(self._native().gradients(p.array, threads_of(threads)))

    # Files, pictures, checks.

    def save(self, path: PathLike, *, compress: bool = True, overwrite: bool = True, threads: int = 0) -> None:
        """Writes the field in the format of the extension: .vti, .nrrd, .npz, .vdb or .nvdb.

        The file appears whole or not at all, and a band is never made dense in memory.

        Raises:
            OutputError: it cannot be written, or exists and `overwrite` is False.
            UsageError: no format has this extension, or it cannot carry nearest triangles.
        """
        self._native().save(path, compress, overwrite, threads_of(threads))

    def to_bytes(self, format: str = "nvdb", *, compress: bool = True) -> bytes:
        """The content of the file that `save` writes in the format of this extension.

        ``warp.Volume.load_from_nvdb`` takes that of ``"nvdb"`` in a file object, as Newton does.
        """
        return packed(lambda path: self.save(path, compress=compress), "." + format.removeprefix("."))

    def plot(
        self,
        kind: Literal["slice", "surface"] = "slice",
        *,
        axis: Literal["x", "y", "z"] = "z",
        at: float = 0.5,
        colormap: Literal["auto", "viridis", "diverging", "thesis"] = "auto",
        pixels: int = 512,
    ) -> Picture:
        """A picture, which notebooks show.

        Args:
            kind: a slice through the field, or its surface of value 0 (of unsigned fields of one spacing).
            axis: what the slice is perpendicular to.
            at: where along the axis, from 0 to 1.
            colormap: by default red outside and blue inside for signed fields, else viridis.
            pixels: the least length of the picture's longer side.
        """
        if kind == "surface":
            from ._surface import surface

            return surface(self, at=0.0 if self.signed else max(self._grid.spacing)).plot()
        if kind != "slice":
            raise ValueError(f"kind: must be 'slice' or 'surface', not {kind!r}")
        native = self._native()
        return Picture.drawn(lambda path: _core.write_slice(native, path, axis, number(at, "at"), colormap, pixels))

    def _repr_png_(self) -> bytes:
        return bytes(self.plot())

    # Copies.

    def __reduce__(self) -> tuple[Any, ...]:
        state = (self._grid, self._thickness, self.provenance, self._sign)
        if self._dense is not None:
            return _rebuild_dense, (*state, self._dense)
        native = self._native()
        if native.has_nearest:  # files keep the nearest triangles too
            return _rebuild_packed, (packed(lambda path: self.save(path), ".npz"), self._sign)
        # In the order of the grid: as they lie in memory depends on which thread was first.
        slots = np.array(native.slots())
        stored = slots >= 0
        values = native.tile_values().transpose(0, 3, 2, 1)[slots[stored]].reshape(-1, 512)
        slots[stored] = np.arange(len(values))
        return _rebuild_tiles, (*state, values, slots)

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


def _rebuild_dense(
    grid: Grid, thickness: float, provenance: dict[str, Any], sign: SignReport | None, dense: np.ndarray
) -> DistanceField:
    return DistanceField._make(
        grid, thickness, _core.Provenance(**provenance), dense=np.asfortranarray(dense), sign=sign
    )


def _rebuild_tiles(
    grid: Grid,
    thickness: float,
    provenance: dict[str, Any],
    sign: SignReport | None,
    values: np.ndarray,
    slots: np.ndarray,
) -> DistanceField:
    native = _core.from_tiles(grid._core(), thickness, values, slots, _core.Provenance(**provenance))
    return DistanceField._of_native(native, sign)


def _rebuild_packed(content: bytes, sign: SignReport | None) -> DistanceField:
    return DistanceField._of_native(unpacked(content, lambda path: _core.read_field(path, 0), ".npz"), sign)


def field(
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
    method: Literal["tiles", "thesis"] = "tiles",
    out: np.ndarray | None = None,
    device: str = "auto",
    threads: int = 0,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> DistanceField:
    """Computes the distance field of a mesh. Values are exact up to rounding to float32.

    Args:
        mesh: a path, a `Mesh`, ``(vertices, faces)``, or an object of trimesh, pyvista, Open3D, meshio, ...
        resolution: samples on the longest side, 256 by default. Or give one of:
        spacing: distance between samples, world units, one for all axes or one for each;
        shape: samples per axis;
        grid: a `Grid`, for example that of another field.
        padding: samples beyond the mesh on each side; by default the band's width, at least 2.
        band: half-width of the band in samples; or
        thickness: the same in world units. Without either every sample gets its distance.
        sign: ``"auto"`` makes values inside negative by what fits the mesh, and warns if that is not certain
            (`SignWarning`). Another method's name, a `Sign`, or None for distances without sign.
        nearest: also store the index of each sample's nearest triangle.
        method: ``"tiles"``, or Algorithm 1 of the 2008 thesis.
        out: float32 array ``(nx, ny, nz)`` in Fortran order that the values are written to; the field keeps it.
        device: ``"auto"``, ``"cpu"``, ``"cuda"``, ``"cuda:N"`` or ``"emulated"``.
        threads: 0 for all. Values do not depend on it.
        memory_limit: bytes; 80 % of the machine's by default.
        progress: True for a bar by tqdm, or a function of stage and fraction. What it raises ends the work.

    Raises:
        MeshError: the mesh is empty, has a face out of range or a corner that is not finite, or the sign's method
            cannot work with it.
        UsageError, ValueError, TypeError: arguments.
        LimitError: more memory than `memory_limit`.
        DeviceError: there is no such GPU.
        KeyboardInterrupt: Ctrl-C, within 0.1 s.
    """
    found = as_mesh(mesh)
    where, half_width = grid_of(lambda: found.bounds, grid, resolution, spacing, shape, padding, band, thickness)
    asked = Sign.of(sign)
    limit = memory_limit_of(memory_limit)
    dense = None
    if out is not None:
        if nearest:
            raise ValueError("out and nearest: nearest triangles are stored in tiles; leave out one of these")
        dense = _checked_out(out, where)
    elif math.isinf(half_width) and not nearest:
        mesh_and_grid = found.vertices, found.faces, where._core()
        dense = _new_dense(where, limit, lambda: _core.memory_needed(*mesh_and_grid, half_width, asked, False, True))
    settings = (asked, method)
    with progress_of(progress, "field") as report:
        if dense is None:
            native, done = _core.compute(
                found.vertices,
                found.faces,
                where._core(),
                half_width,
                *settings,
                nearest,
                *runs_on(threads, device),
                limit,
                report,
            )
            signs = sign_report(done.pop("sign"), asked, stacklevel=2)
            del done["provenance"], done["method"]
            return DistanceField._of_native(native, signs, done)
        done = _core.compute_dense(
            found.vertices,
            found.faces,
            where._core(),
            half_width,
            dense,
            *settings,
            *runs_on(threads, device),
            limit,
            report,
        )
    signs = sign_report(done.pop("sign"), asked, stacklevel=2)
    made = done.pop("provenance")
    del done["method"]
    provenance = _core.Provenance(made.method, _core.content_hash(found.vertices, found.faces), made.version, made.sign)
    return DistanceField._make(where, half_width, provenance, dense=dense, sign=signs, computation=done)


def _checked_out(out: Any, grid: Grid) -> np.ndarray:
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: must be a numpy array, not {type(out).__name__}; of a torch tensor t pass t.numpy()")
    if out.dtype != np.float32 or out.shape != grid.shape:
        raise ValueError(f"out: must be float32 of shape {grid.shape}, not {out.dtype} of shape {out.shape}")
    if not out.flags.f_contiguous:
        raise ValueError("out: must be in Fortran order: numpy.empty(shape, numpy.float32, order='F')")
    if not out.flags.writeable:
        raise ValueError("out: is read-only")
    return out


def _new_dense(grid: Grid, limit: int, needed_for: Callable[[], int]) -> np.ndarray:
    if 0 < limit < 4 * math.prod(grid.shape):
        needed = needed_for()
        from ._errors import make

        raise make(
            "limit",
            f"a full field of {' x '.join(map(str, grid.shape))} samples takes {memory_text(needed)}, and the limit is "
            f"{memory_text(limit)}; take a band (band=3), a lower resolution, or raise memory_limit",
            bytes_needed=needed,
            bytes_limit=limit,
        )
    return np.empty(grid.shape, np.float32, order="F")


def load(path: PathLike, *, memory_limit: int | None = None) -> DistanceField:
    """Reads a field: .vti, .nrrd, .npz, .vdb or .nvdb, as written by `DistanceField.save` or the program.

    Raises:
        FileNotFoundError, PermissionError: as ``open`` does.
        InputError: the file is damaged, or no field.
        LimitError: it needs more than `memory_limit` bytes, by default 80 % of the machine's.
    """
    expect_file(path)
    return DistanceField._of_native(_core.read_field(path, memory_limit_of(memory_limit)))
