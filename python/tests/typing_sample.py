# SPDX-License-Identifier: Apache-2.0
"""Typical use, for typing_test.py: it must pass `mypy --strict`, and its mistakes must be found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import standoff as so


def first_field(path: Path) -> npt.NDArray[np.float32]:
    mesh: so.Mesh = so.read(path, scale=0.001)
    low, high = mesh.bounds
    field = so.field(mesh, resolution=64, band=3, sign=so.Sign("winding", invert=True), threads=2)
    field.save("field.vdb", compress=False)
    values: npt.NDArray[np.float32] = field.numpy()
    tiles, coordinates = field.tiles()
    report = field.sign
    if report is not None and not report.sure:
        print(report.why, low[0], high[2])
    return values[tiles.shape[0] :, coordinates.shape[0] :]


def points(mesh: so.Mesh, where: npt.NDArray[np.float64]) -> float:
    query = so.MeshQuery(mesh, sign="auto")
    nearest = query.closest(where)
    also: so.ClosestPoints = so.distance(mesh, where, sign=None, closest=True)
    print(nearest.point, also.gradient, so.distance(query, where))
    return float(query.distance(where).max())


def bodies(mesh: so.Mesh, poses: npt.NDArray[np.float64]) -> list[int]:
    a, b = so.Body(mesh), so.Body((mesh.vertices, mesh.faces))
    hits: so.Collisions = so.collide(a, b, poses, margin=0.1, mode="certified")
    sweeps = so.sweep(a, b, poses, poses)
    print(hits.hit, sweeps.time, so.distance_between(a, b, poses).point_a, len(so.contacts(a, b, poses[0])))
    return [so.NO_TRIANGLE]


def many(paths: list[Path]) -> list[so.DistanceField]:
    made = []
    for result in so.fields(paths, workers=2, resolution=32):
        if isinstance(result.error, so.MeshError):
            print(result.error.triangle, result.error.file)
        elif result.field is not None:
            made.append(result.field)
    return made


def surfaces(field: so.DistanceField, mesh: so.Mesh) -> str:
    solid = so.surface(field, at=0.1, method="dual")
    check = so.verify(field, mesh, samples=100)
    return f"{len(solid.faces)} {check.ok} {so.report(mesh).volume} {bytes(field.plot(axis='x'))!r} {so.__version__}"


def progress(stage: str, fraction: float) -> None:
    print(stage, fraction)


so.field("mesh.stl", spacing=(0.1, 0.1, 0.2), progress=progress, grid=None)
so.Grid.fit(((0, 0, 0), (1, 1, 1)), resolution=10).points()
