# SPDX-License-Identifier: Apache-2.0
"""The steps of script/gpu-check, one after the other. One that fails, or takes too long, is told and remembered, and the
next one begins. What a step has found is in its file at once."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time

import gpu_jobs
from gpu_build import Unfit
from harness import BENCH, write_csv

ROOT = BENCH.parent
CANNOT_BE_USED = 6  # the exit code of standoff's programs where there is no GPU they can use
TIMED_OUT = "took too long"


def say(text):
    print(f"\n== {text}", flush=True)


def limited(command, limit, output, stdin=None, errors=subprocess.STDOUT):
    """Runs a command with all that it starts, for `limit` seconds at most: its exit code, or TIMED_OUT."""
    child = subprocess.Popen(command, stdin=stdin or subprocess.DEVNULL, stdout=output, stderr=errors,
                             start_new_session=True)
    try:
        return child.wait(limit)
    except subprocess.TimeoutExpired:
        return TIMED_OUT
    finally:
        if child.poll() is None:
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()


def last_lines(path, count):
    return "\n".join(path.read_text(errors="replace").splitlines()[-count:])


PEER_COLUMNS = "job,triangles,query,grid,thickness,median_ms,least_ms,runs,tree_ms,largest_difference,peer"
# tests/gpu_check/peer_NAME.py, the module that it needs, and the package that brings that.
PYTHON_PEERS = (("warp", "warp", "warp-lang"), ("physicsnemo", "physicsnemo", "nvidia-physicsnemo"))


class Steps:
    """One call of script/gpu-check: where the programs are, where results go, what went wrong."""

    def __init__(self, out, build, emulated=False, quick=False):
        self.out, self.build, self.emulated, self.quick = out, build, emulated, quick
        self.problems = []

    def problem(self, text):
        print(f"script/gpu-check: {text}", file=sys.stderr, flush=True)
        self.problems.append(text)

    def tell(self, step, began, result):
        """A line in steps.csv, at once."""
        path = self.out / "steps.csv"
        head = "" if path.exists() else "step,seconds,result\n"
        with path.open("a") as file:
            file.write(f"{head}{step},{time.monotonic() - began:.1f},{result}\n")

    def step(self, name, command, limit, path, mode="w", stdin=None, errors=None):
        """Runs a program with its output in a file, and its errors too, or in one of their own (added to it): what it said
        is there whatever becomes of it. True where it went well."""
        began = time.monotonic()
        with path.open(mode) as output, (errors.open("a") if errors else contextlib.nullcontext(subprocess.STDOUT)) as to:
            code = limited(command, limit, output, stdin, to)
        self.tell(name, began, "ok" if code == 0 else code)
        if code == 0:
            return True
        said = errors or path
        print(last_lines(said, 5), file=sys.stderr)
        if code == CANNOT_BE_USED:
            raise Unfit("the GPU cannot be used; see above, and nvidia-smi")
        self.problem(f"{name}: {f'exit code {code}' if code != TIMED_OUT else f'took over {limit} s'}; see {said}")
        return False

    # --- check

    def check(self):
        brief = ["--quick"] if self.quick or self.emulated else []
        say("every kernel against its emulation")
        self.step("check", [self.build / "check", *brief], 100, self.out / "check.txt")
        self.show_wrong("check.txt")
        if self.emulated:
            return
        say("collision queries against the CPU's answers")
        self.step("check_collide", [self.build / "check_collide", *brief], 60, self.out / "collide.txt")
        self.show_wrong("collide.txt")

    def show_wrong(self, name):
        print("".join(line for line in (self.out / name).open(errors="replace") if not line.startswith("ok")), end="")

    # --- sanitize

    def sanitize(self):
        sanitizer = shutil.which("compute-sanitizer")
        if self.emulated or not sanitizer:
            print("compute-sanitizer is not there: skipped")
            return
        summary = self.out / "sanitizer.txt"
        summary.write_text("")
        for tool in ("memcheck", "racecheck", "initcheck", "synccheck"):
            say(f"compute-sanitizer --tool {tool}")
            # The check asks for more memory than there is, which is no fault.
            of_tool = ["--report-api-errors", "no"] if tool == "memcheck" else []
            of_check = ["--unpoisoned"] if tool == "initcheck" else []
            for program, options in (("check", of_check), ("check_collide", [])):
                log = self.build / f"{tool}-{program}.txt"
                began = time.monotonic()
                with log.open("w") as output:
                    code = limited([sanitizer, "--tool", tool, *of_tool, "--error-exitcode", "9", self.build / program,
                                    "--quick", *options], 60, output)
                text = log.read_text(errors="replace")
                unfit = "Device not supported" in text
                self.tell(f"{tool} {program}", began, "skipped" if unfit else "ok" if code == 0 else code)
                marks = ("=========", "checks went wrong")
                with summary.open("a") as file:
                    file.write(f"== {tool} {program}\n")
                    file.writelines(f"{line}\n" for line in
                                    [line for line in text.splitlines() if any(m in line for m in marks)][-40:])
                if unfit:
                    print("compute-sanitizer does not work on this machine (Device not supported): skipped")
                    return
                if code != 0:
                    self.problem(f"{tool} of {program} {TIMED_OUT if code == TIMED_OUT else 'found something'}; "
                                 f"see {summary}")
            print(last_lines(summary, 1))

    # --- measure

    def measure(self, what, jobs, limit):
        """Those jobs that have no row yet; a row a job, written as soon as it is there."""
        path, list_path = self.out / "gpu.csv", self.build / "jobs.txt"
        jobs = [gpu_jobs.small(job) for job in jobs] if self.emulated else jobs
        left = gpu_jobs.left(jobs, gpu_jobs.rows_of(path))
        say(f"measuring {what}: {len(left)} jobs" + (f", {len(jobs) - len(left)} were" if len(left) < len(jobs) else ""))
        if left:
            list_path.write_text("".join(job.line() + "\n" for job in left))
            options = [*(["--once"] if self.emulated else []), *(["--continue"] if path.exists() else [])]
            with list_path.open() as lines:
                self.step(f"measure {what}", [self.build / "measure", *options], limit, path, "a", lines,
                          self.out / "measure.log")
        rows = gpu_jobs.rows_of(path)
        write_csv(self.out / "table-5.4.csv", [], gpu_jobs.table_5_4(rows))
        for row in rows[:23]:
            print(",".join(list(row.values())[:9]))

    def profile(self):
        """What Nsight Compute says of the two kernels that take longest, a report a job, where it works."""
        ncu = shutil.which("ncu")
        if self.emulated or not ncu:
            print("ncu is not there: no profiles")
            return
        for job in gpu_jobs.peer_jobs():
            report, log = self.out / f"profile-{job.scene}.ncu-rep", self.build / f"profile-{job.scene}.log"
            say(f"profile of {job.scene}")
            (self.build / "job.txt").write_text(job.line() + "\n")
            began = time.monotonic()
            with (self.build / "job.txt").open() as line, log.open("w") as output:
                code = limited([ncu, "--clock-control", "none", "--set", "full", "--profile-from-start", "off",
                                "--kernel-name", "regex:^(gather|bin_long)$", "--force-overwrite", "--export", report,
                                self.build / "measure", "--profile"], 90, output, line)
            self.tell(f"profile {job.scene}", began, "ok" if code == 0 else code)
            if code != 0 or not report.exists():  # many machines keep the counters to themselves: no fault of the kernels
                print(f"ncu did not work ({last_lines(log, 1) or code}): no profile; see {log}")
                return
            with report.with_suffix(".txt").open("w") as text:
                limited([ncu, "--import", report, "--page", "details"], 30, text)

    def peers(self):
        """Others at the same jobs: each that is here adds its rows to peer.csv."""
        programs = {}
        for name, module, package in PYTHON_PEERS:
            # Found, not imported: PhysicsNeMo takes seconds to.
            look = f"import importlib.util, sys; sys.exit(importlib.util.find_spec({module!r}) is None)"
            if subprocess.run(["python3", "-c", look], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode:
                print(f"python3 has no module {module} (pip install {package} brings it): skipped")
            else:
                programs[name] = ["python3", ROOT / f"tests/gpu_check/peer_{name}.py"]
        if (self.build / "peer_nanovdb").exists():
            programs["nanovdb"] = [self.build / "peer_nanovdb"]
        else:
            print("no NanoVDB with MeshToGrid (NANOVDB names a folder with nanovdb/tools/cuda/MeshToGrid.cuh): skipped")
        if not programs:
            return
        say("peers: " + ", ".join(programs))
        folder, log = self.build / "peer", self.build / "peer.log"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        # Peers are compared by magnitude.
        jobs = [*gpu_jobs.peer_jobs(), *(job._replace(output="dense") for job in gpu_jobs.newton_jobs())]
        (self.build / "peer_jobs.txt").write_text(
            "".join((gpu_jobs.small(job) if self.emulated else job).line() + "\n" for job in jobs))
        with (self.build / "peer_jobs.txt").open() as lines:
            exported = self.step("peer files", [self.build / "measure", "--export", folder], 60, log, stdin=lines)
        if exported:
            once = ["--once"] if self.emulated else []
            (self.out / "peer.csv").write_text(PEER_COLUMNS + "\n")
            for name, program in programs.items():
                self.step(f"peer {name}", [*program, *once, *sorted(folder.glob("*.bin"))], 60, self.out / "peer.csv", "a",
                          errors=log)
            print((self.out / "peer.csv").read_text(), end="")
        shutil.rmtree(folder, ignore_errors=True)

    # --- all

    def run(self, parts):
        """The parts' steps, what we want to know most first. `goals` is the beginning of `measure`."""
        if "measure" in parts or "goals" in parts:
            self.measure("the goals", gpu_jobs.goal_jobs(), 60)
        if "check" in parts:
            self.check()
        if "sanitize" in parts:
            self.sanitize()
        if "measure" in parts:
            self.measure("the rest", [*gpu_jobs.goal_jobs(), *gpu_jobs.own_jobs(), *gpu_jobs.thesis_jobs()], 180)
            self.profile()
            self.peers()
