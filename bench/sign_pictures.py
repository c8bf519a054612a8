#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""sign_pictures.py STANDOFF MESH.obj PICTURE.png: each sign method on the same damaged mesh, one picture of all.

The mesh loses 1 % of its triangles and all that are near a point; of the rest, 1 % and all that are near another point are
flipped. Of each field, one plane is drawn by `standoff slice`. Needs matplotlib (Debian: python3-matplotlib), which brings numpy and Pillow."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from PIL import Image  # noqa: E402

# Of glmark2's bunny: a hole in its back, a chest that is turned around, and a box with some air around it.
HOLE = (0.45, 0.35, 0), 0.33
TURNED = (-0.7, -0.3, 0), 0.3
BOX = (-1.15, -1.15, -0.9, 1.15, 1.15, 0.9)
FIELD = [f"--bounds={','.join(map(str, BOX))}", "-r", "256", "-t", "0.3"]
PANELS = [
    ("--sign none", ["none"]),
    ("--sign auto: winding", ["auto"]),
    ("--sign winding --as-oriented", ["winding", "--as-oriented"]),
    ("--sign normal", ["normal"]),
    ("--sign flood", ["flood"]),
    ("--sign shell:0.06", ["shell:0.06"]),
    ("--sign parity", ["parity"]),
]


def read_obj(path):
    lines = [line.split() for line in Path(path).read_text().splitlines()]
    vertices = np.array([line[1:4] for line in lines if line[:1] == ["v"]], float)
    faces = np.array([[corner.split("/")[0] for corner in line[1:4]] for line in lines if line[:1] == ["f"]], int)
    return vertices, faces - 1


def near(vertices, faces, ball):
    return np.linalg.norm(vertices[faces].mean(axis=1) - ball[0], axis=1) < ball[1]


def damaged(vertices, faces):
    """The faces that are left, and which of them are flipped."""
    random = np.random.default_rng(13)
    faces = faces[~near(vertices, faces, HOLE) & (random.random(len(faces)) > 0.01)]
    flipped = near(vertices, faces, TURNED) | (random.random(len(faces)) < 0.01)
    faces[flipped] = faces[flipped][:, ::-1]
    return faces, flipped


def write_obj(path, vertices, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    path.write_text("\n".join(lines) + "\n")


def section(vertices, faces):
    """The segments in which the faces cross the plane z = 0, which no vertex lies on, and of which face each is."""
    corners = vertices[faces]
    below = corners[:, :, 2] < 0
    of = np.flatnonzero(below.any(axis=1) & ~below.all(axis=1))
    segments = []
    for face in of:
        ends = []
        for n in range(3):
            a, b = corners[face, n], corners[face, (n + 1) % 3]
            if (a[2] < 0) != (b[2] < 0):
                ends.append((a + (b - a) * a[2] / (a[2] - b[2]))[:2])
        segments.append(ends)
    return np.array(segments), of


def slice_of(standoff, mesh, options, folder):
    """The middle plane of the field as an image, or what the program says where there is none."""
    field, picture = folder / "field.vti", folder / "field.png"
    command = [standoff, "compute", str(mesh), "--sign", *options, *FIELD, "-f", "--json", "-o", str(field)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return done.stderr
    size = json.loads(done.stdout)["grid"]["size"]
    subprocess.run([standoff, "slice", str(field), "-q", "-f", "--colormap", "diverging", "-o", str(picture)], check=True)
    # The plane lies 20 pixels from the left and 74 from the top, each sample twice as wide as a pixel here.
    assert size[0] == size[1] == 256, size
    return np.asarray(Image.open(picture).convert("RGB"))[74:586, 20:532]


def draw(standoff, source, folder):
    vertices, faces = read_obj(source)
    faces, flipped = damaged(vertices, faces)
    mesh = folder / "damaged.obj"
    write_obj(mesh, vertices, faces)
    figure, axes = pyplot.subplots(2, 4, figsize=(9.6, 5.2))
    segments, of = section(vertices, faces)
    first = axes.flat[0]
    first.set_title("the mesh, cut (red: flipped)", fontsize=9)
    first.add_collection(LineCollection(segments[~flipped[of]], colors="black", linewidths=1.2))
    first.add_collection(LineCollection(segments[flipped[of]], colors="red", linewidths=2))
    first.set(xlim=(BOX[0], BOX[3]), ylim=(BOX[1], BOX[4]), aspect="equal")
    for ax, (title, options) in zip(axes.flat[1:], PANELS):
        found = slice_of(standoff, mesh, options, folder)
        ax.set_title(title, fontsize=9)
        if isinstance(found, str):
            print(found, file=sys.stderr)
            ax.text(0.5, 0.5, "refused:\nthe mesh is not closed", ha="center", va="center", transform=ax.transAxes)
            ax.set_aspect("equal")
        else:
            ax.imshow(found, interpolation="antialiased")
    for ax in axes.flat:
        ax.set(xticks=[], yticks=[])
    figure.tight_layout()
    figure.savefig(folder / "all.png", dpi=100)
    return folder / "all.png"


def main():
    standoff, source, picture = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        drawn = Image.open(draw(standoff, source, Path(folder))).convert("RGB")
        drawn.quantize(96, dither=Image.Dither.NONE).save(picture, optimize=True)
    print(f"wrote {picture}", file=sys.stderr)


if __name__ == "__main__":
    main()
