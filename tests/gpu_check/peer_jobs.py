# SPDX-License-Identifier: Apache-2.0
"""What peers in Python share: the jobs that `measure --export` wrote, runs, and the CSV line of a job and query."""

import os
import statistics
import sys
from pathlib import Path

import numpy as np

LEAST_RUNS, MOST_RUNS, ENOUGH_MS = 3, 20, 3000


def read(path):
    """What peer_file.h wrote."""
    data, at = path.read_bytes(), 0

    def take(kind, count):
        nonlocal at
        array = np.frombuffer(data, kind, count, at)
        at += array.nbytes
        return array

    vertices, triangles, *size = (int(n) for n in take("<i8", 5))
    origin, spacing, thickness = take("<f8", 3), take("<f8", 3), float(take("<f8", 1)[0])
    return {
        "name": path.stem,
        "size": size,
        "origin": origin,
        "spacing": spacing,
        "thickness": thickness,
        "vertices": take("<f8", 3 * vertices).reshape(-1, 3),
        "triangles": take("<u4", 3 * triangles),
        "values": take("<f4", size[0] * size[1] * size[2]),
    }


def repeated(milliseconds, once):
    """What some calls of `milliseconds` give, after one to warm up."""
    milliseconds()
    runs = []
    while len(runs) < (1 if once else LEAST_RUNS) or (not once and len(runs) < MOST_RUNS and sum(runs) < ENOUGH_MS):
        runs.append(milliseconds())
    return runs


def print_row(csv, job, query, runs, build_ms, values, peer):
    """`build_ms` as text: what is not known is left empty. `values` are distances as the peer has them."""
    thickness = np.float32(min(job["thickness"], 1e30))
    off = float(np.max(np.abs(np.minimum(np.abs(values), thickness) - np.minimum(job["values"], thickness))))
    print(
        f"{job['name']},{len(job['triangles']) // 3},{query},{'x'.join(str(n) for n in job['size'])},"
        f"{job['thickness']:g},{statistics.median(runs):.4f},{min(runs):.4f},{len(runs)},{build_ms},{off:.6g},{peer}",
        file=csv,
        flush=True,
    )


def main(measure):
    """Calls measure(job, once, csv) for the files of the command line."""
    csv = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # peers talk on stdout, which is ours
    for path in sys.argv[1:]:
        if path != "--once":
            measure(read(Path(path)), "--once" in sys.argv, csv)
