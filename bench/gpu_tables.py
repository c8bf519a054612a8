# SPDX-License-Identifier: Apache-2.0
"""gpu_tables.py FOLDER: what script/gpu-check measured, as tables beside the thesis's figures, our goals, and what was
predicted for this GPU before (gpu_predictions.csv).

Reads gpu.csv, table-5.4.csv and, where they are there, peer.csv and kernels.csv; prints Markdown."""

import sys
from pathlib import Path

from gpu_jobs import rows_of
from harness import BENCH, markdown


def ms(text):
    return f"{float(text):.3g}"


def predictions(machine):
    """What was predicted, on paper, for the GPU and the kernels that the machine's description names: the job's columns to a
    range."""
    return {(p["scene"], p["method"], p["output"], p["grid"], p["thickness"]): f"{p['ms_from']}-{p['ms_to']}"
            for p in rows_of(BENCH / "gpu_predictions.csv") if p["gpu"] in machine and p["standoff"] in machine}


def goals(rows, peers, predicted):
    """Our jobs; beside the dense and the signed ones how many times longer Warp took."""
    peer = {}
    for row in peers:
        if row["query"] == "mesh_query_point":
            peer[row["job"]] = float(row["median_ms"])
    shown = []
    for row in rows:
        job = f"{row['scene']}-{row['thickness']}-{row['grid'].split('x')[0]}"
        compared = row["method"] == "tiles" and row["output"] in ("dense", "signed") and job in peer
        key = (row["scene"], row["method"], row["output"], row["grid"], row["thickness"])
        shown.append({"scene": row["scene"], "triangles": f"{int(row['triangles']):,}", "method": row["method"],
                      "output": row["output"], "grid": row["grid"], "thickness": row["thickness"],
                      "ms": ms(row["median_ms"]), "at most": row["at_most_ms"],
                      **({"predicted": predicted.get(key, "-")} if predicted else {}),
                      "GB/s written": row["written_gb_per_s"],
                      **({"Warp, times as long": f"{peer[job] / float(row['median_ms']):.3g}" if compared else ""}
                         if peers else {})})
    return shown


def quoted_goals(rows, before):
    """Our jobs, as the documentation shows them: beside what we want, and what the kernels of the first run took."""
    key = lambda row: tuple(row[name] for name in ("scene", "method", "output", "grid", "thickness"))
    first = {key(row): row for row in before if row["table"] == "goal"}
    return [{"scene": row["scene"], "triangles": f"{int(row['triangles']):,}", "method": row["method"],
             "output": row["output"], "grid": row["grid"], "thickness": row["thickness"], "ms": ms(row["median_ms"]),
             "wanted, ms": row["at_most_ms"],
             "first run, ms": ms(first[key(row)]["median_ms"]) if key(row) in first else "-"}
            for row in rows if row["table"] == "goal"]


def quoted_grids(rows, before, scenes):
    """Table 5.1's grids of some scenes, by both methods, beside what `tiles` took in the first run."""
    first = {(row["scene"], row["grid"]): row for row in before if (row["table"], row["method"]) == ("table_5.1", "tiles")}
    table = []
    for job in beside_thesis([row for row in rows if row["table"] == "table_5.1" and row["scene"] in scenes]):
        shown = {name: job[name] for name in ("scene", "triangles", "grid", "2008, s", "thesis, ms", "tiles, ms")}
        table.append(shown | {"tiles, first run, ms": ms(first[job["scene"], job["grid"]]["median_ms"])})
    return table


def quoted_devices(rows):
    """The GPU beside the CPU. A size is TRIANGLES@SAMPLES/SPACINGS of a field, TRIANGLES@POINTS or POSES of queries."""
    table = []
    for row in rows:
        triangles, _, asked = row["size"].rpartition("@")
        samples, _, spacings = asked.partition("/")
        what = f"{int(samples):,}" if not spacings else f"{samples}, " + ("full" if int(spacings) > 1000 else f"band {spacings}")
        table.append({"work": row["work"], "scene": row["scene"], "triangles": f"{int(triangles):,}" if triangles else "-",
                      "samples a side, points or poses": what, "CPU, ms": ms(row["cpu_ms"]), "GPU, ms": ms(row["gpu_ms"]),
                      "ratio": f"{float(row['ratio']):.2f}x"})
    return table


def beside_thesis(rows):
    """A row a job of the thesis, both methods in it."""
    jobs = {}
    for row in rows:
        key = (row["scene"], row["grid"], row["thickness"])
        job = jobs.setdefault(key, {"scene": row["scene"], "triangles": f"{int(row['triangles']):,}",
                                    "grid": row["grid"], "thickness": row["thickness"],
                                    "2008, s": row["seconds_2008"]})
        job[f"{row['method']}, ms"] = ms(row["median_ms"])
        if row["method"] == "thesis":
            job["examined"] = f"{int(row['samples_examined']):,}"
    columns = list(dict.fromkeys(name for job in jobs.values() for name in job))
    return [{name: job.get(name, "") for name in columns} for job in jobs.values()]


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    folder = Path(sys.argv[1])
    rows = rows_of(folder / "gpu.csv")
    peers, kernels = rows_of(folder / "peer.csv"), rows_of(folder / "kernels.csv")
    machine = (folder / "machine.txt").read_text()
    print("# What script/gpu-check measured\n")
    print("Scenes made by code stand in for the thesis's meshes. Medians, device memory to device memory.\n")
    print(machine)
    predicted = predictions(machine)
    print(f"## Goals\n\n{markdown(goals([r for r in rows if r['table'] == 'goal'], peers, predicted))}\n")
    if predicted:
        print("*predicted*: milliseconds, from counts and compiled instructions, before any GPU ran this. Not a measurement.\n")
    for table in ("figure_1.1", "table_5.1", "table_5.2", "table_5.3", "table_5.5"):
        if not any(r["table"] == table for r in rows):
            continue  # after script/gpu-check --quick
        title = table.replace("_", " ").capitalize()
        print(f"## {title}\n\n{markdown(beside_thesis([r for r in rows if r['table'] == table]))}\n")
    parts = rows_of(folder / "table-5.4.csv")
    if parts:
        print("## Table 5.4: where the time goes\n")
        print(markdown([{"method": p["method"], "part": p["part"], "ms": ms(p["ms"]), "2008, s": p["seconds_2008"]}
                        for p in parts]))
    if kernels:
        print(f"\n## Kernels, as compiled\n\n{markdown(kernels)}")
    if peers:
        print(f"\n## Peer\n\n{markdown(peers)}")


if __name__ == "__main__":
    main()
