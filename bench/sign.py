# SPDX-License-Identifier: Apache-2.0
"""What a sign costs: each workload of "sign" in workloads.json without and with it, in turns; beside libigl's fast
winding number where a Python with libigl is named by STANDOFF_PEER_PYTHON, and OpenVDB's level sets where they are built."""

import tempfile
from pathlib import Path

from harness import chosen, machine_lines, markdown, median, peer_python, results_folder, write_csv


def row_of(drivers, job, with_peers, rounds):
    with tempfile.TemporaryDirectory() as folder:
        mesh = str(Path(folder) / "mesh.obj")
        lines = [drivers.run("sign", [*job["args"], "--save", mesh], job.get("repeats", 7)) for _ in range(rounds or 3)]
        plain, with_sign, sign = (median(lines, key) for key in ("unsigned_s", "signed_s", "sign_s"))
        line = lines[0]
        per_second = line["samples"] / sign if sign else 0
        row = {"workload": job["what"], "method": line["method"], "triangles": line["triangles"],
               "boundary edges": line["boundary_edges"], "unsigned ms": f"{1e3 * plain:.1f}",
               "signed ms": f"{1e3 * with_sign:.1f}", "added": f"{100 * (with_sign / plain - 1):.0f} %",
               "M samples/s": f"{line['samples'] / with_sign / 1e6:.0f}",
               "sign alone, M samples/s": f"{per_second / 1e6:.0f}",
               "peak MB unsigned": f"{max(l['memory_unsigned'] for l in lines) / 2**20:.0f}",
               "signed": f"{max(l['memory_signed'] for l in lines) / 2**20:.0f}"}
        if with_peers and "peer_side" in job and (peer := peer_python("peer_libigl.py", mesh, job["peer_side"], 200_000)):
            row |= {"libigl fast, k samples/s": f"{peer['fast_per_s'] / 1e3:.0f}",
                    "ratio": f"{per_second / peer['fast_per_s']:.0f}x",
                    "libigl exact, k samples/s": f"{peer['exact_per_s'] / 1e3:.1f}"}
        if with_peers and job.get("openvdb") and drivers.has("openvdb"):
            peers = [drivers.run("openvdb", job["args"], 3, signed=True, **({"check": True} if n == 0 else {}))
                     for n in range(rounds or 3)]
            check = peers[0]["check"]
            row |= {"OpenVDB ms": f"{1e3 * median(peers, 'warm_s'):.0f}",
                    "OpenVDB / ours": f"{median(peers, 'warm_s') / with_sign:.1f}x",
                    "OpenVDB's largest error, samples": f"{check['largest_error_samples']:.2g}"}
        return row


def run(drivers, workloads, with_peers, only, rounds, build):
    rows = [row_of(drivers, job, with_peers, rounds) for job in chosen(workloads["sign"], only)]
    print(markdown(rows))
    if not only:
        write_csv(results_folder() / "sign.csv", machine_lines(build), rows)
