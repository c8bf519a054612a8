# SPDX-License-Identifier: Apache-2.0
"""What the documentation says of measured collision queries, of fields on a GPU, of skip rules and of the thesis's tables,
written from the CSV files of one machine each: pages of their own and the parts of others between markers.
tests/bench/collision_tables_test.py compares them."""

import csv
import json
import math
import re
import statistics
from pathlib import Path

import gpu_tables
import methods_page
import output_quotes
import skip_rules
import thesis_tables
from gpu_jobs import rows_of
from harness import BENCH, markdown

QUOTED = "2-core-avx512"  # the machine the documentation speaks of
GPU_QUOTED = "nvidia-h200"
ROOT = BENCH.parent

PAGE = """# Collision queries, pair by pair

This page is written by `script/bench pairs --peers`, from [its CSV file](../bench/results/{quoted}/collision.csv).
standoff and a peer run in one process and take turns at every query. A time is the median of up to five rounds over all
poses, in processor time of one thread, divided by the poses. A ratio is the peer's time divided by standoff's; below 1,
standoff is slower. *Of medians* is the same ratio of the median pose alone, so that a few slow poses do not count.
*Slowest / median* is of standoff's own poses, in time by the clock: other programs lengthen the slowest ones.
A > or < says that the peer or standoff was stopped. [bench/README.md](../bench/README.md) says more.

{machine}

## Worst, median, best

{summary}

## The pairs

The pair that falls shortest of what is asked for stands first.

{pairs}

The column *place of b* says where b is. *1 apart*: b has a random rotation and approaches from far away, in a random
direction, until the distance is 1. *1 deep*: b moves on in that direction, to 1 beyond the first contact, and touches a
there. *In its box*: b is anywhere in a's box. Motions have random directions, but terrains are swept down. Lengths are in
the units of the table above.

{tables}
"""


def read(path):
    """What the file's comments say, and its rows."""
    lines = Path(path).read_text().splitlines()
    comments = [line[2:] for line in lines if line.startswith("#")]
    return comments, list(csv.DictReader(line for line in lines if not line.startswith("#")))


def value(ratio):
    """Of "12.3x" or "> 12.3x"; None where neither side finished."""
    found = re.search(r"[\d.]+", ratio)
    return float(found.group()) if found else None


def short(number, sign=""):
    """Two digits are enough to quote."""
    return sign + (f"{number:.{0 if number >= 9.95 else 1 if number >= 0.995 else 2}f}x" if number >= 0.0995 else f"{number:.2g}x")


def summary(rows, with_cases):
    """For each query and peer the worst, the median and the best of all its lines; with the cases, where they were."""
    table = []
    for query, peer in dict.fromkeys((row["query"], row["peer"]) for row in rows):
        own = [row for row in rows if (row["query"], row["peer"]) == (query, peer)]
        known = sorted((row for row in own if value(row["ratio"]) is not None), key=lambda row: value(row["ratio"]))
        ratios = [value(row["ratio"]) for row in known]
        case = lambda row: f" ({row['pair']}, {row['place of b']})" if with_cases else ""
        quote = lambda row: short(value(row["ratio"]), row["ratio"][:2] if row["ratio"][0] in "<>" else "") + case(row)
        line = {"query": query, "peer": peer, "cases": len(own), "worst case": quote(known[0]) if known else "-",
                "worst median pose": worst_of_medians(own, case), "median case": short(statistics.median(ratios)) if known else "-",
                "best case": quote(known[-1]) if known else "-",
                "cases slower": sum(ratio < 1 for ratio in ratios)}
        if with_cases:
            line |= {"asked for": own[0]["at least"], "answers": sum(int(row["poses"]) for row in own),
                     "that differ": sum(int(row["answers that differ"]) for row in own)}
        table.append(line)
    return table


def worst_of_medians(rows, case):
    """The least ratio of median poses; "-" if no row has one."""
    known = [row for row in rows if value(row.get("of medians", "")) is not None]
    worst = min(known, key=lambda row: value(row["of medians"]), default=None)
    return short(value(worst["of medians"])) + case(worst) if worst else "-"


