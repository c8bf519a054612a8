# SPDX-License-Identifier: Apache-2.0
"""The tables of bench/collision.py, from drivers that only pretend to measure: what is asked of them, which of several
processes counts, and what is said of a peer that was stopped."""

import contextlib
import csv
import io
import json
import os
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

BENCH = Path(os.environ["STANDOFF_SOURCE_DIR"]) / "bench"
sys.path.insert(0, str(BENCH))
import collision  # noqa: E402
import harness  # noqa: E402
import quotes  # noqa: E402

WORKLOADS = json.loads((BENCH / "workloads.json").read_text())


def line(query, ratio, **more):
    return {"query": query, "peer": "FCL", "poses": 1, "hits": 1, "differ": 0, "rounds": 5, "ratio": ratio, "standoff_s": 0.001,
            "peer_s": 0.001 * ratio, "standoff_late": False, "peer_late": False, "standoff_answer": 1, "peer_answer": 1,
            "standoff_build_s": 1, "peer_build_s": 1, **more}


class Pretended(harness.Drivers):
    """Answers each call for lines with the next of `ratios`; keeps what was asked."""

    def __init__(self, drivers, ratios):
        super().__init__("nowhere")
        self.drivers, self.ratios, self.asked = drivers, list(ratios), []

    def has(self, driver):
        return driver in self.drivers

    def run_lines(self, driver, args):
        self.asked.append((driver, args))
        ratio = self.ratios.pop(0)
        if driver == "collision":
            return [{"query": "collide", "poses": 10, "threads": 2, "rounds": 9, "one_s": 0.2, "many_s": 0.2 / ratio, "ratio": ratio}]
        questions = [question.split("@")[0] for question in args[args.index("--query") + 1:] if question[0] in "acds"]
        return [line(query, ratio, peer={"fcl": "FCL", "coal": "Coal"}[driver]) for query in questions]


