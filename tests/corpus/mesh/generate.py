#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the files of this folder that expected.txt lists, but for 3MF (generate_threemf.py). The same bytes on every run."""
import base64
import json
import struct

from samples import FACES, NAN_POINTS, POINTS, gz, write


def binary_stl(header=b"", count=None, points=POINTS, tail=b""):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *points[a], *points[b], *points[c], 0) for a, b, c in FACES)
    return header.ljust(80, b"\0") + struct.pack("<I", len(FACES) if count is None else count) + body + tail


def ascii_stl(name="", points=POINTS, normal="0 0 0"):
    text = f"solid {name}\n"
    for face in FACES:
        corners = "".join("      vertex %s %s %s\n" % points[i] for i in face)
        text += f"  facet normal {normal}\n    outer loop\n{corners}    endloop\n  endfacet\n"
    return text + f"endsolid {name}\n"


def ply(encoding="ascii", vertices=4, faces=4, points=POINTS, corner=str, body=None, extra=""):
    header = (f"ply\nformat {encoding} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
              f"property float z\n{extra}element face {faces}\nproperty list uchar int vertex_indices\nend_header\n")
    if body is None:
        body = "".join("%s %s %s\n" % p for p in points) + "".join("3 %s %s %s\n" % f for f in FACES)
    return header.encode() + (body if isinstance(body, bytes) else body.encode())


def binary_ply_body(order="<", faces=FACES):
    return b"".join(struct.pack(order + "3f", *p) for p in POINTS) + b"".join(
        struct.pack(order + "B3i", 3, *f) for f in faces)


def obj(points=POINTS, faces=FACES):
    return "".join("v %s %s %s\n" % p for p in points) + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces)


def off(vertices=4, faces=4, first="OFF\n", points=POINTS):
    return (f"{first}{vertices} {faces} 6\n" + "".join("%s %s %s\n" % p for p in points) +
            "".join("3 %d %d %d\n" % f for f in FACES))


def gltf(nodes=None, uri=None, version="2.0", **more):
    buffer = struct.pack("<12f12H", *(c for p in POINTS for c in p), *(i for f in FACES for i in f))
    uri = uri or "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    return json.dumps(dict({
        "asset": {"version": version}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes or [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"byteLength": len(buffer), "uri": uri}]}, **more))


def glb(text):
    document = json.loads(text)
    buffer = base64.b64decode(document["buffers"][0].pop("uri").partition(",")[2])
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


inf = [(0, 0, 0), (1, 0, 0), (0, float("inf"), 0), (0, 0, 1)]
text = ascii_stl()

