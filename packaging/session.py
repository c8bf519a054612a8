# SPDX-License-Identifier: Apache-2.0
"""A short session with the installed package, run by script/wheel-test: session.py FOLDER-OF-MESH-FILES.

It is no test of what the answers are (python/tests is), but of whether the module and the program work where they are.
"""

import importlib.metadata
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import standoff as so

meshes = Path(sys.argv[1])
box = so.read(meshes / "tetrahedron.3ds")
field = so.field(box, resolution=24)
assert field.numpy().min() < 0 < field.numpy().max()
with tempfile.TemporaryDirectory() as folder:
    for name in ("box.npz", "box.vdb", "box.nvdb", "box.vti"):
        field.save(Path(folder, name))
        assert (so.load(Path(folder, name)).numpy() == field.numpy()).all(), name
    so.surface(field, at=0.01).save(Path(folder, "solid.ply"))
    assert bytes(field.plot()).startswith(b"\x89PNG"), "no pictures"

distances = so.distance(box, np.array([[100.0, 0, 0], box.vertices.mean(axis=0)]))
assert distances[0] > 0 > distances[1], distances
assert so.collide(so.Body(box), so.Body(box), np.eye(4)[None]).hit.all()
for name in ("tetrahedron.3ds", "tetrahedron.dae"):
    assert len(so.read(meshes / name).faces) > 0, name
so.devices()

# The program, as its users call it: beside the interpreter, in front of the PATH.
program = Path(sys.executable).parent / "standoff"
said = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout
assert so.__version__ in said and importlib.metadata.version("standoff") == so.__version__, said
subprocess.run([program, "info", meshes / "tetrahedron.3ds"], check=True, stdout=subprocess.DEVNULL)
