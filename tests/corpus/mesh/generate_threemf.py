#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the 3MF files of this folder that expected.txt lists. The same bytes on every run."""
import io
import zipfile

from samples import FACES, NAN_POINTS, POINTS, gz, write

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
THREEMF = "http://schemas.microsoft.com/3dmanufacturing/"


def threemf_mesh(points=POINTS, faces=FACES):
    return ("<mesh>\n<vertices>\n" + "".join('<vertex x="%s" y="%s" z="%s"/>\n' % p for p in points) +
            "</vertices>\n<triangles>\n" + "".join('<triangle v1="%d" v2="%d" v3="%d"/>\n' % f for f in faces) +
            "</triangles>\n</mesh>\n")


def threemf_model(objects=None, build='<item objectid="1"/>', attributes='unit="millimeter"', before=""):
    """The XML of a model part; objects as (id, content)."""
    objects = objects or [(1, threemf_mesh())]
    return (f'<?xml version="1.0" encoding="UTF-8"?>\n{before}<model {attributes} xml:lang="en-US" xmlns="{CORE}" '
            f'xmlns:p="{THREEMF}production/2015/06" xmlns:b="{THREEMF}beamlattice/2017/02">\n'
            '<metadata name="Title">a &amp; b</metadata>\n<resources>\n' +
            "".join(f'<object id="{n}" type="model">\n{content}</object>\n' for n, content in objects) +
            f"</resources>\n<build>\n{build}\n</build>\n</model>\n")


def threemf(model=None, target="/3D/3dmodel.model", relations=None, packed=True, **parts):
    """The archive of a model part and others, the same on every run."""
    relations = relations or f'<Relationship Target="{target}" Id="rel0" Type="{THREEMF}2013/01/3dmodel"/>'
    members = {
        "[Content_Types].xml": '<?xml version="1.0" encoding="UTF-8"?>\n<Types '
                               'xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default '
                               'Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                               '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-'
                               '3dmodel+xml"/></Types>\n',
        "_rels/.rels": '<?xml version="1.0" encoding="UTF-8"?>\n<Relationships xmlns="http://schemas.openxmlformats.org/'
                       f'package/2006/relationships">{relations}</Relationships>\n',
        target.lstrip("/"): model or threemf_model()}
    members.update({name.replace("__", "/") + ".model": text for name, text in parts.items()})
    bytes_ = io.BytesIO()
    with zipfile.ZipFile(bytes_, "w") as archive:
        for name, text in members.items():
            if text != "":
                archive.writestr(zipfile.ZipInfo(name), text,
                                 zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED)
    return bytes_.getvalue()


def threemf_with_line(old, new):
    return threemf(threemf_model().replace(old, new))


shift = 'transform="1 0 0 0 1 0 0 0 1 10 20 30"'
turn = 'transform="0 1 0 -1 0 0 0 0 1 5 0 0"'  # x becomes y
assembly = [(1, threemf_mesh()), (2, f'<components><component objectid="1"/><component objectid="1" {turn}/></components>')]
write("threemf_plain.3mf", threemf())
write("threemf_called_mesh.dat", threemf())
write("threemf_not_packed.3mf", threemf(packed=False))
write("threemf_other_target.3mf", threemf(target="3D/Other.model"))
write("threemf_no_unit.3mf", threemf(threemf_model(attributes="")))
write("threemf_metres.3mf", threemf(threemf_model(attributes='unit="meter"')))
write("threemf_no_relations.3mf", threemf().replace(b"_rels/.rels", b"_rels/_rels"))
write("threemf_two_items.3mf", threemf(threemf_model(build=f'<item objectid="1"/><item objectid="1" {shift} printable="1"/>')))
write("threemf_components.3mf", threemf(threemf_model(assembly, f'<item objectid="2" {shift}/>')))
write("threemf_not_in_build.3mf", threemf(threemf_model([(1, threemf_mesh()), (7, threemf_mesh(faces=FACES[:1]))])))
write("threemf_mirrored.3mf", threemf(threemf_model(build='<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>')))
write("threemf_production.3mf", threemf(
    threemf_model([(2, '<components><component p:path="/3D/Objects/object_1.model" objectid="1" p:UUID="1"/></components>')],
                  '<item objectid="2"/>', 'unit="millimeter" requiredextensions="p"'),
    **{"3D__Objects__object_1": threemf_model(build="")}))