# STL, binary
write("stl_header_says_solid.stl", binary_stl(b"solid made by a program that does not know better"))
write("stl_header_says_solid_padded.stl", binary_stl(b"solid".ljust(80), tail=b"!!"))
write("stl_trailing_bytes.stl", binary_stl(tail=b"checksum"))
write("stl_attribute_colours.stl", binary_stl()[:-2] + b"\xff\x7f")
write("stl_negative_zero.stl", binary_stl(points=[(0.0, -0.0, 0), (1, 0, -0.0), (-0.0, 1, 0), (0, 0, 1)]))
write("stl_cut_off.stl", binary_stl()[:-60])
write("stl_cut_off_in_header.stl", binary_stl()[:83])
write("stl_absurd_count.stl", binary_stl(count=0xffffffff))
write("stl_count_too_large.stl", binary_stl(count=5))
write("stl_no_triangles.stl", binary_stl(count=0)[:84])
write("stl_nan.stl", binary_stl(points=NAN_POINTS))
write("stl_infinite.stl", binary_stl(points=inf))
write("stl_empty.stl", b"")
write("stl_one_byte.stl", b"s")
write("stl_not_a_mesh.stl", b"<html><body>404 Not Found</body></html>\n" * 3)
write("stl_is_ply.stl", ply())
# STL, ASCII
write("stl_text.stl", text)
write("stl_text_crlf.stl", text.replace("\n", "\r\n"))
write("stl_text_cr.stl", text.replace("\n", "\r"))
write("stl_text_upper_case.stl", text.upper())
write("stl_text_one_line.stl", text.replace("\n", " ").replace("solid ", "solid\n", 1))
write("stl_text_two_solids.stl", ascii_stl("a") + ascii_stl("b facet", [(2 + x, y, z) for x, y, z in POINTS]))
write("stl_text_nan_normal.stl", ascii_stl(normal="-nan(ind) nan 1.#QNAN"))
write("stl_text_leading_space.stl", "\n  " + text)
write("stl_text_no_solid_end.stl", text[:text.rindex("endsolid")])
write("stl_text_cut_off.stl", text[:300])
write("stl_text_bad_number.stl", text.replace("vertex 1 ", "vertex 1,5 ", 1))
write("stl_text_nan.stl", text.replace("vertex 1 ", "vertex nan ", 1))
write("stl_text_overflow.stl", text.replace("vertex 1 ", "vertex 1e999 ", 1))
write("stl_text_underflow.stl", text.replace("vertex 0 ", "vertex 1e-999 ", 1))
write("stl_text_four_corners.stl", text.replace("    endloop", "      vertex 1 1 1\n    endloop", 1))
write("stl_text_bytes.stl", text.replace("facet", "\x01\xff\x7ffacet", 1).encode("latin-1"))
write("stl_text_no_triangles.stl", "solid nothing\nendsolid nothing\n")
# PLY
write("ply_text.ply", ply())
write("ply_text_crlf.ply", ply().replace(b"\n", b"\r\n"))
write("ply_text_cr.ply", ply().replace(b"\n", b"\r"))
write("ply_little_endian.ply", ply("binary_little_endian", body=binary_ply_body()))
write("ply_big_endian.ply", ply("binary_big_endian", body=binary_ply_body(">")))
write("ply_crlf_header_binary.ply",
      ply("binary_little_endian", body=b"").replace(b"\n", b"\r\n") + binary_ply_body())
# A lone CR ends lines, and the first byte of the body is the one that would end them elsewhere.
write("ply_cr_header_binary.ply",
      ply("binary_little_endian", body=b"").replace(b"\n", b"\r") + b"\n\0\0\0" + binary_ply_body()[4:])
write("ply_comments.ply", ply().replace(b"element face", b"comment a \\\nobj_info b\n\nelement face"))
write("ply_blender_comment.ply", ply().replace(b"element vertex", b"Created by Blender\nelement vertex", 1))
write("ply_faces_first.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n"
      "element vertex 5\nproperty double z\nproperty uchar red\nproperty double x\nproperty float y\nend_header\n"
      "5 0 1 2 3 4\n0 255 0 0\n0 0 2 0\n0 0 2 2\n0 0 1 1\n0 0 0 2\n")
write("ply_extra_elements.ply",
      ply(extra="property list uchar float weights\nelement edge 2\nproperty int a\nproperty list int double b\n",
          body="0 0 0 0\n1 0 0 2 .5 .5\n0 1 0 0\n0 0 1 1 1\n1 2 1.5 2.5\n3 0\n" +
          "".join("3 %s %s %s\n" % f for f in FACES)))
write("ply_element_without_properties.ply", ply(extra="element nothing 9000000000000000000\n"))
write("ply_unused_nan.ply", ply(vertices=5, points=NAN_POINTS[1:2] + POINTS, faces=1,
                                body="nan 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 1 2 3\n"))
write("ply_edges_and_points.ply", ply(faces=4, body="0 0 0\n1 0 0\n0 1 0\n0 0 1\n0\n1 0\n2 0 1\n3 0 1 2\n"))
write("ply_nan.ply", ply(points=NAN_POINTS))
write("ply_index_out_of_range.ply", ply().replace(b"3 1 2 3", b"3 1 2 4"))
write("ply_negative_index.ply", ply().replace(b"3 1 2 3", b"3 1 2 -1"))
write("ply_binary_index_out_of_range.ply",
      ply("binary_little_endian", body=binary_ply_body(faces=FACES[:3] + [(0, 1, 1 << 30)])))
