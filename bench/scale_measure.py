# SPDX-License-Identifier: Apache-2.0
"""scale_measure.py PROGRAM JOB...: what the model of scale.py is made of, measured here; one JSON line. Each JOB is a JSON object.
Returns 3 if this Python lacks standoff or Dask."""

import json
import random
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

try:
    import distributed
    import numpy as np
    import standoff as so
    import standoff.dask as sd
    from standoff._targets import Target
    from standoff.dask import _write
except ImportError:
    sys.exit(3)

SEED = 5


def mesh_of(program, scene, folder):
    path = Path(folder) / (scene.replace(":", "-") + ".ply")
    name, _, triangles = scene.removeprefix("scene:").partition(":")
    subprocess.run([program, "generate", name, *(["--triangles", triangles] if triangles else []), "-o", str(path)], check=True,
                   capture_output=True)
    return so.read(path)


def counted(windows):
    """Windows at the surface, and a sample of the others, which are inside or outside; how many there are of each kind, and what
    looking at one of all takes."""
    began, found, others = time.perf_counter(), {"surface": [], "inside": [], "outside": []}, []
    for first, shape in windows:
        (found["surface"] if windows.is_reached(first, shape) else others).append((first, shape))
    reached_s, total = time.perf_counter() - began, len(found["surface"]) + len(others)
    some = random.Random(SEED).sample(others, min(200, len(others)))
    began = time.perf_counter()
    for first, shape in some:
        found["outside" if windows.is_empty(first, shape) else "inside"].append((first, shape))
    look = (reached_s + (time.perf_counter() - began) * len(others) / max(1, len(some))) / total
    counts = {kind: len(places) for kind, places in found.items()}
    for kind in ("inside", "outside"):
        counts[kind] = round(counts[kind] * len(others) / max(1, len(some)))
    return found, counts, look


def tried(windows, store, places, count):
    """Seconds of this process, and bytes, of some windows that are computed and written as shards."""
    rows = []
    for first, shape in random.Random(SEED).sample(places, min(count, len(places))):
        before = sum(file.stat().st_size for file in store.rglob("*") if file.is_file())
        began = time.process_time()
        target = Target(str(store), None)
        target.write(first, windows.field(first, shape), 1)
        took = time.process_time() - began
        rows.append((took, sum(file.stat().st_size for file in store.rglob("*") if file.is_file()) - before))
    return rows


def field_job(mesh, job, folder):
    """The windows of a large field: how many, and what some of them take."""
    arguments = {"resolution": job["resolution"], "band": job["band"], "sign": "auto"}
    began = time.process_time()
    windows = so.FieldWindows(mesh, window=job["shard"], threads=1, device="cpu", **arguments)
    prepare = time.process_time() - began
    found, counts, looking = counted(windows)
    store = Path(folder) / "store.zarr"
    shard = (job["shard"],) * 3
    Target(str(store), None).create(windows._windows, windows.grid, windows.thickness, shard, (32, 32, 32), True)
    tries = {kind: tried(windows, store, found[kind], job["tries"]) for kind in ("surface", "inside")}
    return {"name": job["name"], "windows": counts, "prepare_s": prepare,
            "look_s": looking, "tries": tries, "mesh_bytes": mesh.vertices.nbytes + mesh.faces.nbytes}


def same(data):
    return data


def dask_seconds(workers):
    """What Dask's scheduler takes for a task that does nothing, and what a byte takes from the client to a worker, and from there to
    another one."""
    count, data = 3000, np.random.default_rng(SEED).bytes(100_000_000)
    with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        client.gather(client.map(abs, range(100), pure=False))
        began = time.perf_counter()
        client.gather(client.map(abs, range(count), pure=False))
        task = (time.perf_counter() - began) / count
        first, second = client.scheduler_info()["workers"]
        began = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            held = client.submit(same, data, workers=[first])
        distributed.wait(held)
        sent = time.perf_counter()
        client.submit(len, held, workers=[second]).result()
        return {"tasks_of_a_thread": _write.TASKS_OF_A_THREAD, "most_of_a_task": _write.MOST_OF_A_TASK, "task_s": task,
                "send_s": (sent - began) / len(data), "copy_s": (time.perf_counter() - sent) / len(data)}


def checked(mesh, job, folder):
    """The same field by one worker and by two, on the wall."""
    seconds = {}
    for workers in (1, 2):
        with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
            client.wait_for_workers(workers)
            began = time.perf_counter()
            sd.write(str(Path(folder) / f"{workers}.zarr"), mesh, resolution=job["resolution"], band=job["band"], shard=job["shard"],
                     client=client)
            seconds[workers] = time.perf_counter() - began
    return seconds


def main():
    program, *jobs = sys.argv[1:]
    results = {"dask": dask_seconds(2), "fields": []}
    for job in map(json.loads, jobs):
        with tempfile.TemporaryDirectory() as folder:
            mesh = mesh_of(program, job["scene"], folder)
            found = field_job(mesh, job, folder)
            if job.get("check"):
                found["measured_s"] = checked(mesh, job, folder)
            results["fields"].append(found)
    print(json.dumps(results))


if __name__ == "__main__":
    main()
