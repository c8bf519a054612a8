# SPDX-License-Identifier: Apache-2.0
"""Reports of meshes, checks of fields, pictures and devices."""

import math
import subprocess

import numpy as np
import pytest
import shapes
import standoff as so


def joined(*meshes):
    offsets = np.cumsum([0] + [len(v) for v, _ in meshes])
    return np.concatenate([v for v, _ in meshes]), np.concatenate([f + o for (_, f), o in zip(meshes, offsets)])


def test_a_cube():
    report = so.report(shapes.cube())
    assert (report.triangles, report.positions, report.closed, report.sure) == (12, 8, True, True)
    assert report.bounds == ((-0.5,) * 3, (0.5,) * 3)
    assert report.area == pytest.approx(6) and report.volume == pytest.approx(1)
    assert report.open_edges == report.nonmanifold_edges == report.inconsistent_edges == report.degenerate == 0
    assert report.boundary_edges == report.boundary_loops == report.intersecting_pairs == 0
    assert report.component_count == len(report.components) == 1
    component = report.components[0]
    assert component.centroid == pytest.approx((0, 0, 0), abs=1e-12)
    assert component.inertia == pytest.approx((1 / 6, 1 / 6, 1 / 6, 0, 0, 0), abs=1e-12)
    assert component.closed and component.solid and component.depth == 0
    text = str(report)
    assert "12 over 8 positions" in text and "closed        yes" in text
    assert "components" not in repr(report)
    with pytest.raises(AttributeError):
        report.triangles = 3


@pytest.mark.parametrize("name", ["cube", "opened", "flipped", "twice", "nested", "crossing", "sheet"])
def test_reports_say_what_the_program_says(name, tmp_path, program):
    vertices, faces = shapes.cube()
    flipped = faces.copy()
    flipped[3] = flipped[3][::-1]
    mesh = {
        "cube": (vertices, faces),
        "opened": (vertices, faces[2:]),
        "flipped": (vertices, flipped),
        "twice": (vertices, np.concatenate([faces, faces[:1], [[0, 0, 1]]])),
        "nested": joined(shapes.cube(), shapes.cube(0.5)),
        "crossing": joined(shapes.cube(), shapes.cube(1, (0.4, 0.3, 0.2))),
        "sheet": shapes.sheet(),
    }[name]
    so.Mesh(*mesh).save(tmp_path / "mesh.obj")
    said = subprocess.run([program, "info", tmp_path / "mesh.obj"], capture_output=True, text=True, check=True).stdout
    rows = {line[:14].strip(): line[14:] for line in said.splitlines() if not line.startswith(" ")}
    ours = {line[:14].strip(): line[14:] for line in str(so.report(tmp_path / "mesh.obj")).splitlines()}
    assert ours.keys() - rows.keys() == set()
    assert {"orientation", "defects", "intersections", "parts", "sign"} <= ours.keys()
    for key in ours.keys() - {"triangles"}:  # with the positions, which the program has with the vertices
        assert ours[key] == rows[key]


def test_what_is_wrong_with_a_mesh():
    vertices, faces = shapes.cube()
    opened = so.report((vertices, faces[2:]))
    assert not opened.closed
    assert (opened.open_edges, opened.boundary_edges, opened.boundary_loops) == (4, 4, 1)
    assert opened.boundary_length == pytest.approx(4)
    assert opened.largest_hole == pytest.approx(math.sqrt(2))
    flipped = faces.copy()
    flipped[3] = flipped[3][::-1]
    assert so.report((vertices, flipped)).flipped == 1
    assert so.report((vertices, flipped)).inconsistent_edges == 3
    twice = so.report((vertices, np.concatenate([faces, faces[:1]])))
    assert twice.duplicate == twice.duplicate_same == 1
    flat = so.report((vertices, np.concatenate([faces, [[0, 0, 1]]])))
    assert flat.degenerate == 1
    crossing = so.report(joined(shapes.cube(), shapes.cube(1, (0.4, 0.3, 0.2))))
    assert crossing.intersecting_pairs > 0 and crossing.component_count == 2
    nested = so.report(joined(shapes.cube(), shapes.cube(0.5)), most_components=1)
    assert nested.component_count == 2 and len(nested.components) == 1
    sheet = so.report(shapes.sheet())
    assert sheet.sign == "none" and not sheet.sure and sheet.openness == pytest.approx(1)
    assert "not certain" in str(sheet)


def test_limits_of_reports():
    for wrong in (
        {"spacing": -1},
        {"spacing": math.nan},
        {"most_components": -1},
        {"most_intersections": -1},
        {"threads": -1},
    ):
        with pytest.raises(ValueError):
            so.report(shapes.cube(), **wrong)
    for wrong in ({"spacing": "1"}, {"most_components": 1.5}, {"most_intersections": None}):
        with pytest.raises(TypeError):
            so.report(shapes.cube(), **wrong)


