# SPDX-License-Identifier: Apache-2.0
"""The thesis's tables beside a GPU's times, and skip rules, from CSV files and from drivers that only pretend to measure."""

import contextlib
import io
import os
import sys
import tempfile
import unittest
from pathlib import Path

BENCH = Path(os.environ["STANDOFF_SOURCE_DIR"]) / "bench"
sys.path.insert(0, str(BENCH))
import harness  # noqa: E402
import quotes  # noqa: E402
import skip_rules  # noqa: E402
import thesis_tables  # noqa: E402


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


class Page(unittest.TestCase):
    """Of the CSV files in the repository."""

    def setUp(self):
        results = BENCH / "results"
        self.page = thesis_tables.page(results / quotes.QUOTED, results / quotes.GPU_QUOTED)
        self.card = (results / quotes.GPU_QUOTED / "machine.txt").read_text().splitlines()[1].split(",")[0].split()[-1]

    def table(self, number):
        lines = self.page.split(f"## Table {number}")[1].split("\n## ")[0].splitlines()
        head, _, *rows = [cells(line) for line in lines if line.startswith("|")]
        return [dict(zip(head, row)) for row in rows if len(row) == len(head)]

    # Two rows of Table 5.2 have one grid, and only their thicknesses tell them apart; the first examines eleven times as much.
    def test_times_of_the_gpu_are_the_rows_own(self):
        as_it_is, scaled = (float(row[f"thesis, {self.card}, ms"]) for row in self.table("5.2") if row["grid"] == "200x200x200")
        self.assertGreater(as_it_is, 4 * scaled)

    def test_no_time_is_missing(self):
        for number, count in (("5.1", 26), ("5.2", 8), ("5.3", 9), ("5.5", 6)):
            rows = self.table(number)
            self.assertEqual(len(rows), count)
            for row in rows:
                for method in ("thesis", "tiles"):
                    self.assertGreater(float(row[f"{method}, {self.card}, ms"]), 0, row)

    def test_what_was_not_measured_is_not_there(self):
        parts = {row["part left out"]: row for row in self.table("5.4") if "part left out" in row}
        self.assertEqual([name for name, row in parts.items() if row[f"{self.card}, ms"] == "-"],
                         ["the kernel", "closest point of the triangle", "squared distance", "vector from the sample to the triangle"])
        self.assertEqual((parts["nothing"][f"{self.card}, share"], parts["global memory write"]["2008, share"]), ("100 %", "72 %"))


class Pretended(harness.Drivers):
    def run(self, driver, args, repeats, **options):
        kinds = [("thesis", "none"), ("thesis", "neighbour"), ("thesis", "exact"), ("thesis", "any"), ("tiles", "none")]
        return {"triangles": 1000, "rules": [
            {"method": method, "rule": rule, "skipped": 400 if rule == "any" else 0, "samples_examined": 300 if rule == "any" else 1200,
             "compute_cpu_s": 0.25, "band": 90 if rule == "any" else 100, "band_exact": 100, "largest_error_samples": 0.5,
             "mean_error_samples": 0.125} | ({"rule_cpu_s": 0.5} if rule == "any" else {}) for method, rule in kinds]}


class SkipRules(unittest.TestCase):
    def test_table(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            skip_rules.results_folder = lambda: Path(folder)
            skip_rules.run(Pretended("nowhere"), None, "nowhere", "a noisy day")
            comments, rows = quotes.read(Path(folder) / "skip.csv")
        self.assertIn("note: a noisy day", comments)
        lines = skip_rules.table(rows)
        self.assertEqual(len(lines), 16)  # eight meshes, two grids
        self.assertEqual((lines[0]["mesh"], lines[1]["mesh"], lines[2]["mesh"]), ("Process (SINTEF)", "", "Catapult"))
        self.assertEqual((lines[0]["grid"], lines[1]["grid"]), ("5x5x5", "402x400x403"))
        first = lines[0]
        self.assertEqual((first["any drops"], first["any examines"], first["any, band lost"]), ("400", "25 %", "10.0 %"))
        self.assertEqual((first["any, s"], first["of it the rule, s"], first["none, s"]), ("0.750", "0.500", "0.250"))


if __name__ == "__main__":
    unittest.main()