write("ply_cut_off.ply", ply()[:-15])
write("ply_binary_cut_off.ply", ply("binary_little_endian", body=binary_ply_body()[:-1]))
write("ply_header_cut_off.ply", ply()[:60])
write("ply_absurd_vertices.ply", ply(vertices=10**18))
write("ply_absurd_faces.ply", ply("binary_little_endian", faces=4000000000, body=binary_ply_body()))
write("ply_count_overflow.ply", ply(vertices=10**30))
write("ply_negative_count.ply", ply(faces=-1))
write("ply_absurd_list.ply", ply("binary_little_endian", faces=1, body=binary_ply_body(faces=[])).replace(
    b"list uchar", b"list uint") + b"\xff\xff\xff\xff" + bytes(12))
write("ply_negative_list.ply", ply(faces=1, body="0 0 0\n1 0 0\n0 1 0\n0 0 1\n-3 0 1 2\n"))
write("ply_unknown_format.ply", ply("binary_middle_endian"))
write("ply_unknown_type.ply", ply().replace(b"float x", b"half x"))
write("ply_no_format.ply", ply().replace(b"format ascii 1.0\n", b""))
write("ply_no_positions.ply", ply().replace(b"float x", b"float u"))
write("ply_no_vertex_properties.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nelement face 1\n"
      "property list uchar uint vertex_indices\nend_header\n3 0 1 3999999999\n")
write("ply_no_face_properties.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 4000000000\nend_header\n0 0 0\n1 0 0\n0 1 0\n")
write("ply_no_faces.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 0 0\n")
write("ply_float_indices.ply", ply().replace(b"uchar int", b"uchar float"))
write("ply_float_list_count.ply", ply().replace(b"list uchar", b"list float"))
write("ply_two_vertex_elements.ply", ply(extra="element vertex 4\nproperty float x\n"))
write("ply_property_first.ply", b"ply\nformat ascii 1.0\nproperty float x\nend_header\n")
write("ply_wrong_magic.ply", b"plyy\n" + ply()[4:])
write("ply_damaged_header.ply", ply().replace(b"element face", b"elemnt face"))
write("ply_many_elements.ply", ply().replace(b"element vertex", b"".join(b"element e%d 0\n" % n for n in range(1000)) +
                                            b"element vertex", 1))
# OBJ
write("obj_plain.obj", obj())
write("obj_crlf.obj", obj().replace("\n", "\r\n"))
write("obj_cr.obj", obj().replace("\n", "\r"))
write("obj_byte_order_mark.obj", b"\xef\xbb\xbf" + obj().encode())
write("obj_corner_forms.obj", obj(faces=[]) + "vt 0 0\nvn 0 0 1\nf 1/1 3/1 2/1\nf 1//1 2//1 4//1\n"
      "f 2/1/1 3/1/1 4/1/1\nf 3/ 1/ 4/\n")
write("obj_negative_indices.obj", obj(faces=[]) + "f -4 -2 -3\nf -4/-1 -3/-1 -1/-1\nf 2 3 4\nf 3 1 4\n")
write("obj_continued_lines.obj", "v 0 \\\n0 0\nv 1 0\\\n 0\nv 0 1 \\\r\n0\nv 0 0 1\n# not continued \\\nf 1 \\\n 3 2\n"
      "g a \\\nf 9 9 9\nf 1 2 4\nf 2 3\\\n 4\nf 3 1 4 # comment\n")
