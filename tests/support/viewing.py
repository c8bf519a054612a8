# SPDX-License-Identifier: Apache-2.0
"""What the tests of pages and their server share."""

import contextlib
import os
import subprocess

# A tetrahedron, as an OBJ file.
MESH = "v 0 0 0\nv 2 0 0\nv 0 1.5 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
failures = []


def expect(condition, what):
    if not condition:
        failures.append(what)
        print(f"FAILED: {what}")


@contextlib.contextmanager
def served(*arguments, environment=None):
    """The program and the address that it prints."""
    program = subprocess.Popen([os.environ["STANDOFF"], *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    try:
        yield program, program.stdout.readline().strip()
    finally:
        program.kill()
        program.communicate()
