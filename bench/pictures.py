# SPDX-License-Identifier: Apache-2.0
"""Pictures of meshes, from arrays in memory to a PNG file, beside VTK and polyscope in software. Writes render.csv."""

import tempfile
from pathlib import Path

from harness import chosen, header_of, median, peer_python, results_folder, seconds, tell, write_csv

PEERS = {"vtk": "VTK", "polyscope": "polyscope"}


def measure(drivers, picture, with_peers, rounds, folder):
    """standoff with and without shadows, and its peers, in turns: {name: [line per round]}."""
    width, height = picture["size"].split("x")
    args = [*picture["args"], "--width", width, "--height", height, *["--slice"] * picture.get("slice", False)]
    lines = {}
    for _ in range(rounds):
        lines.setdefault("standoff", []).append(drivers.run("render", args, 3, save=folder))
        lines.setdefault("standoff, no shadows", []).append(drivers.run("render", [*args, "--no-shadows"], 3))
        for peer in PEERS if with_peers else ():
            line = peer_python("peer_render.py", peer, folder, "--size", picture["size"], *["--slice"] * picture.get("slice", False))
            if line:
                lines.setdefault(peer, []).append(line)
    return lines


def rows_of(picture, lines):
    """A row for each way; the ratios are those of the seconds of standoff's picture with shadows, which peers do not draw."""
    rows = []
    for name, own in lines.items():
        row = {"picture": picture["what"], "by": f"{PEERS[name]} {own[0]['version']}" if name in PEERS else name,
               "first s": seconds(median(own, "first_s")), "processor s": seconds(median(own, "first_cpu_s")),
               "each of 8 s": seconds(median(own, "turns_s"))}
        if name in PEERS:
            ours = lines["standoff"]
            row |= {"ratio": f"{median(own, 'first_s') / median(ours, 'first_s'):.2f}x",
                    "ratio, each of 8": f"{median(own, 'turns_s') / median(ours, 'turns_s'):.2f}x"}
        elif name == "standoff" and "at_most" in picture:
            row |= {"at most": picture["at_most"], "goal": picture["goal"]}
        rows.append(row)
    return rows


def run(drivers, workloads, with_peers, only, rounds, build, note=""):
    job = workloads["render"]
    rows = []
    for picture in chosen(job["pictures"], only):
        with tempfile.TemporaryDirectory() as name:
            rows += rows_of(picture, measure(drivers, picture, with_peers, rounds or job["rounds"], Path(name)))
    header = header_of(build, note)
    tell(header, rows)
    if not only and with_peers:
        write_csv(results_folder() / "render.csv", header, rows)
