# SPDX-License-Identifier: Apache-2.0
"""Fields in stores, of which only what is asked for is read."""

from __future__ import annotations

import operator
import threading
import weakref
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from ._arrays import Points
from ._checks import triple, whole_number
from ._errors import UsageError
from ._field import DistanceField
from ._gradients import differentiable, refuse_gradient, wants_gradient
from ._options import Grid, memory_limit_of
from ._targets import Target, Triple

_BLOCK = 64  # samples along each axis of what is read for points
_MOST_BLOCKS = 32  # that are kept
_MOST_SHARDS = 64  # of a store elsewhere that are kept on the disk


class _Reader:
    """Reads windows of a store; of one that is no folder, from copies of its shards."""

    def __init__(self, target: Target, level: int) -> None:
        self._target = target
        self._level = level
        self.store = target.open(level)
        self._copy: Path | None = None
        self._shards: OrderedDict[Triple, Path] = OrderedDict()
        self._fetching = threading.Lock()

    def read(self, first: Triple, shape: Triple, limit: int) -> _core.Field:
        if self._target.is_folder:
            return self.store.read(first, shape, limit)
        with self._fetching:
            if self._copy is None:
                import shutil
                import tempfile

                self._copy = Path(tempfile.mkdtemp(prefix="standoff-"))
                weakref.finalize(self, shutil.rmtree, self._copy, True)
                self._target.copy_metadata(self._copy, self._level)
            self._fetch(self._copy, first, shape)
            return _core.open_store(self._copy, self._level).read(first, shape, limit)

    def _fetch(self, copy: Path, first: Triple, shape: Triple) -> None:
        files, side = self._target.files(), self.store.shard
        ranges = [range(at // s, (at + n - 1) // s + 1) for at, n, s in zip(first, shape, side)]
        wanted = [(i, j, k) for i in ranges[0] for j in ranges[1] for k in ranges[2]]
        for shard in wanted:
            name = "/".join(map(str, shard))
            for array in (str(self._level), "nearest") if self.store.has_nearest else (str(self._level),):
                path = copy / array / "c" / name
                if shard not in self._shards:
                    data = files.get(f"{array}/c/{name}")
                    if data is not None:
                        path.parent.mkdir(parents=True, exist_ok=True)
                        path.write_bytes(data)
            self._shards[shard] = Path(name)
            self._shards.move_to_end(shard)
        while len(self._shards) > max(_MOST_SHARDS, len(wanted)):
            _, old = self._shards.popitem(last=False)
            for array in (str(self._level), "nearest"):
                (copy / array / "c" / old).unlink(missing_ok=True)


def _index(key: Any) -> int:
    try:
        return operator.index(key)
    except TypeError:
        raise IndexError(
            f"a stored field takes whole numbers, slices and ..., not {key!r}; give one of these"
        ) from None


class StoredField:
    """A field in a Zarr store (`standoff.open`). It is read where it is asked for, and may be larger than memory.

    Dask, and others who take what has ``shape``, ``dtype`` and slices, read it in parts: ``dask.array.from_array(stored,
    chunks=stored.shard)``. Pickled, it is the way to the store alone.
    """

    def __init__(self, target: Any, level: int = 0) -> None:  # a Target
        self._target: Target = target
        self._level = level
        self._reader = _Reader(target, level)
        store = self._reader.store
        lists: Any = store.shape, store.origin, store.spacing  # Grid makes tuples of them
        self._grid = Grid(*lists)
        self._blocks: OrderedDict[Triple, DistanceField] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def grid(self) -> Grid:
        """Where the samples are."""
        return self._grid

    @property
    def shape(self) -> tuple[int, int, int]:
        """Samples per axis."""
        return self._grid.shape

    @property
    def ndim(self) -> int:
        """3."""
        return 3

    @property
    def dtype(self) -> np.dtype[Any]:
        """float32."""
        return np.dtype(np.float32)

    @property
    def thickness(self) -> float:
        """Half-width of the band, world units; infinite for a full field."""
        return self._reader.store.thickness

    @property
    def signed(self) -> bool:
        """Whether values inside are negative."""
        return bool(self._reader.store.provenance.sign)

    @property
    def has_nearest(self) -> bool:
        """Whether the store also has nearest triangles."""
        return self._reader.store.has_nearest

    @property
    def provenance(self) -> dict[str, Any]:
        """Where the values come from, as `DistanceField.provenance`."""
        p = self._reader.store.provenance
        return {"method": p.method, "mesh_hash": p.mesh_hash, "version": p.version, "sign": p.sign, "up": p.up}

    @property
    def shard(self) -> tuple[int, int, int]:
        """Samples per axis of a shard, which is one file."""
        i, j, k = self._reader.store.shard
        return i, j, k

    @property
    def chunk(self) -> tuple[int, int, int]:
        """Samples per axis of a chunk, which is what is unpacked."""
        i, j, k = self._reader.store.chunk
        return i, j, k

    @property
    def level(self) -> int:
        """Which level of the store this is: it has every 2**level-th sample along each axis."""
        return self._level

    @property
    def levels(self) -> int:
        """How many levels the store has. 1: the field alone."""
        return self._reader.store.levels

    def __repr__(self) -> str:
        level = f", level {self._level} of {self.levels}" if self.levels > 1 else ""
        return f"<StoredField {self.shape}, thickness {self.thickness:g}{level}, {self._target.url}>"

    def window(self, first: Sequence[int], shape: Sequence[int], *, memory_limit: int | None = None) -> DistanceField:
        """Reads a part.

        Args:
            first: its first sample.
            shape: its samples per axis. Its grid is ``grid.window(first, shape)``.
            memory_limit: bytes, as for `standoff.load`.

        Raises:
            UsageError: samples that are not in the grid.
            InputError: a shard that is damaged.
        """
        at, size = triple(first, "first", whole=True), triple(shape, "shape", whole=True)
        return DistanceField._of_native(self._reader.read(at, size, memory_limit_of(memory_limit)))

    def __getitem__(self, key: Any) -> np.ndarray:
        """``field[10:20, :, 5]``: values as numpy has them, of what is read for it."""
        keys = key if isinstance(key, tuple) else (key,)
        if Ellipsis in keys:
            at = keys.index(Ellipsis)
            keys = keys[:at] + (slice(None),) * (4 - len(keys)) + keys[at + 1 :]
        keys += (slice(None),) * (3 - len(keys))
        if len(keys) != 3:
            raise IndexError(f"a field has three axes, not {len(keys)}")
        first, size = [], []
        steps: list[slice | int] = []
        for axis, (one, n) in enumerate(zip(keys, self.shape)):
            if isinstance(one, slice):
                places = range(n)[one]
                low, high = (min(places), max(places)) if places else (0, 0)
                first.append(low)
                size.append(high - low + 1)
                steps.append(slice(0, 0) if not places else slice(None, None, places.step))
            else:
                index = _index(one)
                if not -n <= index < n:
                    raise IndexError(f"sample {index} is not along axis {axis}, which has {n}")
                first.append(index % n)
                size.append(1)
                steps.append(0)
        return self.window(first, size).numpy()[tuple(steps)]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        if copy is False:
            raise ValueError("a stored field is read from its files: it has no array to share; leave copy=False out")
        values = self.load().numpy()
        return values if dtype is None else values.astype(dtype)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle keeps where the store is: it is opened again."""
        return StoredField, (self._target, self._level)

    def __call__(self, points: Any, *, outside: str = "nan", threads: int = 0) -> Any:
        """Values between samples, as `DistanceField` gives them; reads the chunks around the points.

        Args:
            points: ``(..., 3)``, world units.
            outside: ``"nan"``, ``"border"`` or ``"bound"``, what points beyond the grid get.
            threads: 0 for all.
        """
        values = self._ask(points, lambda block, some: block(some, outside=outside, threads=threads), ())
        if not wants_gradient(points):
            return values
        slopes = self._ask(points, lambda block, some: block._slopes(some, outside, threads), (3,))
        return differentiable(values, points, slopes)

    def gradient(self, points: Any, *, outside: str = "nan", threads: int = 0) -> Any:
        """The gradient of the values between samples, ``(..., 3)``, as `DistanceField.gradient`."""
        refuse_gradient(points, "points")
        return self._ask(points, lambda block, some: block.gradient(some, outside=outside, threads=threads), (3,))

    def _ask(self, points: Any, ask: Any, more: tuple[int, ...]) -> Any:
        given = Points(points, gradient=True)
        rows = given.array.reshape(-1, 3)
        answers = np.empty((len(rows), *more))
        with np.errstate(invalid="ignore"):
            at = np.floor((rows - self._grid.origin) / self._grid.spacing)
        last = np.maximum(np.array(self.shape) - 2, 0)
        blocks = np.clip(np.nan_to_num(at), 0, last).astype(np.int64) // _BLOCK
        for block in np.unique(blocks, axis=0):
            here = (blocks == block).all(axis=1)
            answers[here] = ask(self._block((int(block[0]), int(block[1]), int(block[2]))), rows[here])
        return given.give(answers)

    def _block(self, number: Triple) -> DistanceField:
        """The samples of a block and the first ones after it, so that all its cells are whole."""
        with self._lock:
            found = self._blocks.get(number)
            if found is not None:
                self._blocks.move_to_end(number)
                return found
        first = [_BLOCK * n for n in number]
        found = self.window(first, [min(_BLOCK + 1, n - at) for at, n in zip(first, self.shape)])
        with self._lock:
            self._blocks[number] = found
            while len(self._blocks) > _MOST_BLOCKS:
                self._blocks.popitem(last=False)
        return found

    def load(self, *, memory_limit: int | None = None) -> DistanceField:
        """All of it."""
        return self.window((0, 0, 0), self.shape, memory_limit=memory_limit)


def open_store(url: Any, *, level: int = 0, storage_options: dict[str, Any] | None = None) -> StoredField:
    """Opens a field in a Zarr store, without reading its samples.

    Args:
        url: a folder, a URL that fsspec knows (``"s3://bucket/field.zarr"``), or a store of obstore.
        level: which one, of a store that has several: level n has every 2**n-th sample along each axis.
        storage_options: for fsspec.

    Raises:
        UsageError: the store does not list that level.
        InputError: there is no store, or it is of a kind that is not read: the message says which are.
        ImportError: fsspec, or what it needs for this kind of URL, is not installed.
    """
    target = Target(url, storage_options)
    if not target.exists() and not target.is_folder:
        raise UsageError(f"{target.url}: there is no store; check the name")
    return StoredField(target, whole_number(level, "level", bits=32))