def printed(run, *args):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        run(*args)
    return out.getvalue()


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        collision.results_folder = lambda: self.folder

    def test_late(self):
        late = line("distance", 5000.04, peer_s=120, peer_late=True, peer_answer=None)
        self.assertEqual((collision.ratio(late), collision.milliseconds(late, "peer")), ("> 5000.0x", "> 120000"))
        self.assertEqual(collision.ratio(line("distance", 0.01, standoff_s=120, standoff_late=True)), "< 0.01x")
        self.assertEqual(collision.ratio(late | {"standoff_late": True}), "-")
        self.assertEqual((collision.ratio(line("contacts", 0.00342)), quotes.short(0.0034)), ("0.0034x", "0.0034x"))

    def test_milliseconds(self):
        for seconds, text in [(120, "120000"), (0.0123, "12.3"), (2e-6, "0.00200")]:
            self.assertEqual(collision.milliseconds(line("collide", 1, standoff_s=seconds), "standoff"), text)

    def test_bounds_are_numbers_of_a_table(self):
        self.assertIn("|---:|---|", harness.markdown([{"a": "> 4.0x", "b": "x > 4"}, {"a": "1.0x", "b": 1}]))

    # A new machine has none; the tables used to end in a trace.
    def test_without_git(self):
        with unittest.mock.patch.dict(os.environ, PATH=""):
            self.assertIn("standoff: unknown", harness.machine_lines("nowhere"))

    def test_contests(self):
        pair = {"name": "horse-bunny", "args": ["--a", "horse"], "ask": {"collide": ["gap=1,poses=9", "depth=2"], "long": ["gap=1,way=5"]}}
        drivers = Pretended(["fcl", "coal", "collision"], [9, 0.4, 1.7, 1.9, 1.8])
        workloads = {"collision": WORKLOADS["collision"] | {"pairs": [pair]}, "batches": WORKLOADS["batches"][:1]}
        text = printed(collision.run, drivers, workloads, True, None, None, "nowhere", "a noisy day")
        self.assertEqual([driver for driver, _ in drivers.asked], ["fcl", "coal"] + ["collision"] * 3)
        args = drivers.asked[0][1]
        self.assertEqual(args[args.index("--query") + 1:], ["collide@gap=1,poses=9", "collide@depth=2", "sweep@gap=1,way=5"])
        self.assertRegex(text, r"horse-bunny \| yes or no \| 1 apart \| FCL \| .* \| 9\.0x \| - \| - \| 4x \|")
        self.assertRegex(text, r"horse-bunny \| long sweep \| 1 apart, way 5 \| Coal \| .* \| 0\.40x \| - \| - \| 8x \|")
        self.assertRegex(text, r"yes or no \| 10 \| 0\.2000 \| 0\.1111 \| 1\.80x \| 1\.8x \| yes \|")
        for name, count in (("collision.csv", 6), ("collision-threads.csv", 1)):
            comments, rows = quotes.read(self.folder / name)
            self.assertEqual(len(rows), count)
            self.assertIn("note: a noisy day", comments)

    # A run of all pairs takes an hour: what one that was stopped has measured counts, unless the code is another one now.
    def test_goes_on_where_it_stopped(self):
        pairs = [{"name": name, "args": [], "ask": {"collide": ["gap=1"]}} for name in ("first", "second")]
        workloads = {"collision": WORKLOADS["collision"] | {"pairs": pairs}, "batches": []}
        drivers = Pretended(["fcl"], [3])
        with self.assertRaises(IndexError):  # it is stopped at the second pair
            printed(collision.run, drivers, workloads, True, None, None, "nowhere")
        self.assertEqual([row["pair"] for row in quotes.read(self.folder / "collision.csv")[1]], ["first"])
        drivers = Pretended(["fcl"], [2])
        printed(collision.run, drivers, workloads, True, None, None, "nowhere", "", True, 2, 20)
        self.assertEqual([row["pair"] for row in quotes.read(self.folder / "collision.csv")[1]], ["second", "first"])
        self.assertEqual(drivers.asked[0][1][:4], ["--enough", "2", "--limit", "20"])
        with unittest.mock.patch.object(harness, "commit", lambda: "another"):
            drivers = Pretended(["fcl"], [2, 2])
            printed(collision.run, drivers, workloads, True, None, None, "nowhere", "", True)
        self.assertEqual(len(drivers.asked), 2)

    def test_placings(self):
        for where, text in [("gap=0.1,poses=9", "0.1 apart"), ("depth=2,way=3", "2 deep, way 3"), ("hits=0", "in its box, free"),
                            ("hits=0.45,poses=10", "in its box, 45 % touching"), ("hits=1", "in its box, touching"),
                            ("spin=5,dy=2,rotate=90", "in its place, spun by at most 5 degrees, moved by at most 2 along y, turning by 90 degrees"),
                            ("turn=1", "in place, turned by at most 1 degree"), ("0,1,-0.5,way=2", "moved by 0, 1, -0.5, way 2")]:
            self.assertEqual(collision.placing(where), text)

    def test_every_pair(self):
        job = WORKLOADS["collision"]
        self.assertGreaterEqual(len(job["pairs"]), 15)
        for pair in job["pairs"]:
            self.assertEqual(set(pair["ask"]), set(job["queries"]), pair["name"])
            places = [place for places in pair["ask"].values() for place in places]
            self.assertTrue(all(collision.placing(place) for place in places))

    # The worst must not hide behind the median, nor a ratio below one behind its rounding.
    def test_summary(self):
        ratios = ["2.0x", "0.98x", "> 30.0x", "-", "12.4x"]
        rows = [{"pair": f"p{n}", "query": "least distance", "place of b": "1 apart", "peer": "FCL", "ratio": ratio, "poses": "10",
                 "at least": "10x", "answers that differ": str(n)} for n, ratio in enumerate(ratios)]
        (line,) = quotes.summary(rows, True)
        self.assertEqual(line["worst median pose"], "-")
        (line,) = quotes.summary([row | {"of medians": f"{n + 2.5}x"} for n, row in enumerate(rows)], True)
        self.assertEqual(line["worst median pose"], "2.5x (p0, 1 apart)")
        self.assertEqual(quotes.shortfall(rows), 0.098)
        self.assertEqual((line["worst case"], line["median case"], line["best case"]), ("0.98x (p1, 1 apart)", "7.2x", "> 30x (p2, 1 apart)"))
        self.assertEqual((line["cases"], line["cases slower"], line["answers"], line["that differ"]), (5, 1, 50, 10))
        self.assertEqual([quotes.short(number) for number in (0.996, 0.994, 9.96, 9.94)], ["1.0x", "0.99x", "10x", "9.9x"])

    def test_markers(self):
        text = "a\n<!-- x: by y -->\nold\n<!-- end of x -->\nb"
        self.assertEqual(quotes.between_markers(text, "x", "new"), "a\n<!-- x: by y -->\n\nnew\n\n<!-- end of x -->\nb")
        for wrong in ("", text + text):
            with self.assertRaises(SystemExit):
                quotes.between_markers(wrong, "x", "new")

    # Measured anew, or edited by hand: script/bench quote writes them again.
    def test_documentation_quotes_the_csv_file(self):
        for path, text in quotes.pages().items():
            self.assertEqual(path.read_text(), text, f"{path} is not what bench/results says; run bench/run.py quote")

    def test_without_peers(self):
        drivers = Pretended(["fcl", "collision"], [1.5])
        printed(collision.run, drivers, WORKLOADS, False, "batch-sweep", 1, "nowhere")
        self.assertEqual([driver for driver, _ in drivers.asked], ["collision"])
        self.assertEqual(list(self.folder.glob("*.csv")), [])


if __name__ == "__main__":
    unittest.main()
