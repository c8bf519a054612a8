# SPDX-License-Identifier: Apache-2.0
"""The recipes of docs/batch.md: Slurm's array, GNU parallel and make do what one run does. What is not installed is passed
over; of Slurm only what it sets is needed."""

import json
import os
import pathlib
import re
import shutil
import subprocess

STANDOFF = pathlib.Path(os.environ["STANDOFF"])
PAGE = (pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"]) / "docs" / "batch.md").read_text()
RECIPES = dict(re.findall(r"^`([\w.]+)`:\n\n```text\n(.*?)^```$", PAGE, re.M | re.S))
SURROUNDINGS = {**os.environ, "PATH": f"{STANDOFF.parent}:{os.environ['PATH']}"}
SCENES = [f"scene:sphere:{100 + 7 * n}" for n in range(11)] + ["missing.obj"]


def run(*words, code=0, **more):
    done = subprocess.run(words, env={**SURROUNDINGS, **more}, cwd="work", capture_output=True, text=True, timeout=120)
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done


def result(folder):
    """All that a batch has made, without what differs from run to run."""
    folder = pathlib.Path("work", folder)
    rows = [json.loads(line) for line in (folder / "manifest.jsonl").read_text().splitlines()]
    rows = sorted(({**row, "seconds": None} for row in rows), key=lambda row: row["index"])
    return rows, {path.relative_to(folder): path.read_bytes() for path in (folder / "fields").rglob("*.npz")}


def begin(recipe):
    """An empty folder with the recipe and the list."""
    shutil.rmtree("work", ignore_errors=True)
    pathlib.Path("work").mkdir()
    pathlib.Path("work", "list.txt").write_text("\n".join(SCENES) + "\n")
    pathlib.Path("work", recipe).write_text(RECIPES[recipe].replace("-r 64", "-r 16"))


assert set(RECIPES) == {"fields.sbatch", "fields.sh", "Makefile"}, RECIPES.keys()
begin("fields.sh")
run("standoff", "batch", "list.txt", "-o", "whole", "-r", "16", "-t", "3s", "-q", code=3)
whole = result("whole")
assert len(whole[0]) == len(SCENES) and len(whole[1]) == len(SCENES) - 1

begin("fields.sbatch")
for part in range(1, 9):
    run("bash", "fields.sbatch", SLURM_CPUS_PER_TASK="1", SLURM_ARRAY_TASK_ID=str(part), SLURM_ARRAY_TASK_COUNT="8")
run("standoff", "batch", "--merge", "-o", "out", code=3)
assert result("out") == whole

if shutil.which("parallel"):
    begin("fields.sh")
    run("bash", "fields.sh", code=3)
    assert result("out") == whole
else:
    print("no GNU parallel here")

if shutil.which("make"):
    begin("Makefile")
    run("make", "-j", "2")
    assert result("out") == whole
    assert "up to date" in run("make").stdout
else:
    print("no make here")
