# SPDX-License-Identifier: Apache-2.0
"""GPUs."""

from __future__ import annotations

from dataclasses import dataclass

from . import _core


@dataclass(frozen=True)
class Device:
    """A GPU that ``device="cuda:N"`` can name."""

    name: str
    capability: tuple[int, int]
    memory_bytes: int


def devices() -> list[Device]:
    """The GPUs, in CUDA's order; empty if there is none that standoff can use."""
    return [Device(**{**d, "capability": tuple(d["capability"])}) for d in _core.devices()]
