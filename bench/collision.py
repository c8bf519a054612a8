"""Collision queries beside FCL: both in one process, in turns (peer_fcl.cpp)."""

from harness import machine_lines, markdown, results_folder, write_csv


def row_of(job, line):
    ratio = line["ratio"]
    return {
        "query": job["what"], "poses": line["poses"], "hits": line["hits"],
        "difi a second": f"{line['difi_per_s']:.0f}", "FCL a second": f"{line['fcl_per_s']:.0f}",
        "ratio": f"{ratio:.1f}x", "at least": f"{job['at_least']}x", "goal": f"{job['goal']}x",
        "met": "goal" if ratio >= job["goal"] else "yes" if ratio >= job["at_least"] else "no",
        "answers that differ": line["differ"], "build s": f"{line['difi_build_s']:.2f}",
        "FCL build s": f"{line['fcl_build_s']:.2f}",
    }


def run(drivers, workloads, only, rounds, build):
    """One line per query: the round with the median ratio."""
    rows = []
    for job in workloads["collision"]:
        if only and only not in job["name"]:
            continue
        lines = sorted((drivers.run("fcl", job["args"], None) for _ in range(rounds or 3)), key=lambda line: line["ratio"])
        rows.append(row_of(job, lines[len(lines) // 2]))
    header = machine_lines(build)
    print("\n".join(f"- {line}" for line in header) + "\n\n" + markdown(rows))
    if not only:
        write_csv(results_folder() / "collision.csv", header, rows)
