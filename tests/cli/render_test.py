# SPDX-License-Identifier: Apache-2.0
"""render_test.py [--update]: standoff render: its inputs and layers, the pictures, and what it says when something is wrong.
--update draws the pictures anew that pictures are compared with: look at them."""

import json
import os
import pathlib
import struct
import sys
import zlib

import numpy as np
from program import run



def pixels(path):
    """The picture as an array, by the PNG specification: 8 bits, RGB or RGBA."""
    data = pathlib.Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0]
        if kind == b"IHDR":
            width, height, depth, color, *_ = struct.unpack(">IIBBBBB", body)
            assert depth == 8 and color in (2, 6)
            channels = 3 if color == 2 else 4
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + channels * width)
    image = np.zeros((height, width, channels), np.uint8)
    before = np.zeros(channels * width, np.uint8)
    for y, row in enumerate(rows):
        line = row[1:].copy()
        if row[0] == 2:
            line += before
        elif row[0] != 0:
            for x in range(channels * width):
                left, above_left = (int(line[x - channels]), int(before[x - channels])) if x >= channels else (0, 0)
                a, b, c = left, int(before[x]), above_left
                nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
                line[x] = (int(line[x]) + {1: a, 3: (a + b) // 2, 4: nearest}[int(row[0])]) % 256
        image[y], before = line.reshape(width, channels), line
    return image


def drawn(image):
    return (image != image[0, 0]).any(axis=2)


SIZE = ["--size", "160x120"]


def meshes():
    answer = json.loads(run("render", "scene:box", *SIZE, "-o", "a.png", "--json").stdout)
    assert answer["verb"] == "render" and answer["inputs"] == [{"file": "scene:box"}] and answer["pictures"] == 1
    assert (answer["width"], answer["height"], answer["output"]["file"]) == (160, 120, "a.png")
    image = pixels("a.png")
    assert image.shape == (120, 160, 3) and (image[0, 0] == 255).all()
    # As large as the picture allows: it touches the margin at the top and the bottom, or at the sides.
    rows, columns = np.nonzero(drawn(image).any(axis=1))[0], np.nonzero(drawn(image).any(axis=0))[0]
    assert rows[0] >= 4 and rows[-1] <= 115 and columns[0] >= 4 and columns[-1] <= 155
    assert rows[-1] - rows[0] >= 108 or columns[-1] - columns[0] >= 148
    # The same bytes for any number of threads.
    first = pathlib.Path("a.png").read_bytes()
    run("render", "scene:box", *SIZE, "-o", "a.png", "-f", "-j", 3)
    assert pathlib.Path("a.png").read_bytes() == first
    for words in (["--camera", "front"], ["--camera", "-20,70,2"], ["--background", "dark"], ["--flat"], ["--edges"],
                  ["--opacity", "0.3"], ["--no-shadows"], ["--samples", "16"], ["--parallel"], ["--up", "x"]):
        run("render", "scene:box", *SIZE, "-o", "b.png", "-f", *words)
        assert (pixels("b.png") != image).any(), words


def fields():
    run("compute", "scene:box", "-r", "24", "--sign", "auto", "-o", "box.vti")
    run("render", "box.vti", *SIZE, "-q")
    both = pixels("box.png")
    assert drawn(both).sum() > 2000
    for layers in ("slice", "iso", "band", "boxes", "slice,iso,boxes"):
        run("render", "box.vti", *SIZE, "-o", "c.png", "-f", "--layers", layers)
        assert drawn(pixels("c.png")).sum() > 500, layers
        assert (pixels("c.png") != both).any()
    # A mesh is cut open where the slice is, unless it shall stay whole.
    run("render", "scene:box", "box.vti", *SIZE, "-o", "cut.png", "--axis", "z", "--camera", "front", "--no-legend")
    run("render", "scene:box", "box.vti", *SIZE, "-o", "whole.png", "--axis", "z", "--camera", "front", "--no-legend",
        "--whole")
    cut, whole = pixels("cut.png")[60, 80].astype(int), pixels("whole.png")[60, 80].astype(int)
    assert cut[2] > cut[0] + 20 and abs(cut - whole).max() > 20  # blue is inside


def points_and_paths():
    pathlib.Path("p.csv").write_text("x,y,z\n0,0,0\n1,0,0\n0,1,1\n")
    run("render", "p.csv", *SIZE)
    image = pixels("p.png").astype(int)
    assert ((image[..., 0] > image[..., 2] + 80).sum()) > 30  # red balls
    pathlib.Path("way.csv").write_text("flier,step,x,y,z\n0,0,0,0,0\n0,1,1,0,0\n1,0,0,0,1\n1,1,1,0,1\n")
    pathlib.Path("way.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
        "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
        "0 0 0\n1 0 0\n0 0 1\n1 0 1\n0 1\n2 3\n")
    for name in ("way.csv", "way.ply"):
        run("render", name, *SIZE, "-o", name + ".png", "--camera", "front", "--no-shadows")
        # Two lines, and nothing between them.
        rows = drawn(pixels(name + ".png")).any(axis=1)
        assert np.count_nonzero(np.diff(rows.astype(int)) == 1) == 2, name
    assert (pixels("way.csv.png") == pixels("way.ply.png")).all()


def turntables():
    run("render", "scene:box", *SIZE, "-o", "t.png", "--turntable", 4)
    names = sorted(p.name for p in pathlib.Path(".").glob("t*.png"))
    assert names == [f"t-00{n}.png" for n in range(4)]
    # One that is in the way is kept, and then none is made.
    for n in (0, 1, 3):
        pathlib.Path(f"t-00{n}.png").unlink()
    before = pathlib.Path("t-002.png").read_bytes()
    run("render", "scene:box", *SIZE, "-o", "t.png", "--turntable", 4, code=2)
    assert [p.name for p in pathlib.Path(".").glob("t*.png")] == ["t-002.png"]
    # Where one cannot be replaced, all stay as they are.
    pathlib.Path("t-003.png").mkdir()
    run("render", "scene:box", *SIZE, "-o", "t.png", "-f", "--turntable", 4, code=4)
    assert sorted(p.name for p in pathlib.Path(".").glob("t*.png")) == ["t-002.png", "t-003.png"]
    assert pathlib.Path("t-002.png").read_bytes() == before


def inputs_are_kept():
    run("generate", "box", "-o", "kept.obj")
    run("compute", "kept.obj", "-r", "8", "-o", "kept.vti")
    for verb, name in (("render", "kept.obj"), ("slice", "kept.vti")):
        before = pathlib.Path(name).read_bytes()
        pathlib.Path("link.png").unlink(missing_ok=True)
        pathlib.Path("link.png").symlink_to(name)
        assert "it is an input" in run(verb, name, "-o", "link.png", "-f", code=2).stderr
        assert pathlib.Path(name).read_bytes() == before


def distances_are_told_where_the_field_knows_them():
    """Beyond the samples points are pink, and the legend does not count them."""
    run("compute", "scene:box", "-r", "24", "-o", "near.vti")
    pathlib.Path("near.csv").write_text("x,y,z\n0,0,0\n0.5,0,0\n")
    pathlib.Path("far.csv").write_text("x,y,z\n50,0,0\n0,0,50\n")
    words = ["--layers", "points", "--no-shadows", "--colormap", "viridis", "--camera", "front"]
    run("render", "near.vti", "near.csv", *SIZE, *words, "-o", "near.png")
    run("render", "near.vti", "far.csv", *SIZE, *words, "-o", "far.png")
    colored = [int((np.ptp(pixels(name)[:, :100].astype(int), axis=2) > 60).sum()) for name in ("near.png", "far.png")]
    assert colored[0] > 30 and colored[1] == 0, colored
    pathlib.Path("holes.csv").write_text("x,y,z\n0,0,0\nnan,0,0\n1,0,0\n")
    run("render", "holes.csv", *SIZE, "-o", "holes.png")


def slices_lie_where_they_are_asked_for():
    run("compute", "scene:box", "-r", "24", "-t", "3s", "--sign", "auto", "-o", "at.vti")
    run("render", "at.vti", *SIZE, "--layers", "slice", "-o", "default.png")
    plane = json.loads(run("slice", "at.vti", "-o", "plane.png", "--json").stdout)
    share = plane["index"] / (json.loads(run("info", "at.vti", "--json").stdout)["grid"]["size"]["xyz".index(plane["axis"])] - 1)
    run("render", "at.vti", *SIZE, "--layers", "slice", "--axis", plane["axis"], "--at", share, "-o", "same.png")
    assert (pixels("default.png") == pixels("same.png")).all()
    run("render", "at.vti", *SIZE, "--layers", "slice", "--axis", plane["axis"], "--at", 0.05, "-o", "other.png")
    assert (pixels("default.png") != pixels("other.png")).any()


def stands_upright():
    """What the format of a mesh says is up, and what a field remembers, is up in the picture: that of --up."""
    pathlib.Path("tall.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 3 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    run("convert", "tall.obj", "-o", "tall.stl")
    for name, up in (("tall.obj", "y"), ("tall.stl", "z")):
        run("compute", name, "-r", "12", "-o", "tall.vti", "-f")
        assert json.loads(run("info", "tall.vti", "--json").stdout)["field"]["up"] == up
        for subject in (name, "tall.vti"):
            run("render", subject, *SIZE, "-o", "auto.png", "-f")
            run("render", subject, *SIZE, "-o", "said.png", "-f", "--up", up)
            run("render", subject, *SIZE, "-o", "other.png", "-f", "--up", "x")
            assert (pixels("auto.png") == pixels("said.png")).all() and (pixels("auto.png") != pixels("other.png")).any()


def answers_of_points_are_colored():
    """Balls in the colors of the distances that standoff points wrote, in either format; blue is inside."""
    pathlib.Path("asked.csv").write_text("x,y,z\n0,0,0\n0,3,0\n")
    for name, words in (("answers.csv", ["--with", "point"]), ("answers.ply", [])):
        run("points", "scene:box", "asked.csv", "-o", name, *words)
        run("render", name, *SIZE, "-o", "answers.png", "-f", "--no-shadows", "--no-legend")
        image = pixels("answers.png").astype(int)
        assert (image[..., 2] > image[..., 0] + 40).sum() > 10 and (image[..., 0] > image[..., 2] + 40).sum() > 10, name


def paper_can_be_left_out():
    """On a transparent background: what is drawn is as opaque as it covers a pixel, and looks on white as it does there."""
    run("render", "scene:box", *SIZE, "-o", "none.png", "--background", "transparent")
    run("render", "scene:box", *SIZE, "-o", "white.png")
    none, white = pixels("none.png").astype(float), pixels("white.png")
    alpha = none[..., 3:] / 255
    assert none.shape[2] == 4 and alpha.min() == 0 and alpha.max() == 1 and ((alpha > 0) & (alpha < 1)).sum() > 20
    off = abs(none[..., :3] * alpha + 255 * (1 - alpha) - white)
    assert off.max() <= 12 and off.mean() < 0.1, (off.max(), off.mean())


def bodies_have_colors():
    run("render", "scene:box", "scene:bender", *SIZE, "-o", "two.png")
    image = pixels("two.png").astype(int)
    assert (image[..., 0] > image[..., 2] + 40).sum() > 50, "the second is orange"


def cut_off_isosurfaces_are_told():
    run("compute", "scene:box", "-r", "12", "-o", "tight.vti")
    assert "cut off at the grid's border" in run("render", "tight.vti", *SIZE, "-o", "c.png", "-f", "--layers", "iso", "--iso", "50s").stderr
    assert "cut off" not in run("render", "tight.vti", *SIZE, "-o", "c.png", "-f", "--layers", "iso", "--iso", "0").stderr


def unsigned_slices_show_the_surface():
    """A white line where the surface is, and colors that the farthest corner does not take for itself."""
    run("compute", "scene:box", "-r", "80", "--sign", "none", "-o", "unsigned.vti")
    run("slice", "unsigned.vti", "-o", "unsigned.png", "--bare")
    image = pixels("unsigned.png").astype(int)
    white = (image.min(axis=2) > 240).sum()
    assert 0.005 < white / image[..., 0].size < 0.2, white


def pictures_look_as_they_did():
    """Light and shadow, a mesh cut open, see-through walls, and all layers of numbers, beside stored pictures."""
    folder = pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"]) / "tests/cli/pictures"
    run("compute", "scene:bender", "-r", "48", "-t", "4s", "--sign", "auto", "-o", "bender.vti")
    pathlib.Path("line.csv").write_text("flier,step,x,y,z\n" + "".join(f"0,{n},{n / 4 - 1.5},{n % 3 / 4},0.4\n" for n in range(13)))
    pathlib.Path("dots.csv").write_text("x,y,z\n-1,1,0\n0,1,0.5\n1,1,0\n")
    run("compute", "scene:box", "-r", "16", "-t", "3s", "--sign", "auto", "-o", "small.vti")
    size = ["--size", "240x180", "--up", "y"]
    for name, words in (
        ("shadows", ["scene:plane", "--camera", "30,35"]),
        ("open", ["scene:bender", "bender.vti", "--axes"]),
        ("clear", ["scene:labyrinth:20000", "--opacity", "0.3", "--camera", "30,50", "--background", "dark", "--edges"]),
        ("layers", ["small.vti", "line.csv", "dots.csv", "--layers", "slice,iso,band,points,path,boxes", "--within", "0.1", "--radius", "0.05"]),
    ):
        run("render", *words, *size, "-o", f"{name}.png", "-f")
        stored = folder / f"{name}.png"
        if "--update" in sys.argv:
            folder.mkdir(exist_ok=True)
            stored.write_bytes(pathlib.Path(f"{name}.png").read_bytes())
        off = np.abs(pixels(f"{name}.png").astype(int) - pixels(stored))
        assert off.mean() < 0.2 and (off.max(axis=2) > 24).mean() < 0.002, (name, off.mean(), off.max())


def errors():
    for words, code, what in (
        (["none.stl"], 3, "none.stl"),
        (["scene:none"], 2, "none"),
        (["scene:box", "--size", "big"], 2, "1920x1080"),
        (["scene:box", "--size", "15x100"], 2, "16"),
        (["scene:box", "--camera", "35"], 2, "AZIMUTH,ELEVATION"),
        (["scene:box", "--camera", "0,95"], 2, "-90 to 90"),
        (["scene:box", "--camera", "0,0,1000"], 2, "zoom"),
        (["scene:box", "--layers", "mesh,hair"], 2, "hair"),
        (["scene:box", "--samples", "3"], 2, "16"),
        (["scene:box", "--layers", "iso"], 2, "--layers iso: there is no field"),
        (["scene:box", "--turntable", "0"], 2, "0"),
        (["scene:box", "--turntable", "721"], 2, "720"),
        (["scene:box", "--layers", "slice"], 2, "--layers slice: there is no field"),
        (["scene:box", "--layers", "mesh,path"], 2, "--layers path: there is no path"),
        (["p.csv", "--layers", "mesh"], 2, "--layers mesh: there is no mesh"),
        (["scene:box", "--edges", "--memory-limit", "1M"], 5, "memory limit"),
        (["scene:box", "--memory-limit", "1K"], 5, "memory limit"),
        (["scene:box", "-o", "x.jpg"], 2, ".png"),
    ):
        ran = run("render", *words, *([] if "-o" in words else ["-o", "e.png"]), code=code)
        assert what in ran.stderr, (words, ran.stderr)
    assert not list(pathlib.Path(".").glob("x*")) and not list(pathlib.Path(".").glob("e*"))


for test in (meshes, fields, points_and_paths, turntables, inputs_are_kept, distances_are_told_where_the_field_knows_them,
             slices_lie_where_they_are_asked_for, stands_upright, answers_of_points_are_colored, paper_can_be_left_out,
             bodies_have_colors, cut_off_isosurfaces_are_told, unsigned_slices_show_the_surface, pictures_look_as_they_did, errors):
    test()
    print(test.__name__)
