# SPDX-License-Identifier: Apache-2.0
"""The notebooks of docs/notebooks run from their first cell to their last."""

import shutil
from pathlib import Path

import nbclient
import nbformat
import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 5


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("default")  # those of the client itself
def test_notebook(path, tmp_path, bunny_path):
    notebook = nbformat.read(path, as_version=4)
    shutil.copy(bunny_path, tmp_path / "bunny.obj")
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    told = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in told if output.output_type == "stream" and output.name == "stderr"]
