"""Collision queries beside FCL and Coal, both in one process with difi, in turns (collision_contest.cpp), and batches of
them with one thread and with two (bench_collision.cpp)."""

from harness import machine_lines, markdown, results_folder, write_csv

PEERS = ("fcl", "coal")


def middle(lines):
    """Of several processes, the line with the median ratio."""
    return sorted(lines, key=lambda line: line["ratio"])[len(lines) // 2]


def ratio(line):
    """How many times as fast as the peer; where one was stopped, what is known of it."""
    if line["difi_late"] and line["peer_late"]:
        return "-"
    sign = "< " if line["difi_late"] else "> " if line["peer_late"] else ""
    return f"{sign}{line['ratio']:.{1 if line['ratio'] >= 1 else 2}f}x"


def met(ratio, at_least, goal):
    return "goal" if ratio >= goal else "yes" if ratio >= at_least else "no"


def contest_row(job, line):
    """Many poses: how many a second."""
    return {
        "query": job["what"], "peer": line["peer"], "poses": line["poses"], "hits": line["hits"],
        "difi a second": f"{line['poses'] / line['difi_s']:.0f}", "peer a second": f"{line['poses'] / line['peer_s']:.0f}",
        "ratio": ratio(line), "at least": f"{job['at_least']}x", "goal": f"{job['goal']}x",
        "met": met(line["ratio"], job["at_least"], job["goal"]), "answers that differ": line["differ"],
        "build s": f"{line['difi_build_s']:.2f}", "peer build s": f"{line['peer_build_s']:.2f}",
    }


def batch_row(job, line):
    return {
        "batch": job["what"], "poses": line["poses"], "1 thread s": f"{line['one_s']:.4f}",
        f"{line['threads']} threads s": f"{line['many_s']:.4f}", "ratio": f"{line['ratio']:.2f}x",
        "at least": f"{job['at_least']}x", "met": "yes" if line["ratio"] >= job["at_least"] else "no",
    }


def milliseconds(line, who):
    """Of one question; a lower bound where it was stopped."""
    value = 1000 * line[f"{who}_s"]
    return ("> " if line[f"{who}_late"] else "") + (f"{value:.0f}" if value >= 100 else f"{value:.3g}" if value >= 0.01 else f"{value:.5f}")


def found(line, who):
    """What was answered, for people."""
    if line[f"{who}_late"]:
        return "?"
    answer, query = line[f"{who}_answer"], line["query"]
    if query == "collide":
        return "yes" if answer else "no"
    if query == "sweep":
        return f"at {answer:.5f}" if answer <= 1 else "free"
    return f"{answer:.6g}" if query == "distance" else f"{answer:.0f}"


def place_row(place, what, line):
    """One pose: how long one question takes."""
    return {
        "place of b": place["what"], "query": what, "peer": line["peer"], "difi ms": milliseconds(line, "difi"),
        "peer ms": milliseconds(line, "peer"), "ratio": ratio(line), "difi's answer": found(line, "difi"),
        "peer's answer": found(line, "peer"), "answers that differ": line["differ"], "rounds": line["rounds"],
    }


def write(tables, only, build):
    """Prints the tables that have rows, {file name: rows}; all of them together are written too."""
    header = machine_lines(build)
    print("\n\n".join(["\n".join(f"- {line}" for line in header), *(markdown(rows) for rows in tables.values() if rows)]))
    if not only:
        for name, rows in tables.items():
            write_csv(results_folder() / f"{name}.csv", header, rows)


def run(drivers, workloads, with_peers, only, rounds, build):
    """A line for each query and peer, and for each batch: the process with the median ratio of three."""
    chosen = lambda jobs: (job for job in jobs if not only or only in job["name"])
    median_of = lambda driver, job: middle([drivers.run(driver, job["args"], None) for _ in range(rounds or 3)])
    peers = [peer for peer in PEERS if with_peers and drivers.has(peer)]
    tables = {"collision": [contest_row(job, median_of(peer, job)) for job in chosen(workloads["collision"]) for peer in peers],
              "collision-threads": [batch_row(job, median_of("collision", job)) for job in chosen(workloads["batches"])]}
    write(tables, only, build)


def run_terrains(drivers, workloads, only, rounds, build):
    """Two surfaces that conform to each other, in some places: all questions of a peer in one process, which builds the
    bodies once."""
    job = workloads["terrains"]
    asked = [(place, query) for place in job["places"] if not only or only in place["name"] for query in place["queries"]]
    args = [*job["args"], "--query", *(f"{query}@{place['at']}" for place, query in asked)]
    processes = [[drivers.run_lines(peer, args) for _ in range(rounds or 1)] for peer in PEERS if drivers.has(peer)]
    table = [place_row(place, job["queries"][query], middle([lines[n] for lines in of_peer]))
             for n, (place, query) in enumerate(asked) for of_peer in processes]
    write({"terrains": table}, only, build)