@pytest.mark.parametrize("options", [{}, {"band": 3}, {"sign": None}, {"nearest": True}], ids=str)
def test_verify_finds_nothing_wrong(options):
    mesh = shapes.sphere(8)
    check = so.verify(so.field(mesh, resolution=24, **options), mesh, samples=500)
    assert check.ok and check.samples == 500
    assert check.samples_wrong == check.sign_wrong == check.nearest_wrong == 0
    assert 0 <= check.largest_error <= check.allowed_error < 1e-4
    assert not check.mesh_differs


def test_verify_finds_what_is_wrong():
    mesh = shapes.sphere(8)
    field = so.field(mesh, resolution=24)
    for spoil in (lambda v: v + 0.01, lambda v: np.where(np.arange(v.size).reshape(v.shape) % 50, v, 0)):
        check = so.verify(so.DistanceField.from_numpy(spoil(field.numpy()), field.grid), mesh, samples=2000)
        assert not check.ok
    assert (
        so.verify(so.DistanceField.from_numpy(-field.numpy(), field.grid), mesh).sign_checked == 0
    )  # by no known method
    assert so.verify(field, shapes.sphere(7)).mesh_differs
    with pytest.raises(TypeError):
        so.verify(field.numpy(), mesh)
    for wrong in ({"samples": 0}, {"samples": -5}, {"threads": -1}):
        with pytest.raises(ValueError):
            so.verify(field, mesh, **wrong)


def test_pictures(tmp_path):
    field, mesh = so.field(shapes.sphere(8), resolution=24), so.Mesh(*shapes.sphere(8))
    pictures = [field.plot(), field.plot(axis="x", at=0.2, colormap="viridis", pixels=64), field.plot("surface"),
                field.plot(at=0.5), field.plot(background="dark", title="Ball, 8 \N{MULTIPLICATION SIGN} 8", unit="mm"),
                so.field(mesh, resolution=16, sign=None).plot(), so.field(mesh, resolution=16, band=2).plot("surface"),
                mesh.plot(width=64, height=48, azimuth=10, elevation=-30, up="y")]  # fmt: skip
    for picture in pictures:
        assert bytes(picture).startswith(b"\x89PNG\r\n\x1a\n")
        assert picture._repr_png_() == bytes(picture)
        picture.save(tmp_path / "picture.png")
        assert (tmp_path / "picture.png").read_bytes() == bytes(picture)
    assert repr(pictures[-1]) == "<standoff.Picture: 64 x 48>"
    assert field._repr_png_() == bytes(field.plot())
    wrong = ({"axis": "w"}, {"background": "pink"}, {"at": 2}, {"at": math.nan}, {"colormap": "jet"}, {"pixels": 0}, {"pixels": -1}, {"pixels": 10**6}, {"kind": "x"})  # fmt: skip
    for arguments in wrong:
        with pytest.raises(ValueError):
            field.plot(**arguments)
    for arguments in ({"width": 0}, {"height": 10**6}, {"azimuth": math.nan}, {"up": "w"}):
        with pytest.raises(ValueError):
            mesh.plot(**arguments)


SLICES = {
    "plain": ({}, []),
    "squares": ({"interpolation": "nearest"}, ["--interpolation", "nearest"]),
    "linear": ({"interpolation": "linear", "pixels": 900}, ["--interpolation", "linear", "--pixels", "900"]),
    "no contours": ({"interpolation": "linear", "contours": False}, ["--interpolation", "linear", "--no-contours"]),
    "bare": ({"bare": True}, ["--bare"]),
    "words": ({"legend": "to the wall", "unit": "mm"}, ["--legend", "to the wall", "--length-unit", "mm"]),
    "title": ({"title": "A ball", "background": "dark"}, ["--title", "A ball", "--background", "dark"]),
}


def test_slices_are_those_of_the_program(tmp_path, program):
    field = so.field(shapes.sphere(8), resolution=64)
    field.save(tmp_path / "field.npz")
    pictures = set()
    for name, (arguments, words) in SLICES.items():
        words = [*([] if "title" in arguments else ["--title", ""]), *words]
        command = [program, "slice", "field.npz", "-o", f"{name}.png", *words]
        subprocess.run(command, check=True, cwd=tmp_path, capture_output=True, timeout=60)
        assert bytes(field.plot(**arguments)) == (tmp_path / f"{name}.png").read_bytes(), name
        pictures.add(bytes(field.plot(**arguments)))
    assert len(pictures) == len(SLICES)
    with pytest.raises(ValueError, match="interpolation"):
        field.plot(interpolation="cubic")
    for wrong in ({"interpolation": 1}, {"contours": 1}, {"bare": None}, {"legend": 3}):
        with pytest.raises(TypeError, match=f"^{next(iter(wrong))}: "):
            field.plot(**wrong)


def test_devices():
    for device in so.devices():
        assert device.name and device.memory_bytes > 0 and len(device.capability) == 2
