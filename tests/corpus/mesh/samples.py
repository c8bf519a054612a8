# SPDX-License-Identifier: Apache-2.0
"""What the files of this folder are made of: a tetrahedron, and how bytes become a file, the same on every run."""
import gzip
import pathlib

HERE = pathlib.Path(__file__).parent
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
NAN_POINTS = [(0, 0, 0), (float("nan"), 0, 0), (0, 1, 0), (0, 0, 1)]


def write(name, content):
    (HERE / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def gz(content):
    """As gzip packs it, the same on every run."""
    return gzip.compress(content if isinstance(content, bytes) else content.encode(), mtime=0)
