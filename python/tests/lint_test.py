# SPDX-License-Identifier: Apache-2.0
"""The package's sources are as ruff wants them, and well typed."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy
import pytest
from standoff import _core

PYTHON = Path(__file__).parents[1]


def run(*command, folder):
    command = [sys.executable, "-m", *command]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=300, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("command", [("check",), ("format", "--check")], ids=lambda command: command[0])
def test_sources_are_clean(command):
    run("ruff", *command, "--no-cache", "--config", str(PYTHON.parent / "pyproject.toml"), folder=PYTHON)


def test_sources_are_well_typed(tmp_path):
    # The build writes the stub of the compiled module beside it.
    shutil.copytree(PYTHON / "standoff", tmp_path / "standoff", ignore=shutil.ignore_patterns("*.so"))
    shutil.copy(Path(_core.__file__).with_name("_core.pyi"), tmp_path / "standoff")
    settings = ["--config-file", str(PYTHON.parent / "pyproject.toml")]
    if numpy.lib.NumpyVersion(numpy.__version__) < "2.3.0":
        settings += ["--allow-any-generics", "--allow-untyped-calls"]  # numpy had fewer types
    run("mypy", *settings, "--cache-dir", "/dev/null", "standoff", folder=tmp_path)
