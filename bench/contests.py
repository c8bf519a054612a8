# SPDX-License-Identifier: Apache-2.0
"""standoff beside its peers: same job, same run, alternating processes."""

from harness import ENOUGH, chosen, machine_lines, markdown, median, results_folder, seconds, write_csv

MEGABYTE = 1 << 20
# What runs.csv keeps of a driver's line.
KEPT = ("driver", "output", "threads", "cold_s", "warm_s", "build_s", "samples_band", "output_bytes", "memory_before",
        "memory_peak")


def raw_rows(contest, lines):
    """The rows of runs.csv for some processes of one driver, in the order they ran."""
    return [{"workload": contest["name"], "round": number, **{key: line[key] for key in KEPT if key in line}}
            for number, line in enumerate(lines)]


def run_contest(drivers, contest, with_peers, rounds):
    """Alternates standoff and the peers: {(driver, output): [line per round]}. Each peer's first field is checked."""
    lines = {}
    for number in range(rounds or contest.get("rounds", 5)):
        for against in contest["against"]:
            output, peer = against["output"], against["peer"]
            ours = drivers.run("standoff", contest["args"], 5, output=output, enough=ENOUGH)
            lines.setdefault(("standoff", output), []).append(ours)
            if with_peers and drivers.has(peer):
                check = {"check": True} if number == 0 else {}
                line = drivers.run(peer, contest["args"], contest.get("peer_repeats", 3), **check)
                lines.setdefault((peer, output), []).append(line)
    return lines


def times(lines):
    """Median cold and warm seconds. A driver called once per process has no warm time: its only one stands for both."""
    cold = median(lines, "cold_s")
    return cold, median(lines, "warm_s") if lines[0]["calls"] > 1 else cold


def verdict(cold, warm, least):
    """Which of the two ratios reach what is asked for."""
    if least is None:
        return "-"
    return " and ".join(name for name, ratio in (("cold", cold), ("warm", warm)) if ratio >= least) or "no"


def ratio_row(contest, against, lines):
    """One line of the table of ratios; without the peer's half when it did not run."""
    cold, warm = times(lines[("standoff", against["output"])])
    row = {"workload": contest["what"], "output": against["output"], "standoff cold s": seconds(cold),
           "standoff warm s": seconds(warm)}
    theirs = lines.get((against["peer"], against["output"]))
    if not theirs:
        return row
    peer_cold, peer_warm = times(theirs)
    least, goal, check = against.get("at_least"), against.get("goal"), theirs[0]["check"]
    row.update({
        "peer": against["peer"], "peer cold s": seconds(peer_cold), "peer warm s": seconds(peer_warm),
        "ratio cold": f"{peer_cold / cold:.1f}x", "ratio warm": f"{peer_warm / warm:.1f}x",
        "at least": f"{least}x" if least else "-", "goal": f"{goal}x" if goal else "-",
        "met": verdict(peer_cold / cold, peer_warm / warm, least),
        "peer's band / ours": f"{check['band'] / max(1, check['band_exact']):.4f}",
        "peer's largest error, samples": f"{check['largest_error_samples']:.2g}",
    })
    return row


def memory_row(contest, output, lines):
    """Peak memory of the whole process in its first call, beside what is allowed."""
    line = max(lines[("standoff", output)], key=lambda one: one["memory_peak"])
    allowed = line["output_bytes"] + 3 * line["mesh_bytes"] + 64 * MEGABYTE
    in_megabytes = lambda size: f"{size / MEGABYTE:.0f}"
    return {
        "workload": contest["what"], "output": output, "output MB": in_megabytes(line["output_bytes"]),
        "mesh MB": in_megabytes(line["mesh_bytes"]), "peak MB": in_megabytes(line["memory_peak"]),
        "allowed MB (output + 3 x mesh + 64)": in_megabytes(allowed),
        "met": "yes" if line["memory_peak"] <= allowed else "no",
    }


def run_threads(drivers, contest, rounds):
    """One thread beside two, dense, alternating: {threads: [line per round]}."""
    lines = {1: [], 2: []}
    for _ in range(rounds or contest.get("rounds", 5)):
        for threads, into in lines.items():
            into.append(drivers.run("standoff", contest["args"], 5, output="dense", threads=threads))
    return lines


def threads_row(contest, at_least, lines):
    one, two = (times(lines[threads])[1] for threads in (1, 2))
    return {"workload": contest["what"], "1 thread, warm s": seconds(one), "2 threads, warm s": seconds(two),
            "ratio": f"{one / two:.2f}x", "at least": f"{at_least}x", "met": "yes" if one / two >= at_least else "no"}


def run(drivers, workloads, with_peers, only, rounds, build):
    """Runs all contests (or those whose name holds `only`), prints the tables; all of them together are written too."""
    tables = {"ratios": [], "memory": [], "threads": []}
    raw = []
    for contest in chosen(workloads["contests"], only):
        lines = run_contest(drivers, contest, with_peers, rounds)
        tables["ratios"] += [ratio_row(contest, against, lines) for against in contest["against"]]
        tables["memory"] += [memory_row(contest, output, lines) for driver, output in lines if driver == "standoff"]
        if contest["name"] in workloads["threads"]["workloads"]:
            by_threads = run_threads(drivers, contest, rounds)
            tables["threads"].append(threads_row(contest, workloads["threads"]["at_least"], by_threads))
            lines |= by_threads
        raw += [row for some in lines.values() for row in raw_rows(contest, some)]

    header, folder = machine_lines(build), results_folder()
    page = "\n\n".join(["\n".join(f"- {line}" for line in header)] +
                       [f"### {name}\n\n{markdown(rows)}" for name, rows in tables.items() if rows])
    print(page)
    if only:
        return
    for name, rows in tables.items():
        write_csv(folder / f"{name}.csv", header, rows)
    write_csv(folder / "runs.csv", header, raw)
    (folder / "README.md").write_text(f"# Measured by `script/bench`\n\n{page}\n")