def shortfall(rows):
    """What the worst of a pair's rows has of the ratio that is asked for."""
    return min((value(row["ratio"]) / value(row["at least"]) for row in rows if value(row["ratio"]) is not None), default=math.inf)


def between_markers(text, name, content):
    """The text with what stands between the markers of that name replaced."""
    pattern = re.compile(rf"(<!-- {name}: [^>]*-->\n).*?(<!-- end of {name} -->)", re.DOTALL)
    if len(pattern.findall(text)) != 1:
        raise SystemExit(f"bench: not one pair of markers '{name}'")
    return pattern.sub(lambda found: f"{found.group(1)}\n{content}\n\n{found.group(2)}", text)


def measured(comments):
    """Where numbers come from, in one line."""
    return f"Measured: {'; '.join(comments)}."


def pages(results=BENCH / "results" / QUOTED):
    """{file: what it should hold}"""
    comments, rows = read(results / "collision.csv")
    jobs = json.loads((BENCH / "workloads.json").read_text())["collision"]["pairs"]
    jobs.sort(key=lambda job: shortfall([row for row in rows if row["pair"] == job["name"]]))
    pairs = []
    for job in jobs:
        of_peer = {row["peer"]: row for row in reversed(rows) if row["pair"] == job["name"]}
        if of_peer:
            pairs.append({"pair": job["name"], "a and b": job["what"], "standoff builds both, s": of_peer.get("FCL", [*of_peer.values()][-1])["standoff build s"],
                          **{f"{peer} builds both, s": row["peer build s"] for peer, row in of_peer.items()}})
    shown = ("query", "place of b", "peer", "poses", "hits", "rounds", "standoff ms", "peer ms", "ratio", "of medians", "slowest / median", "answers that differ")
    tables = [f"## {pair['pair']}\n\n" + markdown([{key: row[key] for key in shown} for row in rows if row["pair"] == pair["pair"]])
              for pair in pairs]
    page = PAGE.format(quoted=QUOTED, machine="\n".join(f"- {line}" for line in comments), summary=markdown(summary(rows, True)),
                       pairs=markdown(pairs), tables="\n\n".join(tables))
    made = {ROOT / "docs" / "collision_tables.md": page}
    for path, with_cases in ((ROOT / "README.md", False), (ROOT / "docs" / "collision_benchmarks.md", True)):
        table = markdown(summary(rows, with_cases))
        made[path] = between_markers(path.read_text(), "collision summary", f"{table}\n\n{measured(comments)}")
    comments, rows = read(results / "collision-threads.csv")
    table = markdown([{key: row[key] for key in row if key not in ("at least", "met")} for row in rows])
    path = ROOT / "docs" / "collision_benchmarks.md"
    made[path] = between_markers(made[path], "collision batches", f"{table}\n\n{measured(comments)}")
    made |= output_quotes.pages(read, between_markers, measured) | methods_page.pages(read, between_markers)
    made[ROOT / "docs" / "thesis_tables.md"] = thesis_tables.page(results, BENCH / "results" / GPU_QUOTED)
    comments, rows = read(results / "skip.csv")
    path = ROOT / "docs" / "skip.md"
    made[path] = between_markers(path.read_text(), "skip rules", f"{markdown(skip_rules.table(rows))}\n\n{measured(comments[1:])}")
    return made | gpu_page(BENCH / "results" / GPU_QUOTED)


def gpu_page(results):
    """{file: what it should hold} of fields on a GPU; `before` in its folder is the first run."""
    rows, before = rows_of(results / "gpu.csv"), rows_of(results / "before" / "gpu.csv")
    machine = (results / "machine.txt").read_text().splitlines()
    comments = [machine[1].split(",")[0], machine[2].split(", ", 1)[1], machine[-1]]
    path = ROOT / "docs" / "cuda.md"
    text = between_markers(path.read_text(), "gpu goals",
                           f"{markdown(gpu_tables.quoted_goals(rows, before))}\n\n{measured(comments)}")
    text = between_markers(text, "gpu devices", markdown(gpu_tables.quoted_devices(rows_of(results / "devices.csv"))))
    return {path: between_markers(text, "gpu grids", markdown(gpu_tables.quoted_grids(rows, before, ("catapult", "factory"))))}


def write():
    for path, text in pages().items():
        path.write_text(text)
