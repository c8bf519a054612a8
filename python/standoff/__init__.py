# SPDX-License-Identifier: Apache-2.0
"""Exact distance fields of triangle meshes, and collision queries.

Example::

    import standoff as so

    mesh = so.read("bunny.obj")
    field = so.field(mesh, resolution=256, band=3)     # DistanceField, negative inside
    field.numpy()[10, 20, 30]
    so.distance(mesh, points)                          # exact, at arbitrary points
"""

from ._batch import BatchResult, batch
from ._bodies import (
    CONTAINMENTS,
    NO_TRIANGLE,
    Body,
    Collisions,
    Contacts,
    Distances,
    PathSweep,
    Sweeps,
    collide,
    contacts,
    distance_between,
    sweep,
    sweep_path,
    sweep_screw,
)
from ._compute import field
from ._core import version as __version__
from ._device_field import DeviceField
from ._devices import Device, devices
from ._errors import (
    DeviceError,
    DoubtError,
    Error,
    InputError,
    LimitError,
    MeshError,
    OutputError,
    SignWarning,
    SurfaceWarning,
    UsageError,
    VerifyError,
)
from ._field import DistanceField, load
from ._many import FieldResult, fields
from ._mesh import Mesh, read
from ._options import Grid, Sign, SignReport
from ._page import Page
from ._picture import Picture
from ._points import FEATURES, ClosestPoints, MeshQuery, distance
from ._report import Check, Component, Report, report, verify
from ._stored import StoredField
from ._stored import open_store as open
from ._surface import surface
from ._update import LiveField
from ._windows import FieldWindows

__all__ = [
    "CONTAINMENTS",
    "FEATURES",
    "NO_TRIANGLE",
    "BatchResult",
    "Body",
    "Check",
    "ClosestPoints",
    "Collisions",
    "Component",
    "Contacts",
    "Device",
    "DeviceError",
    "DeviceField",
    "DistanceField",
    "Distances",
    "DoubtError",
    "Error",
    "FieldResult",
    "FieldWindows",
    "Grid",
    "InputError",
    "LimitError",
    "LiveField",
    "Mesh",
    "MeshError",
    "MeshQuery",
    "OutputError",
    "Page",
    "Picture",
    "Report",
    "Sign",
    "SignReport",
    "SignWarning",
    "StoredField",
    "SurfaceWarning",
    "PathSweep",
    "Sweeps",
    "UsageError",
    "VerifyError",
    "__version__",
    "batch",
    "collide",
    "contacts",
    "devices",
    "distance",
    "distance_between",
    "field",
    "fields",
    "load",
    "open",
    "read",
    "report",
    "surface",
    "sweep",
    "sweep_path",
    "sweep_screw",
    "verify",
]
