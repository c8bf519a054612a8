# SPDX-License-Identifier: Apache-2.0
"""Pages of meshes and fields."""

import html
import math
import sys
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlparse
from urllib.request import url2pathname

import pytest
import shapes
import standoff as so


def test_pages(tmp_path):
    mesh = so.Mesh(*shapes.sphere(8))
    field, band = so.field(mesh, resolution=24), so.field(mesh, resolution=16, band=2)
    pages = [field.show(), field.show(mesh=mesh, up="y", unit="mm", title="a sphere"), field.show(band, mesh=shapes.sphere(4)),
             mesh.show(), mesh.show(field, band, height=300)]  # fmt: skip
    for page in pages:
        assert bytes(page).startswith(b"<!doctype html>")
        page.save(tmp_path / "page.html")
        assert (tmp_path / "page.html").read_bytes() == bytes(page)
    assert [bytes(page).count(b'class="data"') for page in pages] == [1, 2, 3, 1, 3]
    assert b"<title>a sphere</title>" in bytes(pages[1]) and b'"unit":"mm"' in bytes(pages[1])
    assert bytes(field.show()) == bytes(pages[0])
    assert repr(pages[0]) == f"<standoff.Page: {len(bytes(pages[0])):,} bytes>"


def test_scripts_open_the_browser(monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    monkeypatch.setenv("BROWSER", "true")
    mesh = so.Mesh(*shapes.cube())
    pages = [mesh.show(), so.field(mesh, resolution=12).show()]
    for page, address in zip(pages, opened, strict=True):
        path = Path(url2pathname(urlparse(address).path))
        assert path.suffix == ".html" and path.read_bytes() == bytes(page)
        path.unlink()
    assert isinstance(mesh.show(browser=False), so.Page) and len(opened) == 2
    with pytest.raises(TypeError, match="browser: must be True or False"):
        mesh.show(browser=1)
    # A notebook shows what a cell returns; with a terminal alone there is no browser to open.
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel=1)))
    mesh.show()
    assert len(opened) == 2
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    mesh.show()
    assert len(opened) == 3
    Path(url2pathname(urlparse(opened[2]).path)).unlink()
    for name in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    assert mesh.show(browser=False).open() is False and len(opened) == 3


def test_notebooks_show_a_frame():
    page = so.field(shapes.sphere(8), resolution=16).show(title="</iframe><script>alert(1)</script>", height=321)
    shown = page._repr_html_()
    assert shown.count("<") == 2 and "height: 321px" in shown and 'sandbox="allow-scripts allow-downloads"' in shown
    inside = shown.split('srcdoc="')[1].split('"')[0]
    assert html.unescape(inside).encode() == bytes(page)


def test_arguments_of_pages():
    field = so.field(shapes.sphere(8), resolution=16)
    wrong = ({"up": "w"}, {"height": 0}, {"height": -1})
    for arguments in wrong:
        with pytest.raises(ValueError):
            field.show(**arguments)
    for arguments in ({"title": 3}, {"unit": None}, {"height": math.pi}, {"mesh": 5}, {"up": 1}):
        with pytest.raises(TypeError):
            field.show(**arguments)
    with pytest.raises(TypeError):
        field.show(5)
    with pytest.raises(so.MeshError):
        so.Mesh([[0, 0, 0]], [[0, 0, 7]]).show()


def up_of(page):
    return bytes(page).split(b'"up":"')[1][:1].decode()


def test_what_points_up(tmp_path):
    """A mesh knows it from its file's format, its field from the mesh; of arrays it is the axis of the flattest base."""
    mesh = so.Mesh(*shapes.sphere(8))
    for name, up in (("a.obj", "y"), ("a.stl", "z")):
        mesh.save(tmp_path / name)
        read = so.read(tmp_path / name)
        field = so.field(read, resolution=16)
        kept = tmp_path / "a.npz"
        field.save(kept)
        assert (read.up, field.provenance["up"], so.load(kept).provenance["up"]) == (up, up, up)
        assert up_of(read.show()) == up_of(field.show()) == up and up_of(field.show(up="x")) == "x"
        assert so.field(read, resolution=8, band=2).provenance["up"] == up
    vertices = [[0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0.3, 0.3]]
    on_x = so.Mesh(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    assert on_x.up == "" and up_of(on_x.show()) == "x"
    with pytest.raises(ValueError):
        so.Mesh(vertices, [[0, 1, 2]], up="w")
