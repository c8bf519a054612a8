# SPDX-License-Identifier: Apache-2.0
"""The package's types, as mypy --strict sees them from a user's file."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import standoff as so

SAMPLE = Path(__file__).with_name("typing_sample.py")
MISTAKES = """
so.field("x.stl", resolutoin=3)
so.field("x.stl", resolution="3")
so.read(3)
so.distance("x.stl", [[0, 0, 0]], sign=None, closest=True).nearest
so.collide("a", "b", margin="1")
so.Sign("sideways")
so.surface(so.load("x.vdb"), method="cubes").faces.save()
so.fields(["x.stl"]).field
"""


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    folder = tmp_path_factory.mktemp("types")

    def run(path):
        # The installed package, or the one on PYTHONPATH.
        environment = {**os.environ, "MYPYPATH": str(Path(so.__file__).parent.parent)}
        if "site-packages" in so.__file__:
            del environment["MYPYPATH"]
        command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--cache-dir", folder]
        return subprocess.run(
            [*command, path], check=False, capture_output=True, text=True, timeout=300, env=environment, cwd=folder
        )

    return run


def test_typical_use_is_well_typed(check):
    done = check(SAMPLE)
    assert done.returncode == 0, done.stdout


def test_mistakes_are_found(check, tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import standoff as so\n" + MISTAKES.strip() + "\n", encoding="utf-8")
    done = check(wrong)
    found = {int(line.split(":")[1]) for line in done.stdout.splitlines() if "error:" in line}
    assert found == set(range(2, 2 + len(MISTAKES.strip().splitlines()))), done.stdout
