# SPDX-License-Identifier: Apache-2.0
"""The package's sources are as ruff wants them, and well typed; its stub is that of the compiled module."""

import ast
import subprocess
import sys
from pathlib import Path

import numpy
import pytest
from standoff import _core

PYTHON = Path(__file__).parents[1]
SOURCES = PYTHON / "standoff"


@pytest.mark.parametrize(
    "command",
    [
        ("ruff", "check", "--no-cache"),
        ("ruff", "format", "--check", "--no-cache"),
        ("mypy", "--cache-dir", "/dev/null", "standoff"),
    ],
    ids=lambda command: " ".join(command[:2]),
)
def test_sources_are_clean(command):
    settings = ("--config-file" if command[0] == "mypy" else "--config", str(PYTHON.parent / "pyproject.toml"))
    if command[0] == "mypy" and numpy.lib.NumpyVersion(numpy.__version__) < "2.3.0":
        settings += ("--allow-any-generics", "--allow-untyped-calls")  # numpy had fewer types
    done = subprocess.run(
        [sys.executable, "-m", *command, *settings],
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
        cwd=PYTHON,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def interface(stub):
    """What the compiled module defines, without what functions return: the stub knows that better than nanobind."""
    tree = ast.parse(stub)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.returns = None
    return [ast.unparse(node) for node in tree.body if not isinstance(node, (ast.Import, ast.ImportFrom))]


def test_the_stub_is_that_of_the_module():
    generator = pytest.importorskip("nanobind.stubgen").StubGen(_core, quiet=True)
    generator.put(_core)
    # Rewrite it with `python -m nanobind.stubgen -m standoff._core`; keep the types of the arrays that are returned.
    assert interface((SOURCES / "_core.pyi").read_text(encoding="utf-8")) == interface(generator.get())
