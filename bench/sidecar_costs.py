# SPDX-License-Identifier: Apache-2.0
"""What each sidecar adds to a band of distances. Writes sidecars.csv."""

from harness import chosen, header_of, median, results_folder, tell, write_csv

KINDS = ("nearest", "closest_point", "barycentric", "feature", "gradient")


def row_of(job, limits, lines):
    """Nearest triangles are stored by the same pass; each other sidecar is made of them, after it."""
    band = median(lines, "band_cpu_s")
    added = {"nearest": median(lines, "nearest_cpu_s") - band} | {kind: median(lines, f"{kind}_cpu_s") for kind in KINDS[1:]}
    return {"field": job["what"], "triangles": lines[0]["triangles"], "band ms": f"{1e3 * median(lines, 'band_s'):.1f}",
            "processor ms": f"{1e3 * band:.1f}"} | {kind: f"{100 * added[kind] / band:.1f} %" for kind in KINDS} | {
                "at most": f"{limits['most']} %", "goal": f"{limits['goal']} %"}


def run(drivers, workloads, only, rounds, build, note=""):
    job = workloads["sidecars"]
    rows = []
    for field in chosen(job["fields"], only):
        lines = [drivers.run("sidecars", field["args"], 5) for _ in range(rounds or job["rounds"])]
        rows.append(row_of(field, job, lines))
    header = header_of(build, note)
    tell(header, rows)
    if not only:
        write_csv(results_folder() / "sidecars.csv", header, rows)
