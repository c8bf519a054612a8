# SPDX-License-Identifier: Apache-2.0
"""Families of algorithms side by side: meshes, errors and tables, from values that nobody measured."""

import os
import sys
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np

BENCH = Path(os.environ["STANDOFF_SOURCE_DIR"]) / "bench"
sys.path.insert(0, str(BENCH))
import methods  # noqa: E402
import methods_page  # noqa: E402
import surface_check  # noqa: E402

CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
CUBE = np.array([(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
                 (1, 3, 5), (3, 7, 5)], dtype=np.uint32)


class Meshes(unittest.TestCase):
    def test_split_in_four(self):
        vertices, triangles = methods.split_in_four(*methods.split_in_four(CORNERS, CUBE))
        self.assertEqual(len(triangles), 16 * 12)
        self.assertEqual(surface_check.in_words(surface_check.closedness(vertices, triangles)), "closed, oriented, edges of two triangles")
        a, b, c = (vertices[triangles[:, n]] for n in range(3))
        self.assertAlmostEqual(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, 6)

    def test_ply(self):
        with tempfile.TemporaryDirectory() as folder:
            methods.write_ply(Path(folder) / "cube.ply", CORNERS, CUBE)
            content = (Path(folder) / "cube.ply").read_bytes()
            header, data = content.split(b"end_header\n", 1)
            self.assertIn(b"property double z", header)
            self.assertEqual(len(data), 8 * 24 + 12 * 13)


def case_of(distances, windings, closed=True):
    """A case whose samples are all of its grid, with steps of 2."""
    case = types.SimpleNamespace(spacing=2, samples=np.arange(len(distances)), distances=np.array(distances), windings=np.array(windings, np.int8),
                                 shape=types.SimpleNamespace(closed=closed))
    return lambda values, method: methods.Case.errors(case, values, method)


class Errors(unittest.TestCase):
    def errors(self, case, values, method):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "values.f32"
            np.array(values, np.float32).tofile(path)
            return case(path, method)

    def test_near_and_far(self):
        case = case_of([1, 1, 2, 10], [0, 1, 0, 0])
        row = self.errors(case, [2, -2, 5, -20], methods.Method("x", "python", []))
        self.assertEqual((row["near largest"], row["near wrong %"], row["near signs"], row["near exact %"]), ("0.5", "0", 3, "66.67"))
        self.assertEqual((row["far largest"], row["far wrong %"]), ("0", "100"))

    def test_bands_have_no_far_samples(self):
        row = self.errors(case_of([1, 10], [0, 0]), [2, 8], methods.Method("x", "python", [], methods.BAND))
        self.assertEqual(row["near checked"], 1)
        self.assertNotIn("far largest", row)

    def test_what_is_not_a_number_is_infinitely_wrong(self):
        row = self.errors(case_of([1, 10], [0, 0]), [np.nan, 20], methods.Method("x", "python", []))
        self.assertEqual(row["near largest"], "inf")

    def test_open_and_unclear_samples_have_no_side(self):
        self.assertNotIn("near wrong %", self.errors(case_of([1], [0], closed=False), [-2], methods.Method("x", "python", [])))
        self.assertNotIn("near wrong %", self.errors(case_of([1], [methods.UNCLEAR]), [-2], methods.Method("x", "python", [])))

    def test_solids_are_not_asked_inside_where_parts_overlap(self):
        solid = methods.Method("x", "python", [], solid=True)
        self.assertEqual(self.errors(case_of([1, 1, 1], [0, 1, 2]), [2, -9, -9], solid)["near largest"], "0")
        self.assertEqual(self.errors(case_of([1, 1, 1], [0, 1, 1]), [2, -9, -9], solid)["near largest"], "3.5")


class Rows(unittest.TestCase):
    def test_done(self):
        self.assertTrue(methods.is_done({"note": ""}, 10))
        self.assertTrue(methods.is_done({"note": "> 10 s"}, 10))
        self.assertFalse(methods.is_done({"note": "> 10 s"}, 60))
        self.assertFalse(methods.is_done({"note": "not installed"}, 10))

    def test_names_differ_and_parts_name_methods(self):
        names = [method.name for method in methods.METHODS]
        self.assertEqual(len(names), len(set(names)))
        self.assertEqual(set(names), {name for part in methods_page.PARTS.values() for name in part})
        self.assertEqual([shape.name for shape in methods.SHAPES], list(methods_page.MESHES))

    def test_numbers(self):
        self.assertEqual([methods_page.three(text) for text in ("", "0", "0.000001234", "0.1234", "inf")], ["", "0", "1.2e-06", "0.123", "inf"])


if __name__ == "__main__":
    unittest.main()
