# SPDX-License-Identifier: Apache-2.0
"""Collision queries beside FCL and Coal, both in one process with standoff, in turns (collision_contest.cpp), and batches of
them with one thread and with two (bench_collision.cpp)."""

import math

import quotes
from harness import chosen, header_of, markdown, results_folder, tell, write_csv

PEERS = ("fcl", "coal")


def middle(lines):
    """Of several processes, the line with the median ratio."""
    return sorted(lines, key=lambda line: line["ratio"])[len(lines) // 2]


def ratio(line):
    """How many times as fast as the peer; where one was stopped, what is known of it."""
    if line["standoff_late"] and line["peer_late"]:
        return "-"
    sign = "< " if line["standoff_late"] else "> " if line["peer_late"] else ""
    number = line["ratio"]
    return f"{sign}{number:.{1 if number >= 1 else 2}f}x" if number >= 0.095 else f"{sign}{number:.2g}x"


def split(where):
    """What stands after the @ of a question (question.h): its numbers, and its words by key."""
    words = where.split(",")
    return [word for word in words if "=" not in word], dict(word.split("=") for word in words if "=" in word)


def placing(where):
    """The same for people."""
    place, words = split(where)
    text = f"moved by {', '.join(place)}"
    if "gap" in words:
        text = f"{words['gap']} apart"
    elif "depth" in words:
        text = f"{words['depth']} deep"
    elif "turn" in words:
        text = f"in place, turned by at most {words['turn']} degree{'' if words['turn'] == '1' else 's'}"
    elif "hits" in words:
        share = float(words["hits"])
        text = "in its box, " + ("free" if share == 0 else "touching" if share == 1 else f"{100 * share:.0f} % touching")
    elif "spin" in words:
        moved = [f"{words[axis]} along {axis[1]}" for axis in ("dx", "dy", "dz") if axis in words]
        text = f"in its place, spun by at most {words['spin']} degrees" + (f", moved by at most {', '.join(moved)}" if moved else "")
    return text + (f", way {words['way']}" if "way" in words else "") + (f", turning by {words['rotate']} degrees" if "rotate" in words else "")


def contest_row(pair, query, where, line):
    """One query at one placing: the time of one question."""
    return {
        "pair": pair["name"], "query": query["what"], "place of b": placing(where), "peer": line["peer"],
        "poses": line["poses"], "hits": line["hits"], "rounds": line["rounds"],
        "standoff ms": milliseconds(line, "standoff"), "peer ms": milliseconds(line, "peer"), "ratio": ratio(line),
        "of medians": f"{line['ratio_of_medians']:.3g}x" if "ratio_of_medians" in line else "-",
        "slowest / median": f"{line['standoff_slowest_s'] / line['standoff_median_s']:.3g}" if "standoff_slowest_s" in line else "-",
        "at least": f"{query['at_least']}x", "answers that differ": line["differ"],
        "standoff build s": f"{line['standoff_build_s']:.2f}", "peer build s": f"{line['peer_build_s']:.2f}",
    }


def batch_row(job, line):
    return {
        "batch": job["what"], "poses": line["poses"], "1 thread s": f"{line['one_s']:.4f}",
        f"{line['threads']} threads s": f"{line['many_s']:.4f}", "ratio": f"{line['ratio']:.2f}x",
        "at least": f"{job['at_least']}x", "met": "yes" if line["ratio"] >= job["at_least"] else "no",
    }


def milliseconds(line, who):
    """Of one question; a lower bound where it was stopped."""
    value = 1000 * line[f"{who}_s"] / line["poses"]
    return ("> " if line[f"{who}_late"] else "") + (f"{value:.0f}" if value >= 100 else f"{value:.3g}" if value >= 0.01 else f"{value:.5f}")


def write(tables, only, header):
    """Prints the tables that have rows, {file name: rows}; all of them together are written too."""
    tell(header, *tables.values())
    if not only:
        for name, rows in tables.items():
            write_csv(results_folder() / f"{name}.csv", header, rows)


def pair_rows(drivers, peers, job, pair, rounds):
    """All questions about a pair: of each peer in one process, which builds the bodies once."""
    asked = [(query, where) for query, places in pair["ask"].items() for where in places]
    word = lambda query: {"short": "sweep", "long": "sweep", "near": "distance", "far": "distance"}.get(query, query)
    args = [*job["args"], *pair["args"], "--query", *(f"{word(query)}@{where}" for query, where in asked)]
    processes = [[drivers.run_lines(peer, args) for _ in range(rounds or 1)] for peer in peers]
    return [contest_row(pair, job["queries"][query], where, middle([lines[n] for lines in of_peer]))
            for n, (query, where) in enumerate(asked) for of_peer in processes]


def worst_first(row):
    """The order of rows: by query, and of each the worst ratio first."""
    ratio_of = quotes.value(row["ratio"])
    return row["query"], math.inf if ratio_of is None else ratio_of


def measured_before(header):
    """The rows of a run of the same commit that was stopped."""
    path = results_folder() / "collision.csv"
    comments, rows = quotes.read(path) if path.exists() else ([], [])
    return rows if comments[:1] == header[:1] else []


def cut_short(args, options):
    """The arguments with other values of some options."""
    args = list(args)
    for name, seconds in options.items():
        if seconds is not None:
            args[args.index(name) + 1] = str(seconds)
    return args


def all_rows(drivers, peers, job, pairs, rounds, header, rows, only):
    """Adds the rows of the pairs that have none yet. The file is written after each pair: some take minutes, and a run
    that is stopped can go on."""
    measured = {row["pair"] for row in rows}
    for pair in pairs:
        if peers and pair["name"] not in measured:
            rows = sorted(rows + pair_rows(drivers, peers, job, pair, rounds), key=worst_first)
            if not only:
                write_csv(results_folder() / "collision.csv", header, rows)
    return rows


def run(drivers, workloads, with_peers, only, rounds, build, note="", missing=False, enough=None, limit=None):
    """A line for each question about each pair, and the worst, median and best of each query; a line for each batch, from
    the process with the median ratio of three."""
    header = header_of(build, note)
    peers = [peer for peer in PEERS if with_peers and drivers.has(peer)]
    job = workloads["collision"]
    job = job | {"args": cut_short(job["args"], {"--enough": enough, "--limit": limit})}
    before = measured_before(header) if missing and not only else []
    rows = all_rows(drivers, peers, job, chosen(job["pairs"], only), rounds, header, before, only)
    batches = [batch_row(batch, middle([drivers.run("collision", batch["args"], None) for _ in range(rounds or 3)]))
               for batch in chosen(workloads["batches"], only)]
    write({"collision": rows, "collision-threads": batches}, only, header)
    print("\n" + markdown(quotes.summary(rows, True)) if rows else "")
    if rows and not only and results_folder().name == quotes.QUOTED:
        quotes.write()