write("obj_weights_and_colours.obj", "v 0 0 0 1\nv 1 0 0 0.1 0.2 0.3\nv 0 1 0\nv 0 0 1 1 1 1 1\n" + obj([]))
write("obj_number_forms.obj", "v +0 -0 .0\nv 1.E0 0e5 0.\nv 0 10E-1 0\nv 0 0 1.000000000000000000000000000000000001\n" + obj([]))
write("obj_faces_first.obj", obj([]) + obj(faces=[]))
write("obj_quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
write("obj_concave.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 .5 0\nv 0 2 0\nf 2 3 4 5 1\n")
write("obj_degenerate.obj", obj(faces=[(0, 0, 0), (1, 1, 2), (0, 1, 2)]))
write("obj_duplicate_vertices.obj", obj(POINTS + [(1, 0, 0), (0, 0, -0.0)], [(0, 2, 4), (5, 1, 3)]))
write("obj_edges_and_points.obj", obj() + "p 1\nl 1 2\nf 1\nf 1 2\n")
write("obj_other_statements.obj", "mtllib a.mtl\no thing\ng\nusemtl x\ns off\nvp 1 2\ncstype bezier\nxyzzy\n" + obj())
write("obj_no_line_end.obj", obj()[:-1])
write("obj_vertex_ran_into_number.obj", "v 0 0 0\nv1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
write("obj_statement_lost.obj", "v 0 0 0\n1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
write("obj_face_ran_into_number.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf-3 -2 -1\n")
write("obj_upper_case.obj", "v 0 0 0\nv 1 0 0\nV 0 1 1\nv 0 1 0\nf 1 2 3\n")
write("obj_index_zero.obj", obj() + "f 0 1 2\n")
write("obj_index_out_of_range.obj", obj() + "f 1 2 5\n")
write("obj_negative_out_of_range.obj", obj() + "f -1 -2 -5\n")
write("obj_index_overflow.obj", obj() + "f 1 2 99999999999999999999\n")
write("obj_index_too_large.obj", obj() + "f 1 2 5000000000\n")
write("obj_index_lowest.obj", obj() + "f 1 2 -9223372036854775808\n")
write("obj_bad_corner.obj", obj() + "f 1 2 three\n")
write("obj_corner_with_tail.obj", obj() + "f 1 2 3x\n")
write("obj_nan.obj", obj(NAN_POINTS))
write("obj_overflow.obj", obj().replace("v 1 ", "v 1e400 ", 1))
write("obj_missing_coordinate.obj", obj().replace("v 1 0 0", "v 1 0"))
write("obj_bad_number.obj", obj().replace("v 1 0 0", "v 1 0 0x"))
write("obj_no_faces.obj", obj(faces=[]))
write("obj_binary.obj", bytes(range(256)))
# OFF
write("off_plain.off", off())
write("off_crlf.off", off().replace("\n", "\r\n"))
write("off_counts_on_first_line.off", off(first="OFF "))
write("off_counts_without_space.off", off(first="OFF"))
write("off_comments.off", off(first="OFF # made by hand\n# counts\n\n"))
write("off_colours.off", off(first="COFF\n").replace("1 0 0\n", "1 0 0 255 0 0 255\n") .replace("3 0 2 1", "3 0 2 1 7"))
write("off_absurd_vertices.off", off(vertices=2**62))
write("off_absurd_faces.off", off(faces=2**31))
write("off_absurd_corners.off", off().replace("3 0 2 1", "2000000000 0 2 1"))
write("off_negative_count.off", off(vertices=-4))
write("off_cut_off.off", off()[:-9])
write("off_cut_off_in_vertices.off", off()[:30])
write("off_index_out_of_range.off", off().replace("3 1 2 3", "3 1 2 4"))
write("off_nan.off", off(points=NAN_POINTS))
write("off_binary.off", "OFF BINARY\n" + "\0" * 60)
write("off_four_dimensions.off", off(first="4OFF\n"))
# glTF
write("gltf_plain.gltf", gltf())
write("gltf_called_mesh.dat", gltf())
placed = gltf([{"children": [1]}, {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 1, 2]}],
              meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}])
write("gltf_nodes.gltf", placed)
write("gltf_binary.glb", glb(placed))
write("gltf_doubling_nodes.gltf", gltf([{"children": [n, n]} for n in range(1, 40)] + [{"mesh": 0}]))
write("gltf_cycle.gltf", gltf([{"children": [1]}, {"mesh": 0, "children": [0]}]))
write("gltf_leaves_folder.gltf", gltf(uri="../../../../../../../etc/passwd"))
write("gltf_leaves_folder_escaped.gltf", gltf(uri="%2e%2e/%2e%2E%2fcorpus/mesh/off_plain.off"))
write("gltf_device.gltf", gltf(uri="file:///dev/zero"))
write("gltf_missing_buffer.gltf", gltf(uri="there_is_none.bin"))
write("gltf_short_buffer.gltf", gltf(uri="stl_one_byte.stl"))
write("gltf_version_1.gltf", gltf(version="1.0"))
write("gltf_compressed.gltf", gltf(extensionsRequired=["KHR_draco_mesh_compression"]))
# Formats
write("unknown.xyz", "0 0 0\n1 0 0\n")
write("ply_without_extension", ply())
write("obj_called_mesh.txt", "# a comment first\n" + obj())
write("stl_called_mesh.dat", binary_stl())
write("off_called_mesh.dat", off())

