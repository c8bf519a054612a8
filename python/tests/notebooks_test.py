# SPDX-License-Identifier: Apache-2.0
"""The notebooks of docs/notebooks run from their first cell to their last.

``python python/tests/notebooks_test.py`` stores what their cells return now.
"""

import shutil
import tempfile
from pathlib import Path

import nbclient
import nbformat
import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.ipynb"))


def executed(path, folder, bunny):
    notebook = nbformat.read(path, as_version=4)
    shutil.copy(bunny, folder / "bunny.obj")
    resources = {"metadata": {"path": str(folder)}}
    nbclient.NotebookClient(notebook, timeout=300, resources=resources, record_timing=False).execute()
    return notebook


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 5


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("default")  # those of the client itself
def test_notebook(path, tmp_path, bunny_path):
    notebook = executed(path, tmp_path, bunny_path)
    told = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in told if output.output_type == "stream" and output.name == "stderr"]


if __name__ == "__main__":
    for notebook in NOTEBOOKS:
        with tempfile.TemporaryDirectory() as folder:
            nbformat.write(executed(notebook, Path(folder), "/usr/share/glmark2/models/bunny.obj"), notebook)
