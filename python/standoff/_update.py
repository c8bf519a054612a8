# SPDX-License-Identifier: Apache-2.0
"""Fields of meshes of which a part moved."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._checks import name, runs_on
from ._field import DistanceField
from ._mesh import Mesh, as_mesh
from ._options import Progress, Sign, memory_limit_of, progress_of, sign_report


def updated(
    field: DistanceField,
    mesh: Any,
    before: Any,
    changed: Any,
    moved: Any,
    sign: str | Sign | None,
    method: str,
    where: tuple[int, str],
    memory_limit: int | None,
    progress: Progress,
) -> DistanceField:
    """As `DistanceField.update`."""
    old, new = as_mesh(before), as_mesh(mesh)
    asked = Sign.of(sign)
    if changed is not None and moved is not None:
        raise ValueError("changed and moved: both name the triangles that changed; give one of these")
    triangles = None
    if changed is not None:
        triangles = indices(changed, "changed", max(len(old.faces), len(new.faces)))
    elif moved is not None:
        triangles = triangles_of(indices(moved, "moved", max(len(old.vertices), len(new.vertices))), old, new)
    with progress_of(progress, "update") as report:
        native, done = _core.update(
            field._native(),
            old.vertices,
            old.faces,
            new.vertices,
            new.faces,
            triangles,
            asked,
            name(method, "method"),
            *runs_on(*where),
            memory_limit_of(memory_limit),
            report,
        )
    signs = sign_report(done.pop("sign"), asked, stacklevel=3)
    return DistanceField._of_native(native, signs, done)


def indices(chosen: Any, what: str, count: int) -> np.ndarray:
    """Indices below `count` of an array of them, or of one truth value for each."""
    array = np.asarray(chosen)
    if array.ndim != 1 or array.dtype.kind not in "biu" and array.size > 0:
        raise TypeError(f"{what}: must be indices, or True or False for each, in one row; not {chosen!r}")
    if array.dtype.kind == "b":
        if len(array) > count:
            raise ValueError(f"{what}: {len(array)} truth values for {count}")
        array = np.flatnonzero(array)
    if array.size > 0 and not 0 <= int(array.min()) <= int(array.max()) < count:
        raise ValueError(f"{what}: must be from 0 to {count - 1}, not {int(array.min())} to {int(array.max())}")
    return np.ascontiguousarray(array, dtype=np.uint32)


def triangles_of(vertices: np.ndarray, *meshes: Mesh) -> np.ndarray:
    """The triangles of any of the meshes with one of these vertices."""
    found = []
    for mesh in meshes:
        chosen = np.zeros(max(len(mesh.vertices), int(vertices.max(initial=0)) + 1), dtype=bool)
        chosen[vertices] = True
        found.append(np.flatnonzero(chosen[mesh.faces].any(axis=1)))
    return np.unique(np.concatenate(found)).astype(np.uint32)
