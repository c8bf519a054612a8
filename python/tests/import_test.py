# SPDX-License-Identifier: Apache-2.0
"""What `import standoff` loads."""

import subprocess
import sys

LATE = ["concurrent.futures", "tempfile", "tqdm", "subprocess", "asyncio", "json"]


def test_an_import_loads_nothing_that_only_few_calls_need():
    """The package is imported in a twentieth of a second because these wait; numpy's own imports are none of ours."""
    program = f"""
import sys, numpy
before = set(sys.modules)
import standoff
print(*(set(sys.modules) - before) & set({LATE!r}))
"""
    loaded = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
    assert loaded.split() == []
