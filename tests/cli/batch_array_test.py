# SPDX-License-Identifier: Apache-2.0
"""standoff batch --format array: rows of one array, bit for bit what compute writes, whole or in parts, and after changes."""

import json
import pathlib
import shutil
import subprocess

import numpy as np
from program import STANDOFF, run

GRID = ["--size", "20,14,17", "-t", "3s"]
SCENES = [f"scene:sphere:{100 + 20 * n}" for n in range(5)] + ["missing.obj", "scene:box"]


def batch(*words, scenes=SCENES, code=3):
    pathlib.Path("list.txt").write_text("\n".join(scenes) + "\n")
    return run("batch", "list.txt", "--format", "array", "--uncompressed", "-j", "2", *words, code=code)


def metadata(name):
    return json.loads(pathlib.Path(name, "zarr.json").read_text())


def table(out, name, type):
    about = metadata(f"{out}/fields.zarr/{name}")
    assert about["data_type"] == np.dtype(type).name and about["dimension_names"][0] == "mesh"
    shape = about["shape"]
    chunk = pathlib.Path(out, "fields.zarr", name, "c.0" + ".0" * (len(shape) - 1)).read_bytes()
    return np.frombuffer(chunk, type).reshape(-1, *shape[1:])[: shape[0]]


def rows_of(out, shape=(20, 14, 17)):
    """All rows, NaN where there is none, as the metadata say that they lie."""
    about = metadata(f"{out}/fields.zarr/distance")
    assert about["fill_value"] == "NaN" and about["chunk_key_encoding"]["configuration"]["separator"] == "."
    assert about["shape"][1:] == list(shape) and about["codecs"] == [{"name": "bytes", "configuration": {"endian": "little"}}]
    chunk = about["chunk_grid"]["configuration"]["chunk_shape"]
    values = np.full(about["shape"], np.nan, np.float32)
    for file in pathlib.Path(out, "fields.zarr", "distance").glob("c.*"):
        row, *at = map(int, file.name.split(".")[1:])
        begin = [a * c for a, c in zip(at, chunk[1:])]
        part = np.frombuffer(file.read_bytes(), np.float32).reshape(chunk[1:])
        where = tuple(slice(b, min(b + c, s)) for b, c, s in zip(begin, chunk[1:], shape))
        values[(row, *where)] = part[tuple(slice(0, s.stop - s.start) for s in where)]
    return values


def computed(scene, *options):
    run("compute", scene, *(options or GRID), "-o", "one.npz", "-f", "-q")
    return np.load("one.npz")


def expect(out, scenes=SCENES):
    values, code = rows_of(out), table(out, "code", np.uint8)
    assert len(values) == len(code) == len(scenes)
    manifest = {row["index"]: row for row in map(json.loads, pathlib.Path(out, "manifest.jsonl").read_text().splitlines())}
    for n, scene in enumerate(scenes):
        assert code[n] == manifest[n]["code"] == (3 if scene == "missing.obj" else 0)
        if code[n]:
            assert np.isnan(values[n]).all() and np.isnan(table(out, "origin", np.float64)[n]).all() and manifest[n]["output"] is None
            continue
        field = computed(scene)
        assert values[n].tobytes() == np.ascontiguousarray(field["distance"]).tobytes(), scene
        assert (table(out, "origin", np.float64)[n] == field["origin"]).all() and (table(out, "spacing", np.float64)[n] == field["spacing"]).all()
        assert table(out, "thickness", np.float64)[n] == field["thickness"]
        assert manifest[n]["output"]["row"] == n and manifest[n]["output"]["file"] == "fields.zarr"


def files(out):
    return {path.relative_to(out): path.read_bytes() for path in pathlib.Path(out, "fields.zarr").rglob("*") if path.is_file()}


def whole_and_in_parts():
    batch("-o", "whole", *GRID)
    expect("whole")
    for part in ("2/3", "1/3", "3/3"):
        batch("-o", "parts", *GRID, "--shard", part, code=3 if part == "3/3" else 0)
        assert not pathlib.Path("parts/fields.zarr/zarr.json").exists()
    run("batch", "--merge", "-o", "parts", code=3)
    assert files("parts") == files("whole")
    refused = batch("-o", "parts", *GRID, "--resume", code=2).stderr
    assert "counted by a run of other parts" in refused, refused
    refused = batch("-o", "whole", *GRID, "--shard", "1/2", code=2).stderr
    assert "counted by a run of other parts" in refused, refused


