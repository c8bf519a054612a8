# SPDX-License-Identifier: Apache-2.0
"""Fields in windows beside whole fields, by turns in one process: what 64 windows cost more, in time of all processors. Writes
windows.csv."""

from harness import machine_lines, markdown, results_folder, seconds, write_csv


def row(job, line):
    ratio = lambda windows, whole: f"{100 * (line[windows] / line[whole] - 1):+.1f} %"
    return {"field": job["what"], "windows": line["windows"], "whole, processor s": seconds(line["whole_cpu_s"]),
            "windows, processor s": seconds(line["windows_cpu_s"]), "of which prepare": seconds(line["prepare_cpu_s"]),
            "more": ratio("windows_cpu_s", "whole_cpu_s"), "more on the wall": ratio("windows_s", "whole_s")}


def run(drivers, workloads, only, build, note=""):
    header = machine_lines(build) + ([f"note: {note}"] if note else [])
    rows = [row(job, drivers.run("windows", job["args"], 5)) for job in workloads["windows"] if not only or only in job["name"]]
    print("\n\n".join(["\n".join(f"- {line}" for line in header), markdown(rows)]))
    if not only:
        write_csv(results_folder() / "windows.csv", header, rows)
