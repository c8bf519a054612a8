# SPDX-License-Identifier: Apache-2.0
"""Fields beside their floor: what one core of this machine needs at least to read the mesh once, to measure each sample that gets
a distance once, and to write the field once. Writes limits.csv, which docs/limits.md quotes."""

from harness import ENOUGH, chosen, header_of, results_folder, tell, write_csv


def row(job, rates, line):
    """`line`: of bench_standoff with one thread, `rates`: of bench_limits."""
    read = line["mesh_bytes"] * rates["read_s_per_byte"]
    write = line["output_bytes"] * rates["write_s_per_byte"]
    measure = line["samples_band"] * rates["measure_s"]
    floor, taken = read + measure + write, line["warm_cpu_s"] or line["cold_cpu_s"]
    ms = lambda value: f"{1e3 * value:.{1 if value < 0.1 else 0}f}"
    return {"field": job["what"], "sign": line["sign"], "triangles": line["triangles"], "samples with a distance": line["samples_band"],
            "read, ms": ms(read), "measure, ms": ms(measure), "write, ms": ms(write), "floor, ms": ms(floor),
            "measured, ms": ms(taken), "first call, ms": ms(line["cold_cpu_s"]), "times the floor": f"{taken / floor:.1f}",
            "triangles measured for a sample": f"{line['samples_examined'] / line['samples_band']:.0f}"}


def jobs(contests):
    """Each contest's field, and the bands signed, too."""
    for job in contests:
        yield job, []
        if job["name"].startswith("band-2"):
            yield job, ["--sign", "auto"]


def run(drivers, workloads, only, build, note=""):
    rates = drivers.run("limits", [], 9)
    header = header_of(build, note) + [
        f"one core writes {1e-9 / rates['write_s_per_byte']:.1f} GB/s, reads {1e-9 / rates['read_s_per_byte']:.1f} GB/s, measures a sample in "
        f"{1e9 * rates['measure_s']:.2f} ns"]
    rows = [row(job, rates, drivers.run("standoff", [*job["args"], *sign], 7, threads=1, enough=ENOUGH))
            for job, sign in jobs(chosen(workloads["contests"], only))]
    tell(header, rows)
    if not only:
        write_csv(results_folder() / "limits.csv", header, rows)
