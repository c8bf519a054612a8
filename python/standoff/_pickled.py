# SPDX-License-Identifier: Apache-2.0
"""What pickle keeps of a field, and the field made of it again."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._field import DistanceField
from ._files import packed, unpacked
from ._options import Grid, SignReport


def parts(field: DistanceField) -> tuple[Any, ...]:
    """What ``__reduce__`` returns."""
    state = (field._grid, field._thickness, field.provenance, field._sign)
    if field._dense is not None:
        return _rebuild_dense, (*state, field._dense)
    native = field._native()
    if native.has_nearest:  # files keep the nearest triangles too
        return _rebuild_packed, (packed(lambda path: field.save(path), ".npz"), field._sign)
    # In the order of the grid: as they lie in memory depends on which thread was first.
    slots = np.array(native.slots())
    stored = slots >= 0
    values = native.tile_values().transpose(0, 3, 2, 1)[slots[stored]].reshape(-1, 512)
    slots[stored] = np.arange(len(values))
    return _rebuild_tiles, (*state, values, slots)


def _rebuild_dense(
    grid: Grid, thickness: float, provenance: dict[str, Any], sign: SignReport | None, dense: np.ndarray
) -> DistanceField:
    return DistanceField._make(
        grid, thickness, _core.Provenance(**provenance), dense=np.asfortranarray(dense), sign=sign
    )


def _rebuild_tiles(
    grid: Grid,
    thickness: float,
    provenance: dict[str, Any],
    sign: SignReport | None,
    values: np.ndarray,
    slots: np.ndarray,
) -> DistanceField:
    native = _core.from_tiles(grid._core(), thickness, values, slots, _core.Provenance(**provenance))
    return DistanceField._of_native(native, sign)


def _rebuild_packed(content: bytes, sign: SignReport | None) -> DistanceField:
    return DistanceField._of_native(unpacked(content, lambda path: _core.read_field(path, 0), ".npz"), sign)
