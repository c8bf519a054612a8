# SPDX-License-Identifier: Apache-2.0
"""Where stores are: a folder, or what fsspec and obstore reach. Parts are written by the library, in a folder; elsewhere
their files are copied from one."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Protocol

from . import _core
from ._errors import UsageError
from ._field import DistanceField

Triple = tuple[int, int, int]
ARRAY = "0"  # of the distances, in a store


def _scratch() -> AbstractContextManager[str]:
    """A folder that is removed with its end."""
    import tempfile

    return tempfile.TemporaryDirectory(prefix="standoff-")


class Files(Protocol):
    """Whole objects by their keys, which appear whole or not at all."""

    def get(self, key: str) -> bytes | None: ...
    def put(self, key: str, data: bytes) -> None: ...
    def keys(self, prefix: str) -> Iterator[str]: ...
    def delete(self, key: str) -> None: ...


class FsspecFiles:
    """By a file system of fsspec: ``s3://bucket/field.zarr``, ``gs://``, ``memory://``."""

    def __init__(self, url: str, options: dict[str, Any]) -> None:
        try:
            from fsspec.core import url_to_fs  # type: ignore[import-untyped]
        except ImportError:
            raise ImportError(
                f"{url}: needs fsspec, which is not installed; pip install 'standoff[dask]', and what fsspec needs for "
                "this kind of URL, such as s3fs",
                name="fsspec",
            ) from None
        self._system, self._root = url_to_fs(url, **options)

    def _at(self, key: str) -> str:
        return f"{self._root.rstrip('/')}/{key}"

    def get(self, key: str) -> bytes | None:
        try:
            return bytes(self._system.cat_file(self._at(key)))
        except FileNotFoundError:
            return None

    def put(self, key: str, data: bytes) -> None:
        self._system.makedirs(self._at(key).rsplit("/", 1)[0], exist_ok=True)
        self._system.pipe_file(self._at(key), data)

    def keys(self, prefix: str) -> Iterator[str]:
        self._system.invalidate_cache()
        start = len(self._root.rstrip("/")) + 1
        for name in self._system.find(self._at(prefix)):
            yield name[start:]

    def delete(self, key: str) -> None:
        self._system.rm_file(self._at(key))


class ObstoreFiles:
    """By a store of obstore."""

    def __init__(self, store: Any) -> None:
        self._store = store

    def get(self, key: str) -> bytes | None:
        import obstore

        try:
            return bytes(obstore.get(self._store, key).bytes())
        except FileNotFoundError:
            return None

    def put(self, key: str, data: bytes) -> None:
        import obstore

        obstore.put(self._store, key, data)

    def keys(self, prefix: str) -> Iterator[str]:
        import obstore

        for batch in obstore.list(self._store, prefix):
            for item in batch:
                yield item["path"]

    def delete(self, key: str) -> None:
        import obstore

        obstore.delete(self._store, key)


