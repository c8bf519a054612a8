# SPDX-License-Identifier: Apache-2.0
"""What several tests need."""

import atexit
import os
import shutil
from pathlib import Path

import pytest
import standoff

# pytest's import hook is the loader of every module that it has seen. So it outlives them, and with its configuration all
# test modules and their fields, until nanobind calls those leaked (in the developer's mode): it is to forget it.
atexit.register(setattr, globals()["__loader__"], "config", None)


@pytest.fixture(scope="session")
def program() -> str:
    """The program standoff: the one in the package, or $STANDOFF, or the one of the PATH."""
    packaged = Path(standoff.__file__).parent / "bin" / "standoff"
    found = str(packaged) if packaged.exists() else os.environ.get("STANDOFF") or shutil.which("standoff")
    assert found, "the package has no program; set STANDOFF to its path"
    return found


@pytest.fixture(autouse=True)
def no_browser(monkeypatch):
    """show() opens no browser while tests run."""
    monkeypatch.setattr("webbrowser.open", lambda *_, **__: False)


@pytest.fixture(scope="session")
def bunny_path() -> str:
    """A mesh of Debian's glmark2-data, which script/bootstrap installs."""
    return "/usr/share/glmark2/models/bunny.obj"
