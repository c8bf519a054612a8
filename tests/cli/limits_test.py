# SPDX-License-Identifier: Apache-2.0
"""What every verb does with more threads than there are cores, with damaged files of poses, and with little memory."""

import os
import random
import re
import resource
import subprocess
import unittest
from pathlib import Path

STANDOFF = os.environ["STANDOFF"]
LIMIT = 5  # exit code: over a limit


def run(*words, memory=None):
    """Runs the program, with at most `memory` bytes of address space."""

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    return subprocess.run(
        [STANDOFF, *map(str, words)], capture_output=True, timeout=120, preexec_fn=limit if memory else None
    )


def write_lines(name, rows):
    Path(name).write_text("".join(",".join(str(number) for number in row) + "\n" for row in rows))
    return name


def poses(count, width):
    numbers = random.Random(1)
    return [[round(numbers.uniform(-2, 2), 6) for _ in range(width)] for _ in range(count)]


def setUpModule():
    write_lines("points.csv", poses(20_000, 3))
    write_lines("poses.csv", poses(300, 3))
    write_lines("motions.csv", poses(100, 6))
    for verb in (
        ("compute", "scene:sphere:2000", "-r", "40", "-o", "field.vti"),
        ("build", "scene:sphere:2000", "-o", "sphere.body"),
    ):
        assert run(*verb).returncode == 0


# One call of each verb that takes --threads; {} is the output.
CALLS = {
    "compute": ("compute", "scene:sphere:2000", "-r", "40", "--sign", "auto", "-o", "{}.vti"),
    "compute open": ("compute", "scene:open:500", "-r", "24", "--sign", "winding", "-o", "{}.npz"),
    "surface of a mesh": ("surface", "scene:sphere:2000", "-r", "30", "--method", "dual", "-o", "{}.ply"),
    "surface of a field": ("surface", "field.vti", "--at", "0.05", "-o", "{}.ply"),
    "points": ("points", "scene:sphere:2000", "points.csv", "--sign", "auto", "-o", "{}.npy"),
    "crossings": ("crossings", "scene:sphere:2000", "-r", "30", "-o", "{}.npz"),
    "voxels": ("voxels", "scene:sphere:2000", "-r", "30", "-o", "{}.npz"),
    "build": ("build", "scene:sphere:2000", "-o", "{}.body"),
    "build a query": ("build", "scene:sphere:2000", "-o", "{}.query"),
    "collide": ("collide", "sphere.body", "scene:box", "--poses", "poses.csv", "-o", "{}.csv"),
    "distance": ("distance", "sphere.body", "scene:box", "--poses", "poses.csv", "-o", "{}.csv"),
    "sweep": ("sweep", "sphere.body", "scene:box", "--motions", "motions.csv", "-o", "{}.csv"),
    "render": ("render", "scene:sphere:2000", "--size", "120x90", "-o", "{}.png"),
}


def output_of(call, name):
    return next(word for word in call if word.startswith("{}")).format(name)


def words_of(call, name):
    return [word.format(name) if word.startswith("{}") else word for word in call]


class Threads(unittest.TestCase):
    def test_more_than_cores_give_the_same_bytes(self):
        for what, call in CALLS.items():
            with self.subTest(what):
                files = []
                for threads in (1, 3 * os.cpu_count() + 40):
                    name = f"{what} {threads}".replace(" ", "_")
                    ran = run(*words_of(call, name), "--threads", threads)
                    self.assertEqual(ran.returncode, 0, ran.stderr)
                    files.append(Path(output_of(call, name)).read_bytes())
                self.assertEqual(files[0], files[1])

    def test_every_verb_with_threads_is_called(self):
        verbs = re.findall(r"^  ([a-z]+) +\S", run("help").stdout.decode(), re.MULTILINE)
        self.assertIn("compute", verbs)
        with_threads = {verb for verb in verbs if b"--threads" in run(verb, "--help").stdout}
        # verify compares, view and fly serve or draw, batch takes a list: tests of their own.
        self.assertEqual(with_threads - {"verify", "view", "fly", "batch"}, {call[0] for call in CALLS.values()})


class Memory(unittest.TestCase):
    """The program needs some address space to start: from a limit at which the work fails to one at which it succeeds."""

    def test_too_little_is_an_error_that_leaves_nothing(self):
        met = set()
        for what, call in CALLS.items():
            for megabytes in (70, 100, 140, 200, 400):
                with self.subTest(what, megabytes=megabytes):
                    name = f"{what} {megabytes}M".replace(" ", "_")
                    ran = run(*words_of(call, name), "--threads", 1, memory=megabytes << 20)
                    if b"error while loading shared libraries" in ran.stderr:
                        continue
                    met.add(ran.returncode)
                    self.assertIn(ran.returncode, (0, LIMIT), ran.stderr)
                    self.assertEqual(Path(output_of(call, name)).exists(), ran.returncode == 0)
                    if ran.returncode == LIMIT:
                        self.assertRegex(ran.stderr.decode(), r"(?m)^standoff: error: .*memory")
        self.assertEqual(met, {0, LIMIT})
        self.assertEqual([path.name for path in Path(".").iterdir() if path.name.startswith(".")], [])


class DamagedPoses(unittest.TestCase):
    def test_rows_are_read_or_named(self):
        numbers = random.Random(7)
        table = Path("poses.csv").read_bytes()[:2000]
        calls = (("collide", "--poses"), ("distance", "--poses"), ("sweep", "--motions"))
        met = set()
        for n in range(90):
            verb, option = calls[n % 3]
            damaged = bytearray(table)
            for _ in range(numbers.randint(1, 6)):
                damaged[numbers.randrange(len(damaged))] = numbers.choice(
                    (numbers.randrange(256), *b"0x,e\n- +.\"'#;\0")
                )
            if n % 4 == 0:
                damaged = damaged[: numbers.randrange(len(damaged))]
            Path("damaged.csv").write_bytes(damaged)
            with self.subTest(verb, n=n):
                ran = run(verb, "sphere.body", "scene:box", option, "damaged.csv", "-o", "answers.csv", "-f")
                met.add(ran.returncode)
                self.assertIn(ran.returncode, (0, 3), ran.stderr)
                if ran.returncode == 3:
                    self.assertRegex(ran.stderr.decode(), r"damaged\.csv(:\d+)?.*\n$")
                    self.assertLess(len(ran.stderr), 400)
                    self.assertTrue(ran.stderr.decode().isprintable() or ran.stderr.count(b"\n") == 1)
        self.assertIn(3, met)


if __name__ == "__main__":
    unittest.main()
