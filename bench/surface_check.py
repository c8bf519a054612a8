# SPDX-License-Identifier: Apache-2.0
"""Whether a surface is closed, from its triangles alone. Needs numpy."""

import numpy as np


def weld(vertices, triangles):
    """The triangles with one number for each position."""
    _, number = np.unique(vertices, axis=0, return_inverse=True)
    return number.reshape(-1)[triangles.astype(np.int64)]


def closedness(vertices, triangles):
    """Equal positions are one vertex. {"triangles", "degenerate": those with two equal corners, "open_edges": edges of an odd
    number of triangles, "nonmanifold_edges": of more than two, "unoriented_edges": not passed once in each direction}"""
    corners = weld(vertices, triangles)
    bad = (corners[:, 0] == corners[:, 1]) | (corners[:, 1] == corners[:, 2]) | (corners[:, 2] == corners[:, 0])
    good = corners[~bad]
    found = {"triangles": len(corners), "degenerate": int(bad.sum()), "open_edges": 0, "nonmanifold_edges": 0, "unoriented_edges": 0}
    if len(good) == 0:
        return found
    edges = np.concatenate([good[:, [0, 1]], good[:, [1, 2]], good[:, [2, 0]]])
    forward = edges[:, 0] < edges[:, 1]
    keys, place = np.unique(edges.min(axis=1) * (corners.max() + 1) + edges.max(axis=1), return_inverse=True)
    ways = np.bincount(place.reshape(-1), weights=np.where(forward, 1, -1), minlength=len(keys))
    uses = np.bincount(place.reshape(-1), minlength=len(keys))
    return found | {"open_edges": int((uses % 2).sum()), "nonmanifold_edges": int((uses > 2).sum()),
                    "unoriented_edges": int((ways != 0).sum())}


def in_words(found):
    """For a table."""
    faults = [(found["open_edges"], "open edges"), (found["nonmanifold_edges"], "edges of more than two triangles"),
              (found["unoriented_edges"], "edges against the orientation"), (found["degenerate"], "triangles without area")]
    return ", ".join(f"{count} {what}" for count, what in faults if count) or "closed, oriented, edges of two triangles"
