# SPDX-License-Identifier: Apache-2.0
"""docs/defaults.md: what it says of Python are the defaults of the signatures."""

import ast
import inspect
import re
from pathlib import Path

import pytest
import shapes
import standoff as so

PAGE = Path(__file__).parents[2] / "docs" / "defaults.md"
CELLS = [line.split("|")[5] for line in PAGE.read_text().splitlines() if line.startswith("| ")][1:]
CALLS = [call for cell in CELLS for call in re.findall(r"`([^`]+)`", cell)]


@pytest.mark.parametrize("call", CALLS)
def test_a_default(call):
    name, parameter, value = re.fullmatch(r"([\w.]+)\((\w+)=(.+)\)", call).groups()
    function = so
    for part in name.split("."):
        function = getattr(function, part)
    assert inspect.signature(function).parameters[parameter].default == ast.literal_eval(value)


def test_there_are_rows_for_all():
    assert len(CELLS) == 8 and all("`" in cell for cell in CELLS)


def test_what_the_words_mean():
    cube = so.field(shapes.cube())
    assert max(cube.shape) == 256 and cube.thickness == float("inf") and cube.signed
    assert so.distance(shapes.cube(), [0, 0, 0]) == -0.5
    assert so.MeshQuery(shapes.cube()).distance([0, 0, 0]) == -0.5
    with pytest.warns(so.SignWarning):
        sheet = so.field(shapes.sheet(), resolution=8)
    assert not sheet.signed and sheet.sign.why
