# SPDX-License-Identifier: Apache-2.0
"""Stores that a cluster writes, with processes killed at random moments: nothing is lost, wrong or left half-written.

STANDOFF_CHECK_KILLS=200 kills so often, STANDOFF_CHECK_SEED begins elsewhere.
"""

import os
import random
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest
import shapes

pytest.importorskip("distributed", reason="the extra standoff[dask] is not installed")
import standoff.dask as sd

KILLS = int(os.environ.get("STANDOFF_CHECK_KILLS", 4))
SEED = int(os.environ.get("STANDOFF_CHECK_SEED", 1))
SIZES = {"resolution": 160, "band": 3, "shard": 32, "chunk": 16}

# Says its workers, and writes the store.
WRITER = """
    import os, sys
    sys.path.insert(0, sys.argv[1])
    import shapes, standoff.dask as sd
    from distributed import Client, LocalCluster

    if __name__ == "__main__":
        with (
            LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            print(*client.run(os.getpid).values(), flush=True)
            sd.write(sys.argv[2], shapes.sphere(8), client=client, resolution=160, band=3, shard=32, chunk=16)
            print("written", flush=True)
"""


def content(store):
    return {path.relative_to(store).as_posix(): path.read_bytes() for path in store.rglob("*") if path.is_file()}


@pytest.fixture
def writer(tmp_path):
    (tmp_path / "writer.py").write_text(textwrap.dedent(WRITER))

    def start(store):
        command = [sys.executable, str(tmp_path / "writer.py"), str(Path(__file__).parent), str(store)]
        with open(tmp_path / "errors.txt", "w") as errors:
            process = subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=errors, text=True, start_new_session=True
            )
        return process, [int(word) for word in process.stdout.readline().split()]

    return start


def ended(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def wait_for(pids):
    for _ in range(3000):
        if all(map(ended, pids)):
            return
        time.sleep(0.01)
    raise AssertionError(f"{pids} go on")


def test_whatever_is_killed_the_store_is_the_same(tmp_path, writer):
    sd.write(tmp_path / "serial.zarr", shapes.sphere(8), **SIZES)
    expected = content(tmp_path / "serial.zarr")
    numbers = random.Random(SEED)
    process, workers = writer(tmp_path / "undisturbed.zarr")
    began = time.monotonic()
    assert process.stdout.readline() == "written\n"
    longest = time.monotonic() - began
    assert process.wait(timeout=60) == 0
    process.stdout.close()
    assert content(tmp_path / "undisturbed.zarr") == expected
    for n in range(KILLS):
        store = tmp_path / f"{n}.zarr"
        process, workers = writer(store)
        assert len(workers) == 2
        time.sleep(numbers.uniform(0, longest))
        kills_client = numbers.random() < 0.5
        if kills_client:
            os.killpg(process.pid, signal.SIGKILL)
        elif not ended(workers[0]):
            os.kill(workers[0], signal.SIGKILL)
        said, _ = process.communicate(timeout=120)
        wait_for(workers)
        if not kills_client:
            assert (process.returncode, said) == (0, "written\n"), (tmp_path / "errors.txt").read_text()
        # Files have their bytes, or are not there; what a killed process leaves has another name.
        found = {name: data for name, data in (content(store) if store.exists() else {}).items() if ".part" not in name}
        wrong = [name for name, data in found.items() if expected.get(name) != data]
        assert wrong == [] and (kills_client or found.keys() == expected.keys()), f"kill {n} of seed {SEED}"
        sd.write(store, shapes.sphere(8), **SIZES)
        after = {name: data for name, data in content(store).items() if ".part" not in name}
        assert after == expected, f"kill {n} of seed {SEED}"