def at_once():
    """Of two runs that begin at once and count rows by different parts, one at most goes on."""
    for n in range(12):
        out = f"at-once-{n}"
        both = [["--shard", "1/2"], ["--shard", "1/3"] if n % 2 else []]
        words = [STANDOFF, "batch", "list.txt", "--format", "array", *GRID, "-o", out, "-q"]
        running = [subprocess.Popen([*words, *part], stderr=subprocess.PIPE, text=True) for part in both]
        ends = [(process.communicate(timeout=60)[1], process.returncode) for process in running]
        refused = [said for said, code in ends if code == 2]
        assert refused and all("counted by a run of other parts" in said for said in refused), ends
        assert len(list(pathlib.Path(out).glob("manifest*.jsonl"))) == 2 - len(refused)


def go_on():
    said = batch("-o", "whole", *GRID, "--resume").stderr
    assert "1 mesh: 1 input; 6 were done before" in said, said
    # Each file holds what its row says, whatever its size is.
    chunk = pathlib.Path("whole/fields.zarr/distance/c.2.0.0.0")
    chunk.write_bytes(bytes(chunk.stat().st_size))
    pathlib.Path("whole/fields.zarr/distance/c.4.0.0.0").unlink()
    assert "3 meshes: 2 ok, 1 input; 4 were done before" in batch("-o", "whole", *GRID, "--resume").stderr
    expect("whole")
    assert "1 mesh: 1 input; 6 were done before" in batch("-o", "whole", *GRID, "--retry", "failed").stderr
    # Rows are places in the list: of another list those alone hold that have the same mesh at the same place.
    other = [SCENES[1], "missing.obj", *SCENES[2:4], SCENES[3]]
    assert "3 meshes: 2 ok, 1 input; 2 were done before" in batch("-o", "whole", *GRID, "--resume", scenes=other).stderr
    expect("whole", other)
    assert "1 mesh: 1 input; 4 were done before" in batch("-o", "whole", *GRID, "--resume", scenes=other).stderr
    batch("-o", "whole", *GRID, "--retry", "failed")
    expect("whole")
    batch("-o", "whole", *GRID, "-f", scenes=other)
    expect("whole", other)


def the_same_mesh_by_another_name():
    run("convert", "scene:box", "-o", "one.obj")
    shutil.copy("one.obj", "two.obj")
    batch("-o", "copies", *GRID, scenes=["one.obj"], code=0)
    batch("-o", "copies", *GRID, "--resume", scenes=["two.obj"], code=0)
    assert json.loads(pathlib.Path("copies/manifest.jsonl").read_text().splitlines()[-1])["path"] == "two.obj"
    expect("copies", ["two.obj"])


def shapes():
    refused = batch("-o", "none", "-r", "20", code=2).stderr
    assert "--format array: its rows have one shape" in refused and "--size" in refused and not pathlib.Path("none").exists()
    box = ["--bounds=-2,-2,-2,2,2,3", "-r", "11"]
    batch("-o", "box", *box, scenes=SCENES[:2], code=0)
    assert rows_of("box", (9, 9, 11))[1].tobytes() == np.ascontiguousarray(computed(SCENES[1], *box)["distance"]).tobytes()
    assert np.isinf(table("box", "thickness", np.float64)).all()
    # Long rows are several files.
    long = ["--size", "300,9,10", "-t", "2s"]
    batch("-o", "long", *long, scenes=SCENES[:1], code=0)
    assert metadata("long/fields.zarr/distance")["chunk_grid"]["configuration"]["chunk_shape"] == [1, 150, 9, 10]
    assert rows_of("long", (300, 9, 10))[0].tobytes() == np.ascontiguousarray(computed(SCENES[0], *long)["distance"]).tobytes()
    refused = batch("-o", "long", *long, "-f", "--cache", "kept", code=2).stderr
    assert "leave it out" in refused, refused
    batch("-o", "long", *GRID, "--resume", scenes=SCENES[:1], code=0)
    expect("long", SCENES[:1])


