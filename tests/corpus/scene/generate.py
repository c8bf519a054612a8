#!/usr/bin/env python3
"""Writes the files of this folder, a tetrahedron as 3DS and as COLLADA: seeds of the fuzzers. The same
bytes on every run."""
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


(HERE / "tetrahedron.3ds").write_bytes(tetrahedron_3ds())
(HERE / "tetrahedron.dae").write_bytes(dae())
