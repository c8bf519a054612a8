# SPDX-License-Identifier: Apache-2.0
"""Points, surfaces, files and sidecars beside peers: the checks of answers against closed forms, and tables from drivers that
only pretend to measure."""

import contextlib
import io
import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

BENCH = Path(os.environ["STANDOFF_SOURCE_DIR"]) / "bench"
sys.path.insert(0, str(BENCH))
import exact_points  # noqa: E402
import field_files  # noqa: E402
import harness  # noqa: E402
import limits  # noqa: E402
import output_quotes  # noqa: E402
import peer_points  # noqa: E402
import pictures  # noqa: E402
import points  # noqa: E402
import quotes  # noqa: E402
import sidecar_costs  # noqa: E402
import surface_check  # noqa: E402
import surfaces  # noqa: E402

CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
CUBE = np.array([(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
                 (1, 3, 5), (3, 7, 5)])


def cube_distance(p):
    outside = np.linalg.norm(np.maximum(np.maximum(-p, p - 1), 0))
    return outside if outside > 0 else min(p.min(), (1 - p).min())


class Exact(unittest.TestCase):
    def setUp(self):
        self.points = np.random.default_rng(1).uniform(-1, 2, (200, 3))
        self.distances = np.array([cube_distance(p) for p in self.points])
        self.inside = ((self.points > 0) & (self.points < 1)).all(axis=1)

    def test_cube(self):
        found = exact_points.compare(CORNERS, CUBE, self.points, np.where(self.inside, -1, 1) * self.distances, True)
        self.assertLess(found["largest_error"], 1e-14)
        self.assertEqual((found["wrong_signs"], found["compared"]), (0, 200))

    def test_errors_are_found(self):
        wrong = np.where(self.inside, -1, 1) * self.distances
        wrong[7] += 0.25 * np.sign(wrong[7])
        wrong[3] *= -1
        found = exact_points.compare(CORNERS, CUBE, self.points, wrong, True)
        self.assertAlmostEqual(found["largest_error"], 0.25)
        self.assertEqual(found["wrong_signs"], 1)

    def test_triangles_without_area(self):
        a, b, c = (np.array([v], dtype=float) for v in ((0, 0, 0), (2, 0, 0), (1, 0, 0)))
        self.assertAlmostEqual(exact_points.distance(np.array((1, 3, 0)), a, b, c), 3)
        self.assertAlmostEqual(exact_points.distance(np.array((-3, 4, 0)), a, a, a), 5)

    def test_winding_numbers_add_up(self):
        twice = [np.concatenate([CORNERS[CUBE[:, n]]] * 2) for n in range(3)]
        self.assertAlmostEqual(exact_points.winding_number(np.array((0.5, 0.4, 0.3)), *twice), 2)
        self.assertAlmostEqual(exact_points.winding_number(np.array((0.5, 0.4, 1.3)), *twice), 0)


class Surfaces(unittest.TestCase):
    def faults(self, triangles, vertices=CORNERS):
        return {key: value for key, value in surface_check.closedness(vertices, triangles).items() if value and key != "triangles"}

    def test_closed(self):
        self.assertEqual(self.faults(CUBE), {})
        self.assertEqual(self.faults(np.arange(36).reshape(-1, 3), CORNERS[CUBE].reshape(-1, 3)), {})  # unwelded
        self.assertEqual(surface_check.in_words(surface_check.closedness(CORNERS, CUBE)), "closed, oriented, edges of two triangles")

    def test_faults(self):
        self.assertEqual(self.faults(CUBE[1:]), {"open_edges": 3, "unoriented_edges": 3})
        self.assertEqual(self.faults(np.vstack([CUBE[:1, ::-1], CUBE[1:]])), {"unoriented_edges": 3})
        self.assertEqual(self.faults(np.vstack([CUBE, CUBE[:1], CUBE[:1, ::-1]])), {"nonmanifold_edges": 3})
        self.assertEqual(self.faults(np.vstack([CUBE, [(0, 1, 1)]])), {"degenerate": 1})
        self.assertEqual(self.faults(np.empty((0, 3), dtype=int)), {})


class Pretended(harness.Drivers):
    """Each driver takes its number of seconds; points lie outside the cube."""

    def __init__(self, seconds):
        super().__init__("nowhere")
        self.seconds, self.asked = seconds, []

    def has(self, driver):
        return driver in self.seconds

    def run_lines(self, driver, args):
        self.asked.append(driver)
        options = dict(zip(args, args[1:]))
        if "--save" in options:
            folder = Path(options["--save"])
            folder.mkdir(exist_ok=True)
            CORNERS.tofile(folder / "vertices.f64")
            CUBE.astype(np.uint32).tofile(folder / "triangles.u32")
            np.full((5, 3), 2.0).tofile(folder / "points.f64")
        if "--answers" in options:
            np.full(5, np.sqrt(3)).tofile(options["--answers"])
        one = self.seconds[driver]
        line = {"driver": driver, "triangles": 12, "points": 5, "bytes": 1000, "memory_peak": 2e6, "memory_before": 1e6, "surface_triangles": 12}
        for name in ("build", "given", "morton", "bounded", "iso", "write", "band", "nearest", "first", "turns", *sidecar_costs.KINDS[1:]):
            if driver != "points" or name in ("build", "given"):
                line |= {f"{name}_s": one, f"{name}_cpu_s": 2 * one}
        return [line]


def printed(run, *args):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        run(*args)
    return out.getvalue()


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for module in (points, surfaces, field_files, sidecar_costs, limits, pictures):
            module.results_folder = lambda: self.folder
        points.peer_python = surfaces.peer_python = pictures.peer_python = lambda *_: None

    def test_points(self):
        job = {"meshes": [{"name": "cube", "what": "cube", "args": []}], "sets": {"box": "in the box", "near": "near"}, "count": 5,
               "rounds": 2, "checked": 3, "checked_pairs": 1000, "at_least": {"box": 5, "near": 3, "signed": 10, "build": 1},
               "goal": {"box": 15, "near": 10, "signed": 50, "build": 5}}
        drivers = Pretended({"points": 0.5, "embree_points": 2})
        text = printed(points.run, drivers, {"points": job}, True, None, None, "nowhere", "a noisy day")
        self.assertEqual(drivers.asked.count("embree_points"), 4)  # not with a sign
        self.assertRegex(text, r"cube \| 12 \| in the box \| 5 \| no .* embree \| .* \| 4\.00x \| 4\.00x \| 5x \| 15x")
        comments, rows = quotes.read(self.folder / "points.csv")
        self.assertIn("note: a noisy day", comments)
        self.assertEqual([row["wrong signs"] for row in rows], ["0"] * 4)
        (line, near) = output_quotes.points_summary(rows)
        self.assertEqual((line["worst"], line["median"], near["at least"]), ("4.00x (cube, embree)", "4.00x", "3x"))
        self.assertIn("| embree | 1 | 4.00x (cube) |", output_quotes.build(quotes.read(self.folder / "points-build.csv")[1]))

    # Where signs differ the exact winding number says whose is wrong.
    def test_chosen(self):
        for name, values in (("standoff", np.ones(1000)), ("libigl", np.where(np.arange(1000) == 778, -1.5, 1))):
            values.tofile(self.folder / f"{name}.f64")
        CORNERS.tofile(self.folder / "vertices.f64")
        CUBE.astype(np.uint32).tofile(self.folder / "triangles.u32")
        job = {"checked": 10, "checked_pairs": 1e9}
        some = points.checked_points(self.folder, ["standoff", "libigl"], 12, job, True)
        self.assertEqual((len(some), 778 in some, 0 in some, 999 in some), (11, True, True, True))
        self.assertEqual(len(points.checked_points(self.folder, ["standoff", "libigl"], 2e8, job, False)), 5)
        self.assertEqual(points.against_libigl(self.folder, ["standoff", "libigl"]), {"from libigl": "5.0e-01", "signs unlike libigl's": 1})

    # The better peer counts, and the worst mesh.
    def test_summary(self):
        rows = [{"mesh": mesh, "points": "box", "sign": "no", "peer": peer, "ratio": f"{ratio}x", "at least": "5x", "goal": "15x"}
                for mesh, peer, ratio in (("a", "embree", 9), ("a", "fcpw", 3), ("b", "embree", 4), ("b", "fcpw", 8), ("c", "fcpw", 12))]
        (line,) = output_quotes.points_summary(rows)
        self.assertEqual((line["cases"], line["worst"], line["median"], line["best"]), (3, "3x (a, fcpw)", "4.00x", "12x"))

    def test_surfaces(self):
        job = {"fields": [{"name": "band", "what": "a band", "args": []}], "at_least": 2, "goal": 5, "rounds": 1}
        text = printed(surfaces.run, Pretended({"iso": 0.1, "openvdb_iso": 0.3}), {"iso": job}, True, None, None, "nowhere")
        self.assertRegex(text, r"openvdb_iso \| 300\.0 \| 600\.0 \| 12 \| closed.* \| 3\.00x")
        self.assertIn("| openvdb_iso | 1 | 3.00x (a band) |", output_quotes.surfaces(quotes.read(self.folder / "iso.csv")[1]))

    def test_files(self):
        job = {"name": "band", "what": "a band", "args": [], "formats": ["vdb"], "codecs": {"vdb": ["zip"]}, "repeats": 1, "rounds": 1,
               "most": {"seconds": 10, "megabytes": 1}}
        text = printed(field_files.run, Pretended({"files": 1, "openvdb_files": 2}), {"files": [job]}, True, None, None, "nowhere")
        self.assertRegex(text, r"vdb \| standoff \| 1\.0000 \| 2\.0000 \| 0\.0 \| 2 \| 1 \|.*10 s, 1 MB \| no \|")
        self.assertRegex(text, r"vdb \| openvdb_files, zip \| .* 2\.00x \| 2\.00x \|")

    def test_pictures(self):
        job = {"pictures": [{"name": "box", "what": "a box", "size": "64x48", "at_most": "1.5 s", "goal": "0.5 s", "args": []}], "rounds": 1}
        text = printed(pictures.run, Pretended({"render": 0.5}), {"render": job}, True, None, None, "nowhere")
        self.assertIn("| a box | standoff | 0.500 |", text)
        self.assertIn("1.5 s | 0.5 s |", text)

    def test_sidecars(self):
        job = {"fields": [{"name": "band", "what": "a band", "args": []}], "most": 15, "goal": 5, "rounds": 1}
        text = printed(sidecar_costs.run, Pretended({"sidecars": 1}), {"sidecars": job}, None, None, "nowhere")
        self.assertIn("| a band | 12 | 1000.0 | 2000.0 | 0.0 % | 100.0 % |", text)

    # Reading 1e6 bytes, writing 2e6 and measuring 5e6 samples take 1 + 4 + 15 ms at least.
    def test_limits(self):
        field = {"sign": "", "triangles": 12, "mesh_bytes": 1e6, "output_bytes": 2e6, "samples_band": 5e6, "samples_examined": 3e7,
                 "warm_cpu_s": 0.05, "cold_cpu_s": 0.08}
        answers = {"limits": {"read_s_per_byte": 1e-9, "write_s_per_byte": 2e-9, "measure_s": 3e-9}, "standoff": field}
        asked = []

        class Answering(harness.Drivers):
            def run_lines(self, driver, args):
                asked.append(args)
                return [answers[driver]]

        contests = [{"name": name, "what": f"a {name}", "args": []} for name in ("band-2-cube", "full-cube")]
        text = printed(limits.run, Answering("nowhere"), {"contests": contests}, None, "nowhere")
        self.assertIn("| 1.0 | 15.0 | 4.0 | 20.0 | 50.0 | 80.0 | 2.5 | 6 |", text)
        self.assertEqual([("--threads" in args, "--sign" in args) for args in asked[1:]], [(True, False), (True, True), (True, False)])
        self.assertEqual(len(quotes.read(self.folder / "limits.csv")[1]), 3)

    def test_morton_order(self):
        grid = np.array([(x, y, z) for x in range(4) for y in range(4) for z in range(4)], dtype=float)
        ordered = grid[peer_points.morton_order(grid)]
        self.assertEqual(len(np.unique(ordered, axis=0)), 64)
        for block in ordered.reshape(8, 8, 3):  # each run of eight fills a cube
            self.assertTrue((np.ptp(block, axis=0) == 1).all())


if __name__ == "__main__":
    unittest.main()
