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
import json
from pathlib import Path

import collision
import contests
import field_files
import fly
import limits
import pictures
import quotes
import scaling
import sidecar_costs
import sign
import skip_rules
import thesis_tables
import update
import windows
from harness import BENCH, Drivers


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", default="contests",
                        choices=["contests", "scaling", "thesis", "skip", "pairs", "sign", "points", "iso", "files", "windows", "update", "limits", "sidecars", "render", "python", "batch", "scale", "methods",
                                 "quote", "fly", "view"])
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
        kinds = [workloads[kind] for kind in ("contests", "sign", "scaling", "batches")]
        kinds += [workloads["points"]["meshes"], workloads["iso"]["fields"], workloads["files"], workloads["sidecars"]["fields"], workloads["render"]["pictures"]]
        kinds += [workloads["python"]["fields"], workloads["batch"]["jobs"]]
        kinds += [workloads["collision"]["pairs"]]
        for job in (job for jobs in kinds for job in jobs):
            print(f"{job['name']:24} {job['what']}")
        return
    if arguments.what == "quote":
        return quotes.write()
    if arguments.what == "python":  # needs numpy
        return importlib.import_module("python_package").run(workloads["python"], arguments.only, arguments.note, arguments.build)
    if arguments.what == "batch":  # needs numpy
        return importlib.import_module("batch").run(workloads["batch"], arguments.peers, arguments.only, arguments.rounds, arguments.build, arguments.note,
                                                    arguments.count)
    if arguments.what == "scale":  # needs numpy
        return importlib.import_module("scale").run(workloads["scale"], arguments.only, arguments.build, arguments.note)
    if arguments.what == "methods":  # needs numpy
        if not drivers.has("exact"):
            parser.error(f"no drivers in {drivers.folder}; build them with script/bench methods")
        return importlib.import_module("methods").run(drivers, arguments.only, arguments.mesh, arguments.limit, arguments.missing, arguments.unstopped,
                                                      arguments.note, arguments.build)
    if arguments.what == "fly":
        return fly.run(workloads, arguments.build, arguments.note)
    if arguments.what == "view":  # needs a browser
        return importlib.import_module("view").run(arguments.build, arguments.only, arguments.rounds, arguments.note)
    if arguments.what == "pairs":
        if not drivers.has("collision") or arguments.peers and not any(map(drivers.has, collision.PEERS)):
            parser.error(f"no drivers in {drivers.folder}; build them with script/bench pairs --peers")
        return collision.run(drivers, workloads, arguments.peers, arguments.only, arguments.rounds, arguments.build,
                             arguments.note, arguments.missing, arguments.enough, arguments.limit)
    if arguments.what in ("points", "iso", "files", "sidecars", "render"):
        if not drivers.has(arguments.what):
            parser.error(f"no drivers in {drivers.folder}; build them with script/bench {arguments.what}")
        if arguments.what == "sidecars":
            return sidecar_costs.run(drivers, workloads, arguments.only, arguments.rounds, arguments.build, arguments.note)
        if arguments.what in ("files", "render"):
            measured = {"files": field_files, "render": pictures}[arguments.what]
        else:  # these need numpy
            measured = importlib.import_module({"points": "points", "iso": "surfaces"}[arguments.what])
        more = {"count": arguments.count} if arguments.what == "points" else {}
        return measured.run(drivers, workloads, arguments.peers, arguments.only, arguments.rounds, arguments.build, arguments.note, **more)
    if arguments.what == "update":
        return update.run(drivers, workloads, arguments.only, arguments.build, arguments.note)
    if arguments.what == "limits":
        limits.run(drivers, workloads, arguments.only, arguments.build, arguments.note)
        return None if arguments.only else quotes.write()
    if arguments.what == "windows":
        return windows.run(drivers, workloads, arguments.only, arguments.build, arguments.note)
    if arguments.what == "skip":
        if not drivers.has("skip"):
            parser.error(f"no drivers in {drivers.folder}; build them with script/bench skip")
        skip_rules.run(drivers, arguments.only, arguments.build, arguments.note)
        return None if arguments.only else quotes.write()
    if not drivers.has("standoff"):
        parser.error(f"no drivers in {drivers.folder}; build them with script/bench")
    if arguments.peers and not (drivers.has("openvdb") or drivers.has("embree")):
        parser.error(f"no peers in {drivers.folder}; configure with -DSTANDOFF_BENCH_PEERS=ON")
    if arguments.what == "contests":
        contests.run(drivers, workloads, arguments.peers, arguments.only, arguments.rounds, arguments.build)
    elif arguments.what == "sign":
        sign.run(drivers, workloads, arguments.peers, arguments.only, arguments.rounds, arguments.build)
    elif arguments.what == "scaling":
        scaling.run(drivers, workloads, arguments.only, arguments.rounds, arguments.build)
    else:
        thesis_tables.run(drivers, arguments.only, arguments.build)
        if not arguments.only:
            quotes.write()


if __name__ == "__main__":
    main()
