"""difi beside its peers: same job, same run, alternating processes."""

from harness import machine_lines, markdown, median, results_folder, seconds, write_csv

MEGABYTE = 1 << 20
KEPT = ("cold_s", "warm_s", "build_s", "samples_band", "output_bytes", "memory_before", "memory_peak", "threads")


def keep(contest, round_number, line):
    row = {"workload": contest["name"], "round": round_number, "driver": line["driver"], "output": line["output"]}
    row.update({key: line[key] for key in KEPT if key in line})
    return row


def run_contest(drivers, contest, with_peers, rounds):
    """Alternates difi and the peers. Returns {(driver, output): [line per round]}; the first peer line is checked."""
    lines = {}
    for number in range(rounds or contest.get("rounds", 5)):
        for against in contest["against"]:
            key = ("difi", against["output"])
            lines.setdefault(key, []).append(drivers.run("difi", contest["args"], 5, output=against["output"]))
            if with_peers and drivers.has(against["peer"]):
                check = {"check": True} if number == 0 else {}
                peer = drivers.run(against["peer"], contest["args"], contest.get("peer_repeats", 3), **check)
                lines.setdefault((against["peer"], against["output"]), []).append(peer)
    return lines


def ratio_row(contest, against, lines):
    """One line of the table of ratios, or None when the peer did not run."""
    ours, theirs = lines[("difi", against["output"])], lines.get((against["peer"], against["output"]))
    if not theirs:
        return None
    # With one call in its process a peer has no warm time: its only one stands for both.
    theirs_warm = median(theirs, "warm_s") or median(theirs, "cold_s")
    cold, warm = median(theirs, "cold_s") / median(ours, "cold_s"), theirs_warm / median(ours, "warm_s")
    least = against.get("at_least")
    met = {True: "both", False: "no"}.get(min(cold, warm) >= least if (cold >= least) == (warm >= least) else None,
                                          "cold" if least and cold >= least else "warm") if least else "-"
    check = theirs[0].get("check", {})
    return {
        "workload": contest["what"],
        "peer": against["peer"],
        "difi cold s": seconds(median(ours, "cold_s")),
        "difi warm s": seconds(median(ours, "warm_s")),
        "peer cold s": seconds(median(theirs, "cold_s")),
        "peer warm s": seconds(theirs_warm),
        "ratio cold": f"{cold:.1f}x",
        "ratio warm": f"{warm:.1f}x",
        "at least": f"{least}x" if least else "-",
        "goal": f"{against['goal']}x" if "goal" in against else "-",
        "met": met,
        "peer's largest error, samples": f"{check.get('largest_error_samples', 0):.2g}",
        "peer's band / ours": f"{check.get('band', 0) / max(1, check.get('band_exact', 1)):.4f}",
    }


def memory_row(contest, output, lines):
    """Peak memory of the whole process in its first call, beside what is allowed."""
    line = max(lines[("difi", output)], key=lambda one: one["memory_peak"])
    allowed = line["output_bytes"] + 3 * line["mesh_bytes"] + 64 * MEGABYTE
    return {
        "workload": contest["what"],
        "output": output,
        "output MB": f"{line['output_bytes'] / MEGABYTE:.0f}",
        "mesh MB": f"{line['mesh_bytes'] / MEGABYTE:.0f}",
        "peak MB": f"{line['memory_peak'] / MEGABYTE:.0f}",
        "allowed MB (output + 3 x mesh + 64)": f"{allowed / MEGABYTE:.0f}",
        "met": "yes" if line["memory_peak"] <= allowed else "no",
    }


def run_threads(drivers, contest, at_least, rounds):
    """One thread beside two, dense, alternating."""
    lines = {1: [], 2: []}
    for _ in range(rounds or contest.get("rounds", 5)):
        for threads in lines:
            lines[threads].append(drivers.run("difi", contest["args"], 5, output="dense", threads=threads))
    ratio = median(lines[1], "warm_s") / median(lines[2], "warm_s")
    row = {
        "workload": contest["what"],
        "1 thread, warm s": seconds(median(lines[1], "warm_s")),
        "2 threads, warm s": seconds(median(lines[2], "warm_s")),
        "ratio": f"{ratio:.2f}x",
        "at least": f"{at_least}x",
        "met": "yes" if ratio >= at_least else "no",
    }
    return row, [keep(contest, n, line) for runs in lines.values() for n, line in enumerate(runs)]


def run(drivers, workloads, with_peers, only, rounds, build):
    """Runs all contests (or those whose name holds `only`), prints the tables and writes the CSV files."""
    ratios, memory, threads, raw = [], [], [], []
    contests = [c for c in workloads["contests"] if not only or only in c["name"]]
    for contest in contests:
        lines = run_contest(drivers, contest, with_peers, rounds)
        raw += [keep(contest, n, line) for runs in lines.values() for n, line in enumerate(runs)]
        rows = [ratio_row(contest, against, lines) for against in contest["against"]]
        ratios += [row for row in rows if row]
        outputs = [output for driver, output in lines if driver == "difi"]
        memory += [memory_row(contest, output, lines) for output in outputs]
        if not with_peers:
            ours = lines[("difi", outputs[0])]
            ratios.append({"workload": contest["what"], "difi cold s": seconds(median(ours, "cold_s")),
                           "difi warm s": seconds(median(ours, "warm_s"))})
        if contest["name"] in workloads["threads"]["workloads"]:
            row, more = run_threads(drivers, contest, workloads["threads"]["at_least"], rounds)
            threads.append(row)
            raw += more

    header = machine_lines(build)
    folder = results_folder()
    for title, name, rows in (("Ratios", "ratios", ratios), ("Peak memory", "memory", memory),
                              ("Threads", "threads", threads)):
        if not rows:
            continue
        print(f"\n### {title}\n\n{markdown(list(rows[0]), rows)}")
        if not only:
            write_csv(folder / f"{name}.csv", header, rows)
    if not only:
        write_csv(folder / "runs.csv", header, raw)
    print("\n" + "\n".join(header))
