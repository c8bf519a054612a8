# SPDX-License-Identifier: Apache-2.0
"""What is known of a mesh before its sign is decided."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from . import _core
from ._checks import number, threads_of, whole_number
from ._field import DistanceField
from ._mesh import as_mesh
from ._options import Progress, progress_of


@dataclass(frozen=True)
class Component:
    """Triangles that share positions, directly or through others."""

    triangles: int
    first_triangle: int
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]]
    area: float
    volume: float
    """Negative: a cavity."""
    centroid: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]
    """xx, yy, zz, xy, yz, zx at density 1 about the centroid."""
    closed: bool
    solid: bool
    depth: int
    """How many other solid components contain it."""


@dataclass(frozen=True)
class Report:
    """A mesh's diagnosis: what it is, what is wrong with it, and which sign fits. ``print`` shows it."""

    triangles: int
    positions: int
    """Distinct positions of vertices."""
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]]
    area: float
    volume: float
    """With the holes closed; cavities are negative."""
    closed: bool
    """Whether the mesh has no boundary once it is oriented."""
    degenerate: int
    """Triangles without area."""
    duplicate: int
    """Triangles with an earlier copy, in any orientation."""
    duplicate_same: int
    duplicate_opposite: int
    two_sided: bool
    """Nearly every face is there twice, once in each orientation."""
    open_edges: int
    """Edges of one triangle."""
    nonmanifold_edges: int
    """Edges of three triangles or more."""
    inconsistent_edges: int
    """Edges along which two triangles run in the same direction."""
    flipped: int
    """Triangles that the sign takes in the opposite orientation."""
    left_out: int
    """Copies and inner walls that the sign does not use."""
    cancelled_parts: int
    """Components in both orientations without an inside: the sign uses nothing of them."""
    cancelled_share: float
    """Their part of the area."""
    inconsistent_after: int
    unorientable: int
    """Patches with but one side, like a Moebius strip."""
    patches: int
    boundary_edges: int
    """Edges whose triangles do not cancel each other once the mesh is oriented."""
    boundary_loops: int
    boundary_length: float
    largest_hole: float
    """Diameter of the largest boundary loop, world units."""
    largest_hole_in_samples: float
    cap_share: float
    """The area that closes the holes, as part of the mesh's."""
    openness: float
    """0: a body, 1: a sheet."""
    component_count: int
    components: tuple[Component, ...] = field(repr=False)
    """The largest ones by area, largest first."""
    deepest: int
    nesting_known: bool
    least_winding: int
    most_winding: int
    intersecting_pairs: int
    """Pairs of triangles that intersect though they share no position."""
    intersections_known: bool
    """False: the search was stopped, and there may be more."""
    sign: str
    """The method that fits; ``"none"`` if the mesh has no inside."""
    sure: bool
    """Whether the mesh leaves no doubt what is inside."""
    why: str
    """One sentence."""

    def __str__(self) -> str:
        """What ``standoff info`` says, in its words."""
        low, high = self.bounds
        defects = _listed(
            degenerate=self.degenerate, duplicate=self.duplicate, nonmanifold_edges=self.nonmanifold_edges
        )
        rows = [
            ("triangles", f"{self.triangles:,} over {_counted(self.positions, 'position')}"),
            ("from", _point(low)),
            ("to", _point(high)),
            ("extent", _point([b - a for a, b in zip(low, high)])),
            ("area", f"{self.area:.6g}"),
            ("volume", f"{self.volume:.6g}"),
            ("closed", self._closed()),
            ("orientation", self._orientation()),
            ("defects", (defects or "none") + ("; two-sided" if self.two_sided else "")),
            ("intersections", self._intersections()),
            ("parts", self._parts()),
            ("sign", f"{self.sign}{'' if self.sure else ', not certain'}: {self.why}"),
        ]
        return "\n".join(f"{name:<14}{text}" for name, text in rows)

    def _closed(self) -> str:
        if self.closed or self.triangles == 0:
            return "yes" if self.closed else "no"
        holes = f"{_counted(self.boundary_edges, 'boundary edge')} in {_counted(self.boundary_loops, 'loop')}"
        samples = f" ({self.largest_hole_in_samples:.6g} samples)" if self.largest_hole_in_samples > 0 else ""
        share = f"{100 * self.cap_share:.2g}" if self.cap_share < 0.0995 else f"{100 * self.cap_share:.0f}"
        return (
            f"no: {holes}, the largest {self.largest_hole:.6g} across{samples}; closing them takes {share} % of the "
            f"area, openness {self.openness:.6g}"
        )

    def _orientation(self) -> str:
        edges = self.inconsistent_edges
        text = _counted(edges, "inconsistent edge") if edges else "consistent"
        done = _listed(flipped=self.flipped, left_out=self.left_out)
        if done:
            text += f"; for the sign: {done}"
        if self.unorientable:
            text += f"; {self.unorientable:,} {'patch has' if self.unorientable == 1 else 'patches have'} but one side"
        return text

    def _intersections(self) -> str:
        pairs = f"{_counted(self.intersecting_pairs, 'pair')} of triangles"
        if self.intersections_known:
            return pairs if self.intersecting_pairs else "none"
        return f"at least {pairs}" if self.intersecting_pairs else "none found, not all were looked for"

    def _parts(self) -> str:
        text = f"{_counted(self.component_count, 'component')}, {self.patches:,} {'patch' if self.patches == 1 else 'patches'}"
        if self.nesting_known:
            text += f", nested to depth {self.deepest}"
        return text + (f", winding numbers {self.least_winding} to {self.most_winding}" if self.closed else "")


