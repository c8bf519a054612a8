#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""standoff points: files that numpy and others write, read by it, and its answers read by numpy. The mesh is a box, whose
distances are known in closed form."""

import os
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import numpy as np

STANDOFF = os.environ["STANDOFF"]
HALF = np.array([1.0, 0.75, 0.5])  # scene:box is 2 x 1.5 x 1 around the origin
ALL = "closest,triangle,barycentric,feature,gradient"


def run(*words, stdin=None):
    return subprocess.run([STANDOFF, "points", *words], input=stdin, capture_output=True, timeout=120)


def distances_to_box(points):
    """Outside by the part beyond the box, inside, where they are negative, by the nearest face."""
    beyond = np.abs(points) - HALF
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return np.where((beyond <= 0).all(axis=1), beyond.max(axis=1), outside)


def csv_columns(text):
    lines = text.decode().splitlines()
    names = lines[0].split(",")
    cells = [line.split(",") for line in lines[1:]]
    return {name: [row[n] for row in cells] for n, name in enumerate(names)}


def ply_bytes(points, encoding="binary_little_endian", kind="double", extra=True):
    """A point cloud whose positions stand among other properties, after another element."""
    order = ">" if "big" in encoding else "<"
    code = {"double": "d", "float": "f", "int": "i", "short": "h"}[kind]
    head = f"ply\nformat {encoding} 1.0\ncomment made for a test\n"
    if extra:
        head += "element camera 2\nproperty list uchar float view\nproperty int id\n"
    head += f"element vertex {len(points)}\nproperty uchar red\nproperty {kind} z\nproperty {kind} x\n"
    head += f"property list uchar int ids\nproperty {kind} y\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
    body = []
    rows = [("Bfffi", (3, 1, 2, 3, 7)), ("Bi", (0, 8))] if extra else []
    for x, y, z in points:
        rows.append(("B" + code + code + "Bii" + code, (200, z, x, 2, 5, 6, y)))
    for form, values in rows:
        body.append(" ".join(map(repr, values)).encode() + b"\n" if encoding == "ascii" else struct.pack(order + form, *values))
    return head.encode() + b"".join(body)


class Points(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(dir=os.getcwd())
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())  # before the folder is removed
        os.chdir(folder.name)
        self.points = np.random.default_rng(3).normal(size=(500, 3))
        self.points[0] = [0, 0, 0.5]  # on the surface
        self.points[1] = [1, 0.75, 0.5]  # on a corner

    def done(self, *words, stdin=None):
        ran = run(*words, stdin=stdin)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        return ran

    def refused(self, code, message, *words, stdin=None):
        ran = run(*words, stdin=stdin)
        self.assertEqual(ran.returncode, code, (words, ran.stderr))
        self.assertIn(message, ran.stderr.decode(), words)
        self.assertEqual(ran.stderr.decode().count("standoff: error: "), 1)
        return ran

    def distances(self, name, stdin=None):
        return np.array(csv_columns(self.done("scene:box", name, stdin=stdin).stdout)["distance"], dtype=float)

    def expect_distances(self, name, points, stdin=None):
        np.testing.assert_allclose(self.distances(name, stdin), distances_to_box(points), rtol=0, atol=1e-14, err_msg=name)

    def test_every_format_in(self):
        p = self.points
        np.save("c.npy", p)
        np.save("fortran.npy", np.asfortranarray(p))
        np.save("big.npy", p.astype(">f8"))
        np.savez("one.npz", p)
        np.savez("two.npz", other=np.arange(3), points=np.asfortranarray(p))
        np.savez_compressed("packed.npz", points=p)
        np.savez_compressed("packed_fortran.npz", points=np.asfortranarray(p))
        for name in ["c.npy", "fortran.npy", "big.npy", "one.npz", "two.npz", "packed.npz", "packed_fortran.npz"]:
            self.expect_distances(name, p)
        for encoding in ["ascii", "binary_little_endian", "binary_big_endian"]:
            Path("cloud.ply").write_bytes(ply_bytes(p, encoding))
            self.expect_distances("cloud.ply", p)
        single = p.astype("f4").astype("f8")
        np.save("single.npy", p.astype("f4"))
        np.save("single_big.npy", p.astype(">f4"))
        Path("single.ply").write_bytes(ply_bytes(single, kind="float"))
        for name in ["single.npy", "single_big.npy", "single.ply"]:
            self.expect_distances(name, single)
        whole = np.round(p * 3).astype(int)
        Path("whole.ply").write_bytes(ply_bytes(whole, kind="short"))
        self.expect_distances("whole.ply", whole.astype(float))

    def test_tables_of_all_kinds(self):
        p = self.points[:5]
        rows = [[repr(float(v)) for v in row] for row in p]
        lines = lambda separator, head="", end="\n": (head + end.join(separator.join(row) for row in rows) + end).encode()
        tables = {
            "commas": lines(","),
            "commas and blanks": lines(" , "),
            "semicolons": lines(";", "x;y;z\n"),
            "tabs": lines("\t", "x\ty\tz\n"),
            "blanks": lines("   "),
            "dos": lines(",", "X,Y,Z\r\n", "\r\n"),
            "old mac": lines(",", end="\r"),
            "mark": b"\xef\xbb\xbf" + lines(",", "x,y,z\n"),
            "comments": b"# x y z\n\n   # nothing\n" + lines(" ", end=" # a point\n\n"),
            "names that say nothing": lines(",", "east,north,up\n"),
            "quotes": b'"x","y","z"\n' + b"\n".join(",".join(f'"{v}"' for v in row).encode() for row in rows),
            "other columns": b"id,z,label,x,y\n"
            + b"".join(f"{n},{z},p {n},{x},{y},more\n".encode() for n, (x, y, z) in enumerate(rows)),
            "no last line end": lines(",").rstrip(b"\n"),
        }
        for name, text in tables.items():
            with self.subTest(name):
                self.expect_distances("-", p, stdin=text)
                Path("table.txt").write_bytes(text)
                self.expect_distances("table.txt", p)
        np.savetxt("numpy.csv", p, delimiter=",", header="x,y,z", fmt="%.17g")
        self.expect_distances("numpy.csv", p)

    def test_comma_locale(self):
        environment = {**os.environ, "LC_ALL": "de_DE.UTF-8"}
        ran = subprocess.run([STANDOFF, "points", "scene:box", "-"], input=b"0.5,0,1.25\n", capture_output=True, env=environment)
        self.assertEqual(ran.stdout, b"distance\n0.75\n")

    def test_every_format_out(self):
        np.save("p.npy", self.points)
        text = csv_columns(self.done("scene:box", "p.npy", "--with", ALL).stdout)
        self.assertEqual(list(text), "distance closest_x closest_y closest_z triangle w0 w1 w2 feature gradient_x gradient_y "
                         "gradient_z".split())
        features = ["face", "edge0", "edge1", "edge2", "vertex0", "vertex1", "vertex2"]
        of = lambda *names: np.array([text[name] for name in names], dtype=float).T
        expected = {"distance": of("distance")[:, 0], "closest": of("closest_x", "closest_y", "closest_z"),
                    "triangle": np.array(text["triangle"], dtype="u4"), "barycentric": of("w0", "w1", "w2"),
                    "feature": np.array([features.index(f) for f in text["feature"]], dtype="u1"),
                    "gradient": of("gradient_x", "gradient_y", "gradient_z")}
        np.testing.assert_allclose(np.linalg.norm(expected["closest"] - self.points, axis=1), np.abs(expected["distance"]), atol=1e-14)
        np.testing.assert_allclose(expected["barycentric"].sum(axis=1), 1, atol=1e-14)
        np.testing.assert_allclose(np.linalg.norm(expected["gradient"], axis=1), 1, atol=1e-14)
        for name in ["a.csv", "a.npy", "a.npz", "a.ply"]:
            self.done("scene:box", "p.npy", "-o", name, "--with", ALL)
        self.assertEqual(csv_columns(Path("a.csv").read_bytes()), text)
        records, arrays = np.load("a.npy"), np.load("a.npz")
        self.assertEqual(sorted(arrays.files), sorted(expected))
        for name, values in expected.items():
            np.testing.assert_array_equal(records[name], values, name)
            np.testing.assert_array_equal(arrays[name], values, name)
            self.assertEqual(arrays[name].dtype, values.dtype)
        ply = Path("a.ply").read_bytes()
        head, body = ply.split(b"end_header\n", 1)
        self.assertIn(b"element vertex 500\n", head)
        names = [line.split()[-1] for line in head.decode().splitlines() if line.startswith("property")]
        kinds = {"double": "<f8", "uint": "<u4", "uchar": "u1"}
        types = [kinds[line.split()[1]] for line in head.decode().splitlines() if line.startswith("property")]
        cloud = np.frombuffer(body, dtype=list(zip(names, types)))
        np.testing.assert_array_equal(np.stack([cloud["x"], cloud["y"], cloud["z"]], 1), self.points)
        np.testing.assert_array_equal(cloud["distance"], expected["distance"])
        np.testing.assert_array_equal(cloud["w2"], expected["barycentric"][:, 2])
        np.testing.assert_array_equal(cloud["feature"], expected["feature"])
        # Its own answers are points again.
        np.testing.assert_array_equal(self.distances("a.ply"), expected["distance"])
        self.done("scene:box", "p.npy", "-o", "plain.npy")
        plain = np.load("plain.npy")
        self.assertEqual((plain.dtype, plain.shape), (np.dtype("f8"), (500,)))

    def test_more_than_a_block(self):
        points = np.random.default_rng(4).uniform(-2, 2, size=(600_001, 3)).astype("f4")
        np.save("many.npy", points)
        ran = self.done("scene:box", "many.npy", "-o", "many.npz", "--with", "triangle", "--json")
        np.testing.assert_allclose(np.load("many.npz")["distance"], distances_to_box(points.astype("f8")), atol=1e-14)
        self.assertEqual(len(np.load("many.npz")["triangle"]), 600_001)
        self.assertIn(b'"points": 600001,', ran.stdout)

    def test_no_points(self):
        np.save("none.npy", np.zeros((0, 3)))
        self.done("scene:box", "none.npy", "-o", "none_out.npy")
        self.assertEqual(np.load("none_out.npy").shape, (0,))
        Path("none.ply").write_bytes(ply_bytes(np.zeros((0, 3))))
        # One rule for every format: no point, no answer, and a word about it.
        for name, text in [("none.npy", None), ("none.ply", None), ("-", b"x,y,z\n"), ("-", b""), ("-", b"# a comment\n\n")]:
            ran = self.done("scene:box", name, stdin=text)
            self.assertEqual(ran.stdout, b"distance\n")
            shown = "standard input" if name == "-" else name
            self.assertIn(f"warning: {shown}: there is no point in it".encode(), ran.stderr)

    def test_invalid_points(self):
        text = b"x,y,z\n0,0,0\nnan,0,0\n0,0,-inf\n1e200,0,0\n,,\n1e999,0,0\n9,0,0\n"
        self.refused(3, "standard input:line 3: point 1 is not finite", "scene:box", "-", stdin=text)
        self.refused(3, "line 1: point 0 lies beyond 1e+150", "scene:box", "-", stdin=b"1,2,1e200")
        ran = self.done("scene:box", "-", "--skip-invalid", "--with", "closest,triangle,feature,barycentric,gradient", stdin=text)
        columns = csv_columns(ran.stdout)
        self.assertEqual(columns["distance"], ["-0.5", "nan", "nan", "nan", "nan", "nan", "8"])
        self.assertEqual(columns["closest_x"][1], "nan")
        self.assertEqual(columns["triangle"][1:3], ["", ""])
        self.assertEqual(columns["feature"][3], "")
        self.assertIn(b"7 points, 1 of them inside, 5 invalid", ran.stderr)
        points = np.zeros((4, 3))
        points[2, 1] = np.nan
        for name, where in [("bad.npy", "bad.npy:point 2: point 2"), ("bad.npz", "bad.npz:point 2: arr_0.npy: point 2"),
                            ("bad.ply", "bad.ply:vertex 2: point 2")]:
            np.save(name, points) if name.endswith("npy") else None
            np.savez(name, points) if name.endswith("npz") else None
            Path(name).write_bytes(ply_bytes(points)) if name.endswith("ply") else None
            self.refused(3, where + " is not finite", "scene:box", name, "-o", "bad_answers.npy")
            self.assertFalse(os.path.exists("bad_answers.npy"))
            self.done("scene:box", name, "--skip-invalid", "-o", "skipped.npz", "-f", "--with", "triangle,feature")
            answers = np.load("skipped.npz")
            self.assertEqual(list(np.isnan(answers["distance"])), [False, False, True, False])
            self.assertEqual((answers["triangle"][2], answers["feature"][2]), (0xFFFFFFFF, 255))

    def test_damaged_tables(self):
        for text, message in [
            (b"1,2\n", "line 1: it has 2 of the 3 numbers"),
            (b"1,2,3\n1;2;3\n", "line 2: expected a number, found '1;2;3'; write numbers like 12 or -1.5e3, decimals with a "
             "point, between them commas"),
            (b"1,2,3\n4,5,six\n", "line 2: expected a number, found 'six'"),
            (b"x,y,w\n1,2,3\n", "line 1: it names some of the columns x, y and z"),
            (b"x,y,z,x\n1,2,3,4\n", "line 1: two columns called 'x'"),
            (b"1,2,3\n" + b"4" * 2_000_000, "line 2: a line of more than 1048576 bytes"),
            (b"1,2,3\n0x10,2,3\n", "line 2: expected a number, found '0x10'"),
            (b"1,2,3\n\0\0,2,3\n", "line 2: expected a number, found '??'"),
            # A damaged first line was taken for names of columns, and vanished.
            (b"1e5x,2,3\n4,5,6\n", "line 1: expected a number, found '1e5x'"),
            (b"0x10,2,3\n4,5,6\n", "line 1: expected a number, found '0x10'"),
            (b"1,2,-3..5\n4,5,6\n", "line 1: expected a number, found '-3..5'"),
            (b'"1,2,3"\n4,5,6\n', "line 1: expected a number, found '\"1'"),
            (b"'1','2','3'\n4,5,6\n", "line 1: expected a number, found ''1''"),
            (b"(1 2 3)\n4 5 6\n", "line 1: expected a number, found '(1'"),
            ("−1,2,3\n4,5,6\n".encode(), "line 1: expected a number, found "),
            (b"1st,2nd,3rd\n4,5,6\n", "line 1: expected a number, found '1st'; write numbers like 12 or -1.5e3, decimals "
             "with a point, between them commas (a line that names columns has no field that begins like a number)"),
            (b"point,1,2,3\n", "line 1: expected a number, found 'point'"),
            (b"n/a,n/a,n/a\n4,5,6\n", "line 1: expected a number, found 'n/a'"),
            (b"nan,2,three\n4,5,6\n", "line 1: expected a number, found 'three'"),
            (b"1,5;2,5;3,5\n", "line 1: expected a number, found '1,5'"),
            # Words are no points, and no heading either unless numbers follow.
            (b"hello\n", "line 1: expected a number, found 'hello'"),
            (b"# a poem\n\nthe quick brown fox\n\n", "line 3: expected three numbers, or columns called x, y and z, found 'the quick brown fox'"),
            (b"the quick brown fox\njumps over it all\n", "line 2: expected a number, found 'jumps'"),
        ]:
            self.refused(3, "standard input:" + message, "scene:box", "-", stdin=text)
            Path("damaged.csv").write_bytes(text)
            self.refused(3, "damaged.csv:" + message, "scene:box", "damaged.csv", "-o", "none.csv")
            self.assertFalse(os.path.exists("none.csv"))

    def test_damaged_arrays(self):
        header = lambda text: b"\x93NUMPY\1\0" + struct.pack("<H", len(text)) + text.encode()
        dictionary = lambda kind, shape: header(f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n")
        good = bytes(24 * 4)
        for content, message in [
            (dictionary("<f8", "(4, 2)") + good, "its shape is (4, 2)"),
            (dictionary("<f8", "(12,)") + good, "its shape is (12)"),
            (dictionary("<f8", "(4, 3)") + good[:-1], "its shape promises 4 points, more than the file can hold"),
            (dictionary("<f8", f"({2**62}, 3)") + good, "more than the file can hold"),
            (dictionary("<i8", "(4, 3)") + good, "its type is '<i8'; save points as float64 or float32"),
            (dictionary("|O", "(4, 3)") + good, "its type is '|O'"),
            (header("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (4,), }\n") + good, "no plain array"),
            (b"\x93NUMPY\1\0\xff\xff{", "its header reaches past its end"),
            (b"\x93NUM", "its content is not that of a .npy file"),
        ]:
            Path("damaged.npy").write_bytes(content)
            self.refused(3, message, "scene:box", "damaged.npy")
            with zipfile.ZipFile("damaged.npz", "w") as archive:
                archive.writestr("points.npy", content)
            if b"NUMPY" in content:
                self.refused(3, message, "scene:box", "damaged.npz")
        np.savez("two.npz", a=np.zeros((1, 3)), b=np.zeros((1, 3)))
        self.refused(3, "it has 2 arrays, none of them called points", "scene:box", "two.npz")
        np.savez("crc.npz", points=self.points)
        content = bytearray(Path("crc.npz").read_bytes())
        content[700] ^= 1
        Path("crc.npz").write_bytes(content)
        self.refused(3, "crc.npz:", "scene:box", "crc.npz")

    def test_damaged_clouds(self):
        good = ply_bytes(self.points)
        for content, message in [
            (good[:-1], "vertex 499: the file ends here, of 500"),
            (good.replace(b"vertex 500", b"vertex 4611686018427387904"), "more than the file can hold"),
            (good.replace(b"property double y\n", b""), "element vertex needs properties x, y and z"),
            (good.replace(b"element vertex", b"element points"), "there are no vertices"),
            (good.replace(b"list uchar float", b"list float float"), "the count of a list must be an integer"),
            (b"ply\n", "the header"),
        ]:
            Path("damaged.ply").write_bytes(content)
            self.refused(3, message, "scene:box", "damaged.ply")

    def test_names(self):
        np.save("p.npy", self.points)
        self.refused(2, "p.npy: it is an input", "scene:box", "p.npy", "-o", "p.npy", "-f")
        self.refused(2, "use .csv, .ply, .npy or .npz", "scene:box", "p.npy", "-o", "a.vti")
        self.refused(2, "--with 'near': give point, closest, triangle", "scene:box", "p.npy", "--with", "closest,near")
        self.refused(2, "--with winding is for signs", "scene:box", "p.npy", "--with", "winding", "--sign", "none")
        self.refused(2, "points have no samples", "scene:box", "p.npy", "--sign", "shell:3s")
        self.refused(3, "no such file", "scene:box", "absent.csv")
        self.refused(3, "points are not read from .obj files", "scene:box", self.file("mesh.obj", b"v 0 0 0\n"))
        self.refused(3, "its content is not that of a .npy file", "scene:box", self.file("text.npy", b"1,2,3\n"))
        self.expect_distances(self.file("no_extension", Path("p.npy").read_bytes()), self.points)
        self.done("scene:box", "p.npy", "-o", "kept.csv")
        self.refused(2, "kept.csv: it exists", "scene:box", "p.npy", "-o", "kept.csv")

    def file(self, name, content):
        Path(name).write_bytes(content)
        return name

    def test_scale(self):
        text = self.done("scene:box", "-", "--scale", "2", stdin=b"5,0,0\n").stdout
        self.assertEqual(text, b"distance\n3\n")  # points are not scaled
        self.assertEqual(self.done("scene:box", "-", "--sign", "none", stdin=b"0,0,0\n").stdout, b"distance\n0.5\n")

    def test_queries_in_files(self):
        np.save("p.npy", self.points)
        built = subprocess.run([STANDOFF, "build", "scene:box", "-o", "box.query", "--sign", "auto"], capture_output=True)
        self.assertEqual(built.returncode, 0, built.stderr)
        fresh = self.done("scene:box", "p.npy", "--with", ALL + ",winding", "--sign", "auto")
        again = self.done("box.query", "p.npy", "--with", ALL + ",winding")
        self.assertEqual(again.stdout, fresh.stdout)
        distance = np.array(csv_columns(fresh.stdout)["distance"], dtype=float)
        inside = (np.abs(self.points) < HALF).all(axis=1)
        np.testing.assert_allclose(distance, distances_to_box(self.points), atol=1e-14)
        np.testing.assert_array_equal(np.array(csv_columns(fresh.stdout)["winding"], dtype=float)[2:], inside[2:])
        self.refused(2, "box.query: a query has its scale and sign", "box.query", "p.npy", "--sign", "auto")
        self.refused(2, "box.query: a query has its scale and sign", "box.query", "p.npy", "--scale", "2")
        content = bytearray(Path("box.query").read_bytes())
        content[200] ^= 1
        self.refused(3, "it is damaged: its checksum", self.file("bad.query", content), "p.npy")
        self.refused(3, "this is no query", self.file("none.query", b"solid\n"), "p.npy")
        self.refused(3, "the content is a query", self.file("named.stl", Path("box.query").read_bytes()), "p.npy")
        for words, message in [(["-o", "a.query", "--spacing", "1"], "--spacing is for bodies"),
                               (["-o", "a.body", "--sign", "auto"], "--sign is for queries")]:
            ran = subprocess.run([STANDOFF, "build", "scene:box", *words], capture_output=True)
            self.assertEqual(ran.returncode, 2, ran.stderr)
            self.assertIn(message, ran.stderr.decode())

    def test_emulated_gpu(self):
        np.save("p.npy", self.points)
        words = ["scene:fly:2000", "p.npy", "--with", ALL, "--sign", "auto"]
        self.assertEqual(self.done(*words, "--device", "emulated").stdout, self.done(*words, "--device", "cpu").stdout)

    def test_interrupt(self):
        with subprocess.Popen([STANDOFF, "points", "scene:box", "-", "-o", "a.csv"], stdin=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            process.stdin.write(b"1,2,3\n" * 100)
            process.stdin.flush()
            process.stderr.readline()  # the mesh is read
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(60), 130)
            self.assertIn(b"interrupted", process.stderr.read())
        self.assertEqual(os.listdir("."), [])

    def test_output_that_cannot_be_written(self):
        np.save("p.npy", self.points)
        with open("/dev/full", "wb") as full:
            ran = subprocess.run([STANDOFF, "points", "scene:box", "p.npy"], stdout=full, stderr=subprocess.PIPE)
        self.assertEqual(ran.returncode, 4, ran.stderr)
        self.refused(4, "absent does not exist", "scene:box", "p.npy", "-o", "absent/a.csv")
        os.mkfifo("pipe.npy")
        reader = os.open("pipe.npy", os.O_RDONLY | os.O_NONBLOCK)
        self.refused(4, "this format needs a file that can be rewritten", "scene:box", "p.npy", "-o", "pipe.npy")
        os.close(reader)


if __name__ == "__main__":
    unittest.main(verbosity=1, argv=sys.argv[:1])
