# SPDX-License-Identifier: Apache-2.0
"""Distances of a million points from meshes of all kinds: standoff's MeshQuery beside Embree's point query and FCPW, and
with a sign beside libigl and Open3D. Writes points.csv and points-build.csv; output_quotes.py makes tables of them."""

import tempfile
from pathlib import Path

import numpy as np

from exact_points import compare, read_mesh
from harness import chosen, header_of, median, peer_python, results_folder, tell, write_csv

UNSIGNED, SIGNED = ("embree", "fcpw"), ("libigl", "open3d")
FORMS = ("given", "morton", "bounded")


def quickest(lines):
    """The order in which a peer is quickest in processor time, and its (wall, processor) seconds."""
    form = min((form for form in FORMS if f"{form}_s" in lines[0]), key=lambda form: median(lines, f"{form}_cpu_s"))
    return form, median(lines, f"{form}_s"), median(lines, f"{form}_cpu_s")


def ask_peer(drivers, peer, args, folder, with_sign):
    """One process of a peer; None if it is not there."""
    answers = folder / f"{peer}.f64"
    if peer == "embree":
        return drivers.run("embree_points", args, 1, forms="bounded", answers=answers) if drivers.has("embree_points") else None
    forms = "given,morton" if peer == "fcpw" else "morton"
    return peer_python("peer_points.py", peer, folder, "--repeats", 1, "--forms", forms, "--answers", answers,
                       *["--signed"] * with_sign)


def checked_points(folder, names, triangles, job, with_sign):
    """The points that all answers are checked at: some that are spread over all of them, and some whose signs differ."""
    answers = [np.fromfile(folder / f"{name}.f64") for name in names]
    few = int(np.clip(job["checked_pairs"] / triangles, 5, job["checked"]))
    some = np.linspace(0, len(answers[0]) - 1, few, dtype=int)
    differ = np.flatnonzero(np.any([(other < 0) != (answers[0] < 0) for other in answers], axis=0)) if with_sign else []
    return np.union1d(some, differ[:few]).astype(int)


def agreement(folder, name, some, with_sign):
    """Of the points with these numbers."""
    points = np.fromfile(folder / "points.f64").reshape(-1, 3)
    return compare(*read_mesh(folder), points[some], np.fromfile(folder / f"{name}.f64")[some], with_sign)


def against_libigl(folder, lines):
    """Of all points: how far our distances are from libigl's, also in double precision, and how many signs differ."""
    if "libigl" not in lines:
        return {}
    ours, theirs = (np.fromfile(folder / f"{name}.f64") for name in ("standoff", "libigl"))
    extent = np.ptp(read_mesh(folder)[0], axis=0).max()
    return {"from libigl": f"{np.abs(np.abs(ours) - np.abs(theirs)).max() / extent:.1e}",
            "signs unlike libigl's": int(((ours < 0) != (theirs < 0)).sum())}


def measure(drivers, args, peers, with_sign, rounds, folder):
    """standoff and its peers in turns: {name: [line per round]}."""
    lines = {}
    options = {"signed": True} if with_sign else {}
    for number in range(rounds):
        more = {"save": folder} if number == 0 else {}
        lines.setdefault("standoff", []).append(drivers.run("points", args, 3, answers=folder / "standoff.f64", **options, **more))
        for peer in peers:
            line = ask_peer(drivers, peer, args, folder, with_sign)
            if line:
                lines.setdefault(peer, []).append(line)
    return lines


def rows_of(mesh, where, asked, with_sign, lines, checks):
    """A row for each peer; one without a peer if none is there."""
    wall, processor = median(lines["standoff"], "given_s"), median(lines["standoff"], "given_cpu_s")
    first = {"mesh": mesh["what"], "triangles": lines["standoff"][0]["triangles"], "points": where, "asked": lines["standoff"][0]["points"],
             "sign": "yes" if with_sign else "no", "standoff s": f"{wall:.3f}", "standoff processor s": f"{processor:.3f}",
             "largest error": f"{checks['standoff']['largest_error']:.1e}", "wrong signs": checks["standoff"]["wrong_signs"],
             "compared": checks["standoff"]["compared"]}
    rows = []
    for peer in lines:
        if peer == "standoff":
            continue
        form, peer_wall, peer_processor = quickest(lines[peer])
        rows.append(first | {
            "peer": peer, "order": form, "peer s": f"{peer_wall:.3f}", "peer processor s": f"{peer_processor:.3f}",
            "peer's largest error": f"{checks[peer]['largest_error']:.1e}", "peer's wrong signs": checks[peer]["wrong_signs"],
            "ratio": f"{peer_processor / processor:.2f}x", "ratio on the wall": f"{peer_wall / wall:.2f}x",
            "at least": f"{asked['at_least']}x", "goal": f"{asked['goal']}x"})
    return rows or [first]


def build_row(mesh, lines, asked):
    """The build of the query structure without a sign, in processor time and on the wall."""
    row = {"mesh": mesh["what"], "triangles": lines["standoff"][0]["triangles"]}
    for name in lines:
        row |= {f"{name} s": f"{median(lines[name], 'build_s'):.4f}", f"{name} processor s": f"{median(lines[name], 'build_cpu_s'):.4f}"}
    for name in UNSIGNED:
        if name in lines:
            row |= {f"{name} / standoff": f"{median(lines[name], 'build_cpu_s') / median(lines['standoff'], 'build_cpu_s'):.2f}x",
                    f"{name} / standoff on the wall": f"{median(lines[name], 'build_s') / median(lines['standoff'], 'build_s'):.2f}x"}
    return row | {"at least": f"{asked['at_least']}x", "goal": f"{asked['goal']}x"}


def run(drivers, workloads, with_peers, only, rounds, build, note="", count=None):
    job = workloads["points"]
    limits = lambda kind: {key: job[key][kind] for key in ("at_least", "goal")}
    rows, builds = [], []
    header = header_of(build, note)
    for mesh in chosen(job["meshes"], only):
        for name, where in job["sets"].items():
            for with_sign in (False, True):
                with tempfile.TemporaryDirectory() as folder:
                    args = [*mesh["args"], "--points", name, "--count", str(count or job["count"])]
                    peers = (SIGNED if with_sign else UNSIGNED) if with_peers else ()
                    lines = measure(drivers, args, peers, with_sign, rounds or job["rounds"], Path(folder))
                    some = checked_points(Path(folder), [*lines], lines["standoff"][0]["triangles"], job, with_sign)
                    checks = {peer: agreement(Path(folder), peer, some, with_sign) for peer in lines}
                    more = against_libigl(Path(folder), lines)
                asked = limits("signed" if with_sign else name)
                rows += [row | more for row in rows_of(mesh, where, asked, with_sign, lines, checks)]
                if name == "box" and not with_sign:
                    builds.append(build_row(mesh, lines, limits("build")))
                if not only and with_peers:  # after each, for it takes long
                    write_csv(results_folder() / "points.csv", header, rows)
                    write_csv(results_folder() / "points-build.csv", header, builds)
    tell(header, rows, builds)
