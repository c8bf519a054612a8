# SPDX-License-Identifier: Apache-2.0
"""standoff batch over many small meshes, from files to files, beside a pool of processes with Open3D in Python. Writes
batch.csv. Needs numpy; Open3D where STANDOFF_PEER_PYTHON names a Python that has it."""

import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from harness import chosen, header_of, peer_python, results_folder, tell, write_csv
from many_fields import write_meshes

FORMATS = ("stl", "obj", "ply", "glb")


def make_meshes(folder, count):
    """The meshes, a list of them for standoff and one for others."""
    meshes = folder / "meshes"
    meshes.mkdir()
    paths, triangles = write_meshes(meshes, count, FORMATS)
    (folder / "list.txt").write_text("".join(path + "\n" for path in paths))
    (folder / "meshes.json").write_text(json.dumps({"paths": paths, "triangles": triangles}))
    return triangles


@contextlib.contextmanager
def results_in(folder):
    """A new folder for results. Its files are emptied at its end, and removed with `folder`: ext4 passes over what was removed in the
    last minutes, one by one, before it makes a file, so that one run would slow the next."""
    out = tempfile.mkdtemp(dir=folder)
    yield out
    for path in Path(out).rglob("*"):
        if path.is_file():
            os.truncate(path, 0)


def run_batch(program, folder, job):
    """One run into an empty folder; what it took."""
    with results_in(folder) as out:
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        command = [program, "batch", str(folder / "list.txt"), "-o", out, "-q", "--json", *job["args"]]
        print("  " + " ".join(command), file=sys.stderr)
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        seconds, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        assert json.loads(done.stdout)["counts"] == {"ok": json.loads(done.stdout)["listed"]}
        written = sum(path.stat().st_size for path in Path(out).rglob("*") if path.is_file())
    busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"s": seconds, "processor s": busy, "MB written": written / 1e6}


def row(what, by, count, triangles, found, ours):
    rate = count / found["s"]
    shown = {"what": what, "by": by, "meshes": count, "triangles": triangles, "s": f"{found['s']:.1f}",
             "meshes per s": f"{rate:.3g}" if rate < 100 else f"{rate:.0f}",
             "cores busy": f"{100 * found['processor s'] / found['s'] / os.cpu_count():.0f} %"}
    if "MB written" in found:
        shown["MB written"] = f"{found['MB written']:.0f}"
    return shown | ({"standoff is faster": f"{found['s'] / ours['s']:.3g}x"} if ours else {})


def run(workloads, with_peers, only, rounds, build, note="", count=None):
    """All jobs, each the median of some runs; with `only` those of that name, and nothing is written."""
    header = header_of(build, note)
    workload = workloads["batch"]
    count, rows = count or workload["meshes"], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"  making {count} meshes", file=sys.stderr)
        triangles = make_meshes(folder, count)
        for job in chosen(workload["jobs"], only):
            runs = [run_batch(str(Path(build) / "standoff"), folder, job) for _ in range(rounds or workload["rounds"])]
            found = sorted(runs, key=lambda run: run["s"])[len(runs) // 2]
            rows.append(row(job["what"], "standoff batch", count, triangles, found, None))
            line = peer_python("many_fields.py", "open3d", count, folder) if with_peers and job.get("peer") else None
            if line:
                rows.append(row(f"the same, no files; of {line['done']} meshes", "Open3D, a pool of processes", count, triangles, line, found))
    tell(header, rows)
    if not only and with_peers:
        write_csv(results_folder() / "batch.csv", header, rows)
