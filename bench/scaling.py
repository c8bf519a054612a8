# SPDX-License-Identifier: Apache-2.0
"""How the time grows with triangles and with samples: tables and CSV files; bench/plots.py draws them."""

import math

from harness import chosen, machine_lines, markdown, median, results_folder, seconds, write_csv

# One growth worse than this between neighbouring points is marked: a tenth above linear is noise.
WORSE_THAN_LINEAR = 1.1


def measure(drivers, series, rounds):
    """One row per value of the series, in the order of growth."""
    rows = []
    for value in series["values"]:
        args = [argument.replace("{n}", str(value)) for argument in series["args"]]
        runs = [drivers.run("standoff", args, 3) for _ in range(rounds)]
        first = runs[0]
        rows.append({
            "triangles": first["triangles"], "samples": first["samples"], "samples_band": first["samples_band"],
            "samples_examined": first["samples_examined"], "memory_peak": max(r["memory_peak"] for r in runs),
            "cold_s": median(runs, "cold_s"), "warm_s": median(runs, "warm_s"),
        })
    for row, before in zip(rows[1:], rows):
        growth = math.log(row["warm_s"] / before["warm_s"]) / math.log(row[series["axis"]] / before[series["axis"]])
        row["growth"] = round(growth, 2)
    return rows


def table(series, rows):
    shown = [{
        series["axis"]: f"{row[series['axis']]:,}",
        "cold s": seconds(row["cold_s"]),
        "warm s": seconds(row["warm_s"]),
        "ns per unit": f"{1e9 * row['warm_s'] / row[series['axis']]:.2f}",
        "growth (1: linear)": f"{row['growth']}{' (worse)' if row['growth'] > WORSE_THAN_LINEAR else ''}"
                              if "growth" in row else "",
    } for row in rows]
    return markdown(shown)


def run(drivers, workloads, only, rounds, build):
    """Measures every series (or those whose name holds `only`), prints tables, writes CSV files and plots."""
    header, folder = machine_lines(build), results_folder()
    for series in chosen(workloads["scaling"], only):
        rows = measure(drivers, series, rounds or 2)
        print(f"\n### {series['what']}\n\n{table(series, rows)}")
        if not only:
            write_csv(folder / f"scaling-{series['name']}.csv", [series["what"], *header], rows)
    print("\n" + "\n".join(header))
