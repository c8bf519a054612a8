# SPDX-License-Identifier: Apache-2.0
"""The programs of tests/gpu, built for this machine's GPU: which nvcc, which architecture, ninja or make; and what the
kernels take, out of the build's log."""

import os
import re
import shutil
import subprocess

OLDEST_NVCC = (12, 0)
ALL_ARCHITECTURES = "75-real;80-real;86-real;89-real;90"


class Unfit(Exception):
    """A sentence: why this machine cannot do what was asked, and what to do."""


def text_of(*command):
    """What a command says; empty where it fails or is not there."""
    try:
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    except OSError:
        return ""


def first_line(text):
    return text.strip().split("\n")[0].strip()


def find_nvcc():
    """Its path. Raises Unfit where there is none, or one too old."""
    nvcc = shutil.which("nvcc") or shutil.which("/usr/local/cuda/bin/nvcc")
    if not nvcc:
        raise Unfit("nvcc is not on the PATH nor in /usr/local/cuda/bin; docs/cuda.md says how to get it")
    expect_new_enough(text_of(nvcc, "--version"))
    return nvcc


def expect_new_enough(said):
    """Raises Unfit where nvcc, by what it said of its version, does not know C++20."""
    release = re.search(r"release (\d+)\.(\d+)", said)
    if not release:
        raise Unfit(f"nvcc --version says no release, but: {said.strip() or 'nothing'}; install CUDA anew")
    version = tuple(int(n) for n in release.groups())
    if version < OLDEST_NVCC:
        raise Unfit("nvcc {}.{} is too old: kernels are C++20, which {}.{} is the first to know; "
                    "docs/cuda.md says how to get a newer one".format(*version, *OLDEST_NVCC))


def architecture_for(capability, listed):
    """What to compile for: the GPU's own architecture, or the newest before it that nvcc knows, whose PTX the driver takes.

    `capability` is the driver's ("9.0"), `listed` what nvcc --list-gpu-arch prints. Numbers alone do not tell: there are
    compilers that know 12.1 but not 10.3.
    """
    known = [int(n) for n in re.findall(r"^compute_(\d+)$", listed, re.MULTILINE)]
    if not known:
        raise Unfit("nvcc --list-gpu-arch names no architecture; install CUDA anew")
    if not re.fullmatch(r"\d+\.\d", capability):
        return str(max(known))  # a driver too old to be asked; the check tells whether it fits
    wanted = int(capability.replace(".", ""))
    usable = [one for one in known if one <= wanted]
    if not usable:
        raise Unfit(f"this GPU has compute capability {capability}, this nvcc compiles for {min(known) / 10:.1f} and newer; "
                    "take an older nvcc (12.x knows 5.0 and newer) or a newer GPU")
    return str(max(usable))


def gpu_name_and_architecture(nvcc):
    """Of this machine's first GPU, by its driver. Raises Unfit without one."""
    if not shutil.which("nvidia-smi"):
        raise Unfit("no NVIDIA driver here (nvidia-smi is missing); run this on a machine with a GPU")
    name, capability = (first_line(text_of("nvidia-smi", f"--query-gpu={field}", "--format=csv,noheader"))
                        for field in ("name", "compute_cap"))
    if not name:
        raise Unfit("the driver finds no GPU (see nvidia-smi)")
    return name, architecture_for(capability, text_of(nvcc, "--list-gpu-arch"))


def generator():
    """What CMake is to build with: ninja or make, whichever is there. Raises Unfit without either, CMake or g++."""
    for tool in ("cmake", "g++"):
        if not shutil.which(tool):
            raise Unfit(f"{tool} is missing; install it (Debian: apt-get install cmake g++ ninja-build)")
    for tool, name in (("ninja", "Ninja"), ("make", "Unix Makefiles")):
        if shutil.which(tool):
            return name
    raise Unfit("neither ninja nor make is here; install one (Debian: apt-get install ninja-build)")


def build_commands(source, folder, settings):
    """Configures and builds; what is built already is skipped."""
    # A folder stays with the tool that it was begun with.
    first = [] if (folder / "CMakeCache.txt").exists() else ["-G", generator()]
    jobs = os.environ.get("JOBS") or str(os.cpu_count())
    return [["cmake", "-S", str(source), "-B", str(folder), *first, *settings],
            ["cmake", "--build", str(folder), "--parallel", jobs]]


def short_name(function):
    """A kernel's name without its parameters, and where it is the library's without those of its template."""
    depth = end = 0
    for end, letter in enumerate(function):
        depth += (letter == "<") - (letter == ">")
        if letter == "(" and depth == 0:
            break
    name = re.sub(r"standoff::(cuda|gpu)::|^void ", "", function[:end])
    return name.split("<")[0] if name.startswith("cub::") else name


def kernels_of(log):
    """What ptxas -v says of each kernel in a build's log, a row each, the one with the most registers first."""
    rows, row = {}, None
    for line in log.splitlines():
        if entry := re.search(r"Compiling entry function '(\w+)' for '(\w+)'", line):
            row = rows[entry.groups()] = {"kernel": entry[1], "architecture": entry[2], "registers": 0}
        elif row is not None and (spills := re.search(
                r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line)):
            row.update(zip(("stack_bytes", "spill_store_bytes", "spill_load_bytes"), map(int, spills.groups())))
        elif row is not None and (used := re.search(r"Used (\d+) registers", line)):
            shared = re.search(r"(\d+) bytes smem", line)
            row.update(registers=int(used[1]), shared_bytes=int(shared[1]) if shared else 0)
            row = None
    names = "\n".join(row["kernel"] for row in rows.values())
    if names and shutil.which("c++filt"):
        plain = subprocess.run(["c++filt"], input=names, stdout=subprocess.PIPE, text=True).stdout.splitlines()
        for row, name in zip(rows.values(), plain):
            row["kernel"] = short_name(name)
    return sorted(rows.values(), key=lambda r: -r["registers"])
