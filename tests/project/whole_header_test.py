# SPDX-License-Identifier: Apache-2.0
"""standoff/standoff.h names every public header but CUDA's and itself."""

import os
import re
from pathlib import Path

folder = Path(os.environ["STANDOFF_SOURCE_DIR"]) / "include" / "standoff"
left_out = {"standoff.h", "export.h", "cuda.h", "cuda_batch.h", "cuda_compute.h"}
named = set(re.findall(r'#include "standoff/(.*)"', (folder / "standoff.h").read_text()))
there = {path.name for path in folder.glob("*.h")} - left_out
assert named == there, f"standoff.h: missing {sorted(there - named)}, superfluous {sorted(named - there)}"
