# SPDX-License-Identifier: Apache-2.0
"""A glTF file's numbers lie in a file beside it: standoff batch --resume sees when that one changes."""

import json
import pathlib
import struct

from program import run


def batch(said):
    run("batch", "list.txt", "-o", "out", "-r", "16", "--resume", says=said)


def write(size):
    corners = [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)]
    faces = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
    pathlib.Path("mesh.bin").write_bytes(struct.pack("<12H", *faces) + b"".join(struct.pack("<3f", *corner) for corner in corners))


pathlib.Path("mesh.gltf").write_text(json.dumps({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
    "buffers": [{"byteLength": 72, "uri": "mesh.bin"}],
    "bufferViews": [{"buffer": 0, "byteLength": 24}, {"buffer": 0, "byteOffset": 24, "byteLength": 48}],
    "accessors": [{"bufferView": 0, "componentType": 5123, "count": 12, "type": "SCALAR"},
                  {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}]}))
pathlib.Path("list.txt").write_text("mesh.gltf\n")
write(1)
batch("1 mesh: 1 ok; in")
batch("0 meshes: none; 1 were done before")
write(2)
batch("1 mesh: 1 ok; in")