def after_other_options():
    """Rows of one array are made in one way."""
    batch("-o", "mixed", *GRID)
    before = files("mixed")
    thinner = ["--size", "20,14,17", "-t", "2s"]
    refused = batch("-o", "mixed", *thinner, "--retry", "failed", code=2).stderr
    assert "made with other options" in refused and "--resume" in refused, refused
    assert files("mixed") == before
    # A manifest of an earlier version may have such rows: nothing is known of them.
    for part in ("1/2", "2/2"):
        batch("-o", "mixed-parts", *GRID, "--shard", part, code=3 if part == "2/2" else 0)
    manifest = pathlib.Path("mixed-parts/manifest-1-of-2.jsonl")
    lines = manifest.read_text().splitlines()
    row = next(line for line in lines if json.loads(line)["index"] == 2)
    manifest.write_text("\n".join([*lines, row.replace(json.loads(row)["parameters"], "0123456789abcdef")]) + "\n")
    run("batch", "--merge", "-o", "mixed-parts", code=3)
    code = table("mixed-parts", "code", np.uint8)
    assert code.tolist() == [0, 0, 255, 0, 0, 3, 0], code
    assert np.isnan(rows_of("mixed-parts")[2]).all() and np.isnan(table("mixed-parts", "thickness", np.float64)[2])


def strange_parameters():
    """What stands in the file of the parameters is looked at, and files need it not."""
    for part in ("1/2", "2/2"):
        batch("-o", "strange-parts", *GRID, "--shard", part, scenes=SCENES[:2], code=0)
    path = next(pathlib.Path("strange-parts").glob("parameters-*.json"))
    parameters = json.loads(path.read_text())
    for shape in ([0, 1, 1], [1, -1, 1], [1, 1, 2**41], [1, 1, 1.5], [1, 1, "1"], [1, 1], "1"):
        path.write_text(json.dumps({**parameters, "shape": shape}))
        refused = run("batch", "--merge", "-o", "strange-parts", code=3).stderr
        assert "these are no parameters of a batch" in refused, (shape, refused)
    path.unlink()
    run("batch", "--merge", "-o", "strange-parts")
    assert not pathlib.Path("strange-parts/fields.zarr/zarr.json").exists()


def somebody_elses():
    mine = pathlib.Path("mine/fields.zarr/zarr.json")
    mine.parent.mkdir(parents=True)
    mine.write_text('{"zarr_format": 3, "node_type": "group"}')
    assert "it stays as it is" in batch("-o", "mine", *GRID, "-f", code=4).stderr
    assert mine.read_text() == '{"zarr_format": 3, "node_type": "group"}' and not list(mine.parent.glob("distance"))
    mine.unlink()
    mine = mine.parent / "distance" / "zarr.json"
    mine.parent.mkdir()
    mine.write_text('{"zarr_format": 3, "node_type": "array"}')
    assert "it stays as it is" in batch("-o", "mine", *GRID, "-f", code=4).stderr
    assert mine.read_text() == '{"zarr_format": 3, "node_type": "array"}'
    # An array whose run was killed before its group was there is ours.
    batch("-o", "ours", *GRID)
    pathlib.Path("ours/fields.zarr/zarr.json").unlink()
    batch("-o", "ours", *GRID, "--resume")
    expect("ours")


def keep():
    batch("-o", "first", *GRID, "--cache", "kept")
    batch("-o", "second", *GRID, "--cache", "kept")
    assert files("first") == files("second") and all(row.get("cached", True) for row in map(json.loads, open("second/manifest.jsonl")))
    expect("second")


def stores():
    """A store for each mesh, which is a folder, can be gone on with, too."""
    pathlib.Path("list.txt").write_text("scene:box\nscene:fly\n")
    words = ["batch", "list.txt", "-o", "stores", "-r", "20", "--format", "zarr"]
    run(*words)
    assert "0 meshes: none; 2 were done before" in run(*words, "--resume").stderr
    shutil.rmtree(next(pathlib.Path("stores/fields").glob("*.zarr/0/c")))
    assert "1 mesh: 1 ok; 1 were done before" in run(*words, "--resume").stderr
    assert "a result of --format zarr is a folder" in run(*words, "-f", "--cache", "kept", code=2).stderr


whole_and_in_parts()
at_once()
go_on()
the_same_mesh_by_another_name()
shapes()
after_other_options()
strange_parameters()
somebody_elses()
keep()
stores()
