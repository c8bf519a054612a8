# SPDX-License-Identifier: Apache-2.0
"""script/check_includes refuses what it is there to refuse: each fault is put into a small tree that is clean without it."""

import importlib.machinery
import importlib.util
import os
import pathlib
import sys

SCRIPT = os.environ["STANDOFF_SOURCE_DIR"] + "/script/check_includes"
CLEAN = {
    "include/standoff/mesh.h": "#include <vector>\n",
    "src/core/grid.h": '#include "standoff/mesh.h"\n',
    "src/files/view.h": '#include "core/grid.h"\n',
    "src/gpu/stream.h": "#ifdef STANDOFF_HAVE_CUDA\n#endif\n",
    "src/collision/pair.h": '#include "core/grid.h"\n',
    "src/thesis/ablation.h": "",
    "src/field/gather.h": '#include "core/grid.h"\n#include "thesis/ablation.h"\n',
    "cli/main.cpp": "#include <CLI/CLI.hpp>\n",
}
PERMISSIONS = {("src/field/gather.h", "src/thesis/ablation.h"): "as a test"}


def faults(changes, permissions=PERMISSIONS):
    """What the script says of the clean tree with some files changed."""
    tree = pathlib.Path.cwd() / "tree"
    for path, text in (CLEAN | changes).items():
        (tree / path).parent.mkdir(parents=True, exist_ok=True)
        (tree / path).write_text(text)
    os.environ["STANDOFF_TREE"] = str(tree)
    loader = importlib.machinery.SourceFileLoader("check_includes", SCRIPT)
    script = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_includes", loader))
    loader.exec_module(script)  # afresh: it remembers the files it has read
    script.PERMISSIONS = permissions
    printed = pathlib.Path("printed")
    with printed.open("w") as out:
        sys.stdout, before = out, sys.stdout
        status = script.main()
        sys.stdout = before
    for path in changes:
        (tree / path).unlink()
    said = printed.read_text()
    assert (status == 1) == (not said.startswith("checked ")), said
    return said


def expect(said, *words):
    for word in words:
        assert word in said, f"{word!r} is not in {said!r}"


sys.dont_write_bytecode = True
expect(faults({}), "checked 8 files")
# A room reached directly, through a room that may reach it, and from the public headers.
expect(faults({"src/core/bad.h": '#include "files/view.h"\n'}), "src/core/bad.h: src/core must not reach src/files/view.h")
expect(faults({"src/collision/bad.h": '#include "files/view.h"\n', "src/files/view.h": '#include "thesis/ablation.h"\n'}),
       "src/collision/bad.h: src/collision must not reach src/thesis/ablation.h (through src/files/view.h)")
expect(faults({"include/standoff/bad.h": '#include "core/grid.h"\n'}), "include/standoff must not reach src/core/grid.h")
# Headers that are not ours.
expect(faults({"src/core/bad.h": "#include <CLI/CLI.hpp>\n"}), "src/core must not include <CLI/CLI.hpp>")
expect(faults({"src/core/bad.h": "#include <nobody/knows.h>\n"}), "<nobody/knows.h> is in no table")
expect(faults({"include/standoff/bad.h": "#include <unistd.h>\n"}), "<unistd.h> is in no table")
expect(faults({"src/core/bad.h": '#include "nowhere.h"\n'}), '"nowhere.h" is no file of the project')
# CUDA where it has no business, and a file that lies in no room.
expect(faults({"src/core/bad.h": "#ifdef STANDOFF_HAVE_CUDA\n#endif\n"}), "src/core/bad.h:1: CUDA")
expect(faults({"src/nobody/bad.h": ""}), "src/nobody/bad.h: lies in no room")
# Permissions: missing, stale, too many.
expect(faults({}, {}), "src/field/gather.h: src/field must not reach src/thesis/ablation.h")
stale = ("src/field/gather.h", "src/collision/pair.h")
expect(faults({}, PERMISSIONS | {stale: "as a test"}), "src/field/gather.h does not include src/collision/pair.h")
many = {file: '#include "thesis/ablation.h"\n' for file in ("src/field/a.h", "src/field/b.h", "src/field/c.h")}
expect(faults(many, PERMISSIONS | {(file, "src/thesis/ablation.h"): "as a test" for file in many}), "more than three permissions")
