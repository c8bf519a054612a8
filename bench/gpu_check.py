# SPDX-License-Identifier: Apache-2.0
"""script/gpu-check's work, part by part: builds, then hands over to the steps of gpu_steps.py. script/gpu-check -h says
what it does and how it is called."""

import argparse
import datetime
import hashlib
import os
import sys
import time
from pathlib import Path

import gpu_build
from gpu_build import Unfit, text_of
from gpu_steps import ROOT, Steps, last_lines, limited, say
from harness import commit, write_csv

PARTS = ("build", "check", "sanitize", "measure")
RESULTS = ("machine.txt", "build.log", "kernels.csv", "check.txt", "collide.txt", "sanitizer.txt", "gpu.csv", "measure.log",
           "table-5.4.csv", "peer.csv", "steps.csv", "profile-*")
# Whatever a result hangs on.
SOURCES = ("include", "src", "scenes", "cmake", "tests/gpu_check", "tests/support")


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Unfit(f"{message}; see script/gpu-check -h")


def options_of(arguments):
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("--out")
    parser.add_argument("--only", default="")
    for name in ("--quick", "--again", "--build-only", "--emulated"):
        parser.add_argument(name, action="store_true")
    options = parser.parse_args(arguments)
    chosen = [part for part in options.only.split(",") if part]
    if unknown := [part for part in chosen if part not in PARTS]:
        raise Unfit(f"there is no part '{unknown[0]}', only {', '.join(PARTS)}; see script/gpu-check -h")
    if options.quick:  # goals: the beginning of measure
        chosen = ["goals" if part == "measure" else part for part in chosen] or ["build", "goals", "check"]
    options.parts = chosen or list(PARTS)
    return options


def sources_hash():
    """Of all that the programs are built from."""
    digest = hashlib.sha256()
    for folder in SOURCES:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.suffix in (".h", ".cuh", ".cu", ".cpp", ".cmake", ".txt"):
                digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def begin(out, what, again):
    """Makes the folder of results ready: a later call of the same sources continues there, any other begins anew."""
    out.mkdir(parents=True, exist_ok=True)
    stamp = out / "sources.txt"
    before = stamp.read_text().strip() if stamp.exists() else ""
    if before == what and not again:
        print(f"continuing in {out}")
        return
    for pattern in RESULTS:
        for path in out.glob(pattern):
            path.unlink()
    if before:
        print(f"{out}: what was there is replaced" + ("" if again else ", it is of other sources"))
    stamp.write_text(what + "\n")


def build(folder, settings, limit, out):
    """Builds; the log, and what the kernels take, go to `out` where there is one. Raises Unfit where it fails."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "build.log"
    began, code = time.monotonic(), 0
    with log.open("a") as output:  # what was built before stays told
        for command in gpu_build.build_commands(ROOT / "tests/gpu_check", folder, settings):
            code = code or limited(command, max(1, limit - (time.monotonic() - began)), output)
    if out:
        (out / "build.log").write_text(log.read_text(errors="replace"))
        write_csv(out / "kernels.csv", [], gpu_build.kernels_of(log.read_text(errors="replace")))
    if code != 0:
        print(last_lines(log, 40), file=sys.stderr)
        raise Unfit(f"the build failed or took over {limit} s (above, and {log})")
    print(f"built in {time.monotonic() - began:.0f} s")


def machine_of(nvcc):
    if not nvcc:
        return "the emulated GPU: these times mean nothing\n"
    return (text_of("nvidia-smi", "--query-gpu=name,driver_version,memory.total,clocks.max.sm", "--format=csv") +
            "".join(line + "\n" for line in text_of(nvcc, "--version").splitlines()[-2:]) +
            f"date: {datetime.date.today().isoformat()}\nstandoff: {commit() or 'unknown'}\n")


def main(arguments):
    options = options_of(arguments)
    mode = "build" if options.build_only else "emulated" if options.emulated else "gpu"
    folder = ROOT / "build" / f"gpu-check-{mode}"
    gpu_build.generator()  # says what is missing
    nvcc = None if options.emulated else gpu_build.find_nvcc()
    if options.build_only:
        say("building for all architectures")
        build(folder, [f"-DCMAKE_CUDA_COMPILER={nvcc}", f"-DCMAKE_CUDA_ARCHITECTURES={gpu_build.ALL_ARCHITECTURES}"],
              3600, None)
        return 0
    if options.emulated:  # jobs so small take less time than to build for them
        name, settings = "the emulated GPU", ["-DSTANDOFF_EMULATED=ON", "-DCMAKE_CXX_FLAGS_RELEASE=-O1"]
        out = folder / "results"
    else:
        name, architecture = gpu_build.gpu_name_and_architecture(nvcc)
        settings = [f"-DCMAKE_CUDA_COMPILER={nvcc}", f"-DCMAKE_CUDA_ARCHITECTURES={architecture}",
                    f"-DSTANDOFF_NANOVDB={os.environ.get('NANOVDB', '')}"]
        out = ROOT / "bench/results" / name.lower().replace(" ", "-")
    out = Path(options.out).resolve() if options.out else out
    begin(out, f"{sources_hash()} {name}", options.again)
    (out / "machine.txt").write_text(machine_of(nvcc))
    say(f"building for {name}")
    build(folder, settings, 300, out)
    steps = Steps(out, folder, options.emulated, options.quick)
    steps.run(options.parts)
    say(f"results in {out}")
    if steps.problems:
        print("\n".join(["script/gpu-check: something went wrong:", *steps.problems]), file=sys.stderr)
    return 1 if steps.problems else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Unfit as unfit:
        print(f"script/gpu-check: {unfit}", file=sys.stderr)
        sys.exit(1)