write("gz_obj.obj.gz", gz(obj()))
write("gz_stl.stl.gz", gz(binary_stl()))
write("gz_upper_case.PLY.GZ", gz(ply()))
write("gz_gltf.gltf.gz", gz(gltf()))
write("gz_two_streams.off.gz", gz(off()[:40]) + gz(off()[40:]) + bytes(100))
write("gz_by_content.dat", gz(obj()))
write("gz_without_format.gz", gz(off()))
write("gz_called_obj.obj", gz(obj()))
write("gz_not_packed.obj.gz", obj())
write("gz_other_content.stl.gz", gz(ply()))
write("gz_cut_off.obj.gz", gz(obj())[:-12])
write("gz_wrong_checksum.obj.gz", gz(obj())[:-8] + bytes(8))
write("gz_empty.obj.gz", gz(""))
write("gz_error_inside.obj.gz", gz(obj().replace("v 1 0 0", "v 1 0 x")))

# Texture coordinates are not needed, and fail nothing.
textured = json.loads(gltf())
textured["meshes"][0]["primitives"][0]["attributes"].update({"TEXCOORD_0": 2, "TEXCOORD_1": 99})
textured["accessors"].append({"bufferView": 7, "componentType": 9999, "count": -4, "type": "VEC9"})
write("gltf_bad_texture_coordinates.gltf", json.dumps(textured))
write("obj_bad_texture_coordinates.obj", "vt nan x\nvt\n" + obj().replace("f 1 3 2", "f 1/99 3/x 2/-7/0"))
write("off_bad_texture_coordinates.off", off(first="STOFF\n").replace("0 0 0\n", "0 0 0 x nan\n", 1))
write("ply_texture_lists.ply", ply().replace(b"vertex_indices\n", b"vertex_indices\nproperty list uchar float texcoord\n")
      .replace(b"3 0 2 1\n", b"3 0 2 1 6 0 0 nan 1 x 0\n").replace(b"3 0 1 3\n", b"3 0 1 3 0\n")
      .replace(b"3 1 2 3\n", b"3 1 2 3 0\n").replace(b"3 2 0 3\n", b"3 2 0 3 0\n"))

# Rows of text: more than the header says, in several lines, all in one.
write("ply_text_extra_values.ply", ply().replace(b"1 0 0\n", b"1 0 0 0.5 x\n").replace(b"3 0 2 1\n", b"3 0 2 1 9 9 9\n"))
write("ply_text_broken_rows.ply", ply().replace(b"1 0 0\n", b"1\n\n0 0\n").replace(b"3 0 2 1\n", b"3 0\n2 1\n"))
head, rows = ply().split(b"end_header\n")
write("ply_text_one_row.ply", head + b"end_header\n" + rows.replace(b"\n", b" "))

# Triangle strips as Stanford's scans have them: 0 2 1 3 0 turns to and fro, then the last triangle alone.
STRIPS = [0, 2, 1, 3, -1, 0, 1, 3, -1, 2, 0, 3, -1, 3]
STRIP_HEADER = ply().split(b"element face")[0]


def strips(indices, order=None):
    if order is None:
        head = STRIP_HEADER
        body = "".join("%s %s %s\n" % p for p in POINTS) + " ".join(map(str, [len(indices)] + indices)) + "\n"
        body = body.encode()
    else:
        head = STRIP_HEADER.replace(b"ascii", b"binary_little_endian" if order == "<" else b"binary_big_endian")
        body = b"".join(struct.pack(order + "3f", *p) for p in POINTS) + struct.pack(
            f"{order}{len(indices) + 1}i", len(indices), *indices)
    return head + b"element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + body


