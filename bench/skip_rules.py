# SPDX-License-Identifier: Apache-2.0
"""Skip rules before Algorithm 1, on the coarsest and the finest grid of each mesh of the thesis's Table 5.1: the thesis's own,
and one that compares a triangle with all others, which it wished for."""

import json

from harness import BENCH, header_of, markdown, results_folder, seconds, write_csv
from thesis_tables import arguments, by_axis


def measure(drivers, mesh, row):
    """A row for each rule."""
    found = drivers.run("skip", arguments(mesh, row), 5, threads=1)
    return [{"mesh": mesh["mesh"], "triangles": found["triangles"], "grid": by_axis(row["grid"]), "method": one["method"], "rule": one["rule"],
             "skipped": one["skipped"], "examined": one["samples_examined"], "rule_cpu_s": round(one.get("rule_cpu_s", 0), 6),
             "compute_cpu_s": round(one["compute_cpu_s"], 6), "band": one["band"], "band_exact": one["band_exact"],
             "largest_error_samples": round(one["largest_error_samples"], 4), "mean_error_samples": round(one["mean_error_samples"], 6)}
            for one in found["rules"]]


def table(rows):
    """A line for each grid, from the rows of the CSV file."""
    lines = []
    for mesh, grid in dict.fromkeys((row["mesh"], row["grid"]) for row in rows):
        by = {(row["method"], row["rule"]): row for row in rows if (row["mesh"], row["grid"]) == (mesh, grid)}
        none, neighbour, any_other, tiles = (by[key] for key in (("thesis", "none"), ("thesis", "neighbour"), ("thesis", "any"), ("tiles", "none")))
        whole = lambda row: f"{int(row['skipped']):,}"
        lost = lambda row: f"{1 - int(row['band']) / int(row['band_exact']):.1%}".replace("%", " %").replace("-0.0", "0.0")
        error = lambda row: f"{float(row['largest_error_samples']):.2f}, {float(row['mean_error_samples']):.4f}"
        time = lambda row: seconds(float(row["rule_cpu_s"]) + float(row["compute_cpu_s"]))
        lines.append({
            "mesh": "" if any(line["mesh"] == mesh for line in lines) else mesh, "grid": grid,
            "neighbour drops": whole(neighbour), "any drops": whole(any_other),
            "any examines": f"{int(any_other['examined']) / int(none['examined']):.0%}".replace("%", " %"),
            "neighbour, errors": error(neighbour), "any, errors": error(any_other),
            "neighbour, band lost": lost(neighbour), "any, band lost": lost(any_other),
            "none, s": time(none), "neighbour, s": time(neighbour), "any, s": time(any_other),
            "of it the rule, s": seconds(float(any_other["rule_cpu_s"])), "tiles, s": time(tiles)})
    return lines


def run(drivers, only, build, note):
    """Measures, prints the table, and writes the CSV file unless `only` some meshes are measured."""
    tables = json.loads((BENCH / "thesis.json").read_text())["tables"]
    meshes = [mesh for mesh in tables[0]["meshes"] if not only or only in mesh["mesh"]]
    rows = [row for mesh in meshes for job in (mesh["rows"][0], mesh["rows"][-1]) for row in measure(drivers, mesh, job)]
    print(markdown(table(rows)))
    if not only:
        write_csv(results_folder() / "skip.csv", ["scenes made by code stand in for the thesis's meshes", *header_of(build, note)], rows)
