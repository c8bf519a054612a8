# SPDX-License-Identifier: Apache-2.0
# labels: builds
"""Kernels that spill more, or of which fewer warps fit on a multiprocessor, than kernels.csv says. ptxas knows without a
GPU. What is there is meant: launch bounds take spills for occupancy (docs/cuda.md). After a change that is meant too:
python3 tests/gpu_check/kernels_test.py --write"""

import csv
import os
import re
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(os.environ.get("STANDOFF_SOURCE_DIR", Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(SOURCE / "bench"))
import gpu_build  # noqa: E402

TABLE = SOURCE / "tests" / "gpu_check" / "kernels.csv"
COLUMNS = ["kernel", "registers", "spilled_bytes", "shared_bytes", "warps"]


def nvcc():
    """The compiler and its version, or Nones."""
    for path in ["nvcc", "/usr/local/cuda/bin/nvcc"]:
        try:
            said = subprocess.run([path, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
            return path, re.search(r"release ([\d.]+)", said)[1]
        except (OSError, subprocess.CalledProcessError):
            pass
    return None, None


def warps(registers):
    """How many warps the registers of a multiprocessor of sm_90 have room for; whole blocks are not looked at."""
    return min(64, 65536 // (32 * 8 * -(-registers // 8)))


def compiled(path):
    """A row for each of the library's own kernels, by name."""
    flags = re.search(r"set\(STANDOFF_CUDA_FLAGS (.*)\)", (SOURCE / "cmake" / "cuda_flags.cmake").read_text())[1].split()

    def log_of(source):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([path, "-std=c++20", "-O3", "-DNDEBUG", "-DSTANDOFF_STATIC", *flags, "-arch=sm_90",
                                  "-I", SOURCE / "include", "-I", SOURCE / "src", "-cubin", "-Xptxas=-v",
                                  "-o", Path(folder) / "kernels.cubin", source],
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if run.returncode != 0:
            raise RuntimeError(f"{source}: {run.stdout[-2000:]}")
        return run.stdout

    rows = {}
    with ThreadPoolExecutor(2) as threads:
        for log in threads.map(log_of, sorted((SOURCE / "src").rglob("*.cu"))):
            for kernel in gpu_build.kernels_of(log):
                if kernel["kernel"].startswith("cub::"):
                    continue
                row = {"kernel": kernel["kernel"], "registers": kernel["registers"],
                       "spilled_bytes": kernel["spill_store_bytes"] + kernel["spill_load_bytes"],
                       "shared_bytes": kernel["shared_bytes"]}
                rows[row["kernel"]] = {**row, "warps": warps(row["registers"])}
    return rows


def worse(before, now):
    """What has become worse for a kernel, as a sentence, or nothing."""
    if now["spilled_bytes"] > before["spilled_bytes"]:
        return f"{now['kernel']} spills {now['spilled_bytes']} bytes, where kernels.csv has {before['spilled_bytes']}"
    if now["warps"] < before["warps"]:
        return f"{now['kernel']} has room for {now['warps']} warps, where kernels.csv has {before['warps']}"
    if now["shared_bytes"] > before["shared_bytes"]:
        return f"{now['kernel']} takes {now['shared_bytes']} bytes of shared memory, where kernels.csv has {before['shared_bytes']}"
    return None


def table():
    """The nvcc of the table, and its rows by kernel."""
    first, *lines = TABLE.read_text().splitlines()
    rows = {row["kernel"]: {k: v if k == "kernel" else int(v) for k, v in row.items()} for row in csv.DictReader(lines)}
    return first.removeprefix("# nvcc "), rows


class Kernels(unittest.TestCase):
    def test_no_kernel_spills_or_loses_warps_unannounced(self):
        path, version = nvcc()
        if path is None:
            self.skipTest("no nvcc")
        known, before = table()
        if version != known:
            self.skipTest(f"nvcc {version} is not the table's {known}")
        now = compiled(path)
        self.assertEqual(sorted(now), sorted(before), "kernels came or went: kernels_test.py --write")
        self.assertEqual([text for name in now if (text := worse(before[name], now[name]))], [])

    def test_what_is_worse(self):
        row = {"kernel": "k", "registers": 40, "spilled_bytes": 8, "shared_bytes": 100, "warps": warps(40)}
        self.assertIsNone(worse(row, row))
        self.assertIsNone(worse(row, {**row, "spilled_bytes": 0, "warps": 64}))
        self.assertIn("spills 12 bytes", worse(row, {**row, "spilled_bytes": 12}))
        self.assertIn("48 warps", worse({**row, "warps": 51}, {**row, "warps": 48}))
        self.assertIn("104 bytes of shared", worse(row, {**row, "shared_bytes": 104}))
        self.assertEqual([warps(r) for r in (8, 32, 33, 64, 255)], [64, 64, 51, 32, 8])


if __name__ == "__main__" and sys.argv[1:] == ["--write"]:
    compiler, release = nvcc()
    with open(TABLE, "w") as out:
        out.write(f"# nvcc {release}\n")
        writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(row for _, row in sorted(compiled(compiler).items()))
elif __name__ == "__main__":
    unittest.main()
