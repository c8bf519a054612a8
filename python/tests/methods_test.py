# SPDX-License-Identifier: Apache-2.0
"""Algorithms of others, and several GPUs for one field, through Python: names, values and refusals. Their bounds are tested in
C++ (tests/approximate, tests/field/cuda)."""

import numpy as np
import pytest
import shapes
import standoff as so

BALL = shapes.sphere(24)
EXACT = so.field(BALL, resolution=24, sign=None).numpy()


@pytest.mark.parametrize("method", ["propagate", "jumpflood", "jumpflood+1"])
@pytest.mark.parametrize("device", ["cpu", "emulated"])
def test_methods_that_hand_triangles_on_are_never_too_small(method, device):
    field = so.field(BALL, resolution=24, sign=None, method=method, device=device)
    spacing = max(field.grid.spacing)
    assert np.all(field.numpy() >= EXACT - 1e-6)
    assert np.all(field.numpy() <= EXACT + spacing)


def test_prisms_need_a_finite_thickness():
    with pytest.raises(so.UsageError, match="no full fields"):
        so.field(BALL, resolution=24, method="fuhrmann")
    with pytest.raises(so.UsageError, match="CPU alone"):
        so.field(BALL, resolution=24, band=2, method="fuhrmann", device="emulated")
    assert np.all(so.field(BALL, resolution=24, band=2, sign=None, method="fuhrmann").numpy() > -1e-9)


def test_several_devices_share_a_field():
    whole = so.field(BALL, resolution=40, sign=None, device="cpu").numpy()
    assert np.array_equal(whole, so.field(BALL, resolution=40, sign=None, device="emulated:0,1").numpy())
    with pytest.raises(so.UsageError, match="named twice"):
        so.field(BALL, resolution=24, device="emulated:0,0")
    with pytest.raises(so.UsageError, match="give one GPU here"):
        so.Body(BALL, device="emulated:0,1")
    with pytest.raises(so.UsageError, match="only a GPU takes a number"):
        so.field(BALL, resolution=24, device="cpu:1")
