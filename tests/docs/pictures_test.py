# SPDX-License-Identifier: Apache-2.0
"""The pictures of the documentation are those that script/pictures and script/figures draw: some quick ones are drawn again."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from PIL import Image

SOURCE = Path(os.environ["STANDOFF_SOURCE_DIR"])
QUICK = {"pictures": ["start", "hollow", "levels", "two_bodies", "grid_scheme"], "figures": ["boxes", "fine_collision"]}
FILES = ["start.png", "howto_print.png", "zarr.png", "collide.png", "formats.svg", "thesis_4_1.svg", "thesis_4_6.png"]


def difference(drawn, kept):
    """Of the mean pixel, in levels of 255. Other versions of Pillow choose other palettes: not the bytes are compared."""
    if drawn.suffix == ".svg":
        return 0 if drawn.read_text() == kept.read_text() else 255
    one, other = (np.asarray(Image.open(path).convert("RGB"), float) for path in (drawn, kept))
    return 255 if one.shape != other.shape else np.abs(one - other).mean()


def main():
    here = Path.cwd()
    for script, names in QUICK.items():
        subprocess.run([sys.executable, SOURCE / "script" / script, *names], check=True, env={**os.environ, "OUTPUT": str(here)})
    wrong = [f"docs/images/{name} is not what is drawn now; draw it again, or say why it changes" for name in FILES
             if difference(here / name, SOURCE / "docs/images" / name) > 0.5]  # fmt: skip
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{len(FILES)} pictures are as they are drawn")


main()