class Target:
    """A store that is written shard by shard, by any number of processes. Pickled, it is the way to the store alone."""

    def __init__(self, url: Any, options: dict[str, Any] | None = None) -> None:
        self._options = options or {}
        if isinstance(url, (str, os.PathLike)):
            text = os.fspath(url)
            if not isinstance(text, str):
                raise TypeError("url: must be text, not bytes")
            self.is_folder = "://" not in text or text.startswith("file://")
            self.url: Any = text.removeprefix("file://") if self.is_folder else text
        elif type(url).__module__.split(".")[0] == "obstore":
            self.is_folder, self.url = False, url
        else:
            raise TypeError(f"url: must be a path, a URL or a store of obstore, not {type(url).__name__}")
        if self.is_folder and self._options:
            raise UsageError(f"{self.url}: a folder has no storage_options; leave them out")

    def files(self) -> Files:
        """Of a store that is no folder."""
        return FsspecFiles(self.url, self._options) if isinstance(self.url, str) else ObstoreFiles(self.url)

    def create(
        self, like: _core.Windows, grid: Any, thickness: float, shard: Triple, chunk: Triple, overwrite: bool
    ) -> None:
        """Makes a store without samples, in the place of one that standoff wrote. Errors: output, usage."""
        arguments = (grid._core(), thickness, like.provenance, shard, chunk, False)
        if self.is_folder:
            _core.create_store(Path(self.url), *arguments, overwrite)
            return
        files = self.files()
        if overwrite:
            self._clear(files)
        with _scratch() as folder:
            made = _core.create_store(Path(folder) / "new.zarr", *arguments, False)
            names = [path for path in Path(made.path).rglob("*") if path.is_file()]
            # The group last: until then it is no store.
            for path in sorted(names, key=lambda name: len(name.parts), reverse=True):
                files.put(path.relative_to(made.path).as_posix(), path.read_bytes())

    def exists(self) -> bool:
        return (Path(self.url) / "zarr.json").exists() if self.is_folder else self.files().get("zarr.json") is not None

    def _clear(self, files: Files) -> None:
        import json

        if files.get("zarr.json") is None:
            return
        try:
            attributes = json.loads(files.get(f"{ARRAY}/zarr.json") or b"{}")["attributes"]["standoff"]
        except (ValueError, KeyError, TypeError):
            attributes = None
        if not isinstance(attributes, dict):
            raise UsageError(f"{self.url}: standoff did not write this store, and leaves it; name another")
        # The group first: without it the rest is no store.
        for key in sorted(files.keys(""), key=lambda name: name != "zarr.json"):
            files.delete(key)

    def open(self, level: int = 0) -> _core.Store:
        """The metadata of the store or of a level; of a store that is no folder, of a copy that has no samples."""
        if self.is_folder:
            return _core.open_store(Path(self.url), level)
        with _scratch() as folder:
            self.copy_metadata(Path(folder), level)
            return _core.open_store(Path(folder), level)

    def copy_metadata(self, folder: Path, level: int = 0) -> None:
        """Of a level of a store that is no folder, and of level 0."""
        files = self.files()
        for key in ("zarr.json", f"{ARRAY}/zarr.json", "nearest/zarr.json", f"{level}/zarr.json"):
            data = files.get(key)
            if data is not None:
                (folder / key).parent.mkdir(parents=True, exist_ok=True)
                (folder / key).write_bytes(data)

    def shards(self, level: int = 0) -> set[Triple]:
        """The shards of a level that have a file."""
        if self.is_folder:
            root = Path(self.url) / str(level) / "c"
            parts = (path.relative_to(root).parts for path in root.glob("*/*/*"))
        else:
            parts = (tuple(key.split("/")[2:]) for key in self.files().keys(f"{level}/c/"))
        found = set()
        for name in parts:
            if len(name) == 3 and all(part.isdigit() for part in name):
                found.add((int(name[0]), int(name[1]), int(name[2])))
        return found

    def write(self, first: Triple, window: DistanceField, threads: int) -> None:
        """Whole shards; each appears whole or not at all. Errors: usage, output."""
        if self.is_folder:
            _core.open_store(Path(self.url), 0).write(first, window._native(), threads)
            return
        files = self.files()
        with _scratch() as folder:
            self.copy_metadata(Path(folder))
            group = Path(folder) / "zarr.json"
            before = group.read_bytes()
            _core.open_store(Path(folder), 0).write(first, window._native(), threads)
            if group.read_bytes() != before:  # its levels are no longer those of the field
                files.put("zarr.json", group.read_bytes())
            _put_all(files, Path(folder), ARRAY)

    def begin_levels(self, levels: int) -> None:
        """Makes the arrays of levels, which the store does not list before `end_levels`."""
        if self.is_folder:
            return _core.open_store(Path(self.url), 0).begin_levels(levels)
        with _scratch() as folder:
            self.copy_metadata(Path(folder))
            _core.open_store(Path(folder), 0).begin_levels(levels)
            files = self.files()
            for key in ("zarr.json", *(f"{level}/zarr.json" for level in range(1, levels))):
                files.put(key, (Path(folder) / key).read_bytes())

    def write_level(self, level: int, first: Triple, shape: Triple, threads: int) -> None:
        """Whole shards of a level, out of the one before it."""
        if self.is_folder:
            return _core.open_store(Path(self.url), 0).write_level(level, first, shape, threads)
        files = self.files()
        with _scratch() as folder:
            self.copy_metadata(Path(folder))
            store = _core.open_store(Path(folder), 0)
            ranges = [range(2 * at // s, (2 * (at + n) - 1) // s + 1) for at, n, s in zip(first, shape, store.shard)]
            for shard in itertools.product(*ranges):
                key = f"{level - 1}/c/" + "/".join(map(str, shard))
                data = files.get(key)
                if data is not None:
                    (Path(folder) / key).parent.mkdir(parents=True, exist_ok=True)
                    (Path(folder) / key).write_bytes(data)
            store.write_level(level, first, shape, threads)
            _put_all(files, Path(folder), str(level))

    def end_levels(self, levels: int) -> None:
        """Lists levels, which are complete."""
        if self.is_folder:
            return _core.open_store(Path(self.url), 0).end_levels(levels)
        with _scratch() as folder:
            self.copy_metadata(Path(folder))
            _core.open_store(Path(folder), 0).end_levels(levels)
            self.files().put("zarr.json", (Path(folder) / "zarr.json").read_bytes())


def _put_all(files: Files, folder: Path, array: str) -> None:
    for path in sorted((folder / array / "c").rglob("*")):
        if path.is_file():
            files.put(path.relative_to(folder).as_posix(), path.read_bytes())
