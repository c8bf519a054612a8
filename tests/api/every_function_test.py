# SPDX-License-Identifier: Apache-2.0
"""tests/api calls every function that the headers export: with arguments that make no sense, or with allocations refused."""

import importlib.machinery
import importlib.util
import os
import pathlib
import re
import sys

SOURCE = pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"])
loader = importlib.machinery.SourceFileLoader("exported", str(SOURCE / "script/check_exported_symbols"))
exported = importlib.util.module_from_spec(importlib.util.spec_from_loader("exported", loader))
loader.exec_module(exported)

functions = exported.declared()[0]
calls = "".join(file.read_text(encoding="utf-8") for file in sorted((SOURCE / "tests/api").glob("*.cpp")))
names = {name.split("::")[-1] for name in functions}
missing = sorted(name for name in names if not re.search(rf"(?<![\w.>]){name}\(", calls))
print(*(f"no test in tests/api calls {name}()" for name in missing), sep="\n")
print(f"{len(names)} names")
sys.exit(1 if missing or len(names) < 20 else 0)
