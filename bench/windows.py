# SPDX-License-Identifier: Apache-2.0
"""Fields in windows beside whole fields, by turns in one process: what 64 windows cost more, in time of all processors. Writes
windows.csv."""

from harness import chosen, header_of, results_folder, seconds, tell, write_csv


def row(job, line):
    ratio = lambda windows, whole: f"{100 * (line[windows] / line[whole] - 1):+.1f} %"
    return {"field": job["what"], "windows": line["windows"], "whole, processor s": seconds(line["whole_cpu_s"]),
            "windows, processor s": seconds(line["windows_cpu_s"]), "of which prepare": seconds(line["prepare_cpu_s"]),
            "more": ratio("windows_cpu_s", "whole_cpu_s"), "more on the wall": ratio("windows_s", "whole_s")}


def run(drivers, workloads, only, build, note=""):
    header = header_of(build, note)
    rows = [row(job, drivers.run("windows", job["args"], 5)) for job in chosen(workloads["windows"], only)]
    tell(header, rows)
    if not only:
        write_csv(results_folder() / "windows.csv", header, rows)
