#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures standoff, alone or beside its peers. script/bench builds the drivers and starts this.

  run.py                 the named workloads of workloads.json
  run.py --peers         the same, alternating with OpenVDB and Embree
  run.py scaling         time against triangles and samples
  run.py thesis          the tables of the 2008 thesis, rebuilt
  run.py skip            skip rules before the thesis's Algorithm 1, with the one that it wished for
  run.py pairs           batches of collision queries with 1 and 2 threads; with --peers, queries beside FCL and Coal
  run.py sign            what a sign adds; with --peers beside OpenVDB's level sets and libigl (STANDOFF_PEER_PYTHON)
  run.py points          distances of points; with --peers beside Embree, and FCPW, libigl and Open3D (STANDOFF_PEER_PYTHON)
  run.py iso             surfaces of fields; with --peers beside OpenVDB and VTK
  run.py files           writing fields; with --peers beside OpenVDB and NanoVDB
  run.py windows         fields in 64 windows beside whole fields
  run.py update          updates of fields after 1 % of the triangles moved, beside computing anew
  run.py limits          fields beside what one core needs at least for them
  run.py sidecars        what each sidecar adds to a band
  run.py render          pictures of meshes; with --peers beside VTK and polyscope (STANDOFF_PEER_PYTHON)
  run.py python          the Python package beside Open3D, libigl, FCPW and others (STANDOFF_PEER_PYTHON)
  run.py batch           many small meshes from files to files; with --peers beside Open3D (STANDOFF_PEER_PYTHON)
  run.py scale           what many machines would take, simulated from pieces that are measured (STANDOFF_PEER_PYTHON)
  run.py methods         families of distance field algorithms: exactness, signs, time, memory (STANDOFF_PEER_PYTHON)
  run.py quote           the documentation's tables of CSV files, written again
  run.py fly             the fly in the labyrinth: Figure 5.5 of the thesis, with fields that are computed at each step, what
                         both modes miss, and the fly among millions of triangles
  run.py view            pages in a browser: size, first picture, frames a second, live fields, flights
Tables go to stdout, progress to stderr, CSV files to bench/results/<machine>/."""

import argparse
import importlib
import inspect
import json
from pathlib import Path

import collision
import quotes
from harness import BENCH, Drivers

# Which module measures what, and the driver that it needs. Some need numpy, so that only what is asked for is imported.
MEASURED = {"contests": ("contests", "standoff"), "scaling": ("scaling", "standoff"), "thesis": ("thesis_tables", "standoff"),
            "skip": ("skip_rules", "skip"), "pairs": ("collision", "collision"), "sign": ("sign", "sign"),
            "points": ("points", "points"), "iso": ("surfaces", "iso"), "files": ("field_files", "files"),
            "windows": ("windows", "windows"), "update": ("update", "update"), "limits": ("limits", "limits"),
            "sidecars": ("sidecar_costs", "sidecars"), "render": ("pictures", "render"), "python": ("python_package", None),
            "batch": ("batch", None), "scale": ("scale", None), "methods": ("methods", "exact"), "fly": ("fly", None),
            "view": ("view", None)}
QUOTED = ("thesis", "skip", "limits")  # the documentation's tables are written right after these
PEERS = {"contests": ("openvdb", "embree"), "scaling": ("openvdb", "embree"), "thesis": ("openvdb", "embree"), "sign": ("openvdb", "embree"), "pairs": collision.PEERS}


def list_of(workloads):
    """All that have names."""
    kinds = [workloads[kind] for kind in ("contests", "sign", "scaling", "batches", "files")]
    kinds += [workloads[kind]["fields"] for kind in ("iso", "sidecars", "python")]
    kinds += [workloads["points"]["meshes"], workloads["render"]["pictures"], workloads["batch"]["jobs"], workloads["collision"]["pairs"]]
    return [job for jobs in kinds for job in jobs]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", default="contests",
                        choices=[*MEASURED, "quote"])
    parser.add_argument("--peers", action="store_true", help="run the peers too (built with STANDOFF_BENCH_PEERS)")
    parser.add_argument("--build", default=str(BENCH.parent / "build" / "bench"), help="build folder of the drivers")
    parser.add_argument("--only", help="workloads or tables whose name holds this; nothing is written then (but the rows of methods)")
    parser.add_argument("--rounds", type=int, help="processes per driver, instead of what the workload says")
    parser.add_argument("--mesh", help="methods: of this mesh alone, or with its resolution: bunny-64")
    parser.add_argument("--missing", action="store_true", help="methods: only rows that are not in the table yet; pairs: only pairs that this commit has none of")
    parser.add_argument("--unstopped", action="store_true", help="methods: not again what was stopped at this limit")
    parser.add_argument("--limit", type=float, help="methods, pairs: processor seconds after which a call or a round is stopped")
    parser.add_argument("--enough", type=float, help="pairs: processor seconds after which no new round begins, instead of what the workload says")
    parser.add_argument("--count", type=int, help="of points or meshes, instead of what the workload says")
    parser.add_argument("--note", default="", help="what readers must know of this run (not of contests, scaling, thesis, sign)")
    parser.add_argument("--list", action="store_true", help="name the workloads and stop")
    arguments = parser.parse_args()

    workloads = json.loads(Path(BENCH / "workloads.json").read_text())
    drivers = Drivers(arguments.build)
    if arguments.list:
        for job in list_of(workloads):
            print(f"{job['name']:24} {job['what']}")
        return
    if arguments.what == "quote":
        return quotes.write()
    name, driver = MEASURED[arguments.what]
    if driver and not drivers.has(driver):
        parser.error(f"no drivers in {drivers.folder}; build them with script/bench {arguments.what}")
    if arguments.peers and arguments.what in PEERS and not any(map(drivers.has, PEERS[arguments.what])):
        parser.error(f"no peers in {drivers.folder}; configure with -DSTANDOFF_BENCH_PEERS=ON")
    run = importlib.import_module(name).run
    # What a module takes, by the names of its parameters.
    given = vars(arguments) | {"drivers": drivers, "workloads": workloads, "with_peers": arguments.peers}
    run(**{parameter: given[parameter] for parameter in inspect.signature(run).parameters})
    if arguments.what in QUOTED and not arguments.only:
        quotes.write()


if __name__ == "__main__":
    main()
