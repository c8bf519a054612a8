# SPDX-License-Identifier: Apache-2.0
"""What script/figures and script/pictures draw with: the program ($STANDOFF, or build/release/standoff), its meshes, its
pictures in few colours. Needs numpy and Pillow (Debian: python3-numpy, python3-pil)."""

import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = Path(os.environ.get("OUTPUT", ROOT / "docs/images"))
LARGE = 250_000  # bytes
BUNNY = "/usr/share/glmark2/models/bunny.obj"
STANDOFF = os.environ.get("STANDOFF", str(ROOT / "build/release/standoff"))
RED, BLUE, INK, FAINT = "#c8362b", "#2f6fc4", "#282c34", "#9aa1ad"


def standoff(*arguments):
    subprocess.run([STANDOFF, *map(str, arguments), "-f", "-q"], check=True)


def told(*arguments):
    """The JSON that a verb prints."""
    return json.loads(subprocess.run([STANDOFF, *map(str, arguments), "--json"], check=True, capture_output=True, text=True).stdout)


def compute(mesh, field, *options):
    sign = () if "--sign" in options else ("--sign", "none")  # as the thesis, which has none
    standoff("compute", mesh, "-o", field, *sign, *options)


def render(name, *arguments, size="900x620"):
    """A picture; a large one in few colours, which no eye sees."""
    picture = OUTPUT / f"{name}.png"
    standoff("render", *arguments, "--up", "y", "--size", size, "-o", picture)
    save(Image.open(picture), picture)


def save(image, picture, large=LARGE):
    """With as few colours as it takes to be small."""
    image.save(picture, optimize=True)
    for colors in (256, 128, 64, 48, 32):
        if picture.stat().st_size > large:
            image.convert("RGB").quantize(colors, kmeans=4, dither=Image.Dither.NONE).save(picture, optimize=True)


def letters(size):
    return ImageFont.truetype(str(ROOT / "src/render/font/inter.ttf"), size)


def sheet(name, rows, width, height, large=LARGE):
    """Pictures side by side, each above its words: rows of (words, arguments of render). A row is `width` wide."""
    label = 70
    image = Image.new("RGB", (width, (height + label) * len(rows)), "white")
    draw, font = ImageDraw.Draw(image), letters(22)
    for r, row in enumerate(rows):
        each = width // len(row)
        for c, ((first, second), arguments) in enumerate(row):
            standoff("render", *arguments, "--up", "y", "--no-legend", "--size", f"{each - 24}x{height}", "-o", "cell.png")
            image.paste(Image.open("cell.png").convert("RGB"), (c * each + 12, r * (height + label)))
            middle, below = c * each + each / 2, (r + 1) * (height + label)
            draw.text((middle, below - 52), first, INK, font, "mm")
            draw.text((middle, below - 24), second, "#6b7280", font, "mm")
    save(image, OUTPUT / f"{name}.png", large)


def count(scene):
    """How many triangles a scene has, in words."""
    listed = subprocess.run([STANDOFF, "generate", "--list"], check=True, capture_output=True, text=True).stdout
    return next(line.split()[1] for line in listed.splitlines() if line.split()[0] == scene) + " triangles"


def write_obj(path, vertices, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    Path(path).write_text("\n".join(lines) + "\n")


def read_stl(path):
    """The corners of all triangles, n x 3 x 3, of a binary STL file."""
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    return np.fromfile(path, triangle, offset=84)["corners"].astype(float)


def clipped(polygons, axis, at, side):
    """What of the polygons lies on one side of a plane across an axis: side 1 above `at`, -1 below."""
    kept = []
    for corners in polygons:
        rest = []
        for a, b in zip(corners, [*corners[1:], corners[0]]):
            over_a, over_b = side * (a[axis] - at), side * (b[axis] - at)
            if over_a >= 0:
                rest.append(a)
            if (over_a < 0) != (over_b < 0):
                rest.append(a + (b - a) * (over_a / (over_a - over_b)))
        if len(rest) > 2:
            kept.append(rest)
    return kept


def svg(name, width, height, body):
    (OUTPUT / f"{name}.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f'font-family="Inter, Helvetica, Arial, sans-serif" font-size="14">\n'
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n{body}</svg>\n')


def words(x, y, text, color=INK, anchor="middle"):
    return f'<text x="{x:g}" y="{y:g}" fill="{color}" text-anchor="{anchor}">{text}</text>\n'


def arrow(x0, y0, x1, y1):
    angle = math.atan2(y1 - y0, x1 - x0)
    heads = "".join(
        f"M{x:g},{y:g} L{x + 7 * math.cos(a + 0.45):.1f},{y + 7 * math.sin(a + 0.45):.1f} "
        f"M{x:g},{y:g} L{x + 7 * math.cos(a - 0.45):.1f},{y + 7 * math.sin(a - 0.45):.1f} "
        for x, y, a in ((x0, y0, angle), (x1, y1, angle + math.pi)))
    return f'<path d="M{x0:g},{y0:g} L{x1:g},{y1:g} {heads}" stroke="{RED}" stroke-width="1.3" fill="none"/>\n'


def draw(script, figures):
    """Draws those that the command line names, or all, in an empty folder."""
    wanted = sys.argv[1:]
    if wanted == ["--list"]:
        print("\n".join(f"{figure.__name__:20} {figure.__doc__}" for figure in figures))
        return
    unknown = set(wanted) - {figure.__name__ for figure in figures}
    if unknown:
        sys.exit(f"{script}: no picture {', '.join(sorted(unknown))}; see {script} --list")
    with tempfile.TemporaryDirectory(prefix="standoff-") as folder:
        os.chdir(folder)
        for figure in figures:
            if not wanted or figure.__name__ in wanted:
                print(figure.__name__, flush=True)
                figure()
