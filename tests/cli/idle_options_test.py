# SPDX-License-Identifier: Apache-2.0
"""Options that would say nothing are refused, and so is what would silently do something else."""

import os
import pathlib
import subprocess


def refused(*words, code, what):
    ran = subprocess.run([os.environ["STANDOFF"], *words], capture_output=True, text=True, timeout=60)
    assert ran.returncode == code and what in ran.stderr, (words, ran.returncode, ran.stderr)


served = "only for pages that are written"
for options in (["--size", "9,9,9"], ["--spacing", "1"], ["--padding", "2"], ["--nearest"], ["--json"]):
    refused("view", "scene:box", "--no-browser", *options, code=2, what=served)
refused("view", "scene:box", "-o", "page.html", "--port", "8123", code=2, what="with -o nothing is served")
refused("fly", "--labyrinth", "scene:labyrinth:20000", "--steps", "2", "--port", "8123", code=2, what="without --view")
refused("fly", "--labyrinth", "scene:labyrinth:20000", "--steps", "2", "--speed", "1e4", code=2, what="longer than the labyrinth")

# Decimal commas: without this the first line would count as names of columns, and its point be lost.
pathlib.Path("commas.csv").write_text("1,5;2;3\n4;5;6\n7;8;9\n")
refused("points", "scene:box", "commas.csv", code=3, what="decimals with a point")
pathlib.Path("names.csv").write_text("a1;b;c\n4;5;6\n")
assert subprocess.run([os.environ["STANDOFF"], "points", "scene:box", "names.csv"], capture_output=True).returncode == 0
