# SPDX-License-Identifier: Apache-2.0
"""Queries between bodies: arguments that make no sense, besides poses."""

import numpy as np
import pytest
import shapes
import standoff as so

CUBE = so.Body(shapes.cube())


def test_other_arguments_that_make_no_sense():
    one = np.eye(4)
    for call in (
        lambda: so.contacts(CUBE, CUBE, np.stack([one, one])),
        lambda: so.sweep(CUBE, CUBE, one, np.stack([one, one])),
        lambda: so.sweep(CUBE, CUBE, one, one, center=(0, 0)),
        lambda: so.sweep(CUBE, CUBE, one, one, center=(np.nan, 0, 0)),
        lambda: so.sweep(CUBE, CUBE, one, one, tolerance=-1),
        lambda: so.collide(CUBE, CUBE, one, mode="fast"),
        lambda: so.collide(CUBE, CUBE, one, margin=-1),
        lambda: so.collide(CUBE, CUBE, one, margin=np.nan),
        lambda: so.collide(CUBE, CUBE, one, margin=np.inf),
        lambda: so.distance_between(CUBE, CUBE, one, tolerance=-1),
        lambda: so.distance_between(CUBE, CUBE, one, limit=-1),
        lambda: so.contacts(CUBE, CUBE, one, most=0),
        lambda: so.contacts(CUBE, CUBE, one, most=-3),
        lambda: so.Body(shapes.cube(), spacing=-1),
        lambda: so.Body(shapes.cube(), spacing=np.nan),
        lambda: so.collide(CUBE, CUBE, one, threads=-1),
    ):
        with pytest.raises(ValueError):
            call()
    for call in (
        lambda: so.collide(shapes.cube(), CUBE, one),
        lambda: so.collide(CUBE, None, one),
        lambda: so.distance_between(CUBE, so.Mesh(*shapes.cube()), one),
        lambda: so.collide(CUBE, CUBE, one, margin="1"),
        lambda: so.collide(CUBE, CUBE, one, containment="yes"),
        lambda: so.contacts(CUBE, CUBE, one, most=1.5),
        lambda: so.sweep(CUBE, CUBE, one, one, center="abc"),
    ):
        with pytest.raises((TypeError, ValueError)):
            call()
