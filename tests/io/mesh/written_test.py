#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the program writes as GLB and 3MF, taken apart by Python's struct, json, zipfile and ElementTree: it obeys the
specifications, and holds the mesh that the OBJ file beside it holds."""

import json
import os
import struct
import xml.etree.ElementTree as ElementTree
import zipfile

from program import run

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def obj(path):
    vertices, triangles = [], []
    for line in open(path):
        word, *numbers = line.split()
        if word == "v":
            vertices.append(tuple(float(n) for n in numbers))
        elif word == "f":
            triangles.append(tuple(int(n) - 1 for n in numbers))
    return vertices, triangles


def glb(path):
    """The vertices and triangles of a GLB file of one mesh. Asserts what section 4 (GLB) and 3.6 (buffers) demand."""
    data = open(path, "rb").read()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    json_bytes, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON" and json_bytes % 4 == 0
    document = json.loads(data[20 : 20 + json_bytes])
    binary_bytes, kind = struct.unpack_from("<I4s", data, 20 + json_bytes)
    assert kind == b"BIN\0" and 28 + json_bytes + binary_bytes == len(data)
    binary = data[28 + json_bytes :]
    assert document["asset"]["version"] == "2.0"
    assert document["buffers"] == [{"byteLength": len(binary)}]
    node = document["nodes"][document["scenes"][document["scene"]]["nodes"][0]]
    (primitive,) = document["meshes"][node["mesh"]]["primitives"]

    def numbers(accessor, kind, component, width):
        accessor = document["accessors"][accessor]
        view = document["bufferViews"][accessor["bufferView"]]
        assert (accessor["componentType"], accessor["type"]) == (kind, component)
        start = view.get("byteOffset", 0)
        assert start % 4 == 0 and start + view["byteLength"] <= len(binary)
        assert view["byteLength"] == 4 * width * accessor["count"]
        form = "<%d%s" % (width * accessor["count"], "f" if kind == 5126 else "I")
        return accessor, view, struct.unpack_from(form, binary, start)

    accessor, view, flat = numbers(primitive["attributes"]["POSITION"], 5126, "VEC3", 3)
    assert view["target"] == 34962
    vertices = [flat[n : n + 3] for n in range(0, len(flat), 3)]
    # The bounds as they are parsed, in single precision, are those of the positions to the last bit.
    single = [struct.unpack("<3f", struct.pack("<3f", *accessor[bound])) for bound in ("min", "max")]
    assert single == [tuple(f(axis) for axis in zip(*vertices)) for f in (min, max)]
    _, view, flat = numbers(primitive["indices"], 5125, "SCALAR", 1)
    assert view["target"] == 34963 and len(flat) % 3 == 0 and max(flat) < len(vertices)
    return vertices, [flat[n : n + 3] for n in range(0, len(flat), 3)]


def threemf(path):
    """The unit, vertices and triangles of a 3MF file of one object."""
    archive = zipfile.ZipFile(path)
    assert archive.testzip() is None
    assert archive.namelist()[0] == "[Content_Types].xml"
    types = ElementTree.fromstring(archive.read("[Content_Types].xml"))
    assert {element.get("Extension") for element in types} == {"rels", "model"}
    (relationship,) = ElementTree.fromstring(archive.read("_rels/.rels"))
    assert relationship.get("Type") == "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    model = ElementTree.fromstring(archive.read(relationship.get("Target").lstrip("/")))
    (thing,) = model.find(CORE + "resources")
    (item,) = model.find(CORE + "build")
    assert item.get("objectid") == thing.get("id")
    mesh = thing.find(CORE + "mesh")
    vertices = [tuple(float(v.get(axis)) for axis in "xyz") for v in mesh.find(CORE + "vertices")]
    triangles = [tuple(int(t.get(v)) for v in ("v1", "v2", "v3")) for t in mesh.find(CORE + "triangles")]
    assert all(len(set(t)) == 3 and max(t) < len(vertices) for t in triangles)
    return model.get("unit"), vertices, triangles


def single(vertices):
    return [struct.unpack("<3f", struct.pack("<3f", *vertex)) for vertex in vertices]


def z_up(vertices):
    return [(x, -z, y) for x, y, z in vertices]


run("surface", "scene:bender", "-r", "40", "-o", "surface.obj")
vertices, triangles = obj("surface.obj")
assert len(triangles) > 1000
run("surface", "scene:bender", "-r", "40", "-o", "surface.glb")
assert glb("surface.glb") == (vertices, triangles), "a surface that floats hold exactly"

# Coordinates that floats do not hold, of an unknown unit, in OBJ with y up: for 3MF in millimetres and turned to z up.
with open("part.obj", "w") as file:
    file.write("v 0.1 0.2 0.3\nv 1e-7 20.000000001 -3\nv 0 5 7\nv 1 1 1e10\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n")
vertices, triangles = obj("part.obj")
run("convert", "part.obj", "-o", "part.glb")
run("convert", "part.obj", "-o", "part.3mf")
assert glb("part.glb") == (single(vertices), triangles)
assert threemf("part.3mf") == ("millimeter", z_up(vertices), triangles)

# Where the unit is known 3MF says metres, and what is read has y up and is turned to z up: both ways give the same.
run("convert", "part.glb", "-o", "metres.3mf")
unit, turned, again = threemf("metres.3mf")
assert (unit, again) == ("meter", triangles)
assert turned == z_up(single(vertices))
run("convert", "metres.3mf", "-o", "back.obj")
assert obj("back.obj") == (single(vertices), triangles)
run("convert", "part.obj", "--unit", "cm", "-o", "unit.3mf")
assert threemf("unit.3mf")[0] == "meter"
assert threemf("unit.3mf")[1] == z_up([tuple(c * 0.01 for c in vertex) for vertex in vertices])


def refused(words, *arguments):
    run(*arguments, code=4, says=words)


# What a format cannot hold is an error, and leaves no file.
with open("twice.obj", "w") as file:
    file.write("v 0 0 0\nv 1 0 0\nv 0 1e39 0\nf 1 2 3\nf 1 1 2\n")
refused("triangle 1 names a vertex twice, which 3MF does not allow", "convert", "twice.obj", "-o", "twice.3mf")
refused("too far from the origin for the 32-bit floats of GLB", "convert", "twice.obj", "-o", "twice.glb")
os.mkfifo("pipe.3mf")
reader = os.open("pipe.3mf", os.O_RDONLY | os.O_NONBLOCK)
refused("cannot be written to a pipe", "convert", "part.obj", "-o", "pipe.3mf")
os.close(reader)
assert not any(os.path.exists(name) for name in ("twice.3mf", "twice.glb"))
