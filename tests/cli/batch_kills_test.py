# SPDX-License-Identifier: Apache-2.0
"""Kills at random moments, of the program and of its workers: each time --resume goes on, and at the end the results are, byte
by byte, those of a run that nobody disturbed. STANDOFF_KILLS sets how many; without it some seconds of them."""

import json
import os
import pathlib
import random
import signal
import subprocess
import time

STANDOFF = os.environ["STANDOFF"]
KILLS = int(os.environ.get("STANDOFF_KILLS", 12))  # of each format
MESHES = 24
LIMIT_S = 60  # a run that takes longer hangs
random.seed(31)


def start(out, *options):
    words = [STANDOFF, "batch", "list.txt", "-o", out, "--size", "40,32,36", "-t", "3s", "-j", "2", "-q", *options]
    return subprocess.Popen(words, stderr=subprocess.PIPE, text=True)


def workers_of(process):
    try:
        return [int(pid) for pid in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
    except OSError:
        return []


def files(out):
    """All results. Tables of an array are results too."""
    return {path.relative_to(out): path.read_bytes() for path in pathlib.Path(out).rglob("*") if path.parent != pathlib.Path(out) and path.is_file()}


def rows(out):
    """Of each mesh the last row, without what differs from run to run."""
    last = {}
    for line in pathlib.Path(out, "manifest.jsonl").read_text().splitlines():
        row = json.loads(line)
        last[row["index"]] = {**row, "seconds": None}
    return last


def kill(process, targets):
    """Kills one of them; False where none of them is left, also if it has ended just now."""
    if process.poll() is not None or not targets:
        return False
    try:
        os.kill(random.choice(targets), signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True


def end(process):
    said = process.communicate(timeout=LIMIT_S)[1]
    return process.returncode, said


pathlib.Path("list.txt").write_text("".join(f"scene:sphere:{2000 + 100 * n}\n" for n in range(MESHES)))
for format in ("npz", "array"):
    began = time.monotonic()
    assert end(start(f"{format}-whole", "--format", format))[0] == 0
    whole_s = time.monotonic() - began
    out, killed, ended = f"{format}-killed", {"program": 0, "worker": 0}, 0
    options = ["--format", format]
    for _ in range(10 * KILLS + 100):
        if sum(killed.values()) >= KILLS:
            break
        process = start(out, *options)
        options = ["--format", format, "--resume"]
        # So that every moment of a run may be hit; what is done already is passed over quickly.
        time.sleep(random.random() * random.choice((0.1, 0.5, 1)) * whole_s)
        who = random.choice(("program", "worker"))
        targets = [process.pid] if who == "program" else workers_of(process)
        if not kill(process, targets):
            assert end(process)[0] in (0, 3)
            ended += 1
            if ended % 2 == 0:  # nothing is left to disturb: begin anew
                options = ["--format", format, "-f"]
            continue
        code, said = end(process)
        assert code in (-signal.SIGKILL, 0, 3), (who, code, said)
        killed[who] += who == "worker" or code < 0  # it may just have ended by itself
    assert sum(killed.values()) >= KILLS, f"{killed}: {ended} runs ended before they could be killed"
    code, said = end(start(out, "--format", format, "--resume"))
    assert code == 0, said
    assert rows(out) == rows(f"{format}-whole")
    assert files(out) == files(f"{format}-whole")
    assert not list(pathlib.Path(out).rglob(".standoff-*"))
    print(format, killed, f"{time.monotonic() - began:.1f} s")
