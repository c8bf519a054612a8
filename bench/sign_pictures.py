#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""sign_pictures.py STANDOFF MESH.obj FOLDER: what the sign methods make of a damaged mesh, three pictures.

sign_methods.png: the same plane of the field by each method. sign_confidence.png: how far each sample's winding number is
from where the sign changes. sign_iso.png: the surface at 0 that `standoff surface` finds in three of these fields.

The mesh loses 1 % of its triangles and all that are near a point; of the rest, 1 % and all that are near another point are
flipped. `standoff slice` and `render` draw. Needs matplotlib (Debian: python3-matplotlib), which brings numpy and Pillow."""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from PIL import Image
from plot_style import FAINT, INK, RED, pyplot

plt = pyplot()

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


def bare_slice(standoff, field, folder, *options):
    """The middle plane of a field as an image, two pixels to a sample."""
    picture = folder / "field.png"
    subprocess.run([standoff, "slice", str(field), "-q", "-f", "--axis", "z", "--at", "0.5", "--bare", *options, "-o", str(picture)], check=True)
    image = np.asarray(Image.open(picture).convert("RGB"))
    assert image.shape == (512, 512, 3), image.shape
    return image


def slice_of(standoff, mesh, options, folder):
    """The middle plane of the mesh's field as an image, or what the program says where there is none."""
    field = folder / "field.vti"
    command = [standoff, "compute", str(mesh), "--sign", *options, *FIELD, "-f", "-q", "-o", str(field)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return done.stderr
    return bare_slice(standoff, field, folder, "--colormap", "diverging", "--no-contours")


def methods(standoff, source, folder):
    vertices, faces = read_obj(source)
    faces, flipped = damaged(vertices, faces)
    mesh = folder / "damaged.obj"
    write_obj(mesh, vertices, faces)
    figure, axes = plt.subplots(2, 4, figsize=(9.6, 5.2))
    segments, of = section(vertices, faces)
    first = axes.flat[0]
    first.set_title("the mesh, cut (red: flipped)", fontsize=10, pad=5)
    first.add_collection(LineCollection(segments[~flipped[of]], colors=INK, linewidths=1.2))
    first.add_collection(LineCollection(segments[flipped[of]], colors=RED, linewidths=2))
    first.set(xlim=(BOX[0], BOX[3]), ylim=(BOX[1], BOX[4]), aspect="equal")
    for ax, (title, options) in zip(axes.flat[1:], PANELS):
        found = slice_of(standoff, mesh, options, folder)
        ax.set_title(title, fontsize=10, pad=5)
        if isinstance(found, str):
            print(found, file=sys.stderr)
            ax.text(0.5, 0.5, "refused:\nthe mesh is not closed", color=FAINT, ha="center", va="center", transform=ax.transAxes)
            ax.set_aspect("equal")
        else:
            ax.imshow(found, interpolation="antialiased")
    for ax in axes.flat:
        ax.set(xticks=[], yticks=[])
        ax.spines[:].set_visible(False)
    figure.tight_layout()
    figure.savefig(folder / "methods.png", dpi=100)
    return folder / "methods.png"


def confidence(standoff, folder):
    """The field by winding numbers beside how sure its signs are."""
    sure, picture = folder / "sure.vti", folder / "sure.png"
    subprocess.run([standoff, "compute", str(folder / "damaged.obj"), "--sign", "winding", FIELD[0], "-r", "96", "-t", "0.3", "-f", "-q", "--confidence", str(sure),
                    "-o", str(folder / "field.vti")], check=True)
    subprocess.run([standoff, "slice", str(sure), "-q", "-f", "--axis", "z", "--at", "0.5", "--colormap", "viridis", "--no-contours",
                    "--title", "How sure each sign is", "--legend", "margin", "-o", str(picture)], check=True)
    return picture


def surfaces(standoff, folder):
    """The damaged mesh, and the surfaces of fields of it."""
    panels = [("the damaged mesh", folder / "damaged.obj")]
    for title, options in [PANELS[1], PANELS[3], PANELS[5]]:
        field, surface = folder / "field.vti", folder / f"{options[0].split(':')[0]}.obj"
        subprocess.run([standoff, "compute", str(folder / "damaged.obj"), "--sign", *options, FIELD[0], "-r", "128", "-t", "0.3", "-f", "-q", "-o", str(field)], check=True)
        subprocess.run([standoff, "surface", str(field), "-f", "-q", "-o", str(surface)], check=True)
        panels.append((title, surface))
    figure, axes = plt.subplots(1, 4, figsize=(12, 3.5))
    for ax, (title, mesh) in zip(axes, panels):
        picture = mesh.with_suffix(".png")
        subprocess.run([standoff, "render", str(mesh), "--up", "y", "--camera", "-25,42,1.05", "--size", "600x600", "-q", "-f", "-o", str(picture)], check=True)
        ax.imshow(np.asarray(Image.open(picture).convert("RGB")), interpolation="antialiased")
        ax.set_title(title, fontsize=11, pad=4)
        ax.axis("off")
    figure.tight_layout()
    figure.savefig(folder / "surfaces.png", dpi=100)
    return folder / "surfaces.png"


def main():
    standoff, source, pictures = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        drawn = {"sign_methods": methods(standoff, source, folder), "sign_confidence": confidence(standoff, folder),
                 "sign_iso": surfaces(standoff, folder)}  # fmt: skip
        for name, picture in drawn.items():
            Image.open(picture).convert("RGB").quantize(256, kmeans=4, dither=Image.Dither.NONE).save(Path(pictures) / f"{name}.png", optimize=True)
            print(f"wrote {name}.png", file=sys.stderr)


if __name__ == "__main__":
    main()
