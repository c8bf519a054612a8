# SPDX-License-Identifier: Apache-2.0
"""The examples in docstrings and in README.md run, and every public thing has a docstring that says what it takes."""

import doctest
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest
import shapes
import standoff as so

PACKAGE = Path(__file__).parent.parent


def python_blocks(path):
    return re.findall(r"^```python\n(.*?)^```", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def test_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    so.Mesh(*shapes.sphere(16)).save("bunny.obj")
    blocks = python_blocks(PACKAGE / "README.md")
    assert blocks
    names = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), names)  # noqa: S102
    assert (tmp_path / "bunny.vdb").exists()


def test_the_first_example_of_the_package_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    so.Mesh(*shapes.sphere(16)).save("bunny.obj")
    example = "\n".join(line[4:] for line in so.__doc__.splitlines() if line.startswith("    "))
    assert "so.field" in example
    exec(example, {"points": [[0.0, 0, 0]]})  # noqa: S102


def test_doctests():
    for module in pkgutil.iter_modules(so.__path__):
        if module.name not in ("_core", "__main__"):
            found = doctest.testmod(importlib.import_module(f"standoff.{module.name}"), extraglobs={"standoff": so})
            assert found.failed == 0


def public():
    for name in so.__all__:
        thing = getattr(so, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            yield name, thing
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                value = value.__func__ if isinstance(value, (classmethod, staticmethod)) else value
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                    yield f"{name}.{member}", value


@pytest.mark.parametrize("name", dict(public()))
def test_docstrings(name):
    thing = dict(public())[name]
    text = inspect.getdoc(thing)
    assert text and text.split("\n")[0].rstrip().endswith((".", ":", "?"))
    if not inspect.isfunction(thing):
        return
    described = set(re.findall(r"[*\w]+", " ".join(re.findall(r"^ *((?:\w+, )*\w+):", text, re.MULTILINE))))
    arguments = [p for p in inspect.signature(thing).parameters if p not in ("self", "cls", "path", "points")]
    if "Args:" in text:
        assert not set(arguments) - described - {"options"}, "arguments that the docstring does not name"


def test_the_program():
    version = subprocess.run(
        [sys.executable, "-m", "standoff", "--version"], check=False, capture_output=True, text=True, timeout=60
    )
    assert (version.returncode, so.__version__ in version.stdout) == (0, True), version.stderr
    wrong = subprocess.run(
        [sys.executable, "-m", "standoff", "no-such-verb"], check=False, capture_output=True, text=True, timeout=60
    )
    assert wrong.returncode == 2 and wrong.stderr
