# SPDX-License-Identifier: Apache-2.0
"""Fields of meshes in a GPU's memory: of one, or of many by one launch."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from . import _core
from ._checks import flag, name
from ._device_arrays import DeviceArray, Pool
from ._device_field import DeviceField
from ._device_mesh import MeshOnDevice
from ._errors import OF_A_MESH, UsageError, without_frames
from ._options import Box, Grid, Sign, grid_of, sign_report


def fields_on_gpu(
    meshes: Sequence[MeshOnDevice],
    sizes: Sequence[Any],
    sign: str | Sign | None,
    nearest: bool,
    method: str,
    out: Any = None,
) -> list[DeviceField | Exception]:
    """The fields of meshes that agree in `worker`, in their order, or what is wrong with a mesh. It is raised if it
    concerns all of them.

    Args:
        sizes: what `grid_of` takes after the bounds.
        out: for a single mesh.
    """
    asked = Sign.of(sign)
    if asked.method in ("normal", "facet", "shell") or asked.outer:
        what = "outer" if asked.outer else asked.method
        raise UsageError(
            f"sign: {what!r} needs more than a bit for each sample, which the CPU alone gives; pass another sign, or copy "
            "the mesh to the CPU first"
        )
    if flag(nearest, "nearest"):
        raise UsageError("nearest: triangles are stored in the memory of the CPU; copy the mesh there first")
    method = name(method, "method")
    boxes: Iterable[Box | Exception | None] = (None for _ in meshes)
    if sizes[0] is None:  # no grid
        boxes = _core.bounds_on_device([mesh.rows for mesh in meshes], _stream(meshes))
    answers = [_planned(mesh, box, sizes, out) for mesh, box in zip(meshes, boxes)]
    planned = [each for each in answers if isinstance(each, _Planned)]
    stream = _stream(meshes, planned)
    reports = iter(_core.compute_on_device([each.request() for each in planned], asked, method, stream))
    return [each.field(next(reports), asked) if isinstance(each, _Planned) else each for each in answers]


@dataclass(frozen=True, eq=False)
class _Planned:
    mesh: MeshOnDevice
    grid: Grid
    thickness: float
    values: DeviceArray

    def request(self) -> tuple[Any, ...]:
        return (*self.mesh.rows, self.grid._core(), self.thickness, self.values.pointer)

    def field(self, report: dict[str, Any] | Exception, asked: Sign) -> DeviceField | Exception:
        if isinstance(report, Exception):
            return report
        sign, made = sign_report(report.pop("sign"), asked, stacklevel=5), report.pop("provenance")
        provenance = _core.Provenance(made.method, made.mesh_hash, made.version, made.sign, self.mesh.up)
        del report["method"]
        return DeviceField._make(self.grid, self.thickness, provenance, sign=sign, computation=report)._placed(
            self.values, self.mesh.number, self.mesh.emulated
        )


def _planned(mesh: MeshOnDevice, box: Box | Exception | None, sizes: Sequence[Any], out: Any) -> _Planned | Exception:
    def bounds() -> Box:
        if isinstance(box, Exception):
            raise box
        assert box is not None
        return box

    try:
        grid, thickness = grid_of(bounds, *sizes)
        return _Planned(mesh, grid, thickness, mesh.output(out, grid))
    except OF_A_MESH as error:
        return without_frames(error)


def _stream(meshes: Sequence[MeshOnDevice], planned: Sequence[_Planned] = ()) -> _core.Stream:
    """The meshes' stream, which first waits for others that may still work on them or on the outputs."""
    others: set[int] = set()
    for mesh in meshes:
        others |= mesh.other_streams()
    for each in planned:
        others |= each.mesh.other_streams(each.values)
    return _core.Stream(*meshes[0].worker, sorted(others), Pool.of(meshes[0].source, meshes[0].worker[2]))
