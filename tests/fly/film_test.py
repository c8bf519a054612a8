# SPDX-License-Identifier: Apache-2.0
# labels: none
"""`standoff fly -o` into a folder and a video: what is written, what is refused, and that nothing is left of what failed."""

import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import time

from viewing import MESH, expect, failures

here = pathlib.Path.cwd()
temporary = here / "tmp"
FLIGHT = ("--labyrinth", "scene:labyrinth:1500", "--fly", "a.obj", "--mode", "thesis", "--minimum", "3", "--speed", "3")
SMALL = ("--size", "160x120", "--samples", "1")


def command(*arguments):
    return [os.environ["STANDOFF"], "fly", *FLIGHT, *arguments]


def surroundings(**changes):
    return {**os.environ, "TMPDIR": str(temporary), **changes}


def fly(*arguments, **environment):
    return subprocess.run(command(*arguments), capture_output=True, text=True, env=surroundings(**environment))


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def size_of(picture):
    return struct.unpack(">II", picture.read_bytes()[16:24])


def folders():
    done = fly("--steps", "10", "--every", "3", *SMALL, "--json", "-o", "frames/")
    expect(done.returncode == 0, f"pictures are written: {done.stderr}")
    told = json.loads(done.stdout)
    written = [f"frame-{n:04}.png" for n in range(5)]
    expect(names(here / "frames") == written and told["frames"] == 5, f"a picture for each frame: {names(here / 'frames')}")
    expect({size_of(here / "frames" / name) for name in written} == {(160, 120)}, "they have the size asked for")
    bytes_written = [(here / "frames" / name).read_bytes() for name in written]
    expect(told["output"] == {"file": "frames/", "bytes": sum(map(len, bytes_written))}, f"the answer says what was written: {told}")
    expect(len(set(bytes_written)) == 5, "each differs from the others")
    fly("--steps", "10", "--every", "3", *SMALL, "-j", "1", "-o", "again/")
    expect([(here / "again" / name).read_bytes() for name in written] == bytes_written, "they have the same bytes for any number of threads")

    done = fly("--steps", "3", *SMALL, "-o", "frames/")
    expect(done.returncode == 2 and "is not empty; give -f" in done.stderr, f"a folder that holds something is refused: {done.stderr}")
    expect([(here / "frames" / name).read_bytes() for name in written] == bytes_written, "and stays")
    (here / "frames" / "notes.txt").write_text("mine")
    (here / "frames" / "frame-1.png").write_text("mine too")
    done = fly("--steps", "2", "--background", "dark", *SMALL, "-f", "-o", "frames")
    expect(done.returncode == 0, f"unless it is forced: {done.stderr}")
    expect(names(here / "frames") == ["frame-0000.png", "frame-0001.png", "frame-0002.png", "frame-1.png", "notes.txt"],
           f"pictures of an earlier film go, all else stays: {names(here / 'frames')}")
    expect((here / "frames" / "frame-0000.png").read_bytes() != bytes_written[0], "the pictures are new")
    (here / "empty").mkdir()
    expect(fly("--steps", "1", *SMALL, "-o", "empty").returncode == 0 and len(names(here / "empty")) == 2, "an empty folder is filled")
    for bad, word in ((("-o", "none/frames/"), "does not exist"), (("-o", "a.obj/"), "is a file"), (("-o", "frames.gif"), ".html or .mp4"),
                      (("--size", "20x20"), "there are no pictures"), (("--size", "20x20", "-o", "a.html"), "a page has no pictures"),
                      (("--every", "2"), "there is no film")):
        done = fly("--steps", "1", *bad)
        expect(done.returncode in (2, 4) and word in done.stderr, f"{bad}: {done.returncode} {done.stderr}")


def interrupted(*output):
    """A film of many pictures, stopped while they are drawn."""
    before = names(here)
    process = subprocess.Popen(command("--steps", "5000", "-o", *output), stderr=subprocess.PIPE, text=True, env=surroundings())
    begun = lambda: any(here.glob("**/.standoff-*.part/frame-0002.png")) or any(p.stat().st_size > 40 for p in temporary.glob("*.mp4"))
    deadline = time.monotonic() + 60
    while not begun() and time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.05)
    expect(begun(), f"{output}: the film begins")
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    expect(process.returncode == 130 and "no partial file was left" in said, f"{output}: Ctrl-C ends it: {process.returncode} {said}")
    expect(names(here) == before and not list(temporary.iterdir()), f"{output}: nothing is left: {names(here)} {list(temporary.iterdir())}")


def pretended(script):
    """A folder with a program ffmpeg."""
    folder = here / "programs"
    folder.mkdir(exist_ok=True)
    (folder / "ffmpeg").write_text(f"#!/bin/sh\n{script}\n")
    (folder / "ffmpeg").chmod(0o755)
    return f"{folder}:/usr/bin:/bin"


def videos_that_fail():
    for path in ("", str(here / "nowhere"), "."):
        done = fly("--steps", "1", *SMALL, "-o", "a.mp4", PATH=path)
        expect(done.returncode == 2 and "not on the PATH; install it" in done.stderr, f"no ffmpeg in '{path}': {done.stderr}")
    for script in ("echo it has no such codec >&2; exit 1", "echo it has no such codec >&2; cat >/dev/null; exit 1",
                   "echo it has no such codec >&2; cat >/dev/null"):
        done = fly("--steps", "20", *SMALL, "-o", "a.mp4", PATH=pretended(script))
        expect(done.returncode == 4 and "ffmpeg has failed: it has no such codec" in done.stderr, f"what ffmpeg says is told: {done.returncode} {done.stderr}")
    # Its arguments are what they are: no shell reads them.
    name = "a'; touch hacked; '$(touch hacked).mp4"
    done = fly("--steps", "1", *SMALL, "-o", name, PATH=pretended('for last; do :; done; cat >/dev/null; echo made > "${last#file:}"'))
    expect(done.returncode == 0 and (here / name).read_text() == "made\n" and not (here / "hacked").exists(), f"names are names: {done.stderr}")
    done = fly("--steps", "1", "--size", "161x120", "-o", "a.mp4", PATH=pretended(""))
    expect(done.returncode == 2 and "must be even" in done.stderr, f"odd sides are refused: {done.stderr}")
    expect(not (here / "a.mp4").exists() and not list(temporary.iterdir()), "nothing is left of videos that failed")


def videos():
    if not shutil.which("ffmpeg"):
        print("no ffmpeg; script/bootstrap test installs it")
        return
    done = fly("--steps", "20", "--every", "2", "--rate", "12", *SMALL, "-o", "a.mp4")
    expect(done.returncode == 0, f"a video is written: {done.stderr}")
    probed = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "json", "a.mp4"], capture_output=True, text=True)
    stream = json.loads(probed.stdout)["streams"][0]
    found = [stream[key] for key in ("width", "height", "nb_read_frames", "r_frame_rate", "pix_fmt")]
    expect(found == [160, 120, "11", "12/1", "yuv420p"], f"it holds the frames: {found}")
    done = fly("--steps", "1", *SMALL, "-o", "a.mp4")
    expect(done.returncode == 2 and "it exists; give -f" in done.stderr, f"a video in the way is refused: {done.stderr}")
    interrupted("b.mp4")


def main():
    temporary.mkdir()
    (here / "a.obj").write_text(MESH)
    folders()
    interrupted("stopped/")
    interrupted("frames", "-f")
    videos_that_fail()
    videos()
    sys.exit(1 if failures else 0)


main()
