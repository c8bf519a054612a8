# SPDX-License-Identifier: Apache-2.0
"""How long `import standoff` takes beside `import numpy`: the median of several fresh interpreters."""

import statistics
import subprocess
import sys

SHOW = """
import time, numpy
began = time.perf_counter()
import standoff
print(time.perf_counter() - began)
"""

seconds = [
    float(subprocess.run([sys.executable, "-c", SHOW], check=True, capture_output=True).stdout) for _ in range(9)
]
print(
    f"import standoff, once numpy is there: {1e3 * statistics.median(seconds):.0f} ms (fastest {1e3 * min(seconds):.0f} ms)"
)