write("ply_strips.ply", strips(STRIPS))
write("ply_strips_little_endian.ply", strips(STRIPS, "<"))
write("ply_strips_big_endian.ply", strips(STRIPS, ">"))
write("ply_strips_as_faces.ply", ply(body="".join("%s %s %s\n" % p for p in POINTS) +
                                     "3 0 2 1\n3 1 2 3\n3 0 1 3\n3 2 0 3\n"))
write("ply_strips_index_out_of_range.ply", strips([0, 2, 1, 4]))
write("ply_strips_negative_index.ply", strips([0, 2, 1, -2]))
write("ply_strips_without_triangles.ply", strips([0, 2, -1, 1, -1]))

write("obj_utf_16.obj", ("\ufeff" + obj()).encode("utf-16-le"))
write("stl_utf_16_big_endian.stl", ("\ufeff" + ascii_stl()).encode("utf-16-be"))


def glb_of(document, binary, counted, padded):
    """A binary glTF whose lengths count the padding, or do not, or that has none."""
    text = document.encode()
    text += b" " * (1 if len(text) % 4 == 0 else 0)  # so that there is something to pad
    padding = b" " * (-len(text) % 4) if padded else b""
    chunk = struct.pack("<II", len(text) + (len(padding) if counted else 0), 0x4E4F534A) + text + padding
    chunk += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunk)) + chunk


points = struct.pack("<12f12H", *(c for p in POINTS for c in p), *(i for f in FACES for i in f))
inside = json.loads(gltf())
inside["buffers"] = [{"byteLength": len(points)}]
write("gltf_padded.glb", glb_of(json.dumps(inside), points, True, True))
write("gltf_padding_not_counted.glb", glb_of(json.dumps(inside), points, False, True))
write("gltf_unpadded.glb", glb_of(json.dumps(inside), points, False, False))


def medit(first="MeshVersionFormatted 2\n", dimension="Dimension 3\n", vertices=4, faces=4, points=POINTS, end="End\n", between=""):
    return (f"{first}{dimension}Vertices\n{vertices}\n" + "".join("%s %s %s 0\n" % p for p in points) + between +
            f"Triangles\n{faces}\n" + "".join("%d %d %d 7\n" % tuple(i + 1 for i in f) for f in FACES) + end)


write("medit_plain.mesh", medit())
write("medit_dimension_on_next_line.mesh", medit(dimension="Dimension\n3\n", end=""))
write("medit_comments.mesh", "# written by hand\n" + medit(between="# faces follow\n").replace("0 0 0 0\n", "0 0 0 0 # first\n"))
write("medit_other_keywords.mesh", medit(between="Corners 2\n1\n2\nEdges\n1\n1 2 5\nTetrahedra\n1\n1 2 3 4 0\nNormals\n1\n0 0 -1e0\n"))
write("medit_called_mesh.dat", medit())
write("medit_quadrilaterals.mesh", medit(faces=0, end="").replace(medit(faces=0, end="").split("Triangles\n0\n")[1], "")
      + "Quadrilaterals 1\n1 2 3 4 0\nEnd\n")
write("medit_two_dimensions.mesh", medit(dimension="Dimension 2\n"))
write("medit_index_zero.mesh", medit().replace("1 3 2 7", "0 3 2 7"))
write("medit_index_out_of_range.mesh", medit().replace("1 3 2 7", "1 3 5 7"))
write("medit_absurd_vertices.mesh", medit(vertices=4000000000))
write("medit_negative_count.mesh", medit(faces=-1))
write("medit_cut_off.mesh", medit(end="")[:-9])
write("medit_nan.mesh", medit(points=[("nan", 0, 0)] + POINTS[1:]))
write("medit_no_triangles.mesh", medit().split("Triangles")[0] + "End\n")
write("medit_no_keyword.mesh", medit(between="1 2 3\n"))
write("medit_ogre.mesh", b"\x00\x10[MeshSerializer_v1.100]\n" + bytes(40))
