#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""threemf_reference.py FILE: the triangles that a .3mf file builds, nine numbers a line, in the file's axes and unit.

Shares nothing with standoff: Python's zipfile and ElementTree. Only for good files."""

import sys
import xml.etree.ElementTree as ElementTree
import zipfile

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
PATH = "{http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"

archive = zipfile.ZipFile(sys.argv[1])
models = {}


def model(path):
    path = path.lstrip("/")
    if path not in models:
        models[path] = ElementTree.fromstring(archive.read(path))
    return models[path]


def matrix(element):
    m = [float(word) for word in element.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()]
    return [m[0:3], m[3:6], m[6:9], m[9:12]]


def moved(point, m):
    """A row vector from the left: [x y z 1] times four rows."""
    return tuple(sum(v * m[row][column] for row, v in enumerate((*point, 1.0))) for column in range(3))


def determinant(m):
    (a, b, c), (d, e, f), (g, h, i) = m[:3]
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def triangles(reference, here):
    """Of what a component or an item places, outside kept outside."""
    path = reference.get(PATH, here)
    object_ = next(o for o in model(path).iter(CORE + "object") if o.get("id") == reference.get("objectid"))
    found = []
    for mesh in object_.iter(CORE + "mesh"):
        points = [tuple(float(v.get(axis)) for axis in "xyz") for v in mesh.iter(CORE + "vertex")]
        found += [[points[int(t.get(corner))] for corner in ("v1", "v2", "v3")] for t in mesh.iter(CORE + "triangle")]
    for component in object_.iter(CORE + "component"):
        found += triangles(component, path)
    m = matrix(reference)
    step = -1 if determinant(m) < 0 else 1
    return [[moved(t[0], m)] + [moved(p, m) for p in t[1:][::step]] for t in found]


main = "3D/3dmodel.model"
if "_rels/.rels" in archive.namelist():
    for relation in ElementTree.fromstring(archive.read("_rels/.rels")):
        if relation.get("Type") == MODEL:
            main = relation.get("Target")
for item in model(main).find(CORE + "build"):
    for triangle in triangles(item, main):
        print(*(repr(c) for point in triangle for c in point))
