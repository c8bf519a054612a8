# SPDX-License-Identifier: Apache-2.0
"""What N machines would take for one field of 32,768 samples a side and for a million meshes: measured pieces (scale_measure.py,
standoff batch), put together by a simulation of tasks, and held against one and two workers here. Writes scale.csv. Needs
numpy, and STANDOFF_PEER_PYTHON: a Python with standoff[dask]."""

import heapq
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from batch import make_meshes, results_in
from harness import chosen, header_of, peer_python, results_folder, tell, write_csv

MACHINES = (1, 2, 10, 100, 1000)
# What no machine here can tell. Change them to those of the cluster at hand.
NETWORK = 1.25e9  # bytes per second of each machine, 10 Gbit/s
STORE = 2e9  # bytes per second that the common file system or bucket takes in from all machines together
FILES = 5e3  # files per second that it makes
SEED = 7


def field_seconds(found, workers, dask, network=math.inf, store=math.inf, files=math.inf, cores=math.inf):
    """Simulated: the client looks at all windows, the scheduler gives tasks of some windows one after the other, the mesh spreads from
    worker to worker, each prepares it and computes windows whose times are drawn from those measured. `cores`: that workers, client
    and scheduler share. Returns seconds and what limits."""
    draw = random.Random(SEED)
    counts, tries = found["windows"], found["tries"]
    windows = [draw.choice(tries[kind]) for kind in ("surface", "inside") for _ in range(counts[kind])]
    draw.shuffle(windows)
    side_by_side = min(dask["most_of_a_task"], max(1, len(windows) // (dask["tasks_of_a_thread"] * workers)))
    tasks = [sum(took for took, _ in windows[at : at + side_by_side]) for at in range(0, len(windows), side_by_side)]
    task, byte = dask["task_s"], dask["copy_s"] + 1 / network
    client = found["prepare_s"] + found["look_s"] * sum(counts.values()) + dask["send_s"] * found["mesh_bytes"]
    copies = math.ceil(math.log2(workers)) * byte * found["mesh_bytes"]
    begin = client + copies + found["prepare_s"]
    free = [begin] * workers
    heapq.heapify(free)
    for n, took in enumerate(tasks, start=1):
        heapq.heappush(free, max(heapq.heappop(free), client + n * task) + took)
    bounds = {"workers": max(free), "scheduler": client + len(tasks) * task, "bytes into the store": sum(size for _, size in windows) / store,
              "files of the store": len(windows) / files, "cores": begin + (sum(tasks) + len(tasks) * task) / cores}
    limit = max(bounds, key=bounds.get)
    if limit == "workers" and bounds["scheduler"] > 0.9 * bounds["workers"]:
        limit = "scheduler"
    if limit == "workers" and begin > 0.5 * bounds["workers"]:
        limit = "what is done once"
    return bounds[limit] if limit != "what is done once" else bounds["workers"], limit


def batch_seconds(pieces, meshes, machines, cores, files=math.inf):
    """Simulated: each machine has every machines-th mesh, and its cores take them one by one."""
    draw, longest = random.Random(SEED), 0.0
    for machine in range(min(machines, 100)):  # of more, the rest are like these
        count = len(range(machine, meshes, machines))
        if count * 100 > meshes:  # enough for the mean
            mine = count * sum(pieces) / len(pieces)
        else:
            mine = sum(draw.choices(pieces, k=count))
        longest = max(longest, mine / cores + max(pieces))
    bounds = {"workers": longest, "files of the store": meshes / files}
    limit = max(bounds, key=bounds.get)
    return bounds[limit], limit


def batch_pieces(program, folder, workers):
    """Seconds of a core for each mesh, and of the whole run, with so many workers."""
    with results_in(folder) as out:
        began = time.perf_counter()
        subprocess.run([program, "batch", str(folder / "list.txt"), "-o", out, "-q", "-r", "64", "-t", "3s", "-j", str(workers)], check=True)
        took = time.perf_counter() - began
        rows = [json.loads(line) for line in (Path(out) / "manifest.jsonl").read_text().splitlines()]
    return [row["seconds"]["total"] for row in rows], took


def shown(seconds):
    for most, unit, by in ((120, "s", 1), (7200, "min", 60), (172_800, "h", 3600)):
        if seconds < most:
            return f"{seconds / by:.3g} {unit}"
    return f"{seconds / 86_400:.3g} days"


def run(workloads, only, build, note=""):
    workload, header = workloads["scale"], header_of(build, note)
    header.append(f"assumed: {NETWORK:.3g} bytes/s of network a machine, {STORE:.3g} bytes/s and {FILES:.3g} files/s of the store")
    program = str(Path(build) / "standoff")
    jobs = chosen(workload["fields"], only)
    rows, checks = [], []
    found = peer_python("scale_measure.py", program, *map(json.dumps, jobs))
    if found is None:
        sys.exit("bench: scale needs STANDOFF_PEER_PYTHON, a Python with standoff[dask]")
    for job, pieces in zip(jobs, found["fields"]):
        for workers, measured in sorted(pieces.get("measured_s", {}).items()):
            simulated = field_seconds(pieces, int(workers), found["dask"], cores=os.cpu_count())[0]
            checks.append({"job": job["what"], "workers": workers, "simulated": shown(simulated), "measured": shown(measured),
                           "measured / simulated": f"{measured / simulated:.2f}"})
        if "measured_s" in pieces:
            continue
        for machines in MACHINES:
            seconds, limit = field_seconds(pieces, machines * os.cpu_count(), found["dask"], NETWORK, STORE, FILES)
            rows.append({"job": job["what"], "machines": machines, "time": shown(seconds), "limited by": limit})
        print(f"  {job['name']}: {pieces['windows']}, prepared in {pieces['prepare_s']:.2f} s, " + ", ".join(
            f"{kind}: {sum(t for t, _ in tries) / len(tries):.3f} s and {sum(b for _, b in tries) / len(tries) / 1e6:.2f} MB" for kind, tries
            in pieces["tries"].items() if tries), file=sys.stderr)
    if not only or only in "batch":
        batch = workload["batch"]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            make_meshes(folder, batch["tries"])
            for workers in (1, 2):
                pieces, took = batch_pieces(program, folder, workers)
                simulated = batch_seconds(pieces, batch["tries"], 1, workers)[0]
                checks.append({"job": f"{batch['tries']} meshes", "workers": workers, "simulated": shown(simulated), "measured": shown(took),
                               "measured / simulated": f"{took / simulated:.2f}"})
        for machines in MACHINES:
            seconds, limit = batch_seconds(pieces, batch["meshes"], machines, os.cpu_count(), FILES)
            rows.append({"job": batch["what"], "machines": machines, "time": shown(seconds), "limited by": limit})
    tell(header, checks, rows)
    if not only:
        write_csv(results_folder() / "scale.csv", header, rows)
        write_csv(results_folder() / "scale-check.csv", header, checks)