def _listed(**counts: int) -> str:
    return ", ".join(f"{count:,} {name.replace('_', ' ')}" for name, count in counts.items() if count)


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def _point(point: Any) -> str:
    return f"({', '.join(f'{coordinate:.6g}' for coordinate in point)})"


def report(
    mesh: Any,
    *,
    spacing: float = 0.0,
    most_components: int = 100,
    most_intersections: int = 1000,
    threads: int = 0,
) -> Report:
    """Examines a mesh: is it closed, what is wrong with it, which sign fits and why.

    Args:
        mesh: as for `field`.
        spacing: of the samples that are planned, world units, to judge holes by.
        most_components: that are listed.
        most_intersections: the search stops soon after it has found so many; 0: no search.
        threads: 0 for all.

    Raises:
        MeshError: a face out of range, or a corner that is not finite.
    """
    m = as_mesh(mesh)
    found = _core.report(
        m.vertices,
        m.faces,
        number(spacing, "spacing"),
        whole_number(most_components, "most_components"),
        whole_number(most_intersections, "most_intersections"),
        threads_of(threads),
    )
    components = tuple(
        Component(**{key: _tuples(value) for key, value in one.items()}) for one in found.pop("components")
    )
    return Report(components=components, **{key: _tuples(value) for key, value in found.items()})


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, (list, tuple)) else value


@dataclass(frozen=True)
class Check:
    """The comparison of a field with its mesh."""

    ok: bool
    """No value, sign or nearest triangle is wrong."""
    samples: int
    samples_band: int
    samples_wrong: int
    nearest_wrong: int
    largest_error: float
    """World units."""
    allowed_error: float
    """At the sample of the largest error."""
    sign_checked: int
    sign_wrong: int
    sign_unknown: int
    mesh_differs: bool
    """The field says that it was computed from another mesh."""


def verify(
    field: DistanceField,
    mesh: Any,
    *,
    samples: int = 1000,
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> Check:
    """Compares a field at random samples with distances and signs computed from the mesh by other means."""
    if not isinstance(field, DistanceField):
        raise TypeError(f"field: must be a standoff.DistanceField, not {type(field).__name__}")
    m = as_mesh(mesh)
    numbers = whole_number(samples, "samples"), whole_number(seed, "seed")
    if numbers[1] < 0:
        raise ValueError(f"seed: must be zero or more, not {seed}")
    with progress_of(progress, "verify") as report:
        return Check(**_core.verify(field._native(), m.vertices, m.faces, *numbers, threads_of(threads), report))
