#!/usr/bin/env python3
"""Writes the files of this folder, a tetrahedron in each format that has scenes: seeds of the fuzzers. The same bytes
on every run."""
import base64
import json
import pathlib
import struct

HERE = pathlib.Path(__file__).parent
POINTS = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
FACES = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]


def chunk(kind, *content):
    body = b"".join(content)
    return struct.pack("<HI", kind, 6 + len(body)) + body


def tetrahedron_3ds():
    faces = b"".join(struct.pack("<4H", *FACES[n:n + 3], 0) for n in range(0, 12, 3))
    mesh = chunk(0x4100, chunk(0x4110, struct.pack("<H12f", 4, *POINTS)), chunk(0x4120, struct.pack("<H", 4), faces),
                 chunk(0x4160, struct.pack("<12f", 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)))
    return chunk(0x4D4D, chunk(0x0002, struct.pack("<I", 3)),
                 chunk(0x3D3D, chunk(0x0100, struct.pack("<f", 1)), chunk(0x4000, b"a\0", mesh)),
                 chunk(0xB000, chunk(0xB002, chunk(0xB030, struct.pack("<H", 0)),
                                     chunk(0xB010, b"a\0", struct.pack("<3H", 0, 0, 0xFFFF)))))


BUFFER = struct.pack("<12f12H", *POINTS, *FACES)


def gltf(buffer):
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1]}, {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 1, 2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48, "target": 34962},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 24, "target": 34963}],
        "buffers": [dict(buffer, byteLength=len(BUFFER))]}).encode()


def glb():
    text = gltf({})
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(BUFFER), b"BIN\0") + BUFFER
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def dae():
    numbers = " ".join
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="centimeter"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="12">
{numbers(map(str, POINTS))}</float_array><technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
</source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>{numbers(map(str, FACES[:6]))}</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3 3</vcount>
<p>{numbers(map(str, FACES[6:]))}</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node id="n"><rotate>0 0 1 90</rotate><translate>1 2 3</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#vs"/></scene></COLLADA>
""".encode()


uri = "data:application/octet-stream;base64," + base64.b64encode(BUFFER).decode()
for name, content in (("tetrahedron.3ds", tetrahedron_3ds()), ("tetrahedron.gltf", gltf({"uri": uri})),
                      ("tetrahedron.glb", glb()), ("tetrahedron.dae", dae())):
    (HERE / name).write_bytes(content)
