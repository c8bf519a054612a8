# SPDX-License-Identifier: Apache-2.0
"""Whether all that the module and the program need came along in the wheel, their licences too: script/wheel-test."""

import importlib.metadata
import sys
from pathlib import Path

import standoff as so

# Every library that is not the system's own came out of the wheel.
package = Path(so.__file__).parent
for line in Path("/proc/self/maps").read_text().splitlines():
    library = line.split()[-1]
    if any(part in library for part in ("libtbb", "libpng", "libblosc", "libzstd", "libmeshoptimizer", "libboost")):
        assert package.parent in Path(library).parents, library

files = [Path(file) for file in importlib.metadata.files("standoff") or []]
licences = {file.stem for file in files if "licenses" in file.parts}
copied = {file.name.split("-")[0] for file in files if file.parts[0] == "standoff.libs"}
for library in copied:
    assert any(licence.startswith(library.replace("_", "-").rstrip("0123456789")) for licence in licences), (
        f"no licence of {library}"
    )
print(
    f"{so.__version__} on Python {sys.version.split()[0]}: {len(copied)} libraries and {len(licences)} licences came along"
)
