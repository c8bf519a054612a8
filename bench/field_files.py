# SPDX-License-Identifier: Apache-2.0
"""Writing a signed field as a file: seconds, bytes and memory, beside OpenVDB's and NanoVDB's own writers with each of their
codecs. Writes files.csv."""

import tempfile
from pathlib import Path

from harness import chosen, header_of, median, results_folder, tell, write_csv

MEGABYTE = 1e6


def row(job, name, by, lines, ours, limits):
    wall, processor = median(lines, "write_s"), median(lines, "write_cpu_s")
    peak = max(line["memory_peak"] for line in lines)
    shown = {"field": job["what"], "file": name, "by": by, "s": f"{wall:.4f}", "processor s": f"{processor:.4f}",
             "MB": f"{lines[0]['bytes'] / MEGABYTE:.1f}", "peak MB": f"{peak / MEGABYTE:.0f}",
             "of which before": f"{max(line['memory_before'] for line in lines) / MEGABYTE:.0f}"}
    if ours:
        return shown | {"ratio": f"{processor / median(ours, 'write_cpu_s'):.2f}x",
                        "ratio on the wall": f"{wall / median(ours, 'write_s'):.2f}x"}
    if limits:
        within = wall <= limits["seconds"] and peak <= limits["megabytes"] * MEGABYTE
        shown |= {"at most": f"{limits['seconds']} s, {limits['megabytes']} MB", "met": "yes" if within else "no"}
    return shown


def run_job(drivers, job, with_peers, rounds):
    """Files that this build of standoff cannot write are left out."""
    rows = []
    for name in job["formats"]:
        lines = {}
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(rounds or job["rounds"]):
                to = lambda by: Path(folder) / f"{by}.{name}"
                lines.setdefault("standoff", []).append(drivers.run("files", job["args"], job["repeats"], to=to("standoff")))
                for codec in job.get("codecs", {}).get(name, ()) if with_peers and drivers.has("openvdb_files") else ():
                    line = drivers.run("openvdb_files", job["args"], job["repeats"], to=to(codec), codec=codec)
                    lines.setdefault(f"{line['driver']}, {codec}", []).append(line)
        ours = lines.pop("standoff")
        by = "standoff" + (", computed and written in slabs" if "--slabs" in job["args"] else "")
        rows.append(row(job, name, by, ours, None, job.get("most")))
        rows += [row(job, name, by, theirs, ours, None) for by, theirs in lines.items()]
    return rows


def run(drivers, workloads, with_peers, only, rounds, build, note=""):
    header = header_of(build, note)
    rows = []
    for job in chosen(workloads["files"], only):
        rows += run_job(drivers, job, with_peers, rounds)
        if not only and with_peers:  # after each, for the large ones take long
            write_csv(results_folder() / "files.csv", header, rows)
    tell(header, rows)
