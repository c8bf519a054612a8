# SPDX-License-Identifier: Apache-2.0
"""Updates of fields after 1 % of the triangles moved, in one place, by update_field() and by a LiveField, beside computing
anew, by turns in one process. Writes update.csv."""

from harness import chosen, header_of, results_folder, seconds, tell, write_csv


def row(job, line):
    return {"field": job["what"], "sign": job["sign"], "anew, s": seconds(line["anew_s"]), "update, s": seconds(line["update_s"]),
            "live, s": seconds(line["live_s"]),
            "times": f"{line['anew_s'] / line['update_s']:.1f}",
            "times, processor": f"{line['anew_cpu_s'] / line['update_cpu_s']:.1f}",
            "live, times": f"{line['anew_s'] / line['live_s']:.1f}",
            "live, times, processor": f"{line['anew_cpu_s'] / line['live_cpu_s']:.1f}",
            "live, hash, s": seconds(line["field_s"]), "live, made, s": seconds(line["make_live_s"]),
            "triangles moved": line["changed"], "tiles computed": line["tiles_computed"], "tiles changed": line["tiles_changed"]}


def run(drivers, workloads, only, build, note=""):
    header = header_of(build, note)
    rows = [row(job, drivers.run("update", job["args"], 9)) for job in chosen(workloads["update"], only)]
    tell(header, rows)
    if not only:
        write_csv(results_folder() / "update.csv", header, rows)
