# SPDX-License-Identifier: Apache-2.0
"""Pages that show meshes and fields in a browser or a notebook."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from . import _core
from ._checks import PathLike, flag, name, path_of, whole_number

if TYPE_CHECKING:
    from ._field import DistanceField
    from ._mesh import Mesh


def _in_notebook() -> bool:
    """Whether a kernel runs this, whose front end shows what a cell returns."""
    interactive = sys.modules.get("IPython")
    shell = interactive.get_ipython() if interactive is not None else None
    return getattr(shell, "kernel", None) is not None


class Page:
    """A page that shows meshes and fields: one HTML file, which asks the network for nothing.

    Notebooks show it in a frame; ``open`` shows it in the browser, ``save`` writes it, ``bytes(page)`` is the file's
    content.
    """

    def __init__(self, html: bytes, height: int = 560) -> None:
        self._html = html
        self._height = height

    @classmethod
    def showing(
        cls,
        meshes: list[Mesh],
        fields: list[DistanceField],
        *,
        title: str,
        unit: str,
        up: str,
        height: int,
        browser: bool | None,
    ) -> Page:
        """The page of these meshes and fields, opened in the browser if that is asked for; None: where no notebook shows it."""
        from ._field import DistanceField
        from ._mesh import upwards

        for field in fields:
            if not isinstance(field, DistanceField):
                raise TypeError(f"fields: must be of DistanceField, not {type(field).__name__}")
        rows = whole_number(height, "height", bits=32)
        if rows < 1:
            raise ValueError(f"height: must be at least 1, not {rows}")
        numbers = [f" {n}" if len(fields) > 1 else "" for n in range(1, len(fields) + 1)]
        html = _core.make_page(
            [("mesh", mesh.vertices, mesh.faces) for mesh in meshes],
            [f"field{number}" for number in numbers],
            [field._native() for field in fields],
            name(title, "title") or ("mesh" if not fields else "field" if len(fields) == 1 else "fields"),
            name(unit, "unit"),
            upwards(up, meshes),
        )
        page = cls(html, rows)
        if not _in_notebook() if browser is None else flag(browser, "browser"):
            page.open()
        return page

    def open(self) -> bool:
        """Opens the page in the browser, out of a file in the folder of temporary files; says whether there is one.

        On Linux and without a display nothing is opened, unless the environment variable BROWSER names a browser.
        """
        if sys.platform.startswith("linux") and not any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"))):
            return False  # a browser of text would take the terminal
        import tempfile
        import webbrowser

        with tempfile.NamedTemporaryFile(prefix="standoff-", suffix=".html", delete=False) as file:
            file.write(self._html)
        return webbrowser.open(Path(file.name).as_uri())

    def save(self, path: PathLike) -> None:
        """Writes the page as an HTML file."""
        with open(path_of(path), "wb") as file:
            file.write(self._html)

    def __bytes__(self) -> bytes:
        return self._html

    def _repr_html_(self) -> str:
        from html import escape  # late, like all that only notebooks need

        # Its own origin: the page reaches nothing of the notebook's.
        return (
            f'<iframe srcdoc="{escape(self._html.decode("utf-8", "replace"))}" sandbox="allow-scripts allow-downloads" '
            f'style="width: 100%; height: {self._height}px; border: 0; border-radius: 8px" title="standoff"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<standoff.Page: {len(self._html):,} bytes>"