write("threemf_cycle.3mf", threemf(threemf_model([(1, '<components><component objectid="1"/></components>')])))
write("threemf_doubling.3mf", threemf(threemf_model(
    [(1, threemf_mesh())] + [(n, f'<components><component objectid="{n - 1}"/><component objectid="{n - 1}"/></components>')
                             for n in range(2, 42)], '<item objectid="41"/>')))
write("threemf_missing_object.3mf", threemf(threemf_model(build='<item objectid="9"/>')))
write("threemf_missing_part.3mf", threemf(threemf_model(build='<item objectid="1" p:path="/3D/none.model"/>')))
write("threemf_no_model.3mf", threemf(relations='<Relationship Target="/3D/none.model" Type="%s2013/01/3dmodel"/>' % THREEMF))
write("threemf_index_out_of_range.3mf", threemf_with_line('v1="0" v2="2" v3="1"', 'v1="0" v2="4" v3="1"'))
write("threemf_negative_index.3mf", threemf_with_line('v1="0" v2="2" v3="1"', 'v1="-1" v2="2" v3="1"'))
write("threemf_nan.3mf", threemf(threemf_model([(1, threemf_mesh(NAN_POINTS))])))
write("threemf_no_coordinate.3mf", threemf_with_line('x="1" y="0" z="0"', 'x="1" z="0"'))
write("threemf_overflow.3mf", threemf(threemf_model(
    [(1, threemf_mesh([("1e300", 0, 0)] + POINTS[1:]))], '<item objectid="1" transform="1e300 0 0 0 1 0 0 0 1 0 0 0"/>')))
write("threemf_short_transform.3mf", threemf(threemf_model(build='<item objectid="1" transform="1 0 0"/>')))
write("threemf_unknown_unit.3mf", threemf(threemf_model(attributes='unit="parsec"')))
write("threemf_empty_build.3mf", threemf(threemf_model(build="")))
write("threemf_entities.3mf", threemf(threemf_model(before='<!DOCTYPE x [<!ENTITY a "&b;&b;"><!ENTITY b "c">]>\n')))
write("threemf_not_closed.3mf", threemf(threemf_model().replace("</build>\n</model>\n", "")))
write("threemf_wrong_end.3mf", threemf(threemf_model().replace("</triangles>", "</vertices>")))
write("threemf_beams.3mf", threemf(threemf_model([(1, threemf_mesh().replace("</mesh>", "<b:beamlattice/></mesh>"))])))
write("threemf_required_beams.3mf", threemf(threemf_model(attributes='requiredextensions="p b"')))
write("threemf_boolean.3mf", threemf(threemf_model([(1, '<bo:booleanshape objectid="2"/>')])))
write("threemf_low_resolution.3mf", threemf_with_line('type="model"', 's:meshresolution="lowres"'))
write("threemf_same_id.3mf", threemf(threemf_model([(1, threemf_mesh()), (1, threemf_mesh())])))
write("threemf_encrypted.3mf", threemf(relations='<Relationship Target="/Secure/keystore.xml" Type="http://schemas.microsoft.com/'
                                       '3dmanufacturing/2019/04/keystore"/>'))
write("threemf_cut_off.3mf", threemf()[:-30])
write("threemf_damaged.3mf", threemf(packed=False).replace(b'x="1"', b'x="2"'))
write("threemf_renamed.stl", threemf())
write("gz_threemf.3mf.gz", gz(threemf()))
