# SPDX-License-Identifier: Apache-2.0
"""Options that would say nothing are refused, and so is what would silently do something else."""

import pathlib

from program import run

served = "only for pages that are written"
for options in (["--size", "9,9,9"], ["--spacing", "1"], ["--padding", "2"], ["--nearest"], ["--json"]):
    run("view", "scene:box", "--no-browser", *options, code=2, says=served)
run("view", "scene:box", "-o", "page.html", "--port", "8123", code=2, says="with -o nothing is served")
run("fly", "--labyrinth", "scene:labyrinth:20000", "--steps", "2", "--port", "8123", code=2, says="without --view")
run("fly", "--labyrinth", "scene:labyrinth:20000", "--steps", "2", "--speed", "1e4", code=2, says="longer than the labyrinth")

# Decimal commas: without this the first line would count as names of columns, and its point be lost.
pathlib.Path("commas.csv").write_text("1,5;2;3\n4;5;6\n7;8;9\n")
run("points", "scene:box", "commas.csv", code=3, says="decimals with a point")
pathlib.Path("names.csv").write_text("a1;b;c\n4;5;6\n")
run("points", "scene:box", "names.csv")
