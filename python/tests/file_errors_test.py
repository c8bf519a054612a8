# SPDX-License-Identifier: Apache-2.0
"""Files that cannot be read or written: what, where, and nothing left behind."""

import gzip
import os
import pathlib

import numpy as np
import pytest
import shapes
import standoff as so

MESH = so.Mesh(*shapes.cube())
READ = {"read": so.read, "load": so.load, "query": so.MeshQuery.load, "body": so.Body.load}
EXTENSION = {"read": ".obj", "load": ".npz", "query": ".query", "body": ".body"}
every_reader = pytest.mark.parametrize("kind", READ)


def saved(kind, path):
    thing = {"read": lambda: MESH, "load": lambda: so.field(MESH, resolution=12), "query": lambda: so.MeshQuery(MESH, sign=None),
             "body": lambda: so.Body(MESH)}[kind]()  # fmt: skip
    thing.save(path)
    return path


@every_reader
def test_what_open_raises(kind, tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        READ[kind](tmp_path / "none.obj")
    assert caught.value.filename == tmp_path / "none.obj" or caught.value.filename == str(tmp_path / "none.obj")
    with pytest.raises(IsADirectoryError):
        READ[kind](tmp_path)
    for path in (None, 3, 1.5, [], object()):
        with pytest.raises(TypeError):
            READ[kind](path)
    with pytest.raises(ValueError):
        READ[kind]("nul\0.obj")


@every_reader
@pytest.mark.parametrize("content", [b"", b"junk" * 100, b"\0" * 5000, b"\xff" * 5000, b"v 0 0\n", b"PK\3\4"])
def test_files_that_are_junk(kind, content, tmp_path):
    path = tmp_path / f"junk{EXTENSION[kind]}"
    path.write_bytes(content)
    with pytest.raises((so.InputError, so.LimitError)) as caught:
        mesh = READ[kind](path)
        assert mesh.bounds  # an .obj without a triangle is a mesh, but no shape
    assert isinstance(caught.value, so.Error)


@every_reader
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_files_that_end_too_early(kind, share, tmp_path):
    path = saved(kind, tmp_path / f"whole{EXTENSION[kind]}")
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    try:
        READ[kind](path)
        assert kind == "read"  # text that ends early may still be a mesh
    except so.InputError as error:
        assert error.file == str(path)


@pytest.mark.parametrize("extension", [".vti", ".nrrd", ".npz", ".vdb", ".nvdb"])
def test_fields_with_flipped_bytes(extension, tmp_path):
    path = tmp_path / f"field{extension}"
    so.field(MESH, resolution=12, band=1).save(path)
    content, random = bytearray(path.read_bytes()), np.random.default_rng(1)
    for _ in range(60):
        at, bit = random.integers(len(content)), 1 << random.integers(8)
        content[at] ^= bit
        path.write_bytes(content)
        try:
            repr(so.load(path, memory_limit=10**8)), so.load(path).provenance
        except (so.InputError, so.LimitError):
            pass
        content[at] ^= bit


@pytest.mark.parametrize("name", ["field.obj", "field", "field.unknown"])
def test_files_of_no_format_are_no_meshes(name, tmp_path):
    path = tmp_path / name
    MESH.save(tmp_path / "field.obj")
    path.touch()
    with pytest.raises(so.InputError, match="use one of .vti") as caught:
        so.load(path)
    assert type(caught.value) is so.InputError
    assert caught.value.file == str(path)


def test_lines_and_bytes(tmp_path):
    text = tmp_path / "text.obj"
    text.write_text("v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n")
    with pytest.raises(so.InputError) as caught:
        so.read(text)
    assert (caught.value.file, caught.value.line) == (str(text), 3)
    text.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n")
    with pytest.raises(so.InputError) as caught:
        so.field(text)
    assert caught.value.triangle == 1 or caught.value.line == 5
    with gzip.open(tmp_path / "text.obj.gz", "wt") as packed:
        packed.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert len(so.read(tmp_path / "text.obj.gz").faces) == 1


WRITE = {
    "mesh": MESH,
    "field": so.field(MESH, resolution=8),
    "query": so.MeshQuery(MESH, sign=None),
    "body": so.Body(MESH),
}
ENDING = {"mesh": ".ply", "field": ".vdb", "query": ".query", "body": ".body"}
every_writer = pytest.mark.parametrize("kind", WRITE)


@every_writer
def test_writing(kind, tmp_path):
    path = tmp_path / f"thing{ENDING[kind]}"
    WRITE[kind].save(path)
    first = path.read_bytes()
    WRITE[kind].save(str(path))
    WRITE[kind].save(os.fsencode(path))
    assert path.read_bytes() == first
    path.write_bytes(b"precious")
    with pytest.raises(so.OutputError) as caught:
        WRITE[kind].save(path, overwrite=False)
    assert isinstance(caught.value, OSError)
    assert caught.value.file == str(path)
    assert path.read_bytes() == b"precious"
    with pytest.raises(so.OutputError):
        WRITE[kind].save(tmp_path / "no folder" / path.name)
    for wrong in (None, 3, 1.5, "nul\0" + ENDING[kind]):
        with pytest.raises((TypeError, ValueError)):
            WRITE[kind].save(wrong)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("kind", ["mesh", "field"])
@pytest.mark.parametrize("name", ["x.unknown", "x", ""])
def test_extensions_that_are_no_format(kind, name, tmp_path):
    with pytest.raises(so.UsageError):
        WRITE[kind].save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name", [b"\xff\xfe", "gr\u00fc\u00df dich".encode(), "\u96ea".encode(), b"new\nline", b"'\"$%{}"]
)
def test_names_of_any_bytes(name, tmp_path):
    for kind, thing in WRITE.items():
        path = pathlib.Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name + ENDING[kind].encode()))
        thing.save(path)
        assert {"mesh": so.read, "field": so.load, "query": so.MeshQuery.load, "body": so.Body.load}[kind](path)
    bad = pathlib.Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name + b".obj"))
    bad.write_text("v 0 0 x\n")
    with pytest.raises(so.InputError) as caught:
        so.read(bad)
    assert caught.value.file == str(bad)
    str(caught.value).encode()  # can be printed
    with pytest.raises(so.UsageError):
        WRITE["field"].save(os.fspath(bad) + "x")


@pytest.mark.parametrize("scale", [0, -1, float("nan"), float("inf"), None, "2"])
def test_scales(scale, tmp_path):
    MESH.save(tmp_path / "cube.stl")
    with pytest.raises((ValueError, TypeError)):
        so.read(tmp_path / "cube.stl", scale=scale)
    assert so.read(tmp_path / "cube.stl", scale=0.5).bounds == ((-0.25,) * 3, (0.25,) * 3)
