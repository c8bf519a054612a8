# SPDX-License-Identifier: Apache-2.0
"""Makes a clean solid of a mesh and drops it in MuJoCo, with the inertia of its volume. Needs mujoco.

    python mujoco_part.py bunny.obj

Drake reads the same .obj: <mesh><uri>part.obj</uri></mesh>, with these inertias in its <inertial>.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np
import standoff as so

MODEL = """
<mujoco>
  <asset><mesh name="part" file="{file}"/></asset>
  <worldbody>
    <geom type="plane" size="3 3 0.1"/>
    <body pos="0 0 1.5"><freejoint/>
      <inertial pos="{x} {y} {z}" mass="{mass}" fullinertia="{inertia}"/>
      <geom type="mesh" mesh="part"/>
    </body>
  </worldbody>
</mujoco>
"""


def main(path: str, density: float = 1000.0) -> float:
    solid = so.surface(path, resolution=64)  # closed, whatever the mesh is
    part = so.report(solid, most_intersections=0).components[0]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "part.obj"
        solid.save(file)
        x, y, z = part.centroid
        xx_yy_zz_xy_xz_yz = np.array(part.inertia)[[0, 1, 2, 3, 5, 4]]
        inertia = " ".join(str(density * value) for value in xx_yy_zz_xy_xz_yz)
        text = MODEL.format(file=file, x=x, y=y, z=z, mass=density * part.volume, inertia=inertia)
        model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for _ in range(1000):
        mujoco.mj_step(model, data)
    height = float(data.qpos[2])
    print(f"{len(solid.faces):,} triangles, mass {density * part.volume:.1f}")
    print(f"after {data.time:.1f} s it is at height {height:.3f}")
    return height


if __name__ == "__main__":
    main(sys.argv[1])
