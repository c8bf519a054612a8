# SPDX-License-Identifier: Apache-2.0
"""Running the drivers of bench/, and writing down what they measured."""

import csv
import datetime
import json
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parent
ENOUGH = 20  # seconds: what takes longer is timed once


class Drivers:
    """The measuring programs of one build folder."""

    def __init__(self, build):
        self.folder = Path(build) / "bench"

    def path(self, driver):
        """Those of standoff are called bench_NAME, those of others peer_NAME."""
        ours = self.folder / f"bench_{driver}"
        return ours if ours.exists() else self.folder / f"peer_{driver}"

    def has(self, driver):
        return self.path(driver).exists()

    def run(self, driver, args, repeats, **options):
        """One process; returns what its JSON line says. Options become --name value, or --name when True."""
        more = [] if repeats is None else ["--repeats", str(repeats)]
        for name, value in options.items():
            more += [f"--{name}"] if value is True else [f"--{name}", str(value)]
        return self.run_lines(driver, [*args, *more])[-1]

    def run_lines(self, driver, args):
        """One process that prints a JSON line for each thing it measured."""
        command = [str(self.path(driver)), *args]
        print("  " + " ".join(command), file=sys.stderr)
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
        if done.returncode:
            raise SystemExit(f"bench: {' '.join(command)} failed")
        return [json.loads(line) for line in done.stdout.splitlines()]


def peer_python(script, *args):
    """One process of a script of this folder, with the Python that STANDOFF_PEER_PYTHON names; its JSON line. None if
    there is no such Python, or it has not what the script needs."""
    python = os.environ.get("STANDOFF_PEER_PYTHON")
    if not python:
        return None
    command = [python, str(BENCH / script), *map(str, args)]
    print("  " + " ".join(command), file=sys.stderr)
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode == 3:  # what a script returns if it lacks a library
        return None
    if done.returncode:
        raise SystemExit(f"bench: {' '.join(command)} failed")
    return json.loads(done.stdout.splitlines()[-1])


def median(runs, key):
    """The median of one key over runs."""
    return statistics.median(run[key] for run in runs)


def cpu_info():
    text = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*:\s*(.*)", text)
    flags = re.search(r"flags\s*:\s*(.*)", text)
    return (model.group(1) if model else platform.processor(), set(flags.group(1).split() if flags else ()))


def machine_name():
    """A neutral name: cores and the widest instruction set."""
    flags = cpu_info()[1]
    simd = next((name for flag, name in (("avx512f", "avx512"), ("avx2", "avx2")) if flag in flags), platform.machine())
    return f"{os.cpu_count()}-core-{simd}"


def commit():
    """What is measured; empty outside a repository, or without git."""
    if not shutil.which("git"):
        return ""
    return subprocess.run(["git", "-C", str(BENCH), "describe", "--always", "--dirty"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True).stdout.strip()


def machine_lines(build):
    """What a reader must know about where numbers come from."""
    compiler = "unknown"
    for path in Path(build).glob("CMakeFiles/*/CMakeCXXCompiler.cmake"):
        found = dict(re.findall(r'set\(CMAKE_CXX_COMPILER_(ID|VERSION) "([^"]*)"', path.read_text()))
        compiler = f"{found.get('ID')} {found.get('VERSION')}"
    return [
        f"standoff: {commit() or 'unknown'}",
        f"CPU: {cpu_info()[0]}, {os.cpu_count()} cores",
        f"compiler: {compiler}, system: {platform.system()} {platform.machine()}",
        f"date: {datetime.date.today().isoformat()}",
    ]


def header_of(build, note=""):
    """The same, and what a reader must know of this run. Asked for before anything runs: the commit may be another one afterwards."""
    return machine_lines(build) + ([f"note: {note}"] if note else [])


def chosen(jobs, only):
    """All jobs, or those whose name holds `only`."""
    return [job for job in jobs if not only or only in job["name"]]


def results_folder():
    folder = BENCH / "results" / machine_name()
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def columns_of(rows):
    """The columns of all rows, in order of appearance."""
    return list(dict.fromkeys(key for row in rows for key in row))


def write_csv(path, header_lines, rows):
    """One line per row (a dictionary), after the header as comments. No rows, no file."""
    if not rows:
        return
    with open(path, "w", newline="") as file:
        for line in header_lines:
            file.write(f"# {line}\n")
        writer = csv.DictWriter(file, columns_of(rows), restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(f"wrote {path}", file=sys.stderr)


def markdown(rows):
    """A table in markdown, numbers to the right."""
    columns = columns_of(rows)
    number = re.compile(r"([<>] )?[-\d.,]*x?")
    numeric = [all(number.fullmatch(str(row.get(column, ""))) for row in rows) for column in columns]
    lines = ["| " + " | ".join(columns) + " |", "|" + "|".join("---:" if n else "---" for n in numeric) + "|"]
    lines += ["| " + " | ".join(str(row.get(column, "")) for column in columns) + " |" for row in rows]
    return "\n".join(lines)


def tell(header, *tables):
    """Prints the header and the tables that have rows."""
    print("\n\n".join(["\n".join(f"- {line}" for line in header), *(markdown(rows) for rows in tables if rows)]))


def seconds(value):
    """Three significant digits, never an exponent."""
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.{2 if value >= 10 else 3 if value >= 0.1 else 4}f}"
