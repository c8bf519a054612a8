# SPDX-License-Identifier: Apache-2.0
"""The code in docs/python.md, the quickstart, the how-tos and the READMEs runs as it stands there, and so do the examples in docstrings."""

import doctest
import importlib
import pkgutil
import re
import shutil
from pathlib import Path

import pytest
import standoff

ROOT = Path(__file__).resolve().parents[2]
BUNNY = Path("/usr/share/glmark2/models/bunny.obj")


def fences(page: Path) -> list[tuple[int, str]]:
    """The blocks of Python on a page, and the lines they begin at."""
    text = page.read_text()
    blocks = re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [(text.count("\n", 0, block.start(1)), block[1]) for block in blocks]


@pytest.mark.parametrize(
    ("page", "least_blocks", "least_prints"),
    [
        ("docs/python.md", 10, 6),
        ("docs/python_arrays.md", 4, 0),
        ("docs/scale.md", 1, 3),
        ("docs/start.md", 1, 1),
        ("docs/howto_dataset.md", 1, 2),
        ("docs/howto_exchange.md", 1, 1),
        ("docs/howto_print.md", 1, 0),
        ("docs/howto_robot.md", 1, 3),
        ("docs/howto_solver.md", 1, 2),
        ("docs/howto_watertight.md", 1, 2),
        ("python/README.md", 1, 0),
        ("README.md", 1, 0),
    ],
)
def test_page_runs(page, least_blocks, least_prints, tmp_path, monkeypatch, capsys):
    """And `print(...)  # words` prints these words; dots stand for any."""
    found = fences(ROOT / page)
    if page == "docs/scale.md":
        pytest.importorskip("distributed")
    assert len(found) >= least_blocks, "are the blocks still marked python?"
    shutil.copy(BUNNY, tmp_path)
    monkeypatch.chdir(tmp_path)
    names, prints = {}, 0
    for line, code in found:
        capsys.readouterr()
        # Blank lines before, so that errors name the line of the page.
        exec(compile("\n" * line + code, str(ROOT / page), "exec"), names)  # noqa: S102
        printed = capsys.readouterr().out
        for words in re.findall(r"^ *print\(.*\) +# (.*)$", code, re.MULTILINE):
            assert re.search(".*".join(map(re.escape, words.split("..."))), printed), f"{words} is not in: {printed}"
            prints += 1
    assert prints >= least_prints


@pytest.mark.parametrize("name", [module.name for module in pkgutil.iter_modules(standoff.__path__)])
def test_docstrings_run(name):
    if name == "__main__":
        return
    if name == "dask":
        pytest.importorskip("distributed")
    failed, _ = doctest.testmod(importlib.import_module(f"standoff.{name}"), extraglobs={"standoff": standoff})
    assert failed == 0


def test_guide_names_every_exception():
    text = (ROOT / "docs/python.md").read_text()
    kinds = [
        n for n in standoff.__all__ if isinstance(getattr(standoff, n), type) and n.endswith("Error") and n != "Error"
    ]
    assert [n for n in kinds if f"| `{n}` |" not in text] == []
    for name, base in re.findall(r"^\| `(\w+Error)` \| `(\w+)` \|", text, re.MULTILINE):
        assert base in [kind.__name__ for kind in getattr(standoff, name).__mro__], f"{name} is no {base}"
