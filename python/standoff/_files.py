# SPDX-License-Identifier: Apache-2.0
"""Files: whether they can be read, and what only they can hold as bytes for pickle."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable, Collection
from typing import Any, TypeVar

from ._errors import UsageError

T = TypeVar("T")


def expect_file(path: Any, folders: Collection[str] = ()) -> None:
    """Raises what ``open`` would: what is not there, or not for us, is not ours to describe.

    Names with the endings `folders` may be folders.
    """
    kind = os.stat(os.fspath(path)).st_mode
    if stat.S_ISDIR(kind) and not os.fsdecode(path).rstrip("/").lower().endswith(tuple(folders)):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    if not os.access(path, os.R_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)


def packed(write: Callable[[str], object], extension: str) -> bytes:
    """The content of the file that `write` makes."""
    import tempfile  # late: it takes a tenth of what importing the package does

    with tempfile.TemporaryDirectory(prefix="standoff-") as folder:
        path = os.path.join(folder, "packed" + extension)
        write(path)
        if os.path.isdir(path):
            raise UsageError(f"{extension}: such a field is a folder of files, not the bytes of one; save it")
        with open(path, "rb") as file:
            return file.read()


def unpacked(content: bytes, read: Callable[[str], T], extension: str) -> T:
    """What `read` makes of a file of that content."""
    import tempfile

    with tempfile.TemporaryDirectory(prefix="standoff-") as folder:
        path = os.path.join(folder, "packed" + extension)
        with open(path, "wb") as file:
            file.write(content)
        return read(path)
