# SPDX-License-Identifier: Apache-2.0
"""Pictures, as notebooks show them."""

from __future__ import annotations

import os
from collections.abc import Callable

from ._checks import PathLike, path_of


class Picture:
    """A PNG picture. Notebooks show it; ``save`` writes it, ``bytes(picture)`` is the file's content."""

    def __init__(self, png: bytes) -> None:
        self._png = png

    @classmethod
    def drawn(cls, draw: Callable[[str], None]) -> Picture:
        """The picture that `draw` writes to the path it gets."""
        import tempfile  # late: it takes a tenth of what importing the package does

        with tempfile.TemporaryDirectory(prefix="standoff-") as folder:
            path = os.path.join(folder, "picture.png")
            draw(path)
            with open(path, "rb") as file:
                return cls(file.read())

    def save(self, path: PathLike) -> None:
        """Writes the picture as a PNG file."""
        with open(path_of(path), "wb") as file:
            file.write(self._png)

    def __bytes__(self) -> bytes:
        return self._png

    def _repr_png_(self) -> bytes:
        return self._png

    def __repr__(self) -> str:
        width, height = (int.from_bytes(self._png[at : at + 4], "big") for at in (16, 20))
        return f"<standoff.Picture: {width} x {height}>"
